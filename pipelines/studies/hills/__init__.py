"""Force, contact area, stiffness and run time of maps by summits, hills, Persson's theory and coarse boundary elements.

All methods press a map at the same separations, those at which 0.3 to 20 % are in contact.
"""

from itertools import product

import numpy as np
import xarray as xr

from studies.comparison import groups_of, in_cases, panels, percent, rms
from studies.hills import maps
from studies.hills.convergence import QUICK_TRIALS, TRIALS, draw_convergence, measure_convergence, report_convergence
from studies.hills.grids import measure_grids, report_grids
from studies.study import Axes, Figure, Study, named, table, without_limits

COARSE = (2, 3, 4)
PERSSON = {"Persson, gamma 0.45": 0.45, "Persson, gamma 1": 1.0}
"""Factor gamma of the theory by the names of its methods, for isotropic maps."""
METHODS = ("summits", "summits in pairs", "hills", *(f"elements, {points} points" for points in COARSE), *PERSSON)
RANGES = ((0.003, 0.01), (0.01, 0.05), (0.05, 0.2))
"""Ranges of the contact fraction over which errors are taken together."""
_COLOURS = ("0.45", "#0072b2", "#d55e00", "#e5b8d4", "#cc79a7", "#7b3f61", "#009e73", "#66c2a5")
_STYLES = dict(zip(METHODS, zip(_COLOURS, "vsoDDD^P", strict=True), strict=True))
_CURVES = (*METHODS[:3], METHODS[6])  # methods whose errors are drawn over the contact fraction


def press(case: maps.MapCase) -> list[maps.Pressed]:
    """Return the solution of fine boundary elements, and then that of each method."""
    separation, surface = maps.separations(case), maps.square(case.height(maps.POINTS))
    persson = [maps.by_persson(surface, separation, gamma) for gamma in PERSSON.values() if case.anisotropy == 1.0]
    return [
        *maps.by_elements_and_asperities(surface, separation, maps.PAIRS),
        *(maps.by_elements(maps.square(case.height(points)), separation) for points in COARSE),
        *persson,
    ]


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or a few."""
    with without_limits():
        press(maps.QUICK[0])  # compiles
        pressed = [
            ("isotropic" if case.anisotropy == 1.0 else "4:1", press(case))
            for case in (maps.QUICK if quick else [*maps.ISOTROPIC, *maps.ANISOTROPIC])
        ]
        parts = [dataset_of(pressed + maps.press_files(quick)), measure_convergence(quick), measure_grids(quick)]
    return xr.merge(parts)


def dataset_of(pressed: list[tuple[str, list[maps.Pressed]]]) -> xr.Dataset:
    """Return the numbers of maps, by the name of their group; NaN of the last methods where there are fewer."""
    words = {
        "force": ("force over the effective modulus", "m2"),
        "contact_fraction": ("contact area over nominal area", "1"),
        "stiffness": ("-dF/dh over the effective modulus", "m"),
    }
    seconds = {"seconds": ("run time of force and area along a path", "s")}
    numbers = [{name: [getattr(one, name) for one in each] for name in maps.Pressed._fields} for _, each in pressed]
    solvers = ["fine elements", *METHODS][: max(len(each) for _, each in pressed)]
    return xr.Dataset(
        in_cases(words, numbers, "case", "solver", "fraction") | in_cases(seconds, numbers, "case", "solver"),
        {
            "solver": solvers,
            "fraction": ("fraction", maps.FRACTIONS, named("contact fraction of the separation, about")),
            "maps": ("case", [name for name, _ in pressed]),
        },
    )


def errors_of(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors over case, solver and fraction."""
    true = result[quantity].sel(solver="fine elements", drop=True)
    return result[quantity].drop_sel(solver="fine elements") / true - 1.0


def within(errors: xr.DataArray, share: tuple[float, float]) -> xr.DataArray:
    """Return errors at contact fractions of a range."""
    fraction = errors["fraction"].to_numpy()
    return errors.isel(fraction=np.flatnonzero((fraction >= 0.999 * share[0]) & (fraction <= 1.001 * share[1])))


def groups(result: xr.Dataset) -> dict[str, xr.Dataset]:
    """Return isotropic and anisotropic maps, and each that was measured."""
    return {name: own for (name,), own in groups_of(result, "maps")}


def report(result: xr.Dataset) -> str:
    """Return errors and run times of each method, and what the errors of hills hang on."""
    rows = []
    for (name, own), method in product(groups(result).items(), METHODS):
        force, area, stiffness = (errors_of(own, quantity).sel(solver=method) for quantity in maps.QUANTITIES)
        if np.isfinite(force).any():
            rows.append([
                name, method, percent(rms(force)), f"{100.0 * float(force.mean()):+.1f} %",
                percent(float(np.nanquantile(np.abs(force), 0.9))),
                *(percent(rms(within(force, each))) for each in RANGES),
                percent(float(force["fraction"].where(force.notnull().any("case")).max()), 0),
                percent(rms(area), 0), percent(rms(stiffness)),
                f"{1e3 * float(own['seconds'].sel(solver=method).median()):.0f} ms",
            ])  # fmt: skip
    ranges = [f"{100 * low:g} to {100 * high:g} %" for low, high in RANGES]
    head = ["maps", "method", "force, rms", "mean", "90 % within", *ranges, "answers up to", "area, rms",
            "stiffness, rms", "a path"]  # fmt: skip
    counts = "; ".join(f"{own.sizes['case']} {name}" for name, own in groups(result).items())
    return f"""Maps: {counts}. They are pressed at {result.sizes["fraction"]} separations from 0.3 to 20 % contact, and
held against boundary elements with {maps.POINTS} points a shortest wave; errors by contact fraction are of the force,
r.m.s. The stiffness -dF/dh is held against theirs at every {maps.STIFFNESS_EACH}th separation, and is no part of the
run times. Measured maps are pressed where the environment variable {maps.FOLDER} names a folder with
{" or ".join(maps.FILES)}: squares from the middle, against boundary elements of a free half-space on the same points.
Errors are those of the forces of all cells, those at the border too, where summits beyond it are missing.

{table(head, rows)}

{report_convergence(result)}

{report_grids(result)}
"""


def draw(result: xr.Dataset) -> Figure:
    """Draw the errors of the force on Gaussian maps over the contact fraction, and over the run time."""
    parts = {name: own for name, own in groups(result).items() if name in ("isotropic", "4:1")}
    figure, row = panels(4.6 * (len(parts) + 1), 5.0, len(parts) + 1)
    for panel, (name, own) in zip(row, parts.items(), strict=False):
        _draw_errors(panel, own)
        panel.set_title(f"{name} maps: median, 10 to 90 %")
    own, panel = parts["isotropic"], row[-1]
    for method, (colour, marker) in _STYLES.items():
        seconds = own["seconds"].sel(solver=method).to_numpy()
        by_case = [100.0 * rms(case) for case in errors_of(own).sel(solver=method).to_numpy()]
        panel.loglog(1e3 * seconds, by_case, marker, color=colour, ms=5, label=method)
    panel.set(xlabel="run time of nine separations [ms]", ylabel="r.m.s. error of the force [%]")
    panel.set_title("isotropic maps, one point each")
    figure.legend(*panel.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9)
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
    f"{len(maps.QUICK)} of {len(maps.ISOTROPIC) + len(maps.ANISOTROPIC)} maps; convergence on "
    f"{len(QUICK_TRIALS)} smaller maps in place of {len(TRIALS)}, with elements half as fine; "
    "smaller pieces of measured maps; 8 of 48 references, the coarsest",
)  # fmt: skip
