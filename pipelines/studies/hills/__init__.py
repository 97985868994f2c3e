"""Force, contact area, stiffness and run time of maps by summits, hills, Persson's theory and coarse boundary elements.

All methods press a map at the same separations, those at which 0.3 to 20 % are in contact.
"""

from itertools import product

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.summits import find_summits
from studies.comparison import ERRORS, error_cells, errors_against, in_cases, panels, percent, rms
from studies.hills.convergence import QUICK_TRIALS, TRIALS, draw_convergence, measure_convergence, report_convergence
from studies.hills.grids import measure_grids, report_grids
from studies.hills.maps import (
    ANISOTROPIC,
    FRACTIONS,
    ISOTROPIC,
    PAIRS,
    POINTS,
    QUANTITIES,
    QUICK,
    MapCase,
    Pressed,
    by_asperities,
    by_elements,
    by_persson,
    hills_of,
    separations,
    square,
)
from studies.hills.measured_maps import measure_files, report_files
from studies.study import Axes, Figure, Study, named, table, without_limits

COARSE = (2, 3, 4)
PERSSON = {"Persson, gamma 0.45": 0.45, "Persson, gamma 1": 1.0}
"""Factor gamma of the theory by the names of its methods, for isotropic maps."""
METHODS = ("summits", "summits in pairs", "hills", *PERSSON, *(f"elements, {points} points" for points in COARSE))
RANGES = ((0.003, 0.01), (0.01, 0.05), (0.05, 0.2))
"""Ranges of the contact fraction over which errors are taken together."""
_COLOURS = ("0.45", "#0072b2", "#d55e00", "#009e73", "#66c2a5", "#e5b8d4", "#cc79a7", "#7b3f61")
_STYLES = dict(zip(METHODS, zip(_COLOURS, "vso^PDDD", strict=True), strict=True))
_CURVES = METHODS[:4]  # methods whose errors are drawn over the contact fraction


def press(case: MapCase) -> list[Pressed]:
    """Return the solution of fine boundary elements, and then that of each method."""
    separation, surface = separations(case), square(case.height(POINTS))
    unknown = np.full(separation.size, np.nan)
    nothing = Pressed(unknown, unknown, unknown, np.nan)
    return [
        by_elements(surface, separation),
        by_asperities(surface, separation, find_summits, None),
        by_asperities(surface, separation, find_summits, PAIRS),
        by_asperities(surface, separation, hills_of, PAIRS),
        *(by_persson(surface, separation, gamma) if case.anisotropy == 1.0 else nothing for gamma in PERSSON.values()),
        *(by_elements(square(case.height(points)), separation) for points in COARSE),
    ]


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or a few."""
    with without_limits():
        press(QUICK[0])  # compiles
        parts = [measure_maps(QUICK if quick else [*ISOTROPIC, *ANISOTROPIC]), measure_convergence(quick)]
        return xr.merge([*parts, measure_grids(quick), measure_files(quick)])


def measure_maps(cases: list[MapCase]) -> xr.Dataset:
    """Press maps by each method."""
    words = {
        "force": ("force over the effective modulus", "m2"),
        "contact_fraction": ("contact area over nominal area", "1"),
        "stiffness": ("-dF/dh over the effective modulus", "m"),
    }
    seconds = {"seconds": ("run time of force and area along a path", "s")}
    pressed = [press(case) for case in cases]
    numbers = [{name: [getattr(one, name) for one in each] for name in Pressed._fields} for each in pressed]
    columns = dict(zip(MapCase._fields, zip(*cases, strict=True), strict=True))
    return xr.Dataset(
        in_cases(words, numbers, "case", "solver", "fraction") | in_cases(seconds, numbers, "case", "solver"),
        {
            "solver": ["fine elements", *METHODS],
            "fraction": ("fraction", FRACTIONS, named("contact fraction of the separation, about")),
            **{name: ("case", list(values)) for name, values in columns.items()},
        },
    )


def errors_of(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors over case, solver and fraction."""
    return errors_against(result[quantity], "fine elements")


def within(errors: xr.DataArray, share: tuple[float, float]) -> xr.DataArray:
    """Return errors at contact fractions of a range."""
    fraction = errors["fraction"].to_numpy()
    return errors.isel(fraction=np.flatnonzero((fraction >= 0.999 * share[0]) & (fraction <= 1.001 * share[1])))


