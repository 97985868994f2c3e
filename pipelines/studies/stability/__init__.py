"""Is every answer right, or refused for a reason, when stiff, soft, small, steep or close to the fold?"""

from studies.stability.crowding import crowds
from studies.stability.measure import COUNTED, COUNTED_QUICKLY, FULL, QUICK, measure
from studies.stability.metamorphic import KINDS
from studies.stability.metamorphic import QUICK as QUICK_KINDS
from studies.stability.report import draw, report
from studies.study import Study

STUDY = Study(
    "stability",
    "Stability when stiff, small, steep or close to the fold",
    measure,
    draw,
    report,
    f"{sum(QUICK.values())} of {sum(FULL.values())} cases, "
    f"equilibria counted in {COUNTED_QUICKLY} of {COUNTED}; changes of the problem on "
    f"{len(QUICK_KINDS)} of {len(KINDS)} shapes; {len([*crowds(True)])} of {len([*crowds(False)])} crowds",
)
