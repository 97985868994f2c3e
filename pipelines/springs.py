"""The row of springs, its convergence and its run time: python pipelines/springs.py -o results/studies."""

from figures.springs import measure, report
from figures.springs_pictures import PICTURES
from studies.study import Study

STUDY = Study("springs", "One asperity as a row of springs", measure, PICTURES, report)

if __name__ == "__main__":
    STUDY.command()
