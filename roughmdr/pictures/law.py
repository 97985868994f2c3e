"""The law of a result: its variables over the separation, or over each other, loading and unloading."""

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.curves import Curve, Quantity, curves_of, drawn_against
from roughmdr.pictures.panel import MAX_NAMED, MAX_RUNS, Mark, Panel, draw_panel
from roughmdr.pictures.request import Request
from roughmdr.pictures.style import BRANCH_COLOURS, BRANCH_LINESTYLES, Scale, colours, new_figure, set_title
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import escape_controls
from roughmdr.storage.labelled import Array
from roughmdr.variables import WITH_MODEL_ERROR

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXPECTED = "expected"
INDEPENDENT = "expected, independent"
"""Label of the expected law of asperities that do not feel each other, beside a result of those that do."""
REFERENCE = "boundary elements"
_ABSENT = "the result holds no reference; run its scene with --set reference.model=boundary_elements"
_THEORY_COLOURS = ("#009e73", "#e69f00", "#cc79a7", "#56b4e9", "#8c564b")
_HANDLE, _LETTER = 0.6, 0.066  # widths in a legend [inches]
_PULL_OFF = {"force": "pull_off_force", "pressure": "pull_off_pressure"}


class OverlayLine(NamedTuple):
    """A curve drawn over a result: a variable in one cell, over the whole path."""

    label: str  # name of the theory curve; ``EXPECTED`` or ``INDEPENDENT`` for the expected law, or ``REFERENCE``
    variable: str
    cell: int
    x: Floats  # separation [m], or the variable drawn over
    values: Floats  # NaN where the theory gives none


class Overlay(NamedTuple):
    """Lines to draw, and remarks on those that are drawn or, with the reason, are not."""

    lines: list[OverlayLine]
    remarks: list[str]

    def over(self, name: str) -> "Overlay":
        """Return the lines over another of their variables, without those that lack it."""
        x = {(line.label, line.cell): line.values for line in self.lines if line.variable == name}
        found = [line for line in self.lines if line.variable != name and (line.label, line.cell) in x]
        remarks = self.remarks if found or not self.lines else [f"not drawn: nothing of it is over {name}"]
        return Overlay([line._replace(x=x[line.label, line.cell]) for line in found], remarks)


def overlay_reference(result: ResultView, names: list[str]) -> Overlay:
    """Return the mean law by boundary elements of each cell, in those of the variables that the result has of it."""
    given = [name for name in names if result.holds(f"reference_{name}")]
    if not given:
        return Overlay([], [f"not drawn: {_ABSENT}"])
    separation = result.path
    lines = [
        OverlayLine(REFERENCE, name, number, separation[cell], result.mean(f"reference_{name}")[0][cell])
        for name in given
        for number, cell in enumerate(result.cells)
    ]
    return Overlay(lines, ["drawn"])


