"""Summits of Gaussian surfaces: those of source "nayak" beside those found on synthetic maps of the same spectrum.

On periodic maps the summits are found exactly, by Fourier series, and by paraboloids through points of grids that are
more or less fine, fitted to the eight neighbours. Errors are those of the spread over the maps.
"""

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from oracles.gaussian_maps import Series, gaussian_map, wave_numbers, wave_variances
from studies.study import Axes, Figure, Study, blank, named

from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution, Summits, product_density
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
MAPS = {False: 20, True: 3}
STATISTICS = {
    "density": ("m-2", "summits of a unit of area"),
    "mean_height": ("m", "mean height"),
    "height_variance": ("m2", "variance of the heights"),
    "geometric_curvature": ("m-1", "mean of sqrt(k1 k2)"),
    "geometric_correlation": ("1", "correlation of height and sqrt(k1 k2)"),
    "mean_curvature": ("m-1", "mean of (k1 + k2)/2"),
    "mean_correlation": ("1", "correlation of height and (k1 + k2)/2"),
}
"""Units and words; of paraboloids, without a mean curvature, the first five."""
FITTED = tuple(STATISTICS)[:5]


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
    found, by_fit = [], []
    for seed in range(count):
        series = Series.of(gaussian_map(SPECTRUM, MAP_POINTS, SIZE, seed), SIZE, WAVES)
        found.append(series.summits(EXACT_POINTS))
        by_fit.append([sums(fitted(series, points * WAVES)) for points in grids])
    exact = np.array([sums(one) for one in found])
    detected, error = jackknife(lambda total: statistics(total, area), exact)
    pairs = [np.stack([exact, one], axis=1) for one in np.moveaxis(np.array(by_fit), 1, 0)]
    biases = [jackknife(lambda pair: statistics(pair[1], area) / statistics(pair[0], area) - 1.0, one) for one in pairs]
    bias, bias_error = np.moveaxis(np.array(biases), 1, 0)
    over = ("points_per_wave", "statistic")
    columns: dict[str, Any] = {
        "sampled": ("statistic", statistics(sums(sample), drawn / distribution.density), named("sampled")),
        "detected": ("statistic", detected, named("on maps")),
        "error": ("statistic", error, named("standard error on maps")),
        "bias": (over, bias, named("relative bias of the fit to neighbours")),
        "bias_error": (over, bias_error, named("standard error of the bias")),
    }
    for name in ("height", "radius"):
        columns[f"summit_{name}"] = (
            "summit", np.concatenate([getattr(one, name) for one in found]), named(f"{name}, on maps", "m"),
        )  # fmt: skip
    coords = {
        "statistic": list(STATISTICS),
        "points_per_wave": ("points_per_wave", list(grids), named("points of the grid in a shortest wave")),
    }
    return xr.Dataset(columns, coords, {"maps": count, "summits": sum(one.height.size for one in found)})


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure; of fewer maps on coarser grids where ``quick``."""
    return summits(MAPS[quick], *((GRIDS[:2], DRAWN // 10) if quick else (GRIDS, DRAWN)))


def report(result: xr.Dataset) -> str:
    """Return the statistics of the sample beside those of the maps, and the bias of the fit to neighbours."""
    lines = []
    for name, (unit, text) in STATISTICS.items():
        own = result.sel(statistic=name)
        sampled, detected, error = float(own.sampled), float(own.detected), float(own.error)
        on_maps, off = f"{detected:.5g} ± {error:.2g} {unit}", (sampled - detected) / error
        lines.append(f"{text:<40} sampled {sampled:.5g}, on maps {on_maps}: {off:+.1f} errors")
    for name in FITTED:
        biases = ", ".join(f"{100.0 * value:+.2f} %" for value in result.bias.sel(statistic=name).to_numpy())
        lines.append(f"{STATISTICS[name][1]:<40} fit to neighbours off by {biases}")
    return "\n".join(lines)


def draw(result: xr.Dataset) -> Figure:
    """Draw the distribution beside the summits of the maps, and the bias of the fit to neighbours."""
    distribution = distribution_of_maps()
    figure = blank(11, 8)
    heights, curvatures, conditional, bias = figure.subplots(2, 2).ravel()
    moments = distribution.moments
    rms, unit = math.sqrt(moments.m0), math.sqrt(moments.m4)
    summits, k = result.summit_height.to_numpy() / rms, 1.0 / (result.summit_radius.to_numpy() * unit)
    root, z = np.linspace(0.01, 6.0, 600), np.linspace(-3.0, 5.0, 401)
    of_root = 2.0 * root * product_density(root**2)
    given = rms * distribution.height_density(rms * z[:, None], root**2)
    law_k = 1.0 / distribution.radius(root**2) / unit
    heights.hist(summits, 80, density=True, color="0.8", label=f"{summits.size} summits of the maps")
    heights.plot(z, np.trapezoid(given * of_root, root, axis=1), "C0", label="their distribution")
    heights.plot(z, np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi), "C1:", label="heights of the surface")
    heights.set(xlabel="height / √m0", ylabel="density", title=f"heights, α = {moments.alpha:.1f}", xlim=(-3, 5))
    curvatures.hist(k, 80, density=True, color="0.8", label="summits of the maps")
    curvatures.plot(law_k, of_root * np.gradient(root, law_k), "C0", label="their distribution")
    curvatures.set(xlabel="√(k1 k2) / √m4", ylabel="density", title="curvatures", xlim=(0, 4))
    mean = np.trapezoid(z[:, None] * given, z, axis=0)
    spread = np.sqrt(np.trapezoid((z[:, None] - mean) ** 2 * given, z, axis=0))
    conditional.fill_between(law_k, mean - spread, mean + spread, color="C0", alpha=0.2, label="± standard deviation")
    conditional.plot(law_k, mean, "C0", label="their distribution, mean")
    edges = np.linspace(0.1, 3.1, 16)
    bins = [summits[(k >= low) & (k < high)] for low, high in itertools.pairwise(edges)]
    centres, means, stds = 0.5 * (edges[1:] + edges[:-1]), [part.mean() for part in bins], [part.std() for part in bins]
    conditional.errorbar(centres, means, stds, fmt="ko", ms=4, lw=0.8, capsize=3, label="the maps")
    conditional.set(xlabel="√(k1 k2) / √m4", ylabel="height / √m0", title="height given curvature", xlim=(0, 3.2))
    _draw_bias(bias, result)
    for axes in (heights, curvatures, conditional, bias):
        axes.legend(fontsize=8)
    return figure


def _draw_bias(bias: Axes, result: xr.Dataset) -> None:
    """Draw how far paraboloids fitted to neighbours are off, over the fineness of the grid."""
    for name in ("density", "mean_height", "height_variance", "geometric_curvature"):
        values, errors = (100.0 * result[part].sel(statistic=name) for part in ("bias", "bias_error"))
        bias.errorbar(result.points_per_wave, values, errors, fmt="o-", ms=4, capsize=3, label=STATISTICS[name][1])
    bias.set_yscale("symlog", linthresh=1.0)
    bias.yaxis.set_major_formatter("{x:g}")
    bias.axhline(0.0, color="k", lw=0.6)
    bias.set_xscale("log", base=2)
    bias.set_xticks(result.points_per_wave.to_numpy(), [str(int(n)) for n in result.points_per_wave])
    bias.set(xlabel="points a shortest wave", ylabel="off by [%]", title="paraboloids fitted to neighbours")


STUDY = Study(
    "summits", "Summits of Gaussian surfaces", measure, draw, report,
    f"{MAPS[True]} of {MAPS[False]} maps, on coarser grids; a tenth of the drawn summits",
)  # fmt: skip
