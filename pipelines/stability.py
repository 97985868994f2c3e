"""Stability: is every answer right, or refused for a reason? python pipelines/stability.py -o results/studies."""

from studies.stability.measure import FULL, QUICK, measure
from studies.stability.report import draw, report
from studies.study import Study

STUDY = Study(
    "stability",
    "Stability when stiff, small, steep or close to the fold",
    measure,
    draw,
    report,
    f"{sum(QUICK.values())} of {sum(FULL.values())} cases, three shapes, one crowd",
)

if __name__ == "__main__":
    STUDY.command()
