"""Pictures of a result: mean and standard error of its variables over each loading and unloading."""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.trust import trust_of_result
from roughmdr.result.layout import (
    abscissa_of,
    cell_label,
    cells_of,
    control_of,
    controlled_values,
    done_of,
    realizations_in_words,
)
from roughmdr.schema.wording import escape_controls
from roughmdr.storage.files import check_ending, replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import LAW_VARIABLES, STEP_COORDINATES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EXPECTED = "expected"
REFERENCE = "boundary elements"
_BRANCH_COLOURS = {"loading": "#1b6ca8", "unloading": "#c8553d"}
_BRANCH_LINESTYLES = {"loading": "-", "unloading": "--"}
_THEORY_COLOURS = ("#2a8c4a", "#f2a900", "#8e44ad", "#17a2b8", "#8c564b")
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_MAX_LABELS = 16
_ABSCISSA_NAMES = {**{name: name for name in STEP_COORDINATES}, "remote": "position of the far end of the spring"}


class OverlayLine(NamedTuple):
    """A curve drawn over a result: a variable in one cell, over the whole path."""

    label: str  # name of the theory curve; ``EXPECTED`` for the expected law of the scene, or ``REFERENCE``
    variable: str
    cell: int
    separation: Floats
    values: Floats  # NaN where the theory gives none


class Overlay(NamedTuple):
    """Lines to draw, and remarks on whether they are drawn, and if not why."""

    lines: list[OverlayLine]
    remarks: list[str]


class _Curve(NamedTuple):
    """A variable in one cell of a result, over one loading or unloading."""

    cell: int
    pass_number: int  # counts the loadings and unloadings of the path, from 0
    branch: str
    abscissa: Floats  # the controlled quantity, or what stands in its place
    mean: Floats
    error: Floats  # standard error of the mean; NaN if there is none
    model_error: Floats  # of a force, over itself; NaN where it is not known, or of other variables
    runs: Floats  # [realization, step]; computed realisations, none if only statistics were kept
    abscissae: Floats  # of each of them


def draw(result: Labelled, names: list[str], lines: Sequence[OverlayLine] = ()) -> "Figure":
    """Draw variables of a result against the controlled quantity, with ``lines`` over them.

    Where that is the travel to a preload, the separation or the far end of the spring stands in its place.
    Every realisation is a thin line, the mean a thick one, twice its standard error a band, and of a force the error of
    the model a grey one, where the result has its curve. The cells of a sweep have a colour each and no thin lines;
    unloading is dashed. The expected law is thin and dark, theory curves are dotted. The title says how far the force
    can be trusted.
    StoreError if no run was computed.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    if not done_of(result).any():
        raise StoreError("there is nothing to draw: no run was computed")
    names = [name for name in names if name != abscissa_of(result)] or names
    columns = min(2, len(names))
    rows = -(-len(names) // columns)
    cells, overlays = cells_of(result), list(dict.fromkeys(line.label for line in lines))
    legend_height = 0.2 * (min(len(cells), _MAX_LABELS) + len(overlays)) if len(cells) > 1 else 0.0
    figure = Figure(figsize=(5.2 * columns, 3.6 * rows + 0.4 + legend_height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    labels = [escape_controls(cell_label(result, cell)).replace("$", r"\$") for cell in cells]  # no mathematics
    for ax, name in zip(axes.flat, names, strict=False):
        selected = [line for line in lines if line.variable == name]
        overlay = [(line, _overlay_style(line.label, overlays, line.cell, len(cells))) for line in selected]
        _draw_panel(ax, (abscissa_of(result), name), list(_curves_of(result, name)), labels, overlay)
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    handles, named = axes.flat[0].get_legend_handles_labels()
    handles += [Line2D([], [], label=label, **_overlay_style(label, overlays, None, len(cells))) for label in overlays]
    note = realizations_in_words(result)
    if len(cells) > 1:
        figure.legend(handles=handles, loc="outside lower left", frameon=False, fontsize=8)
        note += ", unloading dashed"
        note += f", {len(named)} of {len(cells)} cells named" if len(named) < len(cells) else ""
    else:
        axes.flat[0].legend(handles=handles, frameon=False)
    title = f"{escape_controls(result.attrs['title'])}\n{note}"
    figure.suptitle("\n".join([title, *_trust_note(result, names)]), fontsize=11, parse_math=False)
    return figure


def _trust_note(result: Labelled, names: list[str]) -> list[str]:
    """Return how far the force can be trusted, in lines as long as a picture is wide."""
    text = dict(trust_of_result(result))["trust"]
    return textwrap.wrap(f"model: {text}", 62 * min(2, len(names)))


def save(figure: "Figure", path: Path) -> None:
    """Write a picture in the format that its name says; StoreError if it cannot be written."""
    with replace_atomically(path) as temporary:
        figure.savefig(temporary, dpi=160, format=format_of(path))


def format_of(path: Path) -> str:
    """Return the format of a picture by its name; StoreError if there is no such format."""
    return check_ending(path, "picture", (".png", ".pdf", ".svg")).removeprefix(".")


def _curves_of(result: Labelled, name: str) -> Iterator[_Curve]:
    """Yield the curves of a variable, cell by cell."""
    branches = result.coordinates["branch"].values
    passes = np.split(np.arange(branches.size), np.flatnonzero(branches[1:] != branches[:-1]) + 1)
    if name in result.variables:
        runs, done = result.variables[name].values, done_of(result)
        mean, error = mean_and_error(runs, done)
    else:
        mean, error = (result.variables[f"{name}_{statistic}"].values for statistic in ("mean", "sem"))
        runs, done = np.empty((*mean.shape[:-1], 0, branches.size)), np.empty((*mean.shape[:-1], 0), dtype=bool)
    model_error = _mean_model_error(result, name, mean)
    abscissa, abscissae = _abscissae(result, runs, done)
    for number, cell in enumerate(np.ndindex(mean.shape[:-1])):
        for pass_number, steps in enumerate(passes):
            columns = abscissa[cell][steps], mean[cell][steps], error[cell][steps], model_error[cell][steps]
            of_runs = (values[cell][done[cell]][:, steps] for values in (runs, abscissae))
            yield _Curve(number, pass_number, str(branches[steps[0]]), *columns, *of_runs)


def _abscissae(result: Labelled, runs: Floats, done: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Return the abscissa of each cell, [..., step], and of each of its ``runs``, [..., realization, step]."""
    name = abscissa_of(result)
    if name == control_of(result):
        values = controlled_values(result)
        return values, np.broadcast_to(values[..., None, :], runs.shape)
    if name in result.variables:
        values = result.variables[name].values
        return mean_and_error(values, done)[0], values
    return result.variables[f"{name}_mean"].values, runs


