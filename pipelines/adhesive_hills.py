"""Adhesive hills and summits of maps against boundary elements: python pipelines/adhesive_hills.py."""

from studies.adhesive_hills.measure import measure
from studies.adhesive_hills.picture import draw
from studies.adhesive_hills.report import report
from studies.study import Study

STUDY = Study("adhesive_hills", "Adhesive hills of maps against boundary elements", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
