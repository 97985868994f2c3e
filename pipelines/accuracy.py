"""How often a run meets the error asked for by [accuracy], and how many realisations it takes.

python pipelines/accuracy.py -o results/studies
"""

from studies.accuracy import REALIZATIONS, RUNS, draw, measure, report
from studies.study import Study

STUDY = Study(
    "accuracy",
    "Errors asked for, and reached",
    measure,
    draw,
    report,
    f"{RUNS[True]} of {RUNS[False]} runs, drawn from {REALIZATIONS[True]} of {REALIZATIONS[False]} realisations",
)

if __name__ == "__main__":
    STUDY.command()
