"""The stated sampling error of one map or ensemble of side 1 against the scatter of the force over many."""

from collections.abc import Callable
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from oracles.gaussian_maps import gaussian_map

import roughmdr as rm
from roughmdr.ensemble.maps.detrend import remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.section import asperities_on
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine
from studies.comparison import in_cases, law_of, percent
from studies.study import table

FRACTIONS = (0.005, 0.02, 0.1)  # mean contact fractions
_ASKED = ("force", "contact_area", "sampling_error", "area_sampling_error", "effective_contacts")
_POINTS = 256  # points along the side of a map
_NAMES = {
    "contacts": "effective contacts, median",
    "force_scatter": "scatter of the force",
    "stated": "stated over true, median",
    "near": "share from 2/3 to 3/2",
    "by_contacts": "1/sqrt(effective contacts) over true, median",
    "area_scatter": "scatter of the area at the same force",
    "area_stated": "stated over true, median",
    "area_near": "share from 2/3 to 3/2",
}


def _of_map(model: Any, waves: int, cut: bool, seed: int) -> xr.Dataset:
    """Return the asperities of a map with waves from 1/waves to 1/32; periodic, or cut out of one of twice the side."""
    side = 1 + cut
    spectrum = SelfAffine.of(hurst=0.8, long_wave=1.0 / waves, short_wave=1.0 / 32.0, rms_slope=0.01)
    height = gaussian_map(spectrum, side * _POINTS, float(side), seed)[:_POINTS, :_POINTS].copy()
    remove_trend(height, "plane" if cut else "mean")
    surface = HeightMap(height, 1 / _POINTS, 1 / _POINTS, not cut)
    return asperities_on(surface, 0.0, model, "it", {"detrend": "none"}).labelled().to_xarray()


def clusters(width: float, seed: int) -> xr.Dataset:
    """Return a patch of an unbounded surface with 60 clusters of ten asperities, of this standard deviation."""
    draws, margin = np.random.default_rng(seed), 5.0 * width
    middles = draws.uniform(-margin, 1.0 + margin, (2, draws.poisson(60.0 * (1.0 + 2.0 * margin) ** 2)))
    at = np.repeat(middles, draws.poisson(10.0, middles.shape[1]), axis=1)
    x, y = at + draws.normal(0.0, width, at.shape)
    on = (x > 0.0) & (x < 1.0) & (y > 0.0) & (y < 1.0)
    columns = {"x": x[on], "y": y[on], "height": draws.normal(0.0, 5e-3, on.sum()), "radius": np.full(on.sum(), 0.03)}
    found = {name: ("asperity", values, {"units": "m"}) for name, values in columns.items()}
    return xr.Dataset(found, attrs={"shape": "paraboloid", "patch": 1.0})


def _at_random(section: dict[str, Any], seed: int) -> xr.Dataset:
    base = {"source": "random", "shape": "paraboloid", "patch": 1.0, "radius": 0.03}
    return rm.generate(base | {"height": {"distribution": "normal", "std": 5e-3}} | section, seed=seed)


_LOGNORMAL = {"distribution": "lognormal", "mean": 0.03, "std": 0.03}
CASES: dict[str, Callable[[int], xr.Dataset]] = {
    **{
        f"{model}, {'cut out' if cut else 'periodic'}, waves up to 1/{waves}": partial(_of_map, model, waves, cut)
        for model, cut, waves in product(("summits", "hills"), (False, True), (2, 4, 8, 16))
        if model == "summits" or waves < 16
    },
    "500 at random": partial(_at_random, {"count": 500}),
    "500 at random, placed": partial(_at_random, {"count": 500, "placement": "random"}),
    "of a density": partial(_at_random, {"density": 500.0}),
    "500 with lognormal radii": partial(_at_random, {"count": 500, "radius": _LOGNORMAL}),
    **{f"clusters, {4.0 * width:g} wide": partial(clusters, width) for width in (0.03, 0.06, 0.15)},
}
QUICK = ("summits, periodic, waves up to 1/4", "of a density", "clusters, 0.12 wide")


def measure_samples(quick: bool) -> xr.Dataset:
    """Press samples of each case at the same separations."""
    names = QUICK if quick else tuple(CASES)
    found = [_press(name, [CASES[name](seed) for seed in range(12 if quick else 50)]) for name in names]
    words = {key: (text, "1") for key, text in _NAMES.items()}
    return xr.Dataset(in_cases(words, found, "surface", "fraction"), {"surface": list(names)})


def _press(name: str, samples: list[xr.Dataset]) -> dict[str, Floats]:
    press = partial(law_of, effective_modulus=1.0, interaction="pairwise" if name.startswith("hills") else None)
    height = samples[0]["height"].to_numpy()
    path = height.mean() + height.std() * np.linspace(4.0, -1.5, 23)
    fractions = [press(each, separation=path, variables="contact_fraction").contact_fraction for each in samples[:5]]
    found = []
    for h in np.interp(FRACTIONS, np.mean(fractions, axis=0), path):
        laws = [press(each, separation=[h]) for each in samples]
        table = np.array([[law[key].item() for key in _ASKED] for law in laws])
        table = table[np.isfinite(table[:, 0])]  # others have no equilibrium
        force, area, of_force, of_area, number = table.T
        scatter = np.std(force, ddof=1) / np.mean(force)
        force, area = np.log(table[force > 0.0, :2]).T
        of_areas = np.std(area - np.polyval(np.polyfit(force, area, 1), force), ddof=2)
        by_contacts = np.nanmedian(number**-0.5) / scatter
        found.append([np.nanmedian(number), *_held(of_force, scatter), by_contacts, *_held(of_area, of_areas)])
    return dict(zip(_NAMES, np.transpose(found), strict=True))


def _held(stated: Floats, true: float) -> tuple[float, float, float]:
    """Return the true scatter, the median of the stated over it, and the share near it."""
    ratio = stated[np.isfinite(stated)] / true
    return true, float(np.median(ratio)), float(np.mean((ratio > 2.0 / 3.0) & (ratio < 1.5)))


def report_samples(result: xr.Dataset) -> str:
    """Return the table of all cases, with a number for each contact fraction."""
    rows = [
        [name, *(", ".join(f"{value:.2g}" for value in result[key].sel(surface=name).to_numpy()) for key in _NAMES)]
        for name in result["surface"].to_numpy().tolist()
    ]
    head = ["samples", *_NAMES.values()]
    return f"Scatter of the force at {', '.join(map(percent, FRACTIONS))} mean contact:\n\n{table(head, rows)}\n"
