"""Stability: is every answer right, or refused for a reason? python pipelines/stability.py -o results/studies."""

from studies.stability.measure import measure
from studies.stability.report import draw, report
from studies.study import Study

STUDY = Study("stability", "Stability when stiff, small, steep or close to the fold", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
