"""One asperity under JKR adhesion: python pipelines/one_asperity.py -o results/studies."""

from figures.one_asperity import POINTS, QUICK, measure, report
from figures.one_asperity_pictures import PICTURES
from studies.study import Study

STUDY = Study(
    "one_asperity", "One asperity under JKR adhesion", measure, PICTURES, report, f"{QUICK} of {POINTS} shapes"
)

if __name__ == "__main__":
    STUDY.command()
