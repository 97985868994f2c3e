"""The picture of the summits of Gaussian surfaces."""

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from figures.summits import STATISTICS, distribution_of_maps
from roughmdr.ensemble.gaussian.summit_distribution import product_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw(result: xr.Dataset) -> "Figure":
    """Draw the distribution beside the summits of the maps, and the bias of the fit to neighbours."""
    from matplotlib.figure import Figure

    distribution = distribution_of_maps()
    figure = Figure(figsize=(11, 8), layout="constrained")
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


def _draw_bias(bias: "Axes", result: xr.Dataset) -> None:
    """Draw how far paraboloids fitted to neighbours are off, over the fineness of the grid."""
    for name in ("density", "mean_height", "height_variance", "geometric_curvature"):
        values, errors = 100.0 * result[f"{name}_bias"], 100.0 * result[f"{name}_bias_error"]
        bias.errorbar(result.points_per_wave, values, errors, fmt="o-", ms=4, capsize=3, label=STATISTICS[name][1])
    bias.set_yscale("symlog", linthresh=1.0)
    bias.yaxis.set_major_formatter("{x:g}")
    bias.axhline(0.0, color="k", lw=0.6)
    bias.set_xscale("log", base=2)
    bias.set_xticks(result.points_per_wave.to_numpy(), [str(int(n)) for n in result.points_per_wave])
    bias.set(xlabel="points a shortest wave", ylabel="off by [%]", title="paraboloids fitted to neighbours")
