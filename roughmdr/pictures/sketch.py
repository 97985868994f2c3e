"""A small picture of a result or a fit for a notebook: SVG in the colour of the text, drawn without matplotlib."""

import html
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.style import Scale
from roughmdr.result.curves import is_result
from roughmdr.result.view import ResultView
from roughmdr.storage.result_file import FIT

if TYPE_CHECKING:
    import xarray as xr

_LEFT, _RIGHT, _TOP, _BOTTOM = 55.0, 328.0, 22.0, 154.0  # ends of the axes in a picture of 340 x 190 [px]
_CELLS = 5  # most cells of a sweep that are drawn: more lines are hard to tell apart
_POINTS = 600  # most points of all lines together: some 10 kB
_NUMBERS = 10_000_000  # most numbers that are read: 80 MB, which take a tenth of a second
_FAINTEST = 0.3  # opacity of the last of several lines


def sketch(dataset: "xr.Dataset") -> str:
    """Return a picture of a law, or of measured points and the fitted law; empty where there is nothing to draw.

    Of a sweep a few cells are drawn, and only their curves are read; none where even one has too many numbers.
    """
    if is_result(dataset):
        return _sketch_law(ResultView(dataset))
    load = "pressure" if "pressure_fitted" in dataset else "force"
    control = "remote" if "remote" in dataset.coords else "separation"
    needed = [control, "branch", f"{load}_fitted", load]
    if dataset.attrs.get("kind") != FIT or not {*needed} <= {*dataset.variables} or dataset[load].ndim != 1:
        return ""
    x, branch, fitted, measured = (dataset[name].to_numpy() for name in needed)
    scales = Scale.of(x, control, "m"), Scale.of(measured, load, dataset[load].attrs.get("units", "1"))
    return _svg(np.array([[x, fitted], [x, measured]]), branch, scales, ", measured as dots", dots=True)


def _sketch_law(result: ResultView) -> str:
    names, cells = result.asked(()), result.cells
    if not names:
        return ""
    name = next((each for each in ("force", "pressure") if each in names), names[0])
    of_cell = result.sizes["step"] * result.sizes.get("realization", 1)
    drawn = min(len(cells), _CELLS, _NUMBERS // max(of_cell, 1))
    chosen = np.unique(np.linspace(0, len(cells) - 1, drawn).astype(int))
    (xs, x), (ys, y) = (_means(result, each, [cells[number] for number in chosen]) for each in (result.abscissa, name))
    note = f", {chosen.size} of {len(cells)} cells, the first darkest" if len(cells) > 1 else ""
    return _svg(np.array([xs, ys]).swapaxes(0, 1), result.branches, (x, y), note, dots=False)


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


def _svg(values: Floats, branch: NDArray[np.str_], scales: tuple[Scale, Scale], note: str, *, dots: bool) -> str:
    """Draw lines [line, axis, step] in SI, each fainter, the last perhaps as dots; empty where no number is finite."""
    x, y = scales
    values = np.stack([x(values[:, 0]), y(values[:, 1])], axis=1)
    if not np.isfinite(values).any(axis=-1).any(axis=0).all():
        return ""
    ends = low, high = np.nanmin(values, axis=(0, 2)), np.nanmax(values, axis=(0, 2))
    span, size = np.where(high > low, high - low, 1.0), np.array([_RIGHT - _LEFT, _TOP - _BOTTOM])
    places = np.array([_LEFT, _BOTTOM])[:, None] + ((values - low[:, None]) * (size / span)[:, None])
    zero = _BOTTOM + size[1] * min(max(-low[1] / span[1], 0.0), 1.0)
    some = np.unique(np.linspace(0, values.shape[-1] - 1, _POINTS // len(values)).astype(int))
    drawn = [f'<path d="M{_LEFT} {zero:.1f}H{_RIGHT}M{_LEFT} {_TOP}V{_BOTTOM}" stroke-width="0.5"/>']
    for number, (of_line, opacity) in enumerate(zip(places, np.linspace(1.0, _FAINTEST, len(values)), strict=True)):
        paths = _drawn(of_line[:, some].T, branch[some], dots=dots and number == len(values) - 1)
        drawn += [f'<path d="{path}" opacity="{opacity:.2f}" {style}/>' for path, style in paths]
    (left, bottom), (right, top) = ((f"{each:.3g}" for each in end) for end in ends)
    texts = [
        (_LEFT, _TOP - 8.0, "start", y.label + note),
        ((_LEFT + _RIGHT) / 2.0, _BOTTOM + 30.0, "middle", x.label),
        (_LEFT, _BOTTOM + 14.0, "middle", left),
        (_RIGHT, _BOTTOM + 14.0, "end", right),
        (_LEFT - 4.0, _BOTTOM + 4.0, "end", bottom),
        (_LEFT - 4.0, _TOP + 4.0, "end", top),
    ]
    written = "".join(f'<text x="{a}" y="{b}" text-anchor="{c}">{html.escape(text)}</text>' for a, b, c, text in texts)
    return (
        f'<svg role="img" aria-label="{html.escape(f"{y.name} over {x.name}")}" width="340" height="190" fill="none" '
        f'stroke="currentColor" stroke-linecap="round">{"".join(drawn)}'
        f'<g fill="currentColor" stroke="none" font-size="11" font-family="sans-serif">{written}</g></svg>'
    )


def _drawn(places: Floats, branch: NDArray[np.str_], *, dots: bool) -> Iterator[tuple[str, str]]:
    """Yield the paths of a line and their styles: of each branch, from where the one before ended, or all dots."""
    known = np.isfinite(places).all(axis=-1)
    at = np.array([f"{left:.1f} {top:.1f}" for left, top in places])
    if dots:
        yield "".join(f"M{each}h0" for each in at[known]), 'stroke-width="4"'
        return
    for each, dashes in (("loading", ""), ("unloading", ' stroke-dasharray="4 3"')):
        here = branch == each
        shown = np.flatnonzero(known & (here | np.append(here[1:], False)))
        for part in np.split(shown, np.flatnonzero(np.diff(shown) > 1) + 1):
            if part.size:  # without h0 a single step would not be seen
                yield f"M{'L'.join(at[part])}h0", f'stroke-width="1.5"{dashes}'
