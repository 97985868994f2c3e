"""A result or a fit as one self-contained page of HTML: pictures, errors, scene and provenance, in light and dark."""

import base64
import shlex
import warnings
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError, level_outside
from roughmdr.fitting.words import curve_names, fit_lines
from roughmdr.model_error.parts import ALL_PARTS
from roughmdr.pictures.kinds import draw_request
from roughmdr.pictures.request import Drawable, Request, drawable
from roughmdr.pictures.style import png_of, styled
from roughmdr.report.cite import describe_papers
from roughmdr.report.summary import describe_cells, summary_lines
from roughmdr.result.model_errors import largest_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.wording import escape_controls, gathered
from roughmdr.storage.files import replace_atomically
from roughmdr.storage.result_file import check_output

if TYPE_CHECKING:
    import xarray as xr

_TEMPLATE = "page.html"
_DARK = "dark_background"
_MAX_LINES = 8  # under one name of the summary
_LEFT = ("variables", "left out", "warning")  # parts of the summary that have a place of their own


class _Figure(NamedTuple):
    """A picture twice, each as PNG in base64, and in words for those who cannot see it."""

    words: str
    caption: str
    across: bool  # whether it is as wide as the page
    light: str
    dark: str


@named_keywords
def write_report(result: "str | Path | xr.Dataset", out: str | Path, *, fresh: bool = False) -> None:
    """Write a result or a fit as one page of HTML that needs no other file.

    It holds the scene, pictures, the pull-off or the fitted parameters, the errors, run time, what was left out, where
    the numbers come from, how to run the scene again and what to cite; it is legible on narrow and wide screens, light
    and dark.

    Parameters
    ----------
    result : path or xarray.Dataset
        The file of a result or a fit, or what ``run`` or ``fit`` returned.
    out : path
        The page to write: .html. A page that is there already is replaced.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``.

    Raises
    ------
    StoreError
        Where there is no such result or fit, no run was computed, or ``out`` cannot be written or must not be replaced.
    """
    source, path = drawable(result), Path(out)
    if source.doubt:
        warnings.warn(f"{source.file}: {source.doubt}", UserWarning, stacklevel=level_outside())
    check_page(path, source.file, fresh=fresh)
    write_page(source, path)


def check_page(path: Path, file: Path | None, *, fresh: bool) -> None:
    """Raise StoreError unless a page can be written to ``path``; with ``fresh`` it may replace a file of any kind."""
    check_output(path, "report", [".html", ".htm"], [file], kind="html", fresh=fresh)


def write_page(source: Drawable, path: Path) -> None:
    """Write the page of a result or a fit that was read; StoreError if it is none, or no run was computed."""
    from importlib.resources import files

    from jinja2 import Environment

    if source.content == "ensemble":
        raise StoreError(f"{source.file or 'result'}: holds asperities; a page is of a result or a fit")
    attrs = source.data.attrs
    template = Environment(autoescape=True).from_string(files(__package__).joinpath(_TEMPLATE).read_text("utf-8"))
    result = source.result if source.content == "result" else None
    text = template.render(
        title=escape_controls(attrs["title"]),
        doubt=source.doubt,
        warnings=attrs.get("warnings", "").splitlines(),
        **(_of_fit(source) if result is None else _of_result(source)),
        scene=attrs["scene"].strip(),
        origin=[("made by", attrs["packages"]), ("history", attrs["history"]), ("checksum", attrs.get("checksum", ""))],
        citations=describe_papers(attrs["scene"], result, bibtex=False),
        bibtex=describe_papers(attrs["scene"], result, bibtex=True),
    )
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _of_result(source: Drawable) -> dict[str, Any]:
    """Return the parts of the page of a result."""
    result, attrs = source.result, source.data.attrs
    return {
        "made": f"{attrs['source']}, seed {attrs['seed']}",
        "summary": list(_summary(summary_lines(result))),
        "figures": list(_figures(source)),
        "errors": list(error_rows(result)),
        "cells": describe_cells(result) if len(result.cells) > 1 else "",
        "left_out": [line.partition(": ")[::2] for line in attrs["left_out"].splitlines()],
        "about_scene": "The result holds its scene; this computes the same numbers again, to the last bit:",
        "command": f"roughmdr run {_name(source, 'out.nc')} -o again.nc",
    }


