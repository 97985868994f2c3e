"""Scenes drawn at random, each refused in words or physically right: python pipelines/random_scenes.py."""

from studies.random_scenes.measure import measure
from studies.random_scenes.report import draw, report
from studies.study import Study

STUDY = Study("random_scenes", "Scenes drawn at random", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
