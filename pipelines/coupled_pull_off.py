"""Pull-off of sticky rough surfaces with asperities independent and coupled: python pipelines/coupled_pull_off.py."""

from studies.coupled_pull_off.measure import REALIZATIONS, USUAL, measure
from studies.coupled_pull_off.report import draw, report
from studies.study import Study

STUDY = Study(
    "coupled_pull_off",
    "Pull-off with and without coupling",
    measure,
    draw,
    report,
    f"{USUAL[True][0]} of {USUAL[False][0]} asperities, {REALIZATIONS[True]} of {REALIZATIONS[False]} realisations, "
    "fewer distances",
)

if __name__ == "__main__":
    STUDY.command()
