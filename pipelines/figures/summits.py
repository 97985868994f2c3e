"""Summits of Gaussian surfaces: those of source "nayak" beside those found on synthetic maps of the same spectrum.

On periodic maps the summits are found exactly, by Fourier series, and by paraboloids through points of grids that are
more or less fine, fitted to the eight neighbours. Errors are those of the spread over the maps.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from oracles.gaussian_maps import gaussian_map, wave_numbers, wave_variances
from oracles.map_summits import Series
from studies.study import named

from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution, Summits
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.ensemble.streams import make_streams
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import Moments, SelfAffine

WAVES = 64  # shortest waves along a side
SIZE = 320e-6  # [m]
SPECTRUM = SelfAffine.of(hurst=0.8, long_wave=SIZE / 8, short_wave=SIZE / WAVES, rms_slope=0.1)
MAP_POINTS, EXACT_POINTS = 4 * WAVES, 16 * WAVES  # along a side: to make a map, and to look for its summits
GRIDS = (4, 8, 16, 32)  # points a shortest wave
DRAWN = 1_000_000
STATISTICS = {
    "density": ("m-2", "summits of a unit of area"),
    "mean_height": ("m", "mean height"),
    "height_variance": ("m2", "variance of the heights"),
    "geometric_curvature": ("m-1", "mean of sqrt(k1 k2)"),
    "geometric_correlation": ("1", "correlation of height and sqrt(k1 k2)"),
    "mean_curvature": ("m-1", "mean of (k1 + k2)/2"),
    "mean_correlation": ("1", "correlation of height and (k1 + k2)/2"),
}
FITTED = tuple(STATISTICS)[:5]  # which an ensemble of paraboloids has


def distribution_of_maps() -> SummitDistribution:
    """Return the distribution for the mean moments of the maps: sums over the waves of the grid, not integrals."""
    variances, q = wave_variances(SPECTRUM, MAP_POINTS, SIZE), wave_numbers(MAP_POINTS, SIZE)
    moments = (part * float(np.sum(variances * q**power)) for part, power in ((1.0, 0), (0.5, 2), (0.375, 4)))
    return SummitDistribution(Moments.checked(*moments))


def fitted(series: Series, points: int) -> Summits:
    """Return the summits by paraboloids through points of a grid, fitted to their neighbours; no mean curvature."""
    spacing = series.size / points
    found = find_summits(HeightMap(series.on_grid(points), spacing, spacing, periodic=True))
    return Summits(found.height, np.full_like(found.height, np.nan), found.parameters["radius"])


def sums(summits: Summits) -> Floats:
    """Return the number of summits, and sums of their heights and curvatures to the second power."""
    z, mean, geometric = summits.height, summits.mean_curvature, 1.0 / summits.radius
    terms = [np.ones_like(z), z, z * z]
    for k in (geometric, mean):
        terms += [k, k * k, k * z]
    return np.array([term.sum() for term in terms])


def statistics(total: Floats, area: float) -> Floats:
    """Return STATISTICS of summits with these sums, found on an area [m2]."""
    z, zz, k, kk, kz, s, ss, sz = total[1:] / total[0]
    variance = zz - z * z
    correlations = [(kz - k * z) / math.sqrt((kk - k * k) * variance), (sz - s * z) / np.sqrt((ss - s * s) * variance)]
    return np.array([total[0] / area, z, variance, k, correlations[0], s, correlations[1]])


def jackknife(function: Callable[[Floats], Floats], maps: Floats) -> tuple[Floats, Floats]:
    """Return a function of the mean over maps, and its standard error, from the means without one map each."""
    count = len(maps)
    left_out = np.array([function((maps.sum(axis=0) - one) / (count - 1)) for one in maps])
    return function(maps.mean(axis=0)), np.sqrt((count - 1) * left_out.var(axis=0))


def summits(count: int, grids: tuple[int, ...], drawn: int) -> xr.Dataset:
    """Return all numbers of the figure, from ``count`` maps, and the summits found exactly on them.

    The sample that is drawn has no area: its density is that of the distribution.
    """
    distribution, area = distribution_of_maps(), SIZE * SIZE
    streams = make_streams(1, 0)
    sample = distribution.draw(*(streams(number, drawn) for number in range(3)))
    sampled = statistics(sums(sample), drawn / distribution.density)
    found, by_fit = [], []
    for seed in range(count):
        series = Series.of(gaussian_map(SPECTRUM, MAP_POINTS, SIZE, seed), SIZE, WAVES)
        found.append(series.summits(EXACT_POINTS))
        by_fit.append([sums(fitted(series, points * WAVES)) for points in grids])
    exact = np.array([sums(one) for one in found])
    detected, error = jackknife(lambda total: statistics(total, area), exact)
    biases = []
    for grid in range(len(grids)):
        pairs = np.stack([exact, np.array(by_fit)[:, grid]], axis=1)
        biases.append(jackknife(lambda pair: statistics(pair[1], area) / statistics(pair[0], area) - 1.0, pairs))
    columns: dict[str, Any] = {
        f"summit_{name}": (
            "summit",
            np.concatenate([getattr(one, name) for one in found]),
            named(f"{name}, on maps", "m"),
        )
        for name in ("height", "radius")
    }
    for i, (name, (unit, text)) in enumerate(STATISTICS.items()):
        columns[f"{name}_sampled"] = ((), sampled[i], named(f"{text}, sampled", unit))
        columns[f"{name}_detected"] = ((), detected[i], named(f"{text}, on maps", unit))
        columns[f"{name}_error"] = ((), error[i], named(f"{text}, standard error on maps", unit))
        if name in FITTED:
            for j, (suffix, label) in enumerate((("bias", "bias"), ("bias_error", "standard error of the bias"))):
                values = [bias[j][i] for bias in biases]
                columns[f"{name}_{suffix}"] = (
                    "points_per_wave", values, named(f"{text}, fit to neighbours, relative {label}")
                )  # fmt: skip
    coords = {"points_per_wave": ("points_per_wave", list(grids), named("points of the grid in a shortest wave"))}
    moments = distribution.moments
    attrs = {"maps": count, "summits": columns["summit_height"][1].size, **moments._asdict(), "alpha": moments.alpha}
    return xr.Dataset(columns, coords, attrs)


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure; of fewer maps on coarser grids where ``quick``."""
    return summits(3, GRIDS[:2], DRAWN // 10) if quick else summits(20, GRIDS, DRAWN)


def report(result: xr.Dataset) -> str:
    """Return the statistics of the sample beside those of the maps, and the bias of the fit to neighbours."""
    lines = []
    for name, (unit, text) in STATISTICS.items():
        sampled, detected, error = (float(result[f"{name}_{part}"]) for part in ("sampled", "detected", "error"))
        off = (sampled - detected) / error
        lines.append(
            f"{text:<40} sampled {sampled:.5g}, on maps {detected:.5g} ± {error:.2g} {unit}: {off:+.1f} errors"
        )
    for name in FITTED:
        biases = ", ".join(f"{100.0 * value:+.2f} %" for value in result[f"{name}_bias"].to_numpy())
        lines.append(f"{STATISTICS[name][1]:<40} fit to neighbours off by {biases}")
    return "\n".join(lines)
