"""numerical_error against the true error of the force, in random scenes."""

from studies.stated_error.judge import QUICK, SCENES, measure
from studies.stated_error.report import draw, report
from studies.study import Study

STUDY = Study("stated_error", "Is the stated error honest?", measure, draw, report, f"{QUICK} of {SCENES} scenes")