def groups(result: xr.Dataset) -> dict[str, xr.Dataset]:
    """Return isotropic and anisotropic maps."""
    ratio = result["anisotropy"].to_numpy()
    found = {"isotropic": ratio == 1.0, "4:1": ratio > 1.0}
    return {name: result.isel(case=np.flatnonzero(member)) for name, member in found.items() if member.any()}


def report(result: xr.Dataset) -> str:
    """Return errors and run times of each method, and what the errors of hills hang on."""
    rows = []
    for (name, own), method in product(groups(result).items(), METHODS):
        force, area, stiffness = (errors_of(own, quantity).sel(solver=method) for quantity in QUANTITIES)
        if np.isfinite(force).any():
            parts = [percent(rms(within(force, each))) for each in RANGES]
            most = percent(float(np.nanquantile(np.abs(force), 0.9)))
            seconds = f"{1e3 * float(own['seconds'].sel(solver=method).median()):.0f} ms"
            rows.append([name, method, *error_cells(force, area, stiffness), most, *parts, seconds])
    in_words = [f"{100 * low:g} to {100 * high:g} %" for low, high in RANGES]
    head = ["maps", "method", *ERRORS, "90 % within", *(f"at {words}" for words in in_words), "a path"]
    counts = ", ".join(f"{own.sizes['case']} {name}" for name, own in groups(result).items())
    stiffnesses = int(result["stiffness"].sel(solver="fine elements").notnull().any("case").sum())
    return f"""{counts} maps, {result.sizes["fraction"]} separations from 0.3 to 20 % contact each, against boundary
elements with {POINTS} points a shortest wave. The stiffness -dF/dh is held against theirs at {stiffnesses} of the
separations, and is no part of the run times. Errors of the force by contact fraction are r.m.s. too.

{table(head, rows)}

{report_convergence(result)}

{report_grids(result)}

{report_files(result)}
"""


def draw(result: xr.Dataset) -> Figure:
    """Draw the errors of the force over the contact fraction, and over the run time."""
    from matplotlib.lines import Line2D

    parts = groups(result)
    figure, row = panels(4.6 * (len(parts) + 1), 5.0, len(parts) + 1)
    for panel, (name, own) in zip(row, parts.items(), strict=False):
        _draw_errors(panel, own)
        panel.set_title(f"{name} maps: median, 10 to 90 %")
    own, panel = parts["isotropic"], row[-1]
    for method, (colour, marker) in _STYLES.items():
        seconds = own["seconds"].sel(solver=method).to_numpy()
        by_case = [100.0 * rms(case) for case in errors_of(own).sel(solver=method).to_numpy()]
        panel.loglog(1e3 * seconds, by_case, marker, color=colour, ms=5)
    panel.set(xlabel="run time of nine separations [ms]", ylabel="r.m.s. error of the force [%]")
    panel.set_title("isotropic maps, one point each")
    handles = [Line2D([], [], color=colour, marker=marker, lw=2.0 * (method in _CURVES), ms=5)
               for method, (colour, marker) in _STYLES.items()]  # fmt: skip
    figure.legend(handles, METHODS, loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _draw_errors(panel: Axes, own: xr.Dataset) -> None:
    """Draw the errors of the force on maps of a kind over the contact fraction."""
    errors, fraction = errors_of(own), 100.0 * own["fraction"].to_numpy()
    for method in _CURVES:
        each = 100.0 * errors.sel(solver=method).to_numpy()
        if np.isfinite(each).any():
            colour, marker = _STYLES[method]
            low, middle, high = np.nanquantile(each, [0.1, 0.5, 0.9], axis=0)
            panel.fill_between(fraction, low, high, color=colour, alpha=0.18, lw=0.0)
            panel.semilogx(fraction, middle, f"{marker}-", color=colour, lw=2.0, ms=5)
    panel.axhline(0.0, color="k", lw=0.8)
    panel.set(xlabel="contact fraction [%]", ylabel="error of the force [%]", ylim=(-50.0, 50.0))
    panel.set_xticks([0.3, 1, 3, 10, 20], ["0.3", "1", "3", "10", "20"], minor=False)
    panel.minorticks_off()


STUDY = Study(
    "hills", "Summits and hills of maps against boundary elements", measure,
    {"hills": draw, "hills_convergence": draw_convergence}, report,
    f"{len(QUICK)} of {len(ISOTROPIC) + len(ANISOTROPIC)} maps; convergence on "
    f"{len(QUICK_TRIALS)} smaller maps in place of {len(TRIALS)}, with elements half as fine; "
    "smaller pieces of measured maps; 8 of 48 references, the coarsest",
)  # fmt: skip
