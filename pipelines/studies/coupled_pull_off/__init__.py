"""The study of the pull-off of sticky rough surfaces, of which the asperities are independent or feel each other."""

from studies.coupled_pull_off.measure import COUNTS, DISTANCES, REALIZATIONS, SPREADS, USUAL, measure
from studies.coupled_pull_off.report import draw, report
from studies.study import Study

STUDY = Study(
    "coupled_pull_off",
    "Pull-off with and without coupling",
    measure,
    draw,
    report,
    f"{USUAL[True][0]} in place of {USUAL[False][0]} asperities, "
    f"at most {USUAL[True][0]} in place of {max(COUNTS[False])}; "
    f"{len(DISTANCES[True])} of {len(DISTANCES[False])} distances, "
    f"{len(SPREADS[True])} of {len(SPREADS[False])} spreads of heights, "
    f"{REALIZATIONS[True]} of {REALIZATIONS[False]} realisations",
)
