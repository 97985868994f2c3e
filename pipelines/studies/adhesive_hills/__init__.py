"""Force, area, pull-off and loss of adhesive maps by summits, hills and adhesive boundary elements."""

from studies.adhesive_hills.cases import CASES, QUICK
from studies.adhesive_hills.measure import measure
from studies.adhesive_hills.picture import draw
from studies.adhesive_hills.report import report
from studies.adhesive_hills.stated import FEW, MAPS
from studies.study import Study

STUDY = Study(
    "adhesive_hills",
    "Adhesive hills of maps against boundary elements",
    measure,
    draw,
    report,
    f"{len(QUICK)} cases in place of {len(CASES)}, on coarser grids and with fewer steps; stated errors on "
    f"{sum(map(len, FEW.values()))} maps in place of {sum(map(len, MAPS.values()))}",
)
