"""The stated error of the force against the true one, scene by scene: python pipelines/trust.py."""

from studies.study import Study
from studies.trust.measure import measure
from studies.trust.report import draw, report

STUDY = Study("trust", "How far the force can be trusted: stated and true errors", measure, draw, report)

if __name__ == "__main__":
    STUDY.command()