def _mean_model_error(result: Labelled, name: str, mean: Floats) -> Floats:
    """Return the model error of a mean force over the realisations; NaN where it is not known, or of others."""
    curve = "model_error_curve"
    if name in ("force", "pressure") and f"{curve}_mean" in result.variables:
        return result.variables[f"{curve}_mean"].values
    if name in ("force", "pressure") and curve in result.variables:
        return mean_and_error(result.variables[curve].values, done_of(result))[0]
    return np.full_like(mean, np.nan)


def _draw_panel(
    ax: "Axes",
    names: tuple[str, str],
    curves: list[_Curve],
    labels: list[str],
    overlay: list[tuple[OverlayLine, dict[str, Any]]],
) -> None:
    """Draw one variable over the abscissa; ``names`` are those of the abscissa and of the variable."""
    abscissa, name = names
    units = LAW_VARIABLES[name].units
    h_scale, h_prefix = _si_scale(np.concatenate([curve.abscissa for curve in curves]))
    visible = _visible_values(name, curves)
    scale, prefix = (1.0, "") if units == "1" else _si_scale(visible, power=2 if units == "m2" else 1)

    def draw_means(axes: "Axes", linewidth: float) -> None:
        for curve in curves:
            style = _curve_style(curve, labels)
            axes.plot(curve.abscissa / h_scale, curve.mean / scale, lw=linewidth, **style)
        for line, style in overlay:
            axes.plot(line.separation / h_scale, line.values / scale, **style)

    for curve in curves:
        if np.isfinite(curve.model_error).any():
            off = curve.model_error * np.abs(curve.mean) / scale
            middle = curve.mean / scale
            ax.fill_between(curve.abscissa / h_scale, middle - off, middle + off, color="0.85", lw=0, zorder=0.5)
        h, mean, error = curve.abscissa / h_scale, curve.mean / scale, curve.error / scale
        colour = _curve_style(curve, labels)["color"]
        if len(labels) == 1 and curve.runs.size:
            ax.plot(curve.abscissae.T / h_scale, curve.runs.T / scale, color=colour, lw=0.3, alpha=0.25)
        if name != "stiffness" or curve.branch == "loading":  # where contacts detach its variance is infinite
            ax.fill_between(h, mean - 2 * error, mean + 2 * error, color=colour, alpha=0.3, lw=0)
    draw_means(ax, 2.6 if len(labels) == 1 else 1.6)
    if name in ("force", "pressure", "stiffness"):
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    if name in ("force", "pressure"):
        h = np.concatenate([curve.abscissa for curve in curves]) / h_scale
        _add_tension_inset(ax, h, np.concatenate([curve.mean for curve in curves]) / scale, draw_means)
    low, high = float(visible.min()) / scale, float(visible.max()) / scale
    if high > low:
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    unit = units.replace(" m-1", "/m").replace("m2", "m²")
    ax.set_ylabel(f"{name.replace('_', ' ')}" + (f" [{prefix}{unit}]" if unit != "1" else ""))
    ax.set_xlabel(f"{_ABSCISSA_NAMES[abscissa]} [{h_prefix}{STEP_COORDINATES[abscissa]}]")


