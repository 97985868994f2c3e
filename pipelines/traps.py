"""Scenes with the mistakes that users make, each refused or with a statement of trust: python pipelines/traps.py."""

from studies.study import Study
from studies.traps import draw, measure, report

STUDY = Study("traps", "Mistakes in scenes", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
