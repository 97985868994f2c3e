"""Summits of Gaussian surfaces: those of source "nayak" beside those found on synthetic maps of the same spectrum.

    python pipelines/summits.py -o results/studies

On periodic maps the summits are found exactly, by Fourier series, and by paraboloids through points of grids that are
more or less fine, fitted to the eight neighbours. Errors are those of the spread over the maps. Writes summits.nc and
summits.png.
"""

import itertools
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
import xarray as xr
from exact_summits import Series

from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution, Summits, product_density
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.ensemble.streams import make_streams
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import Moments, SelfAffine
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance

sys.path.insert(0, str(Path(__file__).parents[1] / "data_gen"))
from surface import gaussian_map, wave_numbers, wave_variances

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
FITTED = tuple(STATISTICS)[:5]  # what an ensemble of paraboloids tells


def law_of_maps() -> SummitDistribution:
    """The law with the moments that the maps have on average: sums over the waves of the grid, not integrals."""
    variances, q = wave_variances(SPECTRUM, MAP_POINTS, SIZE), wave_numbers(MAP_POINTS, SIZE)
    sums = (float(np.sum(variances * q**power)) for power in (0, 2, 4))
    return SummitDistribution(
        Moments.checked(*(part * total for part, total in zip((1.0, 0.5, 0.375), sums, strict=True)))
    )


def fitted(series: Series, points: int) -> Summits:
    """Heights and curvatures of paraboloids through points of a grid, fitted to their neighbours; no mean curvature."""
    spacing = series.size / points
    found = find_summits(HeightMap(series.on_grid(points), spacing, spacing, periodic=True))
    return Summits(found.height, np.full_like(found.height, np.nan), found.parameters["radius"])


def sums(summits: Summits) -> Floats:
    """The number of summits, and sums of their heights and curvatures to the second power."""
    z, mean, geometric = summits.height, summits.mean_curvature, 1.0 / summits.radius
    terms = [np.ones_like(z), z, z * z]
    for k in (geometric, mean):
        terms += [k, k * k, k * z]
    return np.array([term.sum() for term in terms])


def statistics(total: Floats, area: float) -> Floats:
    """STATISTICS of summits with these sums, found on an area [m2]."""
    z, zz, k, kk, kz, s, ss, sz = total[1:] / total[0]
    variance = zz - z * z
    correlations = [(kz - k * z) / math.sqrt((kk - k * k) * variance), (sz - s * z) / np.sqrt((ss - s * s) * variance)]
    return np.array([total[0] / area, z, variance, k, correlations[0], s, correlations[1]])


def jackknife(of: Callable[[Floats], Floats], maps: Floats) -> tuple[Floats, Floats]:
    """``of`` the mean over maps, and its standard error, from the means that leave one map out."""
    count = len(maps)
    left_out = np.array([of((maps.sum(axis=0) - one) / (count - 1)) for one in maps])
    return of(maps.mean(axis=0)), np.sqrt((count - 1) * left_out.var(axis=0))


def summits(count: int = 20, grids: tuple[int, ...] = GRIDS, drawn: int = DRAWN) -> tuple[xr.Dataset, Summits]:
    """All the numbers of this study, and the summits found exactly.

    What is drawn has no area of its own: its density is the law's.
    """
    law, area = law_of_maps(), SIZE * SIZE
    draws = make_streams(1, 0)
    sampled = statistics(sums(law.draw(*(draws(stream, drawn) for stream in range(3)))), drawn / law.density)
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
    text = "points of the grid in a shortest wave"
    result = xr.Dataset(coords={"points_per_wave": ("points_per_wave", list(grids), {"units": "1", "long_name": text})})
    for i, (name, (unit, text)) in enumerate(STATISTICS.items()):
        result[f"{name}_sampled"] = ((), sampled[i], {"units": unit, "long_name": f"{text}, sampled"})
        result[f"{name}_detected"] = ((), detected[i], {"units": unit, "long_name": f"{text}, on maps"})
        result[f"{name}_error"] = ((), error[i], {"units": unit, "long_name": f"{text}, standard error on maps"})
        if name in FITTED:
            for j, part in enumerate(("bias", "bias_error")):
                values = [bias[j][i] for bias in biases]
                label = f"{text}, fit to neighbours, relative {part.replace('_', ', standard ')}"
                result[f"{name}_{part}"] = ("points_per_wave", values, {"units": "1", "long_name": label})
    every = Summits(*(np.concatenate(part) for part in zip(*found, strict=True)))
    attrs = {"maps": count, "summits": every.height.size, **law.moments._asdict(), "alpha": law.moments.alpha}
    return result.assign_attrs(provenance("Summits of Gaussian surfaces", "summits.py"), **attrs), every


