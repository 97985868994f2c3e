"""A number against the swept parameters: points with their errors over one, a colour map over two, panels for three."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.number import Number, number_of
from roughmdr.pictures.request import Request
from roughmdr.pictures.style import BRANCH_COLOURS, COLOUR_MAP, Scale, new_figure, set_title
from roughmdr.result.trust import pull_off_error_of, trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import escape_controls, suggestion
from roughmdr.storage.labelled import Array
from roughmdr.variables import swept_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MAX_KEYS, _FLAT = 3, 2
_MAX_PANELS = 12
_MAX_TICKS = 7
_MAX_WRITTEN = 36  # most cells of a colour map with written numbers
_DECADES = 100.0  # ratio of numbers from which their axis is logarithmic
_EVEN = 1e-6  # difference of steps that count as equal on a logarithmic axis, over a step
_LUMINANCE = (0.2126, 0.7152, 0.0722)  # weights of red, green and blue (ITU-R BT.709)
_DARK = 0.5


class Axis(NamedTuple):
    """A swept key along an axis of a picture."""

    name: str
    scale: Scale
    places: Floats  # in the unit of the axis; of names their numbers
    names: tuple[str, ...]  # empty for numbers
    log: bool

    @classmethod
    def of(cls, name: str, coordinate: Array) -> "Axis":
        """Return the axis of a coordinate: logarithmic where its values are evenly spaced in logarithms."""
        values, label = coordinate.values, str(coordinate.attrs.get("long_name", name)).removeprefix("swept ")
        if values.dtype.kind not in "if":
            numbers = np.arange(values.size, dtype=np.float64)
            return cls(name, Scale(1.0, label), numbers, tuple(map(str, values)), log=False)
        scale = Scale.of(values, label, str(coordinate.attrs.get("units", "1")))
        log = values.size > 2 and bool((values > 0.0).all()) and _is_even(np.log(values)) and not _is_even(values)
        return cls(name, scale, scale(values), (), log)

    def spread_evenly(self) -> "Axis":
        """Return the axis with cells of one width, under their values, where these are few and unevenly spaced."""
        if self.names or self.log or self.places.size > _MAX_TICKS or _is_even(self.places):
            return self
        names = tuple(f"{place:.3g}" for place in self.places)
        return self._replace(places=np.arange(self.places.size, dtype=np.float64), names=names)

    @property
    def edges(self) -> Floats:
        """Edges of the cells around its places."""
        places = np.log(self.places) if self.log else self.places
        if places.size == 1:
            half = 0.5 * (abs(float(places[0])) or 1.0)
            edges = np.array([places[0] - half, places[0] + half])
        else:
            middles = 0.5 * (places[1:] + places[:-1])
            edges = np.concatenate([[2.0 * places[0] - middles[0]], middles, [2.0 * places[-1] - middles[-1]]])
        return np.exp(edges) if self.log else edges


def _is_even(values: Floats) -> bool:
    steps = np.diff(values)
    return values.size < 3 or bool(np.ptp(steps) <= _EVEN * np.abs(steps).max())


def draw_sweep(result: ResultView, note: str, request: Request) -> "Figure":
    """Draw a number of each cell of a sweep against its swept keys.

    The number is a variable of the result, the pull-off force where there is one unless it is named; of a law where
    ``request.at`` says, or else at its largest. Bars are two standard errors. Numbers over two decades have a
    logarithmic axis unless ``request.log`` says otherwise, those below 0 turned round. StoreError where nothing was
    swept or computed, where there is no such variable, or where more than three keys were swept.
    """
    if not result.done.any():
        raise StoreError("there is nothing to draw: no run was computed")
    axes = _axes(result, request.x)
    number = number_of(result, request)
    log = _spans_decades(number.mean) if request.log is None else request.log
    if log and np.nanmax(number.mean) < 0.0:
        number = number._replace(name=f"minus {number.name}", mean=-number.mean)
    swept = list(result.sweep)
    order = [swept.index(axis.name if axis.name in swept else "cell") for axis in axes]
    scale = Scale.of(number.mean, number.name, number.unit)
    mean, error = (scale(values).transpose(order) for values in (number.mean, number.error))
    if request.log and not (mean[np.isfinite(mean)] > 0.0).all():
        raise StoreError("log does not go with these numbers: some are not above 0")
    if len(axes) == 1:
        figure = new_figure(6.4, 4.8)
        _draw_points(figure.subplots(), axes[0], mean, error, scale.label)
        if log:
            figure.axes[0].set_yscale("log")
    else:
        panels = 1 if len(axes) == _FLAT else min(_MAX_PANELS, axes[_FLAT].places.size)
        columns = min(panels, 3)
        size = (2.2 + 4.4 * columns, 5.2) if panels == 1 else (2.2 + 3.4 * columns, 1.6 + 2.9 * -(-panels // columns))
        figure = new_figure(*size)
        _draw_maps(figure, axes, mean, error, scale.label, log=log)
    together = _swept_together(result, axes[0].name)
    notes = [note, together, _words(result, number, scale), _model_note(result, number)]
    set_title(figure, result.attrs["title"], [each for each in notes if each])
    return figure


def _axes(result: ResultView, asked: str | None) -> list[Axis]:
    """Return the swept keys that are drawn, that ``asked`` for first: up to three, or one of those swept together."""
    sizes = result.sweep
    if not sizes:
        raise StoreError("nothing was swept: the result has one cell, of which the law can be drawn")
    together = sizes.keys() == {"cell"}
    names = _swept_keys(result)
    if asked is not None:
        first = swept_name(asked)
        if first not in names:
            raise StoreError(f"x is {asked!r}, which is not swept{suggestion(first, names)}")
        names = [first, *(name for name in names if name != first)]
    if together:
        return [Axis.of(names[0], result.coordinates[names[0]])]
    if len(names) > _MAX_KEYS:
        raise StoreError(
            f"{len(names)} keys were swept, and up to {_MAX_KEYS} are drawn: choose a value of "
            f"{' or '.join(names[_MAX_KEYS - 1 :])} with select"
        )
    return [Axis.of(name, result.coordinates[name]) for name in names]


def _swept_keys(result: ResultView) -> list[str]:
    return [*result.swept(result.cells[0])]


def _swept_together(result: ResultView, shown: str) -> str:
    """Name the keys that are swept together with the one that is shown."""
    others = [name for name in _swept_keys(result) if name != shown] if "cell" in result.sweep else []
    labels = [str(result.coordinates[name].attrs.get("long_name", name)).removeprefix("swept ") for name in others]
    return f"{', '.join(labels)} {'changes' if len(labels) == 1 else 'change'} along with it" if labels else ""


def _words(result: ResultView, number: Number, scale: Scale) -> str:
    """Describe where the number is taken, of how many realisations it is the mean, and its error."""
    count = result.realizations
    told = [number.where, f"mean of {count} realisations" if count > 1 else "one realisation"]
    errors = number.error[np.isfinite(number.error)]
    if errors.size:
        kind = "bars: ± 2 standard errors, one" if number.mean.ndim == 1 else "standard error"
        told.append(f"{kind} at most {float(f'{float(scale(errors.max())):.2g}'):g} {scale.unit}".rstrip())
    missing = int(np.isnan(number.mean).sum())
    if missing:
        told.append(f"none in {missing} of {number.mean.size} cells")
    return ", ".join(part for part in told if part)


def _spans_decades(numbers: Floats) -> bool:
    """Return whether numbers of one sign lie over several decades."""
    sizes = np.abs(numbers[np.isfinite(numbers)])
    same = sizes.size > 0 and bool((numbers[np.isfinite(numbers)] > 0.0).all() or np.nanmax(numbers) < 0.0)
    return same and bool(sizes.max() > _DECADES * sizes.min())


def _model_note(result: ResultView, number: Number) -> str:
    """Return a note on the model error, where the number is a force: for a pull-off that of pull-offs."""
    if number.unit not in ("N", "Pa"):
        return ""
    if "pull_off" in number.name and (own := pull_off_error_of(result)):
        return f"model: {own}"
    return f"model: {dict(trust_of_result(result))['trust']}"


def _draw_points(ax: "Axes", axis: Axis, mean: Floats, error: Floats, label: str) -> None:
    """Draw points with bars of two standard errors over one swept key."""
    colour = BRANCH_COLOURS["loading"]
    joined = "none" if axis.names else "-"
    bars = np.where(np.isfinite(error), 2.0 * error, 0.0)
    ax.errorbar(
        axis.places, mean, yerr=bars if np.isfinite(error).any() else None, fmt="o", ls=joined, lw=1.0, ms=4.5,
        capsize=3.0, color=colour,
    )  # fmt: skip
    _set_ticks(ax, "x", axis)
    ax.set_ylabel(label)
    ax.grid(visible=True, lw=0.4, alpha=0.5)


def _set_ticks(ax: "Axes", which: str, axis: Axis) -> None:
    """Label an axis with its key, and with names where it has these."""
    getattr(ax, f"set_{which}label")(axis.scale.label)
    if axis.log:
        getattr(ax, f"set_{which}scale")("log")
    if axis.names or axis.log or axis.places.size <= _MAX_TICKS:
        shown = np.unique(np.linspace(0, axis.places.size - 1, min(_MAX_TICKS, axis.places.size)).astype(int))
        labels = [axis.names[i] if axis.names else f"{axis.places[i]:.3g}" for i in shown]
        getattr(ax, f"set_{which}ticks")(axis.places[shown], labels=labels)
        getattr(ax, f"set_{which}ticks")([], minor=True)


def _panel_titles(axis: Axis) -> list[tuple[int, str]]:
    """Return which values of the third key have a panel, and its title; evenly chosen where they are many."""
    chosen = np.unique(np.linspace(0, axis.places.size - 1, min(_MAX_PANELS, axis.places.size)).astype(int))
    name, unit = axis.scale.name, axis.scale.unit
    return [
        (int(i), f"{name} = {axis.names[i] if axis.names else f'{axis.places[i]:.4g} {unit}'.rstrip()}") for i in chosen
    ]


def _draw_maps(figure: "Figure", axes: list[Axis], mean: Floats, error: Floats, label: str, *, log: bool) -> None:
    """Draw colour maps over two keys, of which the first is across, side by side for the values of a third."""
    from matplotlib.colors import LogNorm, Normalize

    panels = [(0, "")] if len(axes) == _FLAT else _panel_titles(axes[_FLAT])
    axes = [axis.spread_evenly() for axis in axes[:_FLAT]]
    mean, error = (values.reshape(*values.shape[:_FLAT], -1) for values in (mean, error))
    columns = min(len(panels), 3)
    grid = figure.subplots(-(-len(panels) // columns), columns, squeeze=False, sharex=True, sharey=True)
    finite = mean[np.isfinite(mean)]
    low, high = float(finite.min()), float(finite.max())
    norm = LogNorm(low, high) if log and high > low else Normalize(low, high)
    mesh: Any = None
    for ax, (number, title) in zip(grid.flat, panels, strict=False):
        ax.set_facecolor("0.8")
        values = np.ma.masked_invalid(mean[..., number].T)
        mesh = ax.pcolormesh(axes[0].edges, axes[1].edges, values, norm=norm, cmap=COLOUR_MAP, rasterized=True)
        _set_ticks(ax, "x", axes[0])
        _set_ticks(ax, "y", axes[1])
        ax.label_outer()
        ax.set_title(escape_controls(title), fontsize=9, parse_math=False)
        if len(panels) == 1 and values.size <= _MAX_WRITTEN:
            _write_numbers(ax, axes, mean[..., number], error[..., number], mesh)
    for ax in grid.flat[len(panels) :]:
        ax.set_visible(False)
    figure.colorbar(mesh, ax=list(grid.flat), label=label, shrink=0.9, pad=0.02)


def _write_numbers(ax: "Axes", axes: list[Axis], mean: Floats, error: Floats, mesh: Any) -> None:
    """Write each number with its standard error into its cell, light on dark."""
    for (i, j), value in np.ndenumerate(mean):
        if np.isfinite(value):
            off = f"\n± {error[i, j]:.2g}" if np.isfinite(error[i, j]) else ""
            dark = float(np.dot(mesh.cmap(mesh.norm(value))[:3], _LUMINANCE)) < _DARK
            ax.text(
                float(axes[0].places[i]), float(axes[1].places[j]), f"{value:.3g}{off}", ha="center", va="center",
                fontsize=7, color="white" if dark else "black",
            )  # fmt: skip
