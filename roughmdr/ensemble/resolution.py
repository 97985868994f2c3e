"""How well a height map resolves its summits."""

import math

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.maps import HeightMap

FEW = 40.0
"""Points a summit below which there is a warning.

On maps without noise, the fit finds the mean curvature of the summits 2 % low at 290 points a summit, 9 % at 74, 15 %
at 42 and 29 % at 19 where all waves are equally long; 3 % at 260, 14 % at 68 and 23 % at 42 where they are self-affine.
White noise alone has 9.5. Less noise on many points a wave can lie above; that is told by the misfit of the fit: up to
0.15, the mean curvature is within 15 %, whether noise or the spacing is to blame.
"""


def measures(surface: HeightMap) -> dict[str, float | int | str]:
    """What a map is like: r.m.s. height [m] and slope [1], undefined share [1], whether it is periodic (1) or not (0).

    The slope is that of both directions, sqrt(<h_x^2> + <h_y^2>), from neighbours.
    """
    height, dx, dy, periodic, _ = surface
    slopes = (_mean_square(_steps(height, periodic) / dx), _mean_square(_steps(height.T, periodic) / dy))
    return {
        "rms_height": float(np.nanstd(height)),
        "rms_slope": math.sqrt(sum(slopes)),
        "undefined_share": (height.size - surface.defined) / height.size,
        "periodic": int(periodic),
    }


def few_points(points_per_summit: float) -> list[str]:
    """What to say of a map with so many points a summit."""
    if points_per_summit >= FEW:
        return []
    return [
        f"{points_per_summit:.3g} points a summit (warned of below {FEW:g}): noise, or the spacing, may set the radii "
        "of the summits; a finer map or a cutoff shows whether it does"
    ]


def _steps(height: Floats, periodic: bool) -> Floats:
    return np.diff(height, axis=0, append=height[:1]) if periodic else np.diff(height, axis=0)


def _mean_square(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.mean(known * known)) if known.size else 0.0
