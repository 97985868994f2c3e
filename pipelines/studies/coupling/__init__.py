"""The study of coupled asperities: error against run time, and run time against their number."""

from studies.coupling.costs import COUNTS
from studies.coupling.measure import measure
from studies.coupling.methods import GRIDS
from studies.coupling.report import draw, report
from studies.study import Study

STUDY = Study(
    "coupling",
    "Coupled asperities: error and run time",
    measure,
    draw,
    report,
    f"up to {max(COUNTS[True])} of {max(COUNTS[False])} asperities, one error; "
    f"boundary elements of up to {max(GRIDS[True])} of {max(GRIDS[False])} points a side",
)
