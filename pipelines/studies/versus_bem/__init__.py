"""Independent asperities against boundary elements."""

from studies.study import Study
from studies.versus_bem.measure import CASES, QUICK, measure
from studies.versus_bem.report import draw, report

STUDY = Study(
    "versus_bem",
    "What independence costs: against boundary elements",
    measure,
    draw,
    report,
    f"{len(QUICK)} smaller cases in place of {len(CASES)}, on coarser grids",
)
