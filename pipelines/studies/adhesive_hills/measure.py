"""Press maps and pull them off by each method along the same path."""

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.adhesive_hills.cases import CASES, QUICK, Adhesive, Case, Law
from studies.adhesive_hills.stated import FEW, MAPS, measure_stated
from studies.hills.maps import SIDE
from studies.study import named

METHODS = ("summits", "summits in pairs", "hills", "hills in pairs", "hills, Dugdale")
ELEMENTS = ("elements", "coarse grid", "longer range")
_COARSE = 2.0 / 3.0
"""Of the points of a grid."""
LONGER = 1.5
"""The longer range over the range."""
_DEPTHS = (0.02, 0.03, 0.05, 0.07, 0.1, 0.15)
"""Contact fractions of independent hills at which pairs are tried for an equilibrium."""


def laws(adhesive: Adhesive, separation: Floats) -> list[Law]:
    """Return the laws by boundary elements, on a coarser grid and with a longer range, and by each method."""
    points, reach = adhesive.case.points, adhesive.reach
    hills, summits = adhesive.hills, adhesive.summits
    return [
        adhesive.by_elements(separation, points, reach),
        adhesive.by_elements(separation, _COARSE * points, reach),
        adhesive.by_elements(separation, _COARSE * points, LONGER * reach),
        adhesive.law(summits, separation),
        adhesive.law(summits, separation, interaction="pairwise"),
        adhesive.law(hills, separation),
        adhesive.law(hills, separation, interaction="pairwise"),
        adhesive.law(hills, separation, adhesion="dugdale", strength=adhesive.work / reach),
    ]


def lost_from(adhesive: Adhesive) -> float:
    """Return the contact fraction of independent hills at the first depth where pairs fail; NaN where they do not."""
    for depth in _DEPTHS:
        deeper = Adhesive(adhesive.case._replace(preload=depth))
        loading = deeper.path()[: adhesive.case.steps]
        if np.isnan(deeper.law(deeper.hills, loading, interaction="pairwise").force).any():
            return depth
    return float("nan")


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or one of them on coarse grids."""
    cases = QUICK if quick else CASES
    adhesive = [Adhesive(case) for case in cases]
    paths = [one.path() for one in adhesive]
    numbers = np.array([laws(one, path) for one, path in zip(adhesive, paths, strict=True)])
    lost = [lost_from(one) for one in adhesive]
    over = ("case", "source", "step")
    return xr.Dataset(
        {
            "force": (over, numbers[:, :, 0], named("force over the effective modulus", "m2")),
            "contact_fraction": (over, numbers[:, :, 1], named("contact area over nominal area")),
            "separation": (over[::2], np.array(paths), named("separation from the mean plane", "m")),
            **measure_stated(FEW if quick else MAPS),
            "lost_from": ("case", lost, named("contact fraction from which on pairs have no equilibrium")),
        },
        {"source": [*ELEMENTS, *METHODS], **_columns(cases, adhesive)},
    )


def _columns(cases: list[Case], adhesive: list[Adhesive]) -> dict[str, tuple[str, list[float], dict[str, str]]]:
    """Return what the cases are."""
    columns = {
        "hurst": ([case.surface.hurst for case in cases], "Hurst exponent"),
        "bandwidth": ([float(case.surface.bandwidth) for case in cases], "side over the shortest wave"),
        "anisotropy": ([case.surface.anisotropy for case in cases], "length of the waves along over across"),
        "jump_on": ([case.jump_on for case in cases], "jump-on radius over the wavelength"),
        "stretch": ([one.stretch for one in adhesive], "square of the jump-on radius over the radius [m]"),
        "cells": (
            [one.cohesive_zone * case.points / SIDE for case, one in zip(cases, adhesive, strict=True)],
            "E* w/strength^2 over the spacing of the grid",
        ),
    }
    return {name: ("case", values, named(words)) for name, (values, words) in columns.items()}
