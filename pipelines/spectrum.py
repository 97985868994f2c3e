"""Sources nayak and spectrum against boundary elements: python pipelines/spectrum.py."""

from studies.spectrum.measure import QUICK, REALIZATIONS, measure
from studies.spectrum.report import draw, report
from studies.study import Study

STUDY = Study(
    "spectrum",
    "Sources nayak and spectrum against boundary elements",
    measure,
    draw,
    report,
    f"{QUICK} of {REALIZATIONS} realisations",
)

if __name__ == "__main__":
    STUDY.command()
