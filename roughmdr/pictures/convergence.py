"""How a mean over realisations converges: its standard error against their number, beside the other errors."""

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.pictures.style import BRANCH_COLOURS, colours, set_title
from roughmdr.result.layout import cell_label, cells_of, control_of, done_of, method_of
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Labelled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 160  # of a curve
_MAX_LINES = 6  # cells drawn each; more are a band
_NEEDED = 0.01, 0.001  # relative standard errors of which the note says what they take


class Convergence(NamedTuple):
    """A quantity of the realisations of a cell, in their order."""

    name: str
    cell: int
    values: Floats

    def running(self) -> tuple[Ints, Floats]:
        """Return numbers n of realisations, and the standard error of the mean of the first n over that mean."""
        size = self.values.size
        counts = np.unique(np.geomspace(2, size, _POINTS).round().astype(np.int64))
        first = (self.values[:count] for count in counts.tolist())
        errors = [np.std(some, ddof=1) / math.sqrt(some.size) / abs(np.mean(some)) for some in first]
        return counts, np.array(errors)

    @property
    def scatter(self) -> float:
        """Standard deviation of the realisations over the magnitude of their mean."""
        return float(np.std(self.values, ddof=1) / abs(np.mean(self.values)))


def draw_convergence(result: Labelled) -> "Figure":
    """Draw the relative standard error of the mean of the largest force, and of the pull-off force, against the number
    of realisations.

    The largest force is that at the step at which its mean is largest; under a dead load, which is the force, the
    separation at the largest load stands for it. Beside it: the numerical error, the error of the model and the error
    asked for. More than a few cells are a band with their median. StoreError where the result holds no realisations, or
    too few.
    """
    from matplotlib.figure import Figure

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
    figure = Figure(figsize=(max(5.0 * len(names), 7.0), 5.4), layout="constrained")
    axes = figure.subplots(1, len(names), sharey=True, squeeze=False).ravel()
    notes = []
    for ax, name in zip(axes, names, strict=True):
        of_name = [each for each in found if each.name == name]
        _draw_panel(ax, result, of_name)
        notes.append(f"{name}: {_needed_in_words([each.scatter for each in of_name])}")
    axes[0].set_ylabel("standard error of the mean over the mean")
    set_title(figure, result.attrs["title"], notes)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    return figure


def _quantities(result: Labelled) -> Iterable[Convergence]:
    """Yield the quantities of each cell of which at least two realisations were computed, unless all are alike."""
    done, cells = done_of(result), cells_of(result)
    dead_load = control_of(result) in ("force", "pressure")
    for name, label in (
        ("separation" if dead_load else "force", "separation at the largest load" if dead_load else "largest force"),
        ("pull_off_force", "pull-off force"),
    ):
        for number, cell in enumerate(cells):
            if name not in result.variables or method_of(result, cell) == "expected":
                continue
            values = result.variables[name].values[cell][done[cell]]
            if values.ndim == 2:
                means = np.abs(values.mean(axis=0)) if not dead_load else -values.mean(axis=0)
                values = values[:, int(np.nanargmax(means))] if np.isfinite(means).any() else values[:, 0]
            values = values[np.isfinite(values)]
            if values.size > 1 and np.ptp(values) > 0.0 and np.mean(values) != 0.0:
                yield Convergence(label, number, values)


def _draw_panel(ax: "Axes", result: Labelled, found: list[Convergence]) -> None:
    """Draw one quantity of all cells, the line 1/sqrt(n), and the levels of the other errors."""
    curves = [each.running() for each in found]
    largest = max(int(counts[-1]) for counts, _ in curves)
    if len(found) <= _MAX_LINES:
        palette = [BRANCH_COLOURS["loading"]] if len(found) == 1 else colours(len(found))
        for each, (counts, errors), colour in zip(found, curves, palette, strict=True):
            label = cell_label(result, cells_of(result)[each.cell]).replace("$", r"\$") or "realisations"
            ax.plot(counts, errors, color=colour, lw=1.8, marker="o" if counts.size < 30 else "", ms=3, label=label)
    else:
        grid = np.unique(np.geomspace(2, min(int(counts[-1]) for counts, _ in curves), _POINTS).round())
        errors = np.array([np.interp(np.log(grid), np.log(counts), each) for counts, each in curves])
        colour = BRANCH_COLOURS["loading"]
        ax.fill_between(
            grid, errors.min(axis=0), errors.max(axis=0), color=colour, alpha=0.25, lw=0.0, label=f"{len(found)} cells"
        )
        ax.plot(grid, np.median(errors, axis=0), color=colour, lw=1.8, label="their median")
    middle = float(np.median([each.scatter for each in found]))
    n = np.array([2.0, 2.0 * largest])
    ax.plot(n, middle / np.sqrt(n), color="0.3", lw=1.0, ls="--", label="scatter of all realisations / √n")
    for level, style, label in _levels(result):
        ax.axhline(level, lw=1.2, zorder=1, label=f"{label}, {level:.2g}", **style)
    ax.set(xscale="log", yscale="log", xlabel="realisations n", title=found[0].name, xlim=(2.0, float(n[1])))
    ax.grid(color="0.93", zorder=0)


def _levels(result: Labelled) -> "Iterable[tuple[float, dict[str, Any], str]]":
    """Yield the other errors of the force that are known and above 0, largest of all cells, with how they are drawn."""
    for name, style, label in (
        ("numerical_error", {"color": "#56b4e9", "ls": "-."}, "numerical error"),
        ("model_error", {"color": "#cc79a7", "ls": "-"}, "error of the model, at most"),
    ):
        values = result.variables[name].values if name in result.variables else np.empty(0)
        values = values[np.isfinite(values)]
        if values.max(initial=0.0) > 0.0:
            yield float(values.max()), style, label
    asked = parse_toml(result.attrs["scene"]).get("accuracy", {}).get("relative")
    if asked is not None:
        yield float(asked), {"color": "#009e73", "ls": (0, (1.0, 1.0))}, "accuracy.relative, as asked"


def _needed_in_words(scatters: list[float]) -> str:
    """Return how many realisations the errors of ``_NEEDED`` take, least and most of all cells."""
    parts = []
    for error in _NEEDED:
        low, high = (math.ceil((scatter / error) ** 2) for scatter in (min(scatters), max(scatters)))
        parts.append(f"{error:.1%} takes about {low}" + (f" to {high}" if high > low else ""))
    return ", ".join(parts).replace(".0%", " %").replace("%", " %").replace("  ", " ") + " realisations"
