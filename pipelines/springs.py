"""The row of springs and how it converges: python pipelines/springs.py -o results/studies."""

from figures.springs import COUNTS, PICTURES, QUICK, measure, report
from studies.study import Study

STUDY = Study(
    "springs",
    "One asperity as a row of springs",
    measure,
    PICTURES,
    report,
    f"rows of up to {max(QUICK)} of {max(COUNTS)} springs",
)

if __name__ == "__main__":
    STUDY.command()
