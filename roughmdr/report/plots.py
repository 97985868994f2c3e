"""Pictures of a result."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.curves import EXPECTED, Curve, Line, curves
from roughmdr.result.layout import cell_label, cells_of, done_of, realizations_in_words
from roughmdr.schema.wording import harmless
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.store import replacing
from roughmdr.variables import CURVE_VARIABLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK = {"loading": "#1b6ca8", "unloading": "#c8553d"}
_DASH = {"loading": "-", "unloading": "--"}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_MOST_LABELS = 16
_Said = list[tuple[Line, dict[str, Any]]]
_LAW_INKS = ("#2a8c4a", "#f2a900", "#8e44ad", "#17a2b8", "#8c564b")


def plot(result: Labelled, path: Path, names: list[str], lines: Sequence[Line] = ()) -> None:
    """Draw variables of a result against separation into ``path``, and over them what laws say of them.

    Every realisation is a thin line, the mean a thick one, twice its standard error a band. The cells of a sweep have a
    colour each and no thin lines; the way back is dashed. The expected law is thin and dark, the named laws are dotted.
    StoreError where no run was computed, or the picture cannot be written.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    if not done_of(result).any():
        raise StoreError("there is nothing to draw: no run was computed")
    columns = min(2, len(names))
    rows = -(-len(names) // columns)
    cells = cells_of(result)
    laws = list(dict.fromkeys(line.law for line in lines))
    below = 0.2 * (min(len(cells), _MOST_LABELS) + len(laws)) if len(cells) > 1 else 0.0
    figure = Figure(figsize=(5.2 * columns, 3.6 * rows + 0.4 + below), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    labels = [harmless(cell_label(result, cell)).replace("$", r"\$") for cell in cells]  # no mathematics
    for ax, name in zip(axes.flat, names, strict=False):
        said = [(line, _law_style(line.law, laws, line.cell, len(cells))) for line in lines if line.variable == name]
        _draw(ax, name, list(curves(result, name)), labels, said)
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    handles, shown = axes.flat[0].get_legend_handles_labels()
    handles += [Line2D([], [], label=law, **_law_style(law, laws, None, len(cells))) for law in laws]
    if len(cells) > 1:
        figure.legend(handles=handles, loc="outside lower left", frameon=False, fontsize=8)
    else:
        axes.flat[0].legend(handles=handles, frameon=False)
    note = realizations_in_words(result)
    if len(cells) > 1:
        note += ", unloading dashed"
        note += f", {len(shown)} of {len(cells)} cells named" if len(shown) < len(cells) else ""
    figure.suptitle(f"{harmless(result.attrs['title'])}\n{note}", fontsize=11, parse_math=False)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=160, format=format_of(path))


def format_of(path: Path) -> str:
    """The format of a picture, by its name; StoreError where there is no such format."""
    suffix = path.suffix.lstrip(".").lower() or "png"
    if suffix not in ("png", "pdf", "svg"):
        raise StoreError(f"{path}: cannot draw a .{suffix}; it can be .png, .pdf or .svg")
    return suffix


def _draw(ax: "Axes", name: str, drawn: list[Curve], labels: list[str], said: _Said) -> None:
    units = CURVE_VARIABLES[name].units
    h_scale, h_prefix = _scale(np.concatenate([curve.separation for curve in drawn]))
    shown = _shown(name, drawn)
    scale, prefix = (1.0, "") if units == "1" else _scale(shown, power=2 if units == "m2" else 1)
    for curve in drawn:
        h, mean, error = curve.separation / h_scale, curve.mean / scale, curve.error / scale
        style = _style(curve, labels)
        if len(labels) == 1 and curve.runs.size:
            ax.plot(h, curve.runs.T / scale, color=style["color"], lw=0.3, alpha=0.25)
        if name != "stiffness" or curve.branch == "loading":  # where contacts let go its variance is infinite
            ax.fill_between(h, mean - 2 * error, mean + 2 * error, color=style["color"], alpha=0.3, lw=0)
        ax.plot(h, mean, lw=2.6 if len(labels) == 1 else 1.6, **style)
    for line, style in said:
        ax.plot(line.separation / h_scale, line.values / scale, **style)
    if name in ("force", "pressure", "stiffness"):
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    if name in ("force", "pressure"):
        _zoom_on_tension(ax, drawn, labels, said, h_scale, scale)
    low, high = float(shown.min()) / scale, float(shown.max()) / scale
    if high > low:
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    unit = units.replace(" m-1", "/m").replace("m2", "m²")
    ax.set_ylabel(f"{name.replace('_', ' ')}" + (f" [{prefix}{unit}]" if unit != "1" else ""))
    ax.set_xlabel(f"separation [{h_prefix}m]")


def _style(curve: Curve, labels: list[str]) -> dict[str, Any]:
    """Colour, dash and label: by branch for a single cell, else by cell."""
    if len(labels) == 1:
        first = curve.way < 2
        return {"color": _INK[curve.branch], "label": curve.branch if first else None}
    every = -(-len(labels) // _MOST_LABELS)
    labelled = curve.way == 0 and curve.cell % every == 0
    return {
        "color": _cell_colour(curve.cell, len(labels)),
        "ls": _DASH[curve.branch],
        "label": labels[curve.cell] if labelled else None,
    }


def _law_style(law: str, laws: list[str], cell: int | None, cells: int) -> dict[str, Any]:
    """Of the expected law a thin dark line; of a named one dots of its own, in the colour of its cell.

    A single cell leaves a colour to each law; the legend, which is of no cell, is grey.
    """
    if law == EXPECTED:
        return {"color": "#111111", "lw": 0.7 if cells == 1 else 0.5}
    number = laws.index(law)
    dots = {"ls": (0, (1.0, 1.0 + 0.5 * number)), "lw": 1.8}
    if cells == 1:
        return {"color": _LAW_INKS[number % len(_LAW_INKS)], **dots}
    return {"color": "0.4" if cell is None else _cell_colour(cell, cells), **dots}


def _cell_colour(cell: int, cells: int) -> Any:
    from matplotlib import colormaps

    return colormaps["viridis"](0.92 * cell / (cells - 1))


def _zoom_on_tension(
    ax: "Axes", drawn: list[Curve], labels: list[str], said: _Said, h_scale: float, scale: float
) -> None:
    """An inset where the tension is too small beside the compression to be seen."""
    h = np.concatenate([curve.separation for curve in drawn]) / h_scale
    values = np.concatenate([curve.mean for curve in drawn]) / scale
    lowest = float(values.min())
    tense = h[values < 0.02 * lowest]
    if not -0.2 * values.max() < lowest < 0.0 or np.ptp(tense) == 0.0:
        return
    inset = ax.inset_axes((0.46, 0.3, 0.5, 0.36))
    for curve in drawn:
        inset.plot(curve.separation / h_scale, curve.mean / scale, lw=1.8, **_style(curve, labels))
    for line, style in said:
        inset.plot(line.separation / h_scale, line.values / scale, **style)
    inset.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    inset.set(xlim=(tense.min(), tense.max()), ylim=(1.3 * lowest, -1.3 * lowest))
    inset.tick_params(labelsize=7)


def _shown(name: str, drawn: list[Curve]) -> Floats:
    """What the axis must show: of stiffness, which runs off to minus infinity where a contact snaps, the mean curve."""
    means = np.concatenate([curve.mean for curve in drawn if np.isfinite(curve.mean).all()])
    if name == "stiffness":
        return means.clip(*np.quantile(means, [0.01, 1.0]))
    return np.concatenate([means, *(curve.runs.ravel() for curve in drawn)])


def _scale(values: Floats, power: int = 1) -> tuple[float, str]:
    """The SI prefix under which the largest magnitude reads from 1 to 1000; from 0.1 to 1e5 for areas (``power`` 2)."""
    largest = float(np.max(np.abs(values), initial=0.0))
    if largest == 0.0:
        return 1.0, ""
    exponent = 3 * int(np.floor((np.log10(largest) + power - 1) / (3 * power)))
    exponent = min(max(exponent, -12), 12)
    return 10.0 ** (exponent * power), _PREFIXES[exponent]
