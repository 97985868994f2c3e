"""Pictures of a result."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.curves import Curve, curves
from roughmdr.errors import StoreError
from roughmdr.labelled import Labelled
from roughmdr.store import replacing
from roughmdr.variables import LAW
from roughmdr.views import cell_label, cells_of, held_variables, realizations_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK = {"loading": "#1b6ca8", "unloading": "#c8553d"}
_DASH = {"loading": "-", "unloading": "--"}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_MOST_LABELS = 16


def plot(result: Labelled, path: Path, variables: list[str] | None = None) -> None:
    """Draw variables of a result against separation into ``path``; StoreError for a name that the result lacks.

    Every realisation is a thin line, the mean a thick one, twice its standard error a band. The cells of a sweep have a
    colour each and no thin lines; the way back is dashed. Without ``variables`` all that the result holds.
    """
    from matplotlib.figure import Figure

    held = held_variables(result)
    names = variables or held
    for name in names:
        if name not in held:
            raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(held)}")
    columns = min(2, len(names))
    rows = -(-len(names) // columns)
    cells = cells_of(result)
    below = 0.2 * min(len(cells), _MOST_LABELS) if len(cells) > 1 else 0.0
    figure = Figure(figsize=(5.2 * columns, 3.6 * rows + 0.4 + below), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    labels = [cell_label(result, cell).replace("$", r"\$") for cell in cells]  # no mathematics
    for ax, name in zip(axes.flat, names, strict=False):
        _draw(ax, name, list(curves(result, name)), labels)
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    if len(cells) > 1:
        handles, shown = axes.flat[0].get_legend_handles_labels()
        figure.legend(handles, shown, loc="outside lower left", frameon=False, fontsize=8)
    else:
        axes.flat[0].legend(frameon=False)
    count = realizations_of(result)
    note = f"{count} realisations, mean ± 2 standard errors" if count > 1 else "one realisation"
    if len(cells) > 1:
        note += ", unloading dashed"
        note += f", {len(shown)} of {len(cells)} cells named" if len(shown) < len(cells) else ""
    figure.suptitle(f"{result.attrs['title']}  ({note})", fontsize=11, parse_math=False)
    suffix = path.suffix.lstrip(".").lower() or "png"
    if suffix not in ("png", "pdf", "svg"):
        raise StoreError(f"{path}: cannot draw a .{suffix}; it can be .png, .pdf or .svg")
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=160, format=suffix)


def _draw(ax: "Axes", name: str, drawn: list[Curve], labels: list[str]) -> None:
    units = LAW[name].units
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
        ax.plot(h, mean, lw=1.8 if len(labels) == 1 else 1.2, **style)
    if name in ("force", "pressure", "stiffness"):
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    if name in ("force", "pressure"):
        _zoom_on_tension(ax, drawn, labels, h_scale, scale)
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
    from matplotlib import colormaps

    every = -(-len(labels) // _MOST_LABELS)
    labelled = curve.way == 0 and curve.cell % every == 0
    colour = colormaps["viridis"](0.92 * curve.cell / (len(labels) - 1))
    return {"color": colour, "ls": _DASH[curve.branch], "label": labels[curve.cell] if labelled else None}


def _zoom_on_tension(ax: "Axes", drawn: list[Curve], labels: list[str], h_scale: float, scale: float) -> None:
    """An inset where the tension is too small beside the compression to be seen."""
    h = np.concatenate([curve.separation for curve in drawn]) / h_scale
    values = np.concatenate([curve.mean for curve in drawn]) / scale
    lowest = float(values.min())
    tense = h[values < 0.02 * lowest]
    if not -0.2 * values.max() < lowest < 0.0 or np.ptp(tense) == 0.0:
        return
    inset = ax.inset_axes((0.46, 0.3, 0.5, 0.36))
    for curve in drawn:
        inset.plot(curve.separation / h_scale, curve.mean / scale, lw=1.2, **_style(curve, labels))
    inset.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    inset.set(xlim=(tense.min(), tense.max()), ylim=(1.3 * lowest, -1.3 * lowest))
    inset.tick_params(labelsize=7)


def _shown(name: str, drawn: list[Curve]) -> Floats:
    """What the axis must show: of stiffness, which runs off to minus infinity where a contact snaps, the mean curve."""
    means = np.concatenate([curve.mean for curve in drawn])
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
