"""Count what a scene calls and keeps with each part that it does not need left out, and forced on.

python pipelines/left_out.py -o results/studies
"""

from studies.left_out import ASPERITIES, RUNS, draw, measure, report
from studies.study import Study

STUDY = Study(
    "left_out",
    "What leaving out saves",
    measure,
    draw,
    report,
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities, {RUNS[True]} of {RUNS[False]} realisations",
)

if __name__ == "__main__":
    STUDY.command()
