"""Time a visited asperity and step, against NumPy and SciPy; two workers; a million asperities; a cell.

python pipelines/scaling.py -o results/studies
"""

from benchmarks.scaling import ASPERITIES, draw, measure, report
from studies.study import Study

STUDY = Study(
    "scaling",
    "What the sum costs",
    measure,
    draw,
    report,
    f"up to {ASPERITIES[True]} of {ASPERITIES[False]} asperities, each timed once",
)

if __name__ == "__main__":
    STUDY.command()
