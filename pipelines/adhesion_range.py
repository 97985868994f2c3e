"""Adhesion of finite range, and where JKR ends: python pipelines/adhesion_range.py -o results/studies."""

from figures.adhesion_range import ASPERITIES, TABOR_NUMBERS, draw, measure, report
from studies.study import Study

STUDY = Study(
    "adhesion_range",
    "Adhesion of finite range",
    measure,
    draw,
    report,
    f"{TABOR_NUMBERS[True]} of {TABOR_NUMBERS[False]} Tabor numbers, "
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities",
)

if __name__ == "__main__":
    STUDY.command()
