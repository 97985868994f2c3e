"""What is taken out of a height map before its summits are looked for: its trend, and its short waves."""

import math
from typing import Literal

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.maps import HeightMap
from roughmdr.errors import SceneError

Trend = Literal["none", "mean", "plane", "quadratic"]
_DEGREE: dict[Trend, int] = {"mean": 0, "plane": 1, "quadratic": 2}

_REACH = 1.5  # cut-offs: how far the Gaussian reaches; beyond, it is below 1e-14 of its height
_AT_CUTOFF = 1e-9  # relative; a wave as long as the cut-off is kept


def remove_trend(height: Floats, trend: Trend) -> Floats:
    """The map less its least-squares polynomial in x and y, fitted to the points that are not NaN.

    "mean" leaves the mean 0, "plane" no tilt either, "quadratic" no curvature of the whole.
    """
    if trend == "none":
        return height
    degree = _DEGREE[trend]
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    along_x, along_y = (np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, n), degree) for n in height.shape)
    defined = np.isfinite(height)
    both_x, both_y = ((a[:, :, None] * a[:, None, :]).reshape(len(a), -1) for a in (along_x, along_y))
    products = (both_x.T @ defined @ both_y).reshape(4 * (degree + 1,))
    normal = np.array([[products[i, k, j, m] for k, m in powers] for i, j in powers])
    moments = along_x.T @ np.where(defined, height, 0.0) @ along_y
    coefficients = np.zeros((degree + 1, degree + 1))
    coefficients[tuple(zip(*powers, strict=True))] = np.linalg.lstsq(
        normal, np.array([moments[power] for power in powers]), rcond=None
    )[0]
    return np.asarray(height - along_x @ coefficients @ along_y.T)


def remove_short_waves(surface: HeightMap, cutoff: float) -> HeightMap:
    """The map without waves shorter than ``cutoff`` [m].

    A periodic map is cut sharply in its spectrum. Any other is smoothed by the Gaussian that passes half of a wave of
    the cut-off length, and 2^-(cutoff/length)^2 of any other (ISO 16610-61); at edges and beside undefined points, it
    is the mean over what there is. SceneError where the cut-off does not fit the grid, or a periodic map has gaps.
    """
    height, dx, dy, periodic, _ = surface
    nx, ny = height.shape
    least, most = 2.0 * max(dx, dy), min(nx * dx, ny * dy)
    if not least <= cutoff <= most:
        raise SceneError(
            f"cutoff {cutoff:g} m must lie between two spacings, {least:g} m, and the map's shorter side, {most:g} m"
        )
    defined = np.isfinite(height)
    if periodic:
        if not defined.all():
            raise SceneError(
                "a periodic map with undefined points has no spectrum to cut: fill them or leave out cutoff"
            )
        return surface._replace(height=_filtered(height, dx, dy, cutoff, periodic=True))
    smooth = _filtered(np.where(defined, height, 0.0), dx, dy, cutoff, periodic=False)
    smooth /= _filtered(defined.astype(np.float64), dx, dy, cutoff, periodic=False)
    smooth[~defined] = np.nan
    return surface._replace(height=smooth)


def _filtered(field: Floats, dx: float, dy: float, cutoff: float, *, periodic: bool) -> Floats:
    """The field after the filter; around one that is not periodic lie zeros."""
    from scipy import fft

    nx, ny = field.shape
    mx, my = nx, ny
    if not periodic:
        mx, my = (fft.next_fast_len(n + math.ceil(_REACH * cutoff / d), real=True) for n, d in ((nx, dx), (ny, dy)))
    waves = fft.rfft2(field, (mx, my))
    x, y = cutoff * fft.fftfreq(mx, dx)[:, None], cutoff * fft.rfftfreq(my, dy)[None, :]
    if periodic:
        waves[np.hypot(x, y) > 1.0 + _AT_CUTOFF] = 0.0
    else:
        waves *= np.exp2(-x * x)
        waves *= np.exp2(-y * y)
    return np.asarray(fft.irfft2(waves, (mx, my))[:nx, :ny])
