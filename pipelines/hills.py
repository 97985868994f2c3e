"""Summits and hills of maps against boundary elements: python pipelines/hills.py."""

from studies.hills.measure import measure
from studies.hills.report import draw, report
from studies.study import Study

STUDY = Study("hills", "Summits and hills of maps against boundary elements", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
