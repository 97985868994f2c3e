"""The force of hills over what it hangs on: points of the map, contact radii of a hill, and noise of the heights."""

from functools import partial

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.hills.find import SCALES as USUAL_SCALES, wavelength
from roughmdr.ensemble.maps.resolution import hills_error
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import Variable, in_cases, panels, percent, rms
from studies.hills.maps import PAIRS, POINTS, WORDS, MapCase, by_asperities, by_elements, hills_of, separations, square
from studies.study import Figure, named, table

TRIALS = [MapCase(hurst, 16, 12) for hurst in (0.3, 0.5, 0.8)]
QUICK_TRIALS = [MapCase(0.3, 8, 11), MapCase(0.8, 8, 11)]
GRIDS = (2, 3, 4, 6, 8, 12)  # points a shortest wave
FINEST = 24  # points a shortest wave of the hills that those of coarser grids are compared with
FINEST_ELEMENTS = 32
"""Points a shortest wave of the elements that the fine ones are compared with; half in the reduced form."""
SCALES = (5, 10, 20, 40)
NOISE = (0.01, 0.03, 0.1)  # white, r.m.s. over the r.m.s. height
ASPERITIES = {"summits in pairs": find_summits, "hills": hills_of}
_OVER = {
    "trial_force": (("fraction",), ("force of fine boundary elements over E*", "m2")),
    "trial_force_finest_grid": (("fraction",), ("force of the hills of the finest grid over E*", "m2")),
    "trial_force_by_points": (("points", "fraction"), ("force of hills over E*", "m2")),
    "trial_force_by_scales": (("scales", "fraction"), ("force of hills over E*", "m2")),
    "trial_force_by_noise": (("asperities", "noise", "fraction"), ("force of asperities in pairs over E*", "m2")),
    "trial_elements": (
        ("grid", "quantity", "fraction"), ("force [m2], contact fraction and stiffness [m] of elements", "E*"),
    ),
    "resolution_error": (("points",), ("share of the force that the hills of a grid say they lack", "1")),
}  # fmt: skip
"""Dimensions, besides the map, and words of the numbers of a map."""


def measure_convergence(quick: bool) -> xr.Dataset:
    """Press a few maps again and again."""
    trials = QUICK_TRIALS if quick else TRIALS
    finest_elements = FINEST_ELEMENTS // 2 if quick else FINEST_ELEMENTS
    measured = [_measure(case, finest_elements) for case in trials]
    numbers: dict[str, Variable] = {}
    for name, (dims, words) in _OVER.items():
        numbers |= in_cases({name: words}, measured, "trial", *dims)
    return xr.Dataset(
        numbers,
        {
            "points": ("points", list(GRIDS), named("points a shortest wave")),
            "scales": ("scales", list(SCALES), named("contact radii of a hill")),
            "noise": ("noise", [0.0, *NOISE], named("r.m.s. of white noise over that of the heights")),
            "asperities": list(ASPERITIES),
            "grid": ("grid", [POINTS, finest_elements], named("points a shortest wave of boundary elements")),
            "quantity": list(WORDS),
            "trial_hurst": ("trial", [case.hurst for case in trials]),
        },
    )


def _measure(case: MapCase, finest_elements: int) -> dict[str, Floats]:
    """Return the numbers of one map, by the names of variables."""
    separation, height = separations(case), case.height(POINTS)
    elements = np.array(
        [by_elements(square(case.height(points)), separation)[:3] for points in (POINTS, finest_elements)]
    )
    white = np.random.default_rng([case.seed, round(10 * case.hurst), case.bandwidth, 1]).standard_normal(height.shape)
    shaken = [square(height + noise * height.std() * white) for noise in (0.0, *NOISE)]

    def of_hills(points: int, scales: int = USUAL_SCALES) -> Floats:
        return by_asperities(square(case.height(points)), separation, partial(hills_of, scales=scales), PAIRS).force

    by_noise = [[by_asperities(each, separation, find, PAIRS).force for each in shaken] for find in ASPERITIES.values()]
    surfaces = [square(case.height(points)) for points in GRIDS]
    return {
        "trial_force": elements[0, 0],
        "trial_elements": elements,
        "trial_force_finest_grid": of_hills(FINEST),
        "trial_force_by_points": np.array([of_hills(points) for points in GRIDS]),
        "trial_force_by_scales": np.array([of_hills(POINTS, scales) for scales in SCALES]),
        "trial_force_by_noise": np.array(by_noise),
        "resolution_error": np.array([hills_error(wavelength(each) / each.dx) for each in surfaces]),
    }


