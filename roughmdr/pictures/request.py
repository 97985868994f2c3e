"""A picture that is asked for: its data and its options."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, TypedDict

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.fitting.stored import as_fit
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import short_repr
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.reading import read_arrays
from roughmdr.storage.result_file import FIT
from roughmdr.storage.result_validation import as_result

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

Content = Literal["result", "ensemble", "fit"]


class Drawable(NamedTuple):
    """Data to draw, and the file that they are in, None where they are in none."""

    content: Content
    data: Labelled
    file: Path | None

    @property
    def result(self) -> ResultView:
        """The data as a result."""
        return ResultView(self.data)

    @property
    def doubt(self) -> str:
        """Why the numbers of a result or a fit in a file cannot be trusted; empty if they can."""
        return self.data.integrity_fault() if self.content != "ensemble" and self.file is not None else ""


class Picture(NamedTuple):
    """A figure, and remarks on the curves over it: those drawn and, with the reason, those that are not."""

    figure: "Figure"
    remarks: list[tuple[str, str]]


class Place(TypedDict, total=False):
    """A step of a realisation of a cell."""

    cell: tuple[int, ...]
    realization: int
    step: int | None


@dataclass(frozen=True)
class Request:
    """Options of a picture; ``None``, empty or False where the kind of picture decides."""

    kind: str | None = None
    variables: tuple[str, ...] = ()
    x: str | None = None
    per_area: bool = False
    at: Mapping[str, object] = field(default_factory=dict)
    select: Mapping[str, object] = field(default_factory=dict)
    log: bool | None = None
    step: int | str | None = None
    realization: int | None = None
    asperity: int | None = None
    with_expected: bool = False
    with_theory: bool = False
    with_reference: bool = False

    @property
    def given(self) -> set[str]:
        """Names of the options that are given, but the kind."""
        default = Request()
        return {each.name for each in fields(self) if getattr(self, each.name) != getattr(default, each.name)} - {
            "kind"
        }


def drawable(source: "str | Path | xr.Dataset") -> Drawable:
    """Return data to draw from a file or a Dataset: a result, an ensemble, or a fit; StoreError if it is none."""
    if isinstance(source, str | os.PathLike):
        file = Path(source)
        try:
            data = read_arrays(file)
        except RoughmdrError as error:
            raise StoreError(f"{file}: {error}") from None
    elif hasattr(source, "data_vars"):
        data, file = Labelled.of(source), None
    else:
        raise StoreError(f"result is {short_repr(source)}; it must be a path or a Dataset as roughmdr.run returns it")
    content = _content(data)
    if content == "ensemble":  # which the picture checks
        return Drawable(content, data, file)
    return Drawable(content, (as_result if content == "result" else as_fit)(data, file), file)


def _content(data: Labelled) -> Content:
    if data.attrs.get("kind") == FIT:
        return "fit"
    return "ensemble" if {"asperity"} == set(data.sizes) and "height" in data.variables else "result"
