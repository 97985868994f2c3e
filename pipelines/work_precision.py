"""Error against run time, a curve for each method: of one asperity, and of the mean curve of a rough surface.

python pipelines/work_precision.py -o results/studies
"""

from studies.study import Study
from studies.work_precision.measure import measure
from studies.work_precision.report import draw, report

STUDY = Study(
    "work_precision",
    "Error against run time",
    measure,
    draw,
    report,
    "every other setting, timed once, fewer draws and runs; without the last scene of each part",
)

if __name__ == "__main__":
    STUDY.command()
