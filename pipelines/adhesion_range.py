"""Adhesion of finite range, and where JKR ends: python pipelines/adhesion_range.py -o results/studies."""

from figures.adhesion_range import draw, measure, report
from studies.study import Study

STUDY = Study("adhesion_range", "Adhesion of finite range", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
