"""How often a run meets the error asked for by [accuracy], and how many realisations it takes.

python pipelines/accuracy.py -o results/studies
"""

from studies.accuracy.measure import measure
from studies.accuracy.report import draw, report
from studies.study import Study

STUDY = Study("accuracy", "Errors asked for, and reached", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
