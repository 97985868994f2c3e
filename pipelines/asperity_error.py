"""The bound on the error of the force of single asperities: python pipelines/asperity_error.py -o results/studies."""

from studies.asperity_error.measure import COUNT, QUICK, measure, report
from studies.study import Study

TITLE = "Single asperities up to their folds: is the bound on the error a bound?"
STUDY = Study("asperity_error", TITLE, measure, {}, report, f"{QUICK} of {COUNT} asperities")

if __name__ == "__main__":
    STUDY.command()
