"""Press realisations of surfaces of one spectrum as each source makes asperities of it."""

from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.ensemble.spectral.section import SpectrumAsperities
from studies.comparison import in_cases
from studies.study import Figure, Study, blank, named, table, without_limits

HURST = (0.3, 0.5, 0.8)
SHARES = (2.5, 2.0, 1.5, 1.0)  # separations over the r.m.s. height
METHODS = ("nayak", "nayak in pairs", "summits in pairs", "hills in pairs", "boundary elements")
REALIZATIONS, QUICK = 64, 4
_SIDE, _LONG, _SHORT = 1e-4, 5e-5, 6e-6
_SLOPE = 1e-2  # small: nothing depends on it
_WORDS = {
    "force": ("force over the effective modulus", "m2"),
    "contact_fraction": ("contact area over nominal area", "1"),
}
_PAIRS = {"model": "pairwise"}
_COLOURS = dict(zip(METHODS, ("0.55", "#56b4e9", "#0072b2", "#d55e00", "k"), strict=True))
_MARKERS = dict(zip(METHODS, "voDs ", strict=True))


def laws(hurst: float, realizations: int) -> dict[str, xr.Dataset]:
    """Return forces over realisations and steps by each method; boundary elements press the maps of the hills."""
    waves = {"hurst": hurst, "long_wave": _LONG, "short_wave": _SHORT, "rms_slope": _SLOPE}
    section = {"source": "spectrum", "patch": _SIDE, **waves}
    moments = SpectrumAsperities.model_validate(section).summits.moments
    nayak = {"source": "nayak", "patch": _SIDE, **moments._asdict()}

    def run(asperities: dict[str, Any], **more: Any) -> xr.Dataset:
        return rm.run({
            "title": "Surfaces of one spectrum", "seed": 7, "material": {"effective_modulus": 1.0},
            "asperities": asperities,
            "path": {"separation": [share * float(np.sqrt(moments.m0)) for share in SHARES]},
            "output": {"variables": list(_WORDS)}, "batch": {"realizations": realizations}, **more,
        })  # fmt: skip

    hills = run(section, interaction=_PAIRS, reference={"model": "boundary_elements"})
    reference = {name: hills[f"reference_{name}"] for name in _WORDS}
    summits = run({**section, "model": "summits"}, interaction=_PAIRS)
    found = (run(nayak), run(nayak, interaction=_PAIRS), summits, hills, xr.Dataset(reference))
    return dict(zip(METHODS, found, strict=True))


def measure(quick: bool) -> xr.Dataset:
    """Press surfaces of three Hurst exponents, many of each or a few."""
    with without_limits():
        found = [laws(hurst, QUICK if quick else REALIZATIONS) for hurst in HURST]
    numbers = [{name: [each[method][name] for method in METHODS] for name in _WORDS} for each in found]
    hurst = ("hurst", list(HURST), named("Hurst exponent"))
    share = ("step", list(SHARES), named("separation over r.m.s. height"))
    variables = in_cases(_WORDS, numbers, "hurst", "solver", "realization", "step")
    return xr.Dataset(variables, {"hurst": hurst, "solver": list(METHODS), "share": share})


def means(result: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the mean forces over that of boundary elements less 1, and their standard errors.

    Those of hills and of summits of maps are of the differences on each map, the others of independent means.
    """
    force, count = result["force"], result.sizes["realization"]
    true = force.sel(solver=METHODS[-1], drop=True)
    mean = true.mean("realization")
    paired = (force - true).std("realization", ddof=1)
    alone = np.sqrt(force.var("realization", ddof=1) + true.var("realization", ddof=1))
    spread = paired.where(force["solver"].isin(METHODS[2:]), alone)
    return force.mean("realization") / mean - 1.0, spread / mean / np.sqrt(count)


def report(result: xr.Dataset) -> str:
    """Return the error of the mean force by each source, with its standard error."""
    off, error = means(result)
    rows = []
    for hurst in result["hurst"].to_numpy():
        for method in METHODS[:-1]:
            at = {"hurst": hurst, "solver": method}
            cells = zip(off.sel(at).to_numpy(), error.sel(at).to_numpy(), strict=True)
            rows.append([f"{hurst:g}", method, *(f"{100 * each:+.1f} ± {100 * own:.1f} %" for each, own in cells)])
        fraction = result["contact_fraction"].sel(hurst=hurst, solver=METHODS[-1]).mean("realization").to_numpy()
        rows.append([f"{hurst:g}", "contact fraction", *(f"{100 * each:.2g} %" for each in fraction)])
    head = ["H", "source", *(f"h = {share:g} rms" for share in result["share"].to_numpy())]
    return (
        f"Mean force of {result.sizes['realization']} patches of surfaces of one spectrum, over that of boundary "
        "elements on the maps, less 1, with standard errors (of nayak, which draws other surfaces, of both means).\n\n"
        f"{table(head, rows)}"
    )


def draw(result: xr.Dataset) -> Figure:
    """Draw the error of the mean force of each source over the contact fraction."""
    off, error = means(result)
    figure = blank(12.0, 4.4)
    row = figure.subplots(1, result.sizes["hurst"], sharey=True)
    fraction = 100.0 * result["contact_fraction"].sel(solver=METHODS[-1]).mean("realization")
    for panel, hurst in zip(row, result["hurst"].to_numpy(), strict=True):
        for method in METHODS[:-1]:
            at = {"hurst": hurst, "solver": method}
            style: dict[str, Any] = {"color": _COLOURS[method], "marker": _MARKERS[method], "label": method}
            drawn = (fraction.sel(hurst=hurst), 100.0 * off.sel(at), 200.0 * error.sel(at))
            panel.errorbar(*(each.to_numpy() for each in drawn), capsize=3.0, **style)
        panel.axhline(0.0, color="k", lw=0.8)
        panel.set(xscale="log", xlabel="contact fraction [%]", title=f"Hurst exponent {hurst:g}")
    row[0].set_ylabel("mean force over boundary elements, less 1 [%]")
    figure.legend(*row[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


STUDY = Study(
    "spectrum", "Sources nayak and spectrum against boundary elements", measure, draw, report,
    f"{QUICK} of {REALIZATIONS} realisations",
)  # fmt: skip
