"""The conductance of asperities against the stiffness of boundary elements."""

from studies.conductance.measure import measure
from studies.conductance.report import draw, report
from studies.conductance.surfaces import CASES, QUICK
from studies.study import Study

STUDY = Study(
    "conductance",
    "Conductance against boundary elements",
    measure,
    draw,
    report,
    f"{len(QUICK)} cases, mostly smaller ones on coarser grids, in place of {len(CASES)}",
)
