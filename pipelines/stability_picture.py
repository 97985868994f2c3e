"""The picture of ``stability.py``: every pair of axes, a cell for some of the cases."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from stability_cases import AXES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CELLS = 8  # along an axis
_REFUSED, _WRONG, _NOTHING = "#b8b8b8", "#ff00c8", "#ffffff"
_RIGHT = "#1b6ca8"
_SYMBOLS = {
    "stiffness": "E* [Pa]",
    "scale": "width [m]",
    "work": "w [J/m²]",
    "exponent": "exponent",
    "tabor": "Tabor number",
    "distance": "distance to fold",
    "spread": "spread [decades]",
}


def cell_of(result: xr.Dataset, name: str, cells: int = CELLS) -> Any:
    """In which cell along an axis each case stands."""
    part = AXES[name].part(result[name].to_numpy())
    return np.clip((part * cells).astype(int), 0, cells - 1)


def worst_in(result: xr.Dataset, one: str, other: str, values: Any) -> Any:
    """The largest of the values [case] in each cell of a pair of axes; NaN where there is none."""
    grid = np.full((CELLS, CELLS), np.nan)
    np.fmax.at(grid, (cell_of(result, other), cell_of(result, one)), values)
    return grid


def draw(result: xr.Dataset) -> "Figure":
    """Below the diagonal the worst error, above it the equilibria tried, on it the outcomes along each axis."""
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = list(AXES)
    figure = Figure(figsize=(15, 13.5), layout="constrained")
    panels = figure.subplots(len(names), len(names))
    excess = LogNorm(1e-2, 1.0)
    tried = LogNorm(1.0, max(2.0, float(np.nanmax(result.tried, initial=2.0))))
    below = above = None
    counted = result.isel(case=slice(0, result.sizes["counted_case"]))
    for i, other in enumerate(names):
        for j, one in enumerate(names):
            panel: Axes = panels[i, j]
            _ticks(panel, one if i == len(names) - 1 else None, other if j == 0 and i > 0 else None)
            if j == i:
                _outcomes(panel, result, one)
            elif j < i:
                below = _errors(panel, result, one, other, excess)
            else:
                most = counted.tried.max("counted_law").to_numpy()
                above = panel.imshow(
                    worst_in(counted, one, other, most), origin="lower", aspect="auto", cmap="viridis", norm=tried
                )
    if below is not None and above is not None:
        figure.colorbar(
            below, ax=panels, location="bottom", shrink=0.4, label="below: worst error over what is allowed"
        )
        figure.colorbar(
            above, ax=panels, location="right", shrink=0.4, label="above: most equilibria tried for a contact"
        )
    handles = [
        Patch(color=_RIGHT, label="right"),
        Patch(color=_REFUSED, label="refused: no float holds it"),
        Patch(color=_WRONG, label="wrong"),
    ]
    figure.legend(handles=handles, loc="outside upper right", ncols=3, title="outcomes; white: no case")
    figure.suptitle("Answers over seven axes, without adhesion, with JKR's and with Dugdale's", x=0.02, ha="left")
    return figure


def _asked(result: xr.Dataset, *names: str) -> xr.Dataset:
    """Only the laws that the axes matter to: the Tabor number does to one."""
    return result.sel(law=["dugdale"]) if "tabor" in names else result


def _errors(panel: "Axes", result: xr.Dataset, one: str, other: str, norm: Any) -> Any:
    own = _asked(result, one, other)
    answers = own.answers.sum("law")
    refused = worst_in(own, one, other, np.where(answers.sel(outcome="refused") > 0, 1.0, np.nan))
    wrong = worst_in(own, one, other, np.where(answers.sel(outcome="wrong") > 0, 1.0, np.nan))
    shown = worst_in(own, one, other, own.excess.max("law").to_numpy())
    panel.imshow(
        np.where(np.isnan(refused), 0.0, 1.0),
        cmap=_plain(_NOTHING, _REFUSED),
        vmin=0,
        vmax=1,
        origin="lower",
        aspect="auto",
    )
    drawn = panel.imshow(np.maximum(shown, norm.vmin), cmap="YlOrBr", norm=norm, origin="lower", aspect="auto")
    panel.imshow(wrong, cmap=_plain(_WRONG, _WRONG), origin="lower", aspect="auto")
    return drawn


def _plain(*colours: str) -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap(list(colours))


def _outcomes(panel: "Axes", result: xr.Dataset, name: str) -> None:
    """The share of each outcome along an axis."""
    own = _asked(result, name)
    answers = own.answers.sum("law").to_numpy()
    count = np.zeros((CELLS, answers.shape[1]))
    np.add.at(count, cell_of(result, name), answers)
    share, bottom = count / np.maximum(count.sum(axis=1, keepdims=True), 1.0), np.zeros(CELLS)
    for number, colour in enumerate((_RIGHT, _REFUSED, _WRONG)):
        panel.bar(np.arange(CELLS), share[:, number], 1.0, bottom, color=colour)
        bottom = bottom + share[:, number]
    panel.set(xlim=(-0.5, CELLS - 0.5), ylim=(0.0, 1.0), yticks=(), title=_SYMBOLS[name])


def _ticks(panel: "Axes", below: str | None, left: str | None) -> None:
    """The ends and the middle of an axis."""
    places = np.array([-0.5, 0.5 * CELLS - 0.5, CELLS - 0.5])
    panel.set_xticks(places, [_number(below, part) for part in (0.0, 0.5, 1.0)] if below else [""] * 3, fontsize=8)
    panel.set_yticks(places, [_number(left, part) for part in (0.0, 0.5, 1.0)] if left else [""] * 3, fontsize=8)
    if below:
        panel.set_xlabel(_SYMBOLS[below])
    if left:
        panel.set_ylabel(_SYMBOLS[left])


def _number(name: str, part: float) -> str:
    return f"{AXES[name].place(part):.3g}"