def draw(result: xr.Dataset, found: Summits) -> "Figure":
    """The law beside the summits of the maps, and the bias of the fit to neighbours."""
    from matplotlib.figure import Figure

    law = law_of_maps()
    figure = Figure(figsize=(11, 8), layout="constrained")
    heights, curvatures, tied, bias = figure.subplots(2, 2).ravel()
    rms, unit = math.sqrt(law.moments.m0), math.sqrt(law.moments.m4)
    k = found.radius**-1.0 / unit
    root, z = np.linspace(0.01, 6.0, 600), np.linspace(-3.0, 5.0, 401)
    of_root = 2.0 * root * product_density(root**2)
    given = rms * law.height_density(rms * z[:, None], root**2)
    law_k = 1.0 / law.radius(root**2) / unit
    heights.hist(found.height / rms, 80, density=True, color="0.8", label=f"{found.height.size} summits of the maps")
    heights.plot(z, np.trapezoid(given * of_root, root, axis=1), "C0", label="the law")
    heights.plot(z, np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi), "C1:", label="heights of the surface")
    heights.set(xlabel="height / √m0", ylabel="density", title=f"heights, α = {law.moments.alpha:.1f}", xlim=(-3, 5))
    curvatures.hist(k, 80, density=True, color="0.8", label="summits of the maps")
    curvatures.plot(law_k, of_root * np.gradient(root, law_k), "C0", label="the law")
    curvatures.set(xlabel="√(k1 k2) / √m4", ylabel="density", title="curvatures", xlim=(0, 4))
    mean = np.trapezoid(z[:, None] * given, z, axis=0)
    spread = np.sqrt(np.trapezoid((z[:, None] - mean) ** 2 * given, z, axis=0))
    tied.fill_between(law_k, mean - spread, mean + spread, color="C0", alpha=0.2, label="the law, ± standard deviation")
    tied.plot(law_k, mean, "C0", label="the law, mean")
    edges = np.linspace(0.1, 3.1, 16)
    bins = [found.height[(k >= a) & (k < b)] / rms for a, b in itertools.pairwise(edges)]
    centres, stds = 0.5 * (edges[1:] + edges[:-1]), [part.std() for part in bins]
    tied.errorbar(centres, [part.mean() for part in bins], stds, fmt="ko", ms=4, lw=0.8, capsize=3, label="the maps")
    tied.set(xlabel="√(k1 k2) / √m4", ylabel="height / √m0", title="height given curvature", xlim=(0, 3.2))
    for name in ("density", "mean_height", "height_variance", "geometric_curvature"):
        values, errors = 100.0 * result[f"{name}_bias"], 100.0 * result[f"{name}_bias_error"]
        bias.errorbar(result.points_per_wave, values, errors, fmt="o-", ms=4, capsize=3, label=STATISTICS[name][1])
    bias.set_yscale("symlog", linthresh=1.0)
    bias.yaxis.set_major_formatter("{x:g}")
    bias.axhline(0.0, color="k", lw=0.6)
    bias.set_xscale("log", base=2)
    bias.set_xticks(result.points_per_wave.to_numpy(), [str(int(n)) for n in result.points_per_wave])
    bias.set(xlabel="points a shortest wave", ylabel="off by [%]", title="paraboloids fitted to neighbours")
    for axes in (heights, curvatures, tied, bias):
        axes.legend(fontsize=8)
    return figure


@click.command(help=(__doc__ or "").split("\n", maxsplit=1)[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Fewer maps, on coarser grids.")
def main(output: Path, quick: bool) -> None:
    """Compute, print, write summits.nc and summits.png."""
    output.mkdir(parents=True, exist_ok=True)
    result, found = summits(3, GRIDS[:2], DRAWN // 10) if quick else summits()
    write_netcdf(Labelled.of(result), output / "summits.nc")
    with replace_atomically(output / "summits.png") as temporary:
        draw(result, found).savefig(temporary, dpi=160, format="png")
    for name, (unit, text) in STATISTICS.items():
        sampled, detected, error = (float(result[f"{name}_{part}"]) for part in ("sampled", "detected", "error"))
        off = (sampled - detected) / error
        click.echo(
            f"{text:<40} sampled {sampled:.5g}, on maps {detected:.5g} ± {error:.2g} {unit}: {off:+.1f} errors off"
        )
    for name in FITTED:
        biases = ", ".join(f"{100.0 * value:+.2f} %" for value in result[f"{name}_bias"].to_numpy())
        click.echo(f"{STATISTICS[name][1]:<40} fit to neighbours off by {biases}")


if __name__ == "__main__":
    main()
