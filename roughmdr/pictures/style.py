"""Colours, axes, titles and files that all pictures share."""

import io
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import axis_unit, format_quantity
from roughmdr.schema.wording import escape_controls, short_repr, suggestion
from roughmdr.storage.files import check_ending, replace_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BRANCH_COLOURS = {"loading": "#0072b2", "unloading": "#d55e00"}
"""Colours that are distinct for the colour-blind: M. Okabe, K. Ito, Color universal design (2008)."""
BRANCH_LINESTYLES = {"loading": "-", "unloading": "--"}
COLOUR_MAP = "viridis"
PICTURE_ENDINGS = ".png", ".pdf", ".svg"
_LETTERS_PER_INCH = 12.0  # letters of a title per inch
_DPI = 160
_REASON_LETTERS = 200  # most letters of a reason by matplotlib in a message
_SALT = "roughmdr"  # salt of identifiers, so that an SVG of one figure is always the same


class Scale(NamedTuple):
    """The unit of an axis with its size in SI, and the name of the quantity."""

    size: float
    name: str
    unit: str = ""
    """Unit with prefix; empty for plain numbers and names."""

    @classmethod
    def of(cls, values: ArrayLike, name: str, unit: str) -> "Scale":
        """Return the scale for numbers in SI, of which the largest is from 1 to 1000, under a name."""
        finite = np.asarray(values, dtype=np.float64)
        finite = finite[np.isfinite(finite)]
        size, text = axis_unit(float(np.abs(finite).max(initial=0.0)), unit)
        return cls(size, name.replace("_", " ").replace("pull off", "pull-off"), _spelt(text))

    @property
    def label(self) -> str:
        """The label of the axis."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def __call__(self, values: ArrayLike) -> Floats:
        """Return numbers in SI in the unit of the axis."""
        return np.asarray(values, dtype=np.float64) / self.size


def in_words(value: float, unit: str) -> str:
    """Return a quantity in SI, with the unit spelt as on axes."""
    number, _, prefixed = format_quantity(value, unit).partition(" ")
    return f"{number} {_spelt(prefixed)}".rstrip()


def _spelt(unit: str) -> str:
    """Return a unit with the signs that a terminal may lack."""
    micro = f"µ{unit[1:]}" if unit[:1] == "u" else unit.replace("/u", "/µ")
    return micro.replace("^2", "²")


def colours(count: int) -> list[str]:
    """Return that many colours, from dark to light, distinct for the colour-blind and from the background."""
    from matplotlib import colormaps, rcParams
    from matplotlib.colors import to_hex, to_rgb

    on_dark = sum(to_rgb(rcParams["text.color"])) > 1.5
    first, last = (0.3, 1.0) if on_dark else (0.0, 0.92)
    return [to_hex(colormaps[COLOUR_MAP](each)) for each in np.linspace(first, last, count)]


def new_figure(width: float, height: float) -> "Figure":
    """Return an empty figure of a size [inches], whose parts will make room for each other."""
    from roughmdr.pictures.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def set_title(figure: "Figure", title: str, notes: Sequence[str] = ()) -> None:
    """Write a title with notes above a figure: on one line where that is not wider than the figure, else on several."""
    letters = int(_LETTERS_PER_INCH * figure.get_figwidth())
    title, notes = escape_controls(title), [escape_controls(note) for note in notes]
    figure.set_label("\n".join(notes))  # for users who write the title elsewhere
    lines = ["; ".join(filter(None, [title, *notes]))]
    if len(lines[0]) > letters:
        lines = [line for each in (title, *notes) for line in textwrap.wrap(each, int(0.9 * letters))]
    figure.suptitle("\n".join(lines), fontsize=10, parse_math=False)


@contextmanager
def styled(style: str | None) -> Iterator[None]:
    """Draw in a style of matplotlib, by its name or file; StoreError if there is none, or none to draw with here."""
    if style is None:
        yield
        return
    from matplotlib import style as styles

    shown = short_repr(style)
    if style not in styles.available and style != "default":
        if not Path(style).is_file():
            raise StoreError(f"style {shown}: no style of matplotlib{suggestion(style, [*styles.available])}")
        _check_style_file(style)
    try:
        with styles.context(style):
            yield
    except RoughmdrError:
        raise
    except Exception as error:  # a style can need things that this machine lacks, and set things that cannot be drawn
        reason = str(error).partition("\n")[0][:_REASON_LETTERS]
        raise StoreError(f"style {shown}: matplotlib cannot draw with it here: {reason}") from None


def _check_style_file(style: str) -> None:
    """Raise StoreError unless a file sets parameters of matplotlib, and nothing else."""
    import logging

    from matplotlib import rc_params_from_file

    log, faults = logging.getLogger("matplotlib"), list[str]()
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: faults.append(record.getMessage())  # type: ignore[method-assign]
    before = log.propagate
    log.addHandler(handler)
    log.propagate = False
    try:
        parameters = rc_params_from_file(style, use_default_template=False)
    except (OSError, ValueError, KeyError) as error:
        raise StoreError(f"style {short_repr(style)}: cannot be read as a style of matplotlib: {error}") from None
    finally:
        log.propagate = before
        log.removeHandler(handler)
    if faults:
        reason = " ".join(faults[0].split())[:_REASON_LETTERS]
        raise StoreError(f"style {short_repr(style)}: is no style of matplotlib: {reason}")
    if not parameters:
        raise StoreError(f"style {short_repr(style)}: sets no parameter of matplotlib")


def save(figure: "Figure", path: Path) -> None:
    """Write a picture in the format of its name's ending, with the same bytes for the same figure.

    StoreError if it cannot be written.
    """
    from matplotlib import rc_context

    kind = check_ending(path, "picture", PICTURE_ENDINGS).removeprefix(".")
    dated = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}
    with replace_atomically(path) as temporary, rc_context({"svg.hashsalt": _SALT}):
        figure.savefig(temporary, dpi=_DPI, format=kind, metadata=dated.get(kind))


def png_of(figure: "Figure") -> bytes:
    """Return a picture as PNG, on a transparent ground."""
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=_DPI, transparent=True)
    return content.getvalue()