def _curve_style(curve: _Curve, labels: list[str]) -> dict[str, Any]:
    """Return colour, line style and label: by branch for a single cell, else by cell."""
    if len(labels) == 1:
        return {"color": _BRANCH_COLOURS[curve.branch], "label": curve.branch if curve.pass_number < 2 else None}
    stride = -(-len(labels) // _MAX_LABELS)
    labelled = curve.pass_number == 0 and curve.cell % stride == 0
    return {
        "color": _cell_colour(curve.cell, len(labels)),
        "ls": _BRANCH_LINESTYLES[curve.branch],
        "label": labels[curve.cell] if labelled else None,
    }


def _overlay_style(label: str, overlays: list[str], cell: int | None, cells: int) -> dict[str, Any]:
    """Return a thin dark line for the expected law, dark dashes for the reference, and for a theory curve dots in the
    colour of its cell.

    With a single cell each theory curve has its own colour; in the legend of several cells (``cell`` None) it is grey.
    """
    if label == EXPECTED:
        return {"color": "#111111", "lw": 0.7 if cells == 1 else 0.5}
    if label == REFERENCE:
        return {"color": "#111111", "ls": (0, (4.0, 2.0)), "lw": 1.2 if cells == 1 else 0.8}
    number = overlays.index(label)
    dots = {"ls": (0, (1.0, 1.0 + 0.5 * number)), "lw": 1.8}
    if cells == 1:
        return {"color": _THEORY_COLOURS[number % len(_THEORY_COLOURS)], **dots}
    return {"color": "0.4" if cell is None else _cell_colour(cell, cells), **dots}


def _cell_colour(cell: int, cells: int) -> Any:
    from matplotlib import colormaps

    return colormaps["viridis"](0.92 * cell / (cells - 1))


def _add_tension_inset(ax: "Axes", h: Floats, values: Floats, draw_means: "Callable[[Axes, float], None]") -> None:
    """Add an inset of the tension if it is too small beside the compression to be seen."""
    lowest = float(values.min())
    tense = h[values < 0.02 * lowest]
    if not -0.2 * values.max() < lowest < 0.0 or np.ptp(tense) == 0.0:
        return
    inset = ax.inset_axes((0.46, 0.3, 0.5, 0.36))
    draw_means(inset, 1.8)
    inset.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    inset.set(xlim=(tense.min(), tense.max()), ylim=(1.3 * lowest, -1.3 * lowest))
    inset.tick_params(labelsize=7)


def _visible_values(name: str, curves: list[_Curve]) -> Floats:
    """Return the values that the axis must show; of stiffness, unbounded below at a detachment, the mean curve."""
    means = np.concatenate([curve.mean for curve in curves if np.isfinite(curve.mean).all()])
    if name == "stiffness":
        return means.clip(*np.quantile(means, [0.01, 1.0]))
    return np.concatenate([means, *(curve.runs.ravel() for curve in curves)])


def _si_scale(values: Floats, power: int = 1) -> tuple[float, str]:
    """Return factor and SI prefix by which the largest magnitude is from 1 to 1000, for areas (``power`` 2) to 1e6."""
    largest = float(np.max(np.abs(values), initial=0.0))
    if largest == 0.0:
        return 1.0, ""
    exponent = min(max(3 * int(np.floor((np.log10(largest) + power - 1) / (3 * power))), -12), 12)
    return 10.0 ** (exponent * power), _PREFIXES[exponent]
