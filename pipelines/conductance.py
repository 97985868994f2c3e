"""The conductance of asperities against boundary elements: python pipelines/conductance.py."""

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

if __name__ == "__main__":
    STUDY.command()
