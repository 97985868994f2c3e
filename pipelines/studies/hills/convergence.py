"""The force of hills over what it hangs on: points of the map, contact radii of a hill, and noise of the heights."""

from functools import partial

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.hills.find import SCALES as USUAL_SCALES
from roughmdr.ensemble.maps.hills.find import wavelength
from roughmdr.ensemble.maps.resolution import hills_error
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.hills.maps import MapCase
from studies.hills.press import QUANTITIES, by_asperities, by_elements, hills_of, square
from studies.hills.separations import POINTS, separations
from studies.study import named

TRIALS = [MapCase(hurst, 16, 12) for hurst in (0.3, 0.5, 0.8)]
QUICK_TRIALS = [MapCase(0.3, 8, 11), MapCase(0.8, 8, 11)]
GRIDS = (2, 3, 4, 6, 8, 12)
"""Points a shortest wave."""
FINEST = 24
"""Of the hills that those of coarser grids are held against."""
FINEST_ELEMENTS = 32
"""Of the boundary elements that the fine ones are held against; half as many in the reduced form."""
SCALES = (5, 10, 20, 40)
NOISE = (0.01, 0.03, 0.1)
"""White, r.m.s. over the r.m.s. height."""
ASPERITIES = {"summits in pairs": find_summits, "hills": hills_of}
_PAIRS = "pairwise"


def measure_convergence(quick: bool) -> xr.Dataset:
    """Press a few maps again and again."""
    trials = QUICK_TRIALS if quick else TRIALS
    finest_elements = FINEST_ELEMENTS // 2 if quick else FINEST_ELEMENTS
    measured = [_measure(case, finest_elements) for case in trials]
    over = {
        "trial_force": ((), "force of fine boundary elements"),
        "trial_force_finest_grid": ((), "force of the hills of the finest grid"),
        "trial_force_by_points": (("points",), "force of hills"),
        "trial_force_by_scales": (("scales",), "force of hills"),
        "trial_force_by_noise": (("asperities", "noise"), "force of asperities in pairs"),
    }
    return xr.Dataset(
        {
            **{
                name: (("trial", *dims, "fraction"), [each[name] for each in measured], named(f"{words} over E*", "m2"))
                for name, (dims, words) in over.items()
            },
            "trial_elements": (
                ("trial", "grid", "quantity", "fraction"),
                [each["trial_elements"] for each in measured],
                {"long_name": "force [m2], contact fraction and stiffness [m] of boundary elements, over E*"},
            ),
            "resolution_error": (
                ("trial", "points"),
                [each["resolution_error"] for each in measured],
                named("share of the force that the hills of a grid say they lack"),
            ),
        },
        {
            "points": ("points", list(GRIDS), named("points a shortest wave")),
            "scales": ("scales", list(SCALES), named("contact radii of a hill")),
            "noise": ("noise", [0.0, *NOISE], named("r.m.s. of white noise over that of the heights")),
            "asperities": list(ASPERITIES),
            "grid": ("grid", [POINTS, finest_elements], named("points a shortest wave of boundary elements")),
            "quantity": list(QUANTITIES),
            "trial_hurst": ("trial", [case.hurst for case in trials]),
            "trial_bandwidth": ("trial", [case.bandwidth for case in trials]),
        },
    )


def _measure(case: MapCase, finest_elements: int) -> dict[str, Floats]:
    """Return the forces of one map, by the names of variables."""
    separation, height = separations(case), case.height(POINTS)
    elements = np.array([by_elements(case.height(points), separation).numbers for points in (POINTS, finest_elements)])
    shaken = [height, *(height + noise * height.std() * _white(case, height.shape) for noise in NOISE)]

    def of_hills(points: int, scales: int = USUAL_SCALES) -> Floats:
        return by_asperities(square(case.height(points)), separation, partial(hills_of, scales=scales), _PAIRS).force

    return {
        "trial_force": elements[0, 0],
        "trial_elements": elements,
        "trial_force_finest_grid": of_hills(FINEST),
        "trial_force_by_points": np.array([of_hills(points) for points in GRIDS]),
        "trial_force_by_scales": np.array([of_hills(POINTS, scales) for scales in SCALES]),
        "trial_force_by_noise": np.array(
            [
                [by_asperities(square(each), separation, find, _PAIRS).force for each in shaken]
                for find in ASPERITIES.values()
            ]
        ),
        "resolution_error": np.array([_stated(case, points) for points in GRIDS]),
    }


def _stated(case: MapCase, points: int) -> float:
    """Return the error that the hills of a grid state."""
    surface = square(case.height(points))
    return hills_error(wavelength(surface) / surface.dx)


def _white(case: MapCase, shape: tuple[int, ...]) -> Floats:
    """Return noise of the r.m.s. 1."""
    return np.random.default_rng([case.seed, round(10 * case.hurst), case.bandwidth, 1]).standard_normal(shape)