def _of_fit(source: Drawable) -> dict[str, Any]:
    """Return the parts of the page of a fit."""
    attrs, many = source.data.attrs, bool(curve_names(source.data))
    words = "the parameters of all curves" if many else "the measured points, the fitted law and the residuals"
    own = "The fit holds the fitted scene; this computes its law:"
    return {
        "made": attrs["source"],
        "summary": list(_summary(fit_lines(source.data))),
        "figures": [_figure(source, Request("fit"), words)],
        "about_scene": "Each curve has a scene of its own; the search began with this one:" if many else own,
        "command": "" if many else f"roughmdr run {_name(source, 'fit.nc')} -o law.nc",
    }


def _name(source: Drawable, usual: str) -> str:
    """Return the name of the file in a command."""
    return usual if source.file is None else shlex.quote(source.file.name)


def _summary(lines: Iterable[tuple[str, str]]) -> Iterator[tuple[str, list[str]]]:
    """Yield the lines of a summary, those that go on under the name that they began with."""
    for name, texts in gathered(lines).items():
        more = len(texts) - _MAX_LINES
        if name not in _LEFT:
            rest = [f"... and {more} more lines, which roughmdr info prints"] if more > 0 else []
            yield name, [*texts[:_MAX_LINES], *rest]


def _figures(source: Drawable) -> Iterator[_Figure]:
    """Yield the pictures: of a sweep its number, each variable over the path, and how the errors converge."""
    swept = [size for size in source.result.sweep.values() if size > 1]
    if swept:
        yield _figure(source, Request("sweep"), "the sweep")
    for name in source.result.curves:
        yield _figure(source, Request("law", (name,)), f"{name.replace('_', ' ')} over the path")
    with suppress(StoreError):  # of single realisations, statistics and expected laws there is no convergence
        yield _figure(source, Request("convergence"), "errors over the number of realisations")


def _figure(source: Drawable, request: Request, words: str) -> _Figure:
    pictures, caption = [], ""
    for style in (None, _DARK):
        with styled(style):
            figure = draw_request(source, request).figure
            figure.suptitle("")
            caption = str(figure.get_label())
            pictures.append(base64.b64encode(png_of(figure)).decode())
    return _Figure(words, caption, request.kind == "convergence", *pictures)


class ErrorRow(NamedTuple):
    """One error."""

    name: str
    size: float
    """The largest over all runs, a share of the force, or of the largest force."""
    meaning: str


def error_rows(result: ResultView) -> Iterator[ErrorRow]:
    """Yield the errors of a result that are known, the largest of each over its runs."""
    expected = result.estimator == "expected"
    numerical = result.variables["numerical_error"].values[result.done]
    if numerical.size:
        name = "integration" if expected else "rounding"
        yield ErrorRow(name, float(numerical.max()), "numerical error of the force, over the largest force")
    if result.realizations > 1:
        yield from _of_draws(result)
    if result.known("model_error").size:
        yield ErrorRow(
            "model", result.largest("model_error"), "assumptions of the model, at closest approach, of the force"
        )
        for part, reason in ALL_PARTS.items():
            if (size := result.largest(part)) > 0.0:
                yield ErrorRow(f"– {part.removesuffix('_error').replace('_', ' ')}", size, f"part of it: {reason}")
        for name, size in largest_of_result(result).items():
            if not np.isnan(size):
                words = name.replace("_", " ")
                yield ErrorRow(words, size, f"assumptions of the model, of the {words} at given pressure")


def _of_draws(result: ResultView) -> Iterator[ErrorRow]:
    """Yield the standard errors of the mean over the realisations."""
    name = next((each for each in ("force", "pressure") if result.holds(each)), None)
    if name is not None:
        mean, error = result.mean(name)
        largest = np.abs(mean).max(axis=-1, initial=0.0)
        shares = error.max(axis=-1)[largest > 0.0] / largest[largest > 0.0]
        if np.isfinite(shares).any():
            meaning = "standard error of the mean force over the realisations, over the largest force"
            yield ErrorRow("draws", float(np.nanmax(shares)), meaning)
    if result.holds("pull_off_force"):
        mean, error = result.mean("pull_off_force")
        known = np.isfinite(error) & (mean < 0.0)
        if known.any():
            meaning = "standard error of the mean pull-off force over the realisations, of itself"
            yield ErrorRow("draws, pull-off", float((error[known] / -mean[known]).max()), meaning)
