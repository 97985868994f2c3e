"""The demo's asperities with and without feeling each other: python pipelines/interaction.py -o results/studies."""

from figures.interaction import ASPERITIES, draw, measure, report
from studies.study import Study

STUDY = Study(
    "interaction",
    "Asperities that feel each other",
    measure,
    draw,
    report,
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities, a quarter of the steps",
)

if __name__ == "__main__":
    STUDY.command()
