"""Convergence of a mean over realisations: its standard error against their number, with the other errors."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.pictures.curves import quantiles
from roughmdr.pictures.style import BRANCH_COLOURS, colours, new_figure, set_title
from roughmdr.result.view import ResultView
from roughmdr.variables import TRAVEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 160  # points of a curve
_MAX_LINES = 6  # most cells that are drawn as lines; more are a band
_FEW = 40  # number of points of a curve below which each is marked
_WIDE = 1000  # realisations from which on only powers of ten fit under an axis
_DEEPEST = 0.03  # lowest level drawn, over the least error: a lower one is only named
_NEEDED = 0.01, 0.001  # relative standard errors for which the note gives the number of realisations


class Convergence(NamedTuple):
    """A quantity of the realisations of a cell, in their order."""

    name: str
    cell: int
    values: Floats
    span: float = 0.0
    """Size that errors are relative to; 0 for the mean."""

    def running(self) -> tuple[Ints, Floats]:
        """Return numbers n of realisations, and the relative standard error of the mean of the first n."""
        counts = np.unique(np.geomspace(2, self.values.size, _POINTS).round().astype(np.int64))
        errors = [_scatter(self.values[:count], self.span) / math.sqrt(count) for count in counts.tolist()]
        return counts, np.array(errors)

    @property
    def scatter(self) -> float:
        """Relative standard deviation of the realisations."""
        return _scatter(self.values, self.span)


def _scatter(values: Floats, span: float) -> float:
    """Return the standard deviation over the magnitude of the mean, or over a span; NaN where all values are 0."""
    magnitude = span or abs(float(np.mean(values)))
    return float(np.std(values, ddof=1)) / magnitude if magnitude else math.nan


def draw_convergence(result: ResultView) -> "Figure":
    """Draw the relative standard error of the mean of the largest force, and of the pull-off force, against the number
    of realisations.

    The largest force is that at the step at which its mean is largest; where that is prescribed, by a dead load or a
    preload, the separation there stands for it, over the range of its mean. Beside it: the numerical error, the error
    of the model and the error asked for. More than a few cells are a band with their median. StoreError where the
    result holds no realisations, or too few.
    """
    if "realization" not in result.sizes:
        raise StoreError(
            "the result holds statistics, not its realisations; run its scene with output.keep = 'curves' to see how "
            "they converge"
        )
    found = list(_quantities(result))
    if not found:
        raise StoreError(
            "there is nothing to draw: no cell has two realisations that differ; run its scene with a larger "
            "batch.realizations, and batch.estimator = 'sampled'"
        )
    names = list(dict.fromkeys(each.name for each in found))
    figure = new_figure(max(5.0 * len(names), 7.0), 5.4)
    axes = figure.subplots(1, len(names), sharey=True, squeeze=False).ravel()
    notes, named, lowest = [], dict[str, Any](), math.inf
    for ax, name in zip(axes, names, strict=True):
        of_name = [each for each in found if each.name == name]
        lowest = min(lowest, _draw_panel(ax, result, of_name))
        notes.append(f"{name}: {_needed_in_words(of_name)}")
    levels = list(_levels(result))
    for ax in axes:
        for level, style, label in levels:
            below = ", below" if level < _DEEPEST * lowest else ""
            ax.axhline(level, lw=1.2, zorder=1, label=f"{label}: {level:.2g}{below}", **style)
        named = dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True)) | named
    seen = [lowest, *(level for level, _, _ in levels if level >= _DEEPEST * lowest)]
    axes[0].set_ylim(bottom=0.5 * min(seen))
    axes[0].set_ylabel("relative standard error of the mean")
    set_title(figure, result.attrs["title"], notes)
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    return figure


def _quantities(result: ResultView) -> Iterator[Convergence]:
    """Yield the quantities of each cell of which at least two realisations were computed, unless all are alike."""
    prescribed = result.control in ("force", "pressure", TRAVEL.name)
    curve, label = (
        ("separation", "separation at the largest load, over its range") if prescribed else ("force", "largest force")
    )
    done = result.done
    for name, title in ((curve, label), ("pull_off_force", "pull-off force")):
        for number, cell in enumerate(result.cells):
            if name not in result.variables or result.method(cell) == "expected" or not done[cell].any():
                continue
            values, span = result.variables[name].values[cell], 0.0
            if name == curve:
                means = result.mean(name)[0][cell]
                if np.isnan(means).all():
                    continue
                span = float(np.nanmax(means) - np.nanmin(means)) if prescribed else 0.0
                values = values[:, int(np.nanargmax(-means if prescribed else np.abs(means)))]
            values = values[done[cell]]
            values = values[np.isfinite(values)]
            if values.size > 1 and np.ptp(values) > 0.0:
                yield Convergence(title, number, values, span)


def _draw_panel(ax: "Axes", result: ResultView, found: list[Convergence]) -> float:
    """Draw one quantity of all cells, and the line 1/sqrt(n); return the least error above 0."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    curves, cells = [each.running() for each in found], result.cells
    largest = max(int(counts[-1]) for counts, _ in curves)
    first = BRANCH_COLOURS["loading"]
    if len(found) <= _MAX_LINES:
        palette = [first] if len(cells) == 1 else colours(len(cells))
        for each, (counts, errors) in zip(found, curves, strict=True):
            label = result.label(cells[each.cell]).replace("$", r"\$") or "realisations in their order"
            marker = "o" if counts.size < _FEW else ""
            ax.plot(counts, errors, color=palette[each.cell], lw=1.8, marker=marker, ms=3, label=label)
    else:
        grid = np.unique(np.geomspace(2, min(int(counts[-1]) for counts, _ in curves), _POINTS).round())
        errors = np.array([np.interp(np.log(grid), np.log(counts), each) for counts, each in curves])
        low, middle_error, high = quantiles(errors, [0.0, 0.5, 1.0], axis=0)
        ax.fill_between(grid, low, high, color=first, alpha=0.25, lw=0.0, label="all cells")
        ax.plot(grid, middle_error, color=first, lw=1.8, label="median of the cells")
    middle = float(np.median([each.scatter for each in found]))
    n = np.array([2.0, max(2.0 * largest, 10.0)])
    ax.plot(n, middle / np.sqrt(n), color="0.5", lw=1.0, ls="--", label="as 1/√n, from the scatter of all")
    ax.set(xscale="log", yscale="log", xlabel="realisations n", title=found[0].name, xlim=(1.8, float(n[1])))
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if n[1] < _WIDE else (1.0,)))
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(color="0.5", alpha=0.15, zorder=0)
    return min(float(errors[errors > 0.0].min(initial=math.inf)) for _, errors in curves)


