"""Scenes with the mistakes that users make, each refused or with a statement of trust: python pipelines/traps.py."""

from studies.study import Study
from studies.traps import COUNT, QUICK_COUNT, draw, measure, report

STUDY = Study("traps", "Mistakes in scenes", measure, draw, report, f"{QUICK_COUNT} of {COUNT} scenes")

if __name__ == "__main__":
    STUDY.command()
