"""The conductance of asperities against boundary elements: python pipelines/conductance.py."""

from studies.conductance.measure import measure
from studies.conductance.report import draw, report
from studies.study import Study

STUDY = Study("conductance", "Conductance against boundary elements", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
