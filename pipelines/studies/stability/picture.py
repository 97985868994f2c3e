"""The picture of the stability study: a panel for every pair of axes, in each panel cells of some cases."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from studies.stability.cases import AXES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CELLS = 8  # along an axis
_COLORS = {"right": "#1b6ca8", "refused": "#b8b8b8", "wrong": "#ff00c8"}
_SYMBOLS = {
    "effective_modulus": "E* [Pa]",
    "width": "width [m]",
    "work": "w [J/m²]",
    "exponent": "exponent",
    "tabor": "Tabor number",
    "distance": "distance to fold",
    "spread": "spread [decades]",
}
_CELLS: dict[str, Any] = {"origin": "lower", "aspect": "auto"}


def cell_of(result: xr.Dataset, name: str) -> Any:
    """Return the cell along an axis in which each case lies."""
    return np.clip((AXES[name].fraction(result[name].to_numpy()) * CELLS).astype(int), 0, CELLS - 1)


def worst_in(result: xr.Dataset, one: str, other: str, values: Any) -> Any:
    """Return the largest of the values [case] in each cell of a pair of axes; NaN where there is none."""
    grid = np.full((CELLS, CELLS), np.nan)
    np.fmax.at(grid, (cell_of(result, other), cell_of(result, one)), values)
    return grid


def draw(result: xr.Dataset) -> "Figure":
    """Draw the worst error below the diagonal, equilibria evaluated above it, on it the outcomes along each axis."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = list(AXES)
    figure = Figure(figsize=(15, 13.5), layout="constrained")
    panels = figure.subplots(len(names), len(names))
    excess = LogNorm(1e-2, 1.0)
    evaluated = LogNorm(1.0, max(2.0, float(np.nanmax(result.tried, initial=2.0))))
    counted = result.isel(case=slice(0, result.sizes["counted_case"]))
    for i, other in enumerate(names):
        for j, one in enumerate(names):
            panel: Axes = panels[i, j]
            _ticks(panel, one if i == len(names) - 1 else None, other if j == 0 and i > 0 else None)
            if j == i:
                _outcomes(panel, result, one)
            elif j < i:
                _errors(panel, result, one, other, excess)
            else:
                most = worst_in(counted, one, other, counted.tried.max("counted_law").to_numpy())
                panel.imshow(most, cmap="viridis", norm=evaluated, **_CELLS)
    below, above = "below: worst error over what is allowed", "above: most equilibria evaluated for a contact"
    figure.colorbar(ScalarMappable(excess, "YlOrBr"), ax=panels, location="bottom", shrink=0.4, label=below)
    figure.colorbar(ScalarMappable(evaluated, "viridis"), ax=panels, location="right", shrink=0.4, label=above)
    handles = [Patch(color=color, label=outcome) for outcome, color in _COLORS.items()]
    figure.legend(handles=handles, loc="outside upper right", ncols=3, title="refused: no float holds it; white: none")
    figure.suptitle("Results over seven axes, without adhesion, with JKR and with Dugdale", x=0.02, ha="left")
    return figure


def _relevant(result: xr.Dataset, *names: str) -> xr.Dataset:
    """Return the adhesion models that depend on the axes: only one does on the Tabor number."""
    return result.sel(law=["dugdale"]) if "tabor" in names else result


def _errors(panel: "Axes", result: xr.Dataset, one: str, other: str, excess: Any) -> None:
    from matplotlib.colors import ListedColormap

    chosen = _relevant(result, one, other)
    answers = chosen.answers.sum("law")

    def mark(outcome: str) -> None:
        grid = worst_in(chosen, one, other, np.where(answers.sel(outcome=outcome) > 0, 1.0, np.nan))
        panel.imshow(grid, cmap=ListedColormap([_COLORS[outcome]]), **_CELLS)

    mark("refused")
    worst = worst_in(chosen, one, other, chosen.excess.max("law").to_numpy())
    panel.imshow(np.maximum(worst, excess.vmin), cmap="YlOrBr", norm=excess, **_CELLS)
    mark("wrong")


def _outcomes(panel: "Axes", result: xr.Dataset, name: str) -> None:
    """Draw the fraction of each outcome along an axis."""
    answers = _relevant(result, name).answers.sum("law").to_numpy()
    count = np.zeros((CELLS, answers.shape[1]))
    np.add.at(count, cell_of(result, name), answers)
    fraction, bottom = count / np.maximum(count.sum(axis=1, keepdims=True), 1.0), np.zeros(CELLS)
    for number, color in enumerate(_COLORS.values()):
        panel.bar(np.arange(CELLS), fraction[:, number], 1.0, bottom, color=color)
        bottom = bottom + fraction[:, number]
    panel.set(xlim=(-0.5, CELLS - 0.5), ylim=(0.0, 1.0), yticks=(), title=_SYMBOLS[name])


def _ticks(panel: "Axes", below: str | None, left: str | None) -> None:
    """Label the ends and the middle of an axis."""
    positions = np.array([-0.5, 0.5 * CELLS - 0.5, CELLS - 0.5])
    for name, set_ticks, set_label in ((below, panel.set_xticks, panel.set_xlabel),
                                       (left, panel.set_yticks, panel.set_ylabel)):  # fmt: skip
        texts = [f"{AXES[name].at(part):.3g}" for part in (0.0, 0.5, 1.0)] if name else [""] * 3
        set_ticks(positions, texts, fontsize=8)
        set_label(_SYMBOLS[name] if name else "")
