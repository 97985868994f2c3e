"""Press maps and pull them off by each method along the same path."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from studies.adhesive_hills.cases import CASES, FEW, MAPS, QUICK, Adhesive, Case, measure_stated, report_stated
from studies.comparison import each_of, in_cases, panels, percent, rms
from studies.study import Axes, Figure, Study, table

METHODS = ("summits", "summits in pairs", "hills", "hills in pairs", "hills, Dugdale")
ELEMENTS = ("elements", "coarse grid")
_COARSE = 2.0 / 3.0  # share of the points of a grid
_LEAST = 0.003  # contact fraction of boundary elements from which on steps are compared
_COLOURS = dict(zip(METHODS, ("0.6", "#e69f00", "#56b4e9", "#0072b2", "#d55e00"), strict=True))
_MARKERS = dict(zip(METHODS, "vDosX", strict=True))
_SHOWN = 1
_COLUMNS = {
    "hurst": ("Hurst exponent", "1"),
    "bandwidth": ("side over the shortest wave", "1"),
    "anisotropy": ("length of the waves along over across", "1"),
    "jump_on": ("jump-on radius over the wavelength", "1"),
    "stretch": ("square of the jump-on radius over the radius", "m"),
}
_NUMBERS = {
    "force": ("force over the effective modulus", "m2"),
    "contact_fraction": ("contact area over nominal area", "1"),
}


def press(case: Case) -> dict[str, Any]:
    """Return the numbers of a case, the laws by ``ELEMENTS`` and then by ``METHODS``."""
    adhesive, points = Adhesive(case), case.points
    separation, hills, summits = adhesive.path(), adhesive.hills, adhesive.summits
    found = [
        adhesive.by_elements(separation, points),
        adhesive.by_elements(separation, _COARSE * points),
        adhesive.law(summits, separation),
        adhesive.law(summits, separation, interaction="pairwise"),
        adhesive.law(hills, separation),
        adhesive.law(hills, separation, interaction="pairwise"),
        adhesive.law(hills, separation, adhesion="dugdale", strength=adhesive.work / adhesive.reach),
    ]
    return {
        **{name: [getattr(law, name) for law in found] for name in _NUMBERS},
        **{name: getattr(case.surface, name) for name in ("hurst", "bandwidth", "anisotropy")},
        "separation": separation,
        "jump_on": case.jump_on,
        "stretch": adhesive.stretch,
    }


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or one of them on coarse grids."""
    pressed = [press(case) for case in (QUICK if quick else CASES)]
    along = {"separation": ("separation from the mean plane", "m")}
    return xr.Dataset(
        in_cases(_NUMBERS, pressed, "case", "source", "step") | in_cases(along, pressed, "case", "step"),
        {"source": [*ELEMENTS, *METHODS], **in_cases(_COLUMNS, pressed, "case")},
    ).merge(measure_stated(FEW if quick else MAPS))


class Judged(NamedTuple):
    """Differences from boundary elements; NaN where the method has no law."""

    loading: float  # r.m.s. of the force over its largest size
    unloading: float  # on the way back
    pull_off: float  # the largest tension of unloading over that of boundary elements
    loss: float
    """The energy lost over the cycle, over the pull-off force of boundary elements times the stretch of a contact."""


def judge(case: xr.Dataset, source: str) -> Judged:
    """Judge a source in a case; NaN spreads from steps without a value."""
    separation = case["separation"].to_numpy()
    turn = separation.size // 2
    true, found = (case["force"].sel(source=name).to_numpy() for name in ("elements", source))
    compared = case["contact_fraction"].sel(source="elements").to_numpy() >= _LEAST
    off = (found - true) / np.abs(true).max()
    return Judged(
        loading=rms(off[: turn + 1][compared[: turn + 1]]),
        unloading=rms(off[turn:][compared[turn:]]),
        pull_off=float(found[turn:].min() / true[turn:].min()),
        loss=float(np.trapezoid(found, separation) / (true[turn:].min() * case["stretch"])),
    )


def name_of(case: xr.Dataset) -> str:
    """Return a case in a few words."""
    ratio = f", {float(case['anisotropy']):g}:1" if float(case["anisotropy"]) != 1.0 else ""
    return f"H {float(case['hurst']):g}, 1/{float(case['bandwidth']):g}{ratio}, {float(case['jump_on']):g}"


