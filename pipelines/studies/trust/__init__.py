"""The stated error of the force against the true one, scene by scene."""

from studies.study import Study
from studies.trust.measure import measure
from studies.trust.report import draw, report
from studies.trust.scenes import CASES, QUICK

STUDY = Study(
    "trust",
    "How far the force can be trusted: stated and true errors",
    measure,
    draw,
    report,
    f"{len(QUICK)} of {len(CASES)} scenes",
)
