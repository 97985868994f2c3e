"""Force and contact area of maps by summits, by hills and by coarse boundary elements, with their run times."""

from studies.hills.convergence import QUICK_TRIALS, TRIALS
from studies.hills.draw import draw, draw_convergence
from studies.hills.maps import ANISOTROPIC, ISOTROPIC, QUICK
from studies.hills.measure import measure
from studies.hills.report import report
from studies.study import Study

STUDY = Study(
    "hills",
    "Summits and hills of maps against boundary elements",
    measure,
    {"hills": draw, "hills_convergence": draw_convergence},
    report,
    f"{len(QUICK)} of {len(ISOTROPIC) + len(ANISOTROPIC)} maps; convergence on "
    f"{len(QUICK_TRIALS)} smaller maps in place of {len(TRIALS)}, with elements half as fine; "
    "smaller pieces of measured maps",
)
