"""Time and memory that roughmdr plan foresees, and that the runs then take.

python pipelines/foreseen.py -o results/studies
"""

from benchmarks.batch import tables
from benchmarks.foreseen import SCENES, draw, measure
from studies.study import Study

STUDY = Study("foreseen", "What roughmdr plan foresees", measure, draw, tables, f"1 of {len(SCENES)} scenes")

if __name__ == "__main__":
    STUDY.command()
