"""Measure the cost of a cell, a task and a second worker, memory, and extrapolate to a very large sweep.

python pipelines/batch.py -o results/studies
"""

from benchmarks.batch import draw, measure, report
from studies.study import Study

STUDY = Study(
    "batch",
    "What the batch engine costs",
    measure,
    draw,
    report,
    "few cells, tasks, asperities and realisations, each timed once",
)

if __name__ == "__main__":
    STUDY.command()
