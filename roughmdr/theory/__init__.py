"""Named laws from the literature, to stand beside computed ones. Arrays in and out, SI."""

from roughmdr.theory.bush import bush_gibson_thomas, bush_gibson_thomas_asymptote
from roughmdr.theory.fuller import fuller_tabor
from roughmdr.theory.greenwood import greenwood_williamson
from roughmdr.theory.maugis import dmt_maugis
from roughmdr.theory.mildly_elliptic import greenwood_elliptic

__all__ = [
    "bush_gibson_thomas",
    "bush_gibson_thomas_asymptote",
    "dmt_maugis",
    "fuller_tabor",
    "greenwood_elliptic",
    "greenwood_williamson",
]
