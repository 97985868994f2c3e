"""Named laws from the literature, to stand beside computed ones. Arrays in and out, SI."""

from roughmdr.theory.fuller import fuller_tabor
from roughmdr.theory.greenwood import greenwood_williamson
from roughmdr.theory.maugis import dmt_maugis

__all__ = ["dmt_maugis", "fuller_tabor", "greenwood_williamson"]