def by_points(result: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return over the points a wave the error of the force of hills, what it lacks, and what is said to be lacking."""
    force = result["trial_force_by_points"]
    return {
        "error": _rms_over_maps(force / result["trial_force"] - 1.0),
        "lacking": (1.0 - force / result["trial_force_finest_grid"]).mean(["trial", "fraction"]),
        "stated": result["resolution_error"].mean("trial"),
    }


def by_scales(result: xr.Dataset) -> xr.DataArray:
    """Return the error of the force of hills over their number of contact radii."""
    return _rms_over_maps(result["trial_force_by_scales"] / result["trial_force"] - 1.0)


def by_noise(result: xr.Dataset) -> xr.DataArray:
    """Return by how much noise moves the force of asperities in pairs, [asperities, noise]."""
    force = result["trial_force_by_noise"]
    return _rms_over_maps(force / force.sel(noise=0.0, drop=True) - 1.0).drop_sel(noise=0.0)


def _rms_over_maps(errors: xr.DataArray) -> xr.DataArray:
    return (errors**2).mean(["trial", "fraction"]) ** 0.5


def report_convergence(result: xr.Dataset) -> str:
    """Return how far the elements are right that all is held against, and what the force hangs on, in tables."""
    points, scales, noise = by_points(result), by_scales(result), by_noise(result)
    elements = result["trial_elements"]
    errors = elements.isel(grid=0) / elements.isel(grid=-1) - 1.0
    converged = "; ".join(
        f"{words} within {percent(rms(errors.sel(quantity=quantity)))} r.m.s., "
        f"{percent(float(np.abs(errors.sel(quantity=quantity)).max()))} at most"
        for quantity, words in WORDS.items()
    )
    of_points = [
        ["error, r.m.s.", *map(percent, points["error"].to_numpy())],
        [f"too low against {FINEST} points, mean", *map(percent, points["lacking"].to_numpy())],
        ["`resolution_error`", *map(percent, points["stated"].to_numpy())],
    ]
    of_noise = [[str(name), *map(percent, noise.sel(asperities=name).to_numpy())] for name in ASPERITIES]
    return f"""The elements that all is held against, themselves against {int(elements["grid"][-1])} points a wave on
{result.sizes["trial"]} isotropic maps: {converged}.

What the force of hills hangs on, on these maps (Hurst exponents
{", ".join(f"{hurst:g}" for hurst in result["trial_hurst"].to_numpy())}). The grid of the map, against fine elements and
against hills of the finest grid:

{table(["points a shortest wave", *(f"{n}" for n in result["points"].to_numpy())], of_points)}

The number of contact radii, with {POINTS} points a wave:

{table(["contact radii of a hill", *map(str, SCALES)], [["error, r.m.s.", *map(percent, scales.to_numpy())]])}

White noise added to a map with {POINTS} points a wave moves the force by, r.m.s.:

{table(["noise over r.m.s. height", *(percent(n, 0) for n in NOISE)], of_noise)}"""


def draw_convergence(result: xr.Dataset) -> Figure:
    """Draw the force of hills over points a wave and contact radii, and what noise moves it by."""
    figure, (of_points, of_scales, of_noise) = panels(13.8, 4.6, 3)
    points, scales, noise = by_points(result), by_scales(result), by_noise(result)
    orange, blue = "#d55e00", "#0072b2"
    for name, style, colour, label in (
        ("error", "o-", orange, "error, r.m.s."),
        ("lacking", "s--", blue, f"too low, mean, against {FINEST} points"),
        ("stated", "^:", "k", "stated: resolution_error"),
    ):
        of_points.loglog(result["points"], 100.0 * points[name], style, color=colour, label=label)
    of_points.set(ylabel="force of hills [%]", ylim=(0.02, 300.0), xlabel="points of the map a shortest wave")
    of_scales.semilogx(SCALES, 100.0 * scales, "o-", color=orange, label="error, r.m.s.")
    of_scales.set(ylabel="force of hills [%]", ylim=(0.0, 160.0 * float(scales.max())))
    of_scales.set_xlabel(f"contact radii of a hill ({USUAL_SCALES} unless told)")
    for name, style, colour in zip(ASPERITIES, ("s-", "o-"), (blue, orange), strict=True):
        of_noise.loglog(100.0 * noise["noise"], 100.0 * noise.sel(asperities=name), style, color=colour, label=name)
    of_noise.set(ylabel="change of the force, r.m.s. [%]", ylim=(0.3, 60.0))
    of_noise.set_xlabel("white noise, r.m.s. over that of the heights [%]")
    for panel, at in ((of_points, GRIDS), (of_scales, SCALES), (of_noise, [100.0 * each for each in NOISE])):
        panel.minorticks_off()
        panel.set_xticks(at, [f"{tick:g}" for tick in at])
        panel.legend(fontsize=9, loc="upper right" if panel is of_points else "upper left")
    return figure