def report(result: xr.Dataset) -> str:
    """Return errors of each method by case, those of the elements, and how the stated ones do."""
    rows = []
    for case in each_of(result):
        most = percent(float(case["contact_fraction"].sel(source="elements").max()))
        for source in (*METHODS, *ELEMENTS):
            found = judge(case, source)
            errors = [percent(value, 0) for value in found[:2]]
            rows.append([name_of(case), most, source, *errors, f"{found.pull_off:.2f}", f"{found.loss:.2f}"])
    head = ["map, jump-on radius", "contact", "source", "loading", "unloading", "pull-off", "loss"]
    return f"""Errors against adhesive boundary elements, r.m.s. from 0.3 % contact on, of the force over the
largest; pull-off force over that of boundary elements; energy lost in the cycle over the pull-off force of
boundary elements times the stretch of a contact, a0²/R. Maps by Hurst exponent, shortest wave over the side, and
jump-on radius a0 over the wavelength; the largest contact fraction by elements. The Tabor number is 2; the coarse grid
has 2/3 of the points a side:

{table(head, rows)}

On how many maps `model_error` of hills in pairs, with the range given, is no less than their error against boundary
elements, both over the largest force and at most 1: maps that its form is from, and maps drawn after it was settled
(Tabor numbers from 1, at most 4, as far as the grid resolves them). Of single steps those count at which the force is
more than 2 % off:

{report_stated(result)}
"""


def _curves(panel: Axes, case: xr.Dataset, way: slice, title: str) -> None:
    """Draw the force of one way over the separation, over the largest tension of boundary elements."""
    separation = 1e9 * case["separation"].to_numpy()[way]
    force = case["force"] / -case["force"].sel(source="elements").min()
    panel.axhline(0.0, color="k", lw=0.8)
    panel.plot(separation, force.sel(source="elements").to_numpy()[way], "k.-", lw=2.0, ms=8, label="elements")
    for name in METHODS:
        panel.plot(separation, force.sel(source=name).to_numpy()[way], color=_COLOURS[name], lw=1.5, label=name)
    panel.set(xlabel="separation [nm]", ylabel="force over pull-off force of elements", title=title)


def _pull_off(panel: Axes, result: xr.Dataset) -> None:
    """Draw the pull-off force of each method over that of boundary elements."""
    cases = each_of(result)
    for k, name in enumerate(METHODS):
        ratio = [judge(case, name).pull_off for case in cases]
        place = np.arange(len(cases)) + 0.12 * (k - 2)
        panel.plot(place, ratio, _MARKERS[name], color=_COLOURS[name], ms=7, label=name)
    panel.plot(np.arange(len(cases)), [judge(case, "coarse grid").pull_off for case in cases], "k_", ms=28, mew=1.5,
               label="elements, coarse grid")  # fmt: skip
    panel.axhline(1.0, color="k", lw=0.8)
    panel.set_ylim(bottom=0.0)
    panel.set_xticks(range(len(cases)), [name_of(case) for case in cases], rotation=40, ha="right", fontsize=8)
    panel.set(ylabel="pull-off force over that of elements", title="Map and jump-on radius over wavelength")


def draw(result: xr.Dataset) -> Figure:
    """Draw the force of one map over the separation both ways, and the pull-off forces of all."""
    figure, (left, middle, right) = panels(16, 6.0, 3)
    case = result.isel(case=_SHOWN)
    turn = case.sizes["step"] // 2
    _curves(left, case, slice(None, turn + 1), f"Loading: {name_of(case)}")
    _curves(middle, case, slice(turn, None), "Unloading of the same map")
    _pull_off(right, result)
    handles = {label: handle for panel in (left, right) for handle, label in zip(*panel.get_legend_handles_labels(),
               strict=True)}  # fmt: skip
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles), fontsize=9)
    return figure


STUDY = Study(
    "adhesive_hills", "Adhesive hills of maps against boundary elements", measure, draw, report,
    f"{len(QUICK)} cases in place of {len(CASES)}, on coarser grids and with fewer steps; stated errors on "
    f"{sum(map(len, FEW.values()))} maps in place of {sum(map(len, MAPS.values()))}",
)  # fmt: skip
