"""A result as one self-contained page of HTML: figures, errors, scene and provenance, in light and dark."""

import base64
import shlex
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import ALL_PARTS
from roughmdr.pictures.kinds import draw_request
from roughmdr.pictures.request import Drawable, Request
from roughmdr.pictures.style import png_of, styled
from roughmdr.report.cite import describe_papers
from roughmdr.report.summary import describe_cells, summary_lines
from roughmdr.result.given import given_result
from roughmdr.result.model_errors import largest_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.wording import escape_controls, gathered
from roughmdr.storage.files import check_ending, check_writable, replace_atomically
from roughmdr.storage.result_file import check_same_kind

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
    """Write a result as one page of HTML that needs no other file.

    It holds the scene, pictures, the pull-off, the errors, run time, what was left out, where the numbers come from,
    how to run the scene again and what to cite; it is legible on narrow and wide screens, light and dark.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned.
    out : path
        The page to write: .html. A page that is there already is replaced.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``.

    Raises
    ------
    StoreError
        Where there is no such result, no run was computed, or ``out`` cannot be written or must not be replaced.
    """
    data, file = given_result(result)
    path = Path(out)
    check_page(path, file, fresh=fresh)
    write_page(data, file, path)


def write_page(result: ResultView, file: Path | None, path: Path) -> None:
    """Write the page of a result that was read, from ``file`` or None; StoreError if no run was computed."""
    text = page_of(result, file)
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def check_page(path: Path, file: Path | None, *, fresh: bool) -> None:
    """Raise StoreError unless a page can be written to ``path``; with ``fresh`` it may replace a file of any kind."""
    check_writable(path, [] if file is None else [file])
    check_ending(path, "report", [".html", ".htm"])
    if not fresh:
        check_same_kind(path, "html")


def page_of(result: ResultView, file: Path | None) -> str:
    """Return that page."""
    from importlib.resources import files

    from jinja2 import Environment

    attrs = result.attrs
    template = Environment(autoescape=True).from_string(files(__package__).joinpath(_TEMPLATE).read_text("utf-8"))
    return template.render(
        title=escape_controls(attrs["title"]),
        made=f"{attrs['source']}, seed {attrs['seed']}",
        doubt="" if file is None else result.doubt,
        warnings=attrs.get("warnings", "").splitlines(),
        summary=list(_summary(result)),
        figures=list(_figures(Drawable("result", result.labelled, file))),
        errors=list(error_rows(result)),
        cells=describe_cells(result) if len(result.cells) > 1 else "",
        left_out=[line.partition(": ")[::2] for line in attrs["left_out"].splitlines()],
        file="out.nc" if file is None else shlex.quote(file.name),
        scene=attrs["scene"].strip(),
        origin=[("made by", attrs["packages"]), ("history", attrs["history"]), ("checksum", attrs.get("checksum", ""))],
        citations=describe_papers(attrs["scene"], result, bibtex=False),
        bibtex=describe_papers(attrs["scene"], result, bibtex=True),
    )


def _summary(result: ResultView) -> Iterator[tuple[str, list[str]]]:
    """Yield the lines of the summary, those that go on under the name that they began with."""
    for name, texts in gathered(summary_lines(result)).items():
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
