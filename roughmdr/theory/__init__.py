"""Named theories of rough contact from the literature, to stand beside computed curves. Arrays in and out, SI."""

from roughmdr.theory.bush import bush_gibson_thomas, bush_gibson_thomas_asymptote, greenwood_elliptic
from roughmdr.theory.cooper import cooper_mikic_yovanovich
from roughmdr.theory.equal_summits import dmt_maugis, fuller_tabor, greenwood_williamson
from roughmdr.theory.geike import RoughLine, line_heights, rough_line
from roughmdr.theory.persson import persson_contact_fraction, persson_pressure, persson_separation

__all__ = [
    "RoughLine",
    "bush_gibson_thomas",
    "bush_gibson_thomas_asymptote",
    "cooper_mikic_yovanovich",
    "dmt_maugis",
    "fuller_tabor",
    "greenwood_elliptic",
    "greenwood_williamson",
    "line_heights",
    "persson_contact_fraction",
    "persson_pressure",
    "persson_separation",
    "rough_line",
]


def __dir__() -> list[str]:
    return sorted(__all__)
