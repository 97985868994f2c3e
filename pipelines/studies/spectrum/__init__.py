"""Surfaces of one spectrum as summits by Nayak, as summits and hills of maps, and by boundary elements."""

from studies.spectrum.measure import QUICK, REALIZATIONS, measure
from studies.spectrum.report import draw, report
from studies.study import Study

STUDY = Study(
    "spectrum",
    "Sources nayak and spectrum against boundary elements",
    measure,
    draw,
    report,
    f"{QUICK} of {REALIZATIONS} realisations",
)
