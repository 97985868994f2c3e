"""The demo's asperities with and without feeling each other: python pipelines/interaction.py -o results/studies."""

from figures.interaction import draw, measure, report
from studies.study import Study

STUDY = Study("interaction", "Asperities that feel each other", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
