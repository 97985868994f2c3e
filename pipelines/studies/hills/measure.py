"""Press maps by each method at the same separations, those at which 0.3 to 20 % are in contact."""

import warnings

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.hills.convergence import measure_convergence
from studies.hills.maps import ANISOTROPIC, ISOTROPIC, QUICK, MapCase
from studies.hills.measured_maps import measure_files
from studies.hills.press import QUANTITIES, Pressed, by_asperities, by_elements, by_persson, hills_of, square
from studies.hills.separations import FRACTIONS, POINTS, separations
from studies.study import named

COARSE = (2, 3, 4)
PERSSON = {"Persson, gamma 0.45": 0.45, "Persson, gamma 1": 1.0}
"""What the theory calls gamma, by the names of its methods; for isotropic maps."""
METHODS = ("summits", "summits in pairs", "hills", *PERSSON, *(f"elements, {points} points" for points in COARSE))
PAIRS = "pairwise"


def press(case: MapCase) -> list[Pressed]:
    """Return the solution of fine boundary elements, and then that of each method."""
    height = case.height(POINTS)
    separation, surface = separations(case), square(height)
    return [
        by_elements(height, separation),
        by_asperities(surface, separation, find_summits, None),
        by_asperities(surface, separation, find_summits, PAIRS),
        by_asperities(surface, separation, hills_of, PAIRS),
        *(
            by_persson(surface, separation, gamma) if case.anisotropy == 1.0 else _nothing(separation)
            for gamma in PERSSON.values()
        ),
        *(by_elements(case.height(points), separation) for points in COARSE),
    ]


def _nothing(separation: Floats) -> Pressed:
    unknown = np.full(separation.size, np.nan)
    return Pressed(unknown, unknown, unknown, np.nan)


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or a few."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        press(QUICK[0])  # compiles
        parts = [measure_maps(QUICK if quick else [*ISOTROPIC, *ANISOTROPIC]), measure_convergence(quick)]
        return xr.merge([*parts, measure_files(quick)])


def measure_maps(cases: list[MapCase]) -> xr.Dataset:
    """Press maps by each method."""
    pressed = [press(case) for case in cases]
    numbers = np.array([[method.numbers for method in each] for each in pressed])
    over = ("case", "solver", "fraction")
    columns = dict(zip(MapCase._fields, zip(*cases, strict=True), strict=True))
    attributes = {
        "force": named("force over the effective modulus", "m2"),
        "contact_fraction": named("contact area over nominal area"),
        "stiffness": named("-dF/dh over the effective modulus", "m"),
    }
    return xr.Dataset(
        {
            **{name: (over, numbers[:, :, i], attributes[name]) for i, name in enumerate(QUANTITIES)},
            "seconds": (
                over[:2],
                [[m.seconds for m in each] for each in pressed],
                named("run time of force and area along a path", "s"),
            ),
        },
        {
            "solver": ["fine elements", *METHODS],
            "fraction": ("fraction", FRACTIONS, named("contact fraction of the separation, about")),
            **{name: ("case", list(values)) for name, values in columns.items()},
        },
    )
