"""Summits of Gaussian surfaces, drawn and found on maps: python pipelines/summits.py -o results/studies."""

from figures.summits import draw, measure, report
from studies.study import Study

STUDY = Study("summits", "Summits of Gaussian surfaces", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