def _levels(result: ResultView) -> Iterator[tuple[float, dict[str, Any], str]]:
    """Yield the other errors of the force that are known and above 0, largest of all cells, with their line styles."""
    kinds: tuple[tuple[str, dict[str, Any], str], ...] = (
        ("numerical_error", {"color": "#56b4e9", "ls": "-."}, "numerical error of the force"),
        ("model_error", {"color": "#cc79a7", "ls": "-"}, "error of the force by the model, at most"),
    )
    for name, style, label in kinds:
        if (largest := result.largest(name)) > 0.0:
            yield largest, style, label
    asked = result.scene.get("accuracy", {}).get("relative")
    if asked is not None:
        yield float(asked), {"color": "#009e73", "ls": (0, (1.0, 1.0))}, "accuracy.relative, as asked"


def _needed_in_words(found: list[Convergence]) -> str:
    """Return in words the realisations that the errors of ``_NEEDED`` take, least and most over the cells."""
    scatters = [each.scatter for each in found]
    parts = []
    for error in _NEEDED:
        low, high = (_rounded((scatter / error) ** 2) for scatter in (min(scatters), max(scatters)))
        parts.append(f"{100.0 * error:g} % takes about {low}" + (f" to {high}" if high != low else ""))
    return ", ".join(parts) + f" realisations, by {min(each.values.size for each in found)}"


def _rounded(count: float) -> str:
    """Return a number of realisations with two digits."""
    return f"{max(float(f'{count:.1e}'), 2.0):.0f}"
