"""Summits of Gaussian surfaces, drawn and found on maps: python pipelines/summits.py -o results/studies."""

from figures.summits import MAPS, draw, measure, report
from studies.study import Study

STUDY = Study(
    "summits",
    "Summits of Gaussian surfaces",
    measure,
    draw,
    report,
    f"{MAPS[True]} of {MAPS[False]} maps, on coarser grids; a tenth of the drawn summits",
)

if __name__ == "__main__":
    STUDY.command()
