"""How often a run meets the error asked for by [accuracy], and how many realisations it takes.

python pipelines/accuracy.py -o results/studies
"""

from studies.accuracy import draw, measure, report
from studies.study import Study

STUDY = Study("accuracy", "Errors asked for, and reached", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
