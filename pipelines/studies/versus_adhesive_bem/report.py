"""The study of adhesive pairs against boundary elements: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.study import table
from studies.versus_adhesive_bem.cases import DETACHED, MODELS
from studies.versus_adhesive_bem.judge import Judged, judge, turning

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LABELS = {"independent": "independent", "first": "pairs, order 1", "second": "pairs, order 2"}
_COLOURS = {"independent": "0.6", "first": "#1b6ca8", "second": "#c8553d"}
_SHOWN = 4.0  # Tabor number of the curves, or that next to it


def _curves(panel: "Axes", case: xr.Dataset, quantity: str, share: float) -> None:
    """Draw a quantity over the separation: loading hollow and thin, unloading full."""
    case = case.isel(step=np.flatnonzero(case["separation"].notnull().to_numpy()))
    separation = case["separation"].to_numpy()
    turn = turning(separation)
    for name, style in (("independent", "--"), ("second", "-")):
        values = share * case[quantity].sel(source=name).to_numpy()
        panel.plot(separation[: turn + 1], values[: turn + 1], style, color=_COLOURS[name], lw=1.0)
        panel.plot(separation[turn:], values[turn:], style, color=_COLOURS[name], lw=2.0, label=_LABELS[name])
    values = share * case[quantity].sel(source="bem").to_numpy()
    panel.plot(separation[: turn + 1], values[: turn + 1], "ko", ms=4, mfc="w", label="boundary elements, loading")
    panel.plot(separation[turn:], values[turn:], "ko", ms=4, label="boundary elements, unloading")
    panel.set(xlabel="separation from the highest asperity [a0²/R]")


def _by_tabor(panel: "Axes", result: xr.Dataset) -> None:
    """Draw the largest error of the force over the Tabor number, by ensemble and model; one in a patch for comparison.

    Its neighbours, the periodic images, are so far away that it shows the range alone.
    """
    numbers, spacings = result["asperities"].to_numpy(), result["spacing"].to_numpy()
    groups = sorted(set(zip(numbers.tolist(), spacings.tolist(), strict=True)))
    for (number, spacing), marker in zip(groups, "Dsov", strict=False):
        own = result.isel(case=np.flatnonzero((numbers == number) & (spacings == spacing)))
        for name in ("second",) if number == 1 else ("independent", "second"):
            found = [judge(own.isel(case=i), name) for i in range(own.sizes["case"])]
            errors = [100.0 * max(one.loading, one.unloading) for one in found]
            where = f"one, {spacing:g} a0 apart" if number == 1 else f"{number}, {spacing:g} a0 apart"
            colour, line = ("k", ":") if number == 1 else (_COLOURS[name], "-")
            panel.loglog(own["tabor"], errors, line, marker=marker, color=colour, label=f"{where}: {_LABELS[name]}")
    panel.set(xlabel="Tabor number", ylabel="largest error of the force over pull-off [%]")
    panel.set_xticks([2, 3, 4, 6], ["2", "3", "4", "6"])
    panel.set_xticks([], minor=True)
    panel.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    panel.set_title("Steps with as many in contact")
    panel.legend(fontsize=8)


def draw(result: xr.Dataset) -> "Figure":
    """Draw force and contact area over the separation of one case, and errors over the Tabor number of all."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(16, 5.2), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    several = result.isel(case=np.flatnonzero(result["asperities"].to_numpy() > 1))
    case = several.isel(case=int(np.argmin(np.abs(several["tabor"].to_numpy() - _SHOWN))))
    number, spacing, tabor = int(case["asperities"]), float(case["spacing"]), float(case["tabor"])
    _curves(left, case, "force", 1.0)
    left.set(ylabel="force [E* a0³/R]", title=f"{number} asperities, {spacing:g} a0 apart, Tabor number {tabor:g}")
    left.legend(fontsize=8, loc="lower right")
    _curves(middle, case, "area", 1.0 / (number * spacing**2))
    middle.set(ylabel="contact area over nominal area", title="Thin lines: loading; thick: unloading")
    _by_tabor(right, result)
    for panel in (left, middle, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure


def report(result: xr.Dataset) -> str:
    """Return errors by case and model, where jumps are, and the errors of the grids."""
    errors, lags, grids = [], [], []
    for i in range(result.sizes["case"]):
        case = result.isel(case=i)
        nearest = float(case["nearest"])
        apart = f"{float(case['spacing']):g} ({f'{nearest:.1f}' if np.isfinite(nearest) else 'images'})"
        head = [f"{int(case['asperities'])}", apart, f"{float(case['tabor']):g}"]
        for name in MODELS:
            found = judge(case, name)
            errors.append(
                [*head, _LABELS[name], *_percent(found, "loading", "unloading", "middle", "area", "pull_off")]
            )
            lags.append([*head, _LABELS[name], *_percent(found, "on", "off", "before", "apart")])
        fraction = float(case["area"].sel(source="bem").max() / case["asperities"] / case["spacing"] ** 2)
        mesh = judge(case, "coarse")
        seconds = f"{float(case['seconds'].sel(source='bem')):.1f} s"
        paired = f"{1e3 * float(case['seconds'].sel(source='second')):.0f} ms"
        grids.append([*head, f"{100.0 * fraction:.1f} %", f"{float(case['cells']):.1f}",
                      *_percent(mesh, "loading", "unloading", "area", "pull_off"), seconds, paired])  # fmt: skip
    own = ["asperities", "apart (nearest) [a0]", "Tabor number"]
    errors_head = ["model", "loading", "unloading", "r.m.s.", "contact area", "pull-off force"]
    lags_head = ["model", "jumps on", "lets go", "tension before contact", "steps not compared"]
    grids_head = ["contact", "range over grid", "loading", "unloading", "contact area", "pull-off force", "elements",
                  "pairs"]  # fmt: skip
    return f"""Errors against boundary elements, of the force over the largest tension and of the area over the largest,
the largest of the steps where as many asperities are in contact. One alone has its periodic images as neighbours. The
area of boundary elements is the mean of those where the gap is 0 and where it is less than the range:

{table([*own, *errors_head], errors)}

Lags of jumps, means over the asperities: how much farther away they jump on and let go by boundary elements, over the
stretch at which one alone lets go (a step of the path is {100.0 * _step(result):.0f} % of it):

{table([*own, *lags_head], lags)}

How far a grid of 2/3 as many points a side is from the grid, the largest contact fraction, and run times of a path:

{table([*own, *grids_head], grids)}
"""


def _percent(found: Judged, *names: str) -> list[str]:
    return [f"{100.0 * getattr(found, name):.2g} %" for name in names]


def _step(result: xr.Dataset) -> float:
    """Return the step of the first path over the stretch at which one alone lets go."""
    separation = result["separation"].isel(case=0).to_numpy()
    return float(separation[0] - separation[1]) / -DETACHED
