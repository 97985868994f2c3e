"""A small picture of a result or a fit for a notebook: SVG in the colour of the text, drawn without matplotlib."""

import html
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.style import Scale
from roughmdr.result.curves import is_result
from roughmdr.result.view import ResultView
from roughmdr.storage.result_file import FIT

if TYPE_CHECKING:
    import xarray as xr

_WIDTH, _HEIGHT = 340.0, 190.0  # size [px]
_LEFT, _RIGHT, _TOP, _BOTTOM = 55.0, 12.0, 22.0, 36.0  # margins [px], for the ends and names of the axes
_CELLS = 5  # most cells of a sweep that are drawn: more lines are hard to tell apart
_POINTS = 600  # most points of all lines together: some 10 kB
_NUMBERS = 10_000_000  # most numbers that are read: 80 MB, which take a tenth of a second
_FAINTEST = 0.3  # opacity of the last of several cells


class _Line(NamedTuple):
    x: Floats
    y: Floats
    branch: NDArray[np.str_]
    opacity: float = 1.0
    points: bool = False  # whether circles are drawn in place of a line


def sketch(dataset: "xr.Dataset") -> str:
    """Return a picture of a law, or of measured points and the fitted law; empty where there is nothing to draw.

    Of a sweep a few cells are drawn, and only their curves are read; none where even one has too many numbers.
    """
    if is_result(dataset):
        return _sketch_law(ResultView(dataset))
    load = "pressure" if "pressure_fitted" in dataset else "force"
    control = "remote" if "remote" in dataset.coords else "separation"
    if dataset.attrs.get("kind") != FIT or not {control, "branch", load, f"{load}_fitted"} <= set(dataset.variables):
        return ""
    if dataset[load].ndim != 1:
        return ""
    x, branch = dataset[control].to_numpy(), dataset["branch"].to_numpy()
    measured, fitted = (dataset[name].to_numpy() for name in (load, f"{load}_fitted"))
    lines = [_Line(x, measured, branch, 0.6, points=True), _Line(x, fitted, branch)]
    return _svg(lines, Scale.of(x, control, "m"), Scale.of(measured, load, dataset[load].attrs.get("units", "1")))


def _sketch_law(result: ResultView) -> str:
    names, cells = result.asked(()), result.cells
    name = next((each for each in ("force", "pressure") if each in names), names[0])
    of_cell = result.sizes["step"] * result.sizes.get("realization", 1)
    drawn = min(len(cells), _CELLS, _NUMBERS // max(of_cell, 1))
    chosen = np.unique(np.linspace(0, len(cells) - 1, drawn).astype(int))
    (xs, x), (ys, y) = (_means(result, each, [cells[number] for number in chosen]) for each in (result.abscissa, name))
    fading = np.linspace(1.0, _FAINTEST, chosen.size).tolist()
    lines = [_Line(*each[:2], result.branches, each[2]) for each in zip(xs, ys, fading, strict=True)]
    note = f", {chosen.size} of {len(cells)} cells, the first darkest" if len(cells) > 1 else ""
    return _svg(lines, x, y, note)


def _means(result: ResultView, name: str, cells: Sequence[tuple[int, ...]]) -> tuple[list[Floats], Scale]:
    """Return the means of a variable over the realisations of cells that were computed, and their scale."""
    dataset = result.dataset
    array = dataset[name if name in dataset else f"{name}_mean"].transpose(..., "step")
    means = list[Floats]()
    for cell in cells:
        at = {dim: index for dim, index in zip(result.sweep, cell, strict=True) if dim in array.dims}
        runs = array.isel(at).to_numpy().reshape(-1, array.sizes["step"])
        runs = runs[np.isfinite(runs).any(axis=-1)]
        means.append(runs.mean(axis=0) if len(runs) else np.full(array.sizes["step"], np.nan))
    return means, Scale.of(np.array(means), name, array.attrs.get("units", "1"))


def _svg(lines: Sequence[_Line], x: Scale, y: Scale, note: str = "") -> str:
    """Draw lines between the ends of two axes, with a note beside the name of y; empty where no number is finite."""
    ranges = []
    for scale, arrays in ((x, [line.x for line in lines]), (y, [line.y for line in lines])):
        values = scale(np.concatenate(arrays)) if arrays else np.zeros(0)
        if not np.isfinite(values).any():
            return ""
        ranges.append((np.nanmin(values), np.nanmax(values)))
    (left, right), (low, high) = ranges
    bottom, end = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT

    def at_x(values: Floats) -> Floats:
        return _LEFT + (values - left) / ((right - left) or 1.0) * (end - _LEFT)

    def at_y(values: Floats) -> Floats:
        return bottom - (values - low) / ((high - low) or 1.0) * (bottom - _TOP)

    zero = float(at_y(np.zeros(()))) if low <= 0.0 <= high else bottom
    drawn = [f'<path d="M{_LEFT} {zero:.1f}H{end}M{_LEFT} {_TOP}V{bottom}" stroke-width="0.5"/>']
    for line in lines:
        some = np.unique(np.linspace(0, line.x.size - 1, _POINTS // len(lines)).astype(int))
        places = np.column_stack([at_x(x(line.x[some])), at_y(y(line.y[some]))])
        drawn += _drawn(line, places, line.branch[some])
    texts = [
        (_LEFT, _TOP - 8.0, "start", y.label + note),
        ((_LEFT + end) / 2.0, _HEIGHT - 6.0, "middle", x.label),
        (_LEFT, bottom + 14.0, "middle", f"{left:.3g}"),
        (end, bottom + 14.0, "end", f"{right:.3g}"),
        (_LEFT - 4.0, bottom + 4.0, "end", f"{low:.3g}"),
        (_LEFT - 4.0, _TOP + 4.0, "end", f"{high:.3g}"),
    ]
    written = "".join(
        f'<text x="{place}" y="{height}" text-anchor="{anchor}">{html.escape(text)}</text>'
        for place, height, anchor, text in texts
    )
    return (
        f'<svg role="img" aria-label="{html.escape(f"{y.name} over {x.name}")}" width="{_WIDTH:.0f}" '
        f'height="{_HEIGHT:.0f}" fill="none" stroke="currentColor" stroke-linecap="round">{"".join(drawn)}'
        f'<g fill="currentColor" stroke="none" font-size="11" font-family="sans-serif">{written}</g></svg>'
    )


def _drawn(line: _Line, places: Floats, branch: NDArray[np.str_]) -> Iterator[str]:
    """Yield the elements of a line, one for each branch, or of its points."""
    if line.points:
        known = places[np.isfinite(places).all(axis=-1)]
        yield f'<g opacity="{line.opacity:.2f}">'
        yield from (f'<circle cx="{left:.1f}" cy="{top:.1f}" r="2"/>' for left, top in known)
        yield "</g>"
        return
    for each, dashes in (("loading", ""), ("unloading", ' stroke-dasharray="4 3"')):
        path, pen = "", -1  # number of the point that the pen is at
        for number in np.flatnonzero((branch == each) & np.isfinite(places).all(axis=-1)).tolist():
            before = max(number - 1, 0)  # a branch begins where the one before ended
            if pen != before and np.isfinite(places[before]).all():
                path += "M{:.1f} {:.1f}".format(*places[before])
                pen = before
            path += "{}{:.1f} {:.1f}".format("L" if pen == before else "M", *places[number])
            pen = number
        if path:
            yield f'<path d="{path}" opacity="{line.opacity:.2f}" stroke-width="1.5"{dashes}/>'
