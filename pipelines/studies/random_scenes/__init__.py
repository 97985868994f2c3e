"""Scenes drawn at random, each refused in words or physically right."""

from studies.random_scenes.measure import FULL, QUICK, QUICK_COHESIVE, measure
from studies.random_scenes.report import draw, report
from studies.study import Study

STUDY = Study(
    "random_scenes",
    "Scenes drawn at random",
    measure,
    draw,
    report,
    f"{QUICK} of {FULL} scenes; adhesion of finite range on the shapes {' and '.join(QUICK_COHESIVE)} alone",
)
