"""Summits of Gaussian surfaces, drawn and found on maps: python pipelines/summits.py -o results/studies."""

from figures.summits import measure, report
from figures.summits_picture import draw
from studies.study import Study

STUDY = Study("summits", "Summits of Gaussian surfaces", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