def draw_law(
    result: ResultView, names: list[str], lines: Sequence[OverlayLine], request: Request, note: str
) -> "Figure":
    """Draw variables of a result against the separation, or whatever else its path controls, or another variable.

    Where the path leads to a preload, the separation or the far end of the spring stands in place of the travel.
    The mean is a thick line, twice its standard error a band, and of a force the error of the model a grey one, where
    the result has its curve. Of a single cell realisations are thin lines, and where they are many, nine tenths of them
    a band. The stiffness where contacts detach is a median with a band of two thirds. Unloading is dashed. The cells of
    a sweep have a colour each. The expected law is thin and dark, theory curves are dotted. A point is the mean
    pull-off; separations at which the law is not to be trusted are grey. The title says how far it can be trusted,
    after a ``note`` on the part of a sweep that is drawn. StoreError if no run was computed, or a variable is missing.
    """
    if not result.done.any():
        raise StoreError("there is nothing to draw: no run was computed")
    against = drawn_against(result, request.x)
    names = [name for name in names if name != against] or names
    cells = result.cells
    columns = min(2, len(names))
    rows = -(-len(names) // columns)
    figure = new_figure(5.4 * columns, 3.7 * rows + 1.3)
    axes = figure.subplots(rows, columns, squeeze=False)
    overlays = list(dict.fromkeys(line.label for line in lines))
    palette = list(BRANCH_COLOURS.values()) if len(cells) == 1 else colours(len(cells))
    x = Quantity.of(result, against, per_area=request.per_area)

    def style_of(line: OverlayLine) -> dict[str, Any]:
        return _overlay_style(line.label, overlays, None if len(cells) == 1 else palette[line.cell])

    marked, trusted = False, _trusted(result, against)
    shaded = bool(np.isfinite(trusted))
    for ax, name in zip(axes.flat, names, strict=False):
        quantity = Quantity.of(result, name, per_area=request.per_area)
        curves = list(curves_of(result, quantity, x))
        over = [
            (x.in_cell(line.x, cells[line.cell]), quantity.in_cell(line.values, cells[line.cell]), style_of(line))
            for line in lines
            if line.variable == name
        ]
        marks = [] if request.log else _pull_offs(result, quantity, against, palette)
        marked = marked or bool(marks)
        styles = [_style(curve, palette, len(cells)) for curve in curves]
        draw_panel(ax, Panel(quantity, x, curves, styles, over, marks, trusted, request.log, len(cells)))
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    _add_legend(figure, result, _entries(result, names, marked=marked, shaded=shaded), overlays, palette)
    told = _realizations(result) + (", unloading dashed" if len(cells) > 1 else "")
    notes = [note, told, f"model: {dict(trust_of_result(result))['trust']}"]
    set_title(figure, result.attrs["title"], [each for each in notes if each])
    return figure


def _realizations(result: ResultView) -> str:
    """Describe the number of realisations in a picture, and how they are shown."""
    if result.estimator == "expected":
        return "expected law"
    most = fewest = result.realizations
    if "realization_count" in result.variables:
        fewest = int(result.variables["realization_count"].values.min())
    if most == 1:
        return "one realisation"
    return f"{most if most == fewest else f'{fewest} to {most}'} realisations, mean ± 2 standard errors"


def _style(curve: Curve, palette: Sequence[str], cells: int) -> dict[str, Any]:
    """Return colour and line style: by branch for a single cell, else by cell."""
    dashed = {"ls": BRANCH_LINESTYLES[curve.branch]}
    if cells == 1:
        return {"color": BRANCH_COLOURS[curve.branch], "lw": 2.8, "zorder": 3, **dashed}
    return {"color": palette[curve.cell], "lw": 1.6 if cells <= MAX_NAMED else 0.8, "zorder": 3, **dashed}


def _overlay_style(label: str, overlays: list[str], colour: str | None) -> dict[str, Any]:
    """Return a thin dark line for the expected law, dark dashes for the reference, and for a theory curve dots.

    With a single cell, ``colour`` None, each theory curve has a colour of its own.
    """
    from matplotlib import rcParams
    from matplotlib.patheffects import Normal, withStroke

    behind, dark = rcParams["axes.facecolor"], rcParams["text.color"]
    around = {"path_effects": [withStroke(linewidth=1.8, foreground=behind, alpha=0.5), Normal()], "zorder": 4}
    if label in (EXPECTED, INDEPENDENT):
        return {"color": dark, "lw": 0.9, **around}
    if label == REFERENCE:
        return {"color": dark, "ls": (0, (4.0, 2.0)), "lw": 1.2, **around}
    number = overlays.index(label)
    shown = _THEORY_COLOURS[number % len(_THEORY_COLOURS)] if colour is None else colour
    return {"color": shown, "ls": (0, (1.0, 1.0 + 0.5 * number)), "lw": 2.0, **around}


def _entries(result: ResultView, names: Sequence[str], *, marked: bool, shaded: bool) -> list[Any]:
    """Return the entries of the legend of a single cell: its branches, bands and marks."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    branches, blue = dict.fromkeys(map(str, result.branches)), BRANCH_COLOURS["loading"]
    entries: list[Any] = [
        Line2D([], [], color=BRANCH_COLOURS[each], ls=BRANCH_LINESTYLES[each], lw=2.2, label=each) for each in branches
    ]
    if result.realizations > 1:
        entries.append(Patch(color=blue, alpha=0.3, lw=0, label="± 2 standard errors"))
    if result.sizes.get("realization", 0) > MAX_RUNS:
        entries.append(Patch(color=blue, alpha=0.12, lw=0, label="9 of 10 realisations"))
    if "stiffness" in names and "unloading" in branches and result.adheres:
        entries.append(Patch(color=BRANCH_COLOURS["unloading"], alpha=0.3, lw=0, label="stiffness: median, 2 of 3"))
    if result.holds("model_error_curve") and not {*names}.isdisjoint(WITH_MODEL_ERROR):
        entries.append(Patch(color="0.5", alpha=0.4, lw=0, label="error of the model"))
    if shaded:
        entries.append(Patch(color="0.5", alpha=0.2, lw=0, label="beyond the range of trust"))
    if marked:
        style: dict[str, Any] = {"ls": "none", "marker": "o", "ms": 4.5, "mfc": "white"}
        entries.append(Line2D([], [], label="pull-off", color=BRANCH_COLOURS["unloading"], **style))
    return entries


def _add_legend(
    figure: "Figure", result: ResultView, entries: list[Any], overlays: list[str], palette: Sequence[str]
) -> None:
    """Add a legend below the panels, and a colour bar of the swept values where cells are too many to name.

    ``entries`` are those of a single cell.
    """
    from matplotlib.lines import Line2D

    cells, handles = result.cells, list[Any]()
    if len(cells) == 1:
        handles += entries
    elif len(cells) <= MAX_NAMED:
        labels = [escape_controls(result.label(cell)).replace("$", r"\$") for cell in cells]  # no mathematics
        handles += [
            Line2D([], [], color=colour, lw=1.8, label=label) for colour, label in zip(palette, labels, strict=True)
        ]
    else:
        _add_colour_bar(figure, result, palette)
    grey = None if len(cells) == 1 else "0.4"
    handles += [Line2D([], [], label=label, **_overlay_style(label, overlays, grey)) for label in overlays]
    if handles:
        width = float(figure.get_figwidth())
        longest = max(len(str(each.get_label())) for each in handles)
        columns = max(1, int(width / (_HANDLE + _LETTER * longest)))
        for each in handles:
            letters = int((width - _HANDLE) / _LETTER)
            each.set_label(textwrap.fill(str(each.get_label()), letters))
        figure.legend(handles=handles, loc="outside lower center", frameon=False, fontsize=8, ncols=columns)


def _add_colour_bar(figure: "Figure", result: ResultView, palette: Sequence[str]) -> None:
    """Add a colour bar of the swept values: of the key along which alone they vary, else of the numbers of cells."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    coordinate = _only_coordinate(result)
    mapped = ScalarMappable(Normalize(-0.5, len(palette) - 0.5), ListedColormap(list(palette)))
    bar = figure.colorbar(mapped, ax=figure.axes, shrink=0.8, aspect=40, pad=0.02)
    shown = np.unique(np.linspace(0, len(palette) - 1, 6).astype(int))
    if coordinate is None:
        label, labels = f"cells of {', '.join(result.sweep)}, the last key fastest", list(map(str, shown))
    elif (values := coordinate[1].values).dtype.kind in "if":
        scale = Scale.of(values, coordinate[0], str(coordinate[1].attrs.get("units", "1")))
        label, labels = scale.label, [f"{scale(value):.3g}" for value in values[shown]]
    else:
        label, labels = coordinate[0].replace("_", " "), list(map(str, values[shown]))
    bar.set_ticks(list(map(float, shown)), labels=labels)
    bar.set_label(label)


def _only_coordinate(result: ResultView) -> tuple[str, Array] | None:
    """Return the swept key along which alone cells vary; None where there are several."""
    names = [name for name, size in result.sweep.items() if size > 1]
    if len(names) != 1:
        return None
    return next(((name, array) for name, array in result.coordinates.items() if array.dims == (names[0],)), None)


def _pull_offs(result: ResultView, quantity: Quantity, against: str, palette: Sequence[str]) -> list[Mark]:
    """Return the mean pull-off of each cell, where the picture has its separation and the legend names the cells."""
    name, cells = _PULL_OFF.get(quantity.variable, ""), result.cells
    if against != "separation" or not result.holds(name) or len(cells) > MAX_NAMED:
        return []
    (force, force_error), (place, place_error) = (result.mean(each) for each in (name, "pull_off_separation"))
    force, force_error = quantity.scaled(force), quantity.scaled(force_error)
    shown = list(palette) if len(cells) > 1 else [BRANCH_COLOURS["unloading"]]
    return [
        Mark(float(place[cell]), float(force[cell]), float(place_error[cell]), float(force_error[cell]), colour)
        for cell, colour in zip(cells, shown, strict=True)
        if force[cell] < 0.0
    ]


def _trusted(result: ResultView, against: str) -> float:
    """Return the separation below which a law of one cell is not to be trusted; NaN where there is none."""
    known = result.known("trusted_separation")
    return float(known.max()) if against == "separation" and known.size and len(result.cells) == 1 else float("nan")
