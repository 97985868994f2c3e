"""Adhesive asperities coupled in pairs against boundary elements with an attraction of finite range."""

from studies.study import Study
from studies.versus_adhesive_bem.measure import CASES, QUICK, measure
from studies.versus_adhesive_bem.report import draw, report

STUDY = Study(
    "versus_adhesive_bem",
    "Adhesive pairs against boundary elements",
    measure,
    draw,
    report,
    f"{len(QUICK)} cases in place of {len(CASES)}, on coarser grids",
)
