"""The asperities of a realisation from above, to scale, with the force of each contact; or of an ensemble alone."""

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Unpack

import numpy as np

from roughmdr.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.errors import StoreError
from roughmdr.interaction.placed import sides_of
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.request import Place
from roughmdr.pictures.snapshot import Snapshot
from roughmdr.pictures.style import COLOUR_MAP, Scale, in_words, new_figure, set_title
from roughmdr.result.view import ResultView

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DIVERGING = "PuOr_r"
"""Colours for tension and compression, distinct for the colour-blind."""
_WIDTH = 7.4  # width of the figure [inches]
_SIDE = 5.4  # longer side of the patch as it is drawn [inches]
_BAR = 0.7  # height of a colour bar below [inches]
_MIN_RADIUS = 0.6  # least radius of a contact as it is drawn [points]
_OTHERS = 5000  # most asperities out of contact that are drawn, the highest
_PIXELS = 1200  # most pixels of a height map along a side


class Frame(NamedTuple):
    """The rectangle that is drawn."""

    x: float
    """Lower left corner [m], with ``y``."""
    y: float
    width: float
    """Size [m], with ``height``."""
    height: float

    @classmethod
    def of(cls, ensemble: Ensemble, margin: float) -> "Frame":
        """Return the patch of an ensemble; where there is none, or not all lie on it, the asperities and a margin."""
        x, y = ensemble.positions["x"], ensemble.positions["y"]
        sides = sides_of(ensemble)
        if sides is not None and min(x.min(), y.min()) >= 0.0 and x.max() <= sides[0] and y.max() <= sides[1]:
            return cls(0.0, 0.0, *sides)
        reach = margin or 0.05 * float(max(np.ptp(x), np.ptp(y)))
        reach = reach or float(ensemble.columns.width.max())
        low = float(x.min()) - reach, float(y.min()) - reach
        return cls(*low, float(np.ptp(x)) + 2.0 * reach, float(np.ptp(y)) + 2.0 * reach)

    @property
    def min_radius(self) -> float:
        """The radius [m] below which a disc could not be seen."""
        return _MIN_RADIUS / (72.0 * _SIDE) * max(self.width, self.height)


def draw_map(result: ResultView, file: Path | None = None, **place: Unpack[Place]) -> "Figure":
    """Draw the contacts of a realisation at a step to scale, each in the colour of its force, over the map they are on.

    By default the first step at which the flat is closest, in the first cell; ``file`` is that of the result, if any.
    Asperities without contact, the highest of them, are dots. Errors as ``Snapshot.of``.
    """
    now = Snapshot.of(result, file, placed=True, **place)
    ensemble, contacts = now.ensemble, now.contacts
    _check_placed(ensemble)
    on = np.flatnonzero(contacts.active)
    on = on[np.argsort(-contacts.radius[on], kind="stable")]  # large ones first, so that small ones are not hidden
    others = np.flatnonzero(~contacts.active)
    frame = Frame.of(ensemble, 2.0 * float(contacts.radius.max()))
    surface = now.scene.asperities.height_map(now.scene.seed, place.get("realization", 0))
    figure, ax, length = _start(frame, 0.0 if surface is None else _BAR)
    if surface is not None:
        _draw_surface(figure, ax, surface, length)
    x, y = ensemble.positions["x"], ensemble.positions["y"]
    few = others[:_OTHERS]
    ax.scatter(length(x[few]), length(y[few]), s=3.0, c="k", alpha=0.35, lw=0.0, rasterized=True, label="no contact")
    if on.size:
        _draw_contacts(
            figure,
            ax,
            length(np.array([x[on], y[on], contacts.radius[on]])),
            contacts.force[on],
            length(frame.min_radius),
        )
    needed = surface is not None or now.scene.needs_positions or not now.scene.asperities.is_random
    set_title(figure, result.attrs["title"], [now.place, *_notes(now, frame, few.size, needed=needed)])
    return figure


def draw_ensemble(ensemble: Ensemble, title: str) -> "Figure":
    """Draw the summits of an ensemble, each in the colour of its height; StoreError where it has no positions."""
    _check_placed(ensemble)
    figure, ax, length = _start(Frame.of(ensemble, 0.0), 0.0)
    x, y, z = (each[::-1] for each in (ensemble.positions["x"], ensemble.positions["y"], ensemble.height))
    size = float(np.clip(2e4 / z.size, 1.0, 30.0))
    height = Scale.of(z, "height of the summit", "m")
    dots = ax.scatter(length(x), length(y), s=size, c=height(z), cmap=COLOUR_MAP, lw=0.0, rasterized=True)
    figure.colorbar(dots, ax=ax, label=height.label)
    note = f"{z.size} asperities of shape {ensemble.shape}, from {in_words(z[0], 'm')} to {in_words(z[-1], 'm')}"
    set_title(figure, title, [f"{note}; only their places are to scale"])
    return figure


def _check_placed(ensemble: Ensemble) -> None:
    """Raise StoreError unless asperities have positions."""
    if missing := [name for name in ("x", "y") if name not in ensemble.positions]:
        raise StoreError(
            f"the asperities have no {' and '.join(missing)}, and cannot be drawn on a map; generate them with "
            "asperities.placement = 'random', or give their file the variables x and y [m] over asperity"
        )


def _start(frame: Frame, more: float) -> "tuple[Figure, Axes, Scale]":
    """Return an empty figure of a frame, ``more`` inches taller, its axes, and the scale of lengths."""
    aspect = frame.height / frame.width
    tall = min(_SIDE * aspect, _SIDE) if aspect >= 0.2 else 0.2 * _SIDE
    figure = new_figure(_WIDTH, tall + more + 1.6)
    ax = figure.subplots()
    x, y = (Scale.of([max(frame.width, frame.height)], name, "m") for name in "xy")
    ax.set(
        xlim=(x(frame.x), x(frame.x + frame.width)),
        ylim=(y(frame.y), y(frame.y + frame.height)),
        xlabel=x.label,
        ylabel=y.label,
        aspect="equal",
    )
    return figure, ax, x


def _draw_surface(figure: "Figure", ax: "Axes", surface: HeightMap, length: Scale) -> None:
    """Draw a height map in greys, with its colour bar."""
    nx, ny = surface.height.shape
    stride = -(-max(nx, ny) // _PIXELS)
    z = surface.height[::stride, ::stride].T
    scale = Scale.of(z, "height of the map", "m")
    extent = (0.0, float(length(nx * surface.dx)), 0.0, float(length(ny * surface.dy)))
    low, high = (float(each) for each in scale([np.nanmin(z), np.nanmax(z)]))
    image = ax.imshow(
        scale(z), origin="lower", extent=extent, cmap="gray", vmin=low - 0.7 * (high - low), vmax=high, zorder=0
    )  # fmt: skip
    bar = figure.colorbar(image, ax=ax, label=scale.label, location="bottom", shrink=0.7, aspect=40)
    bar.ax.set_xlim(low, high)


def _draw_contacts(figure: "Figure", ax: "Axes", discs: Floats, force: Floats, least: Floats) -> None:
    """Draw contacts as discs x, y and radius [row, contact] in units of the axes, in the colours of their forces [N].

    No disc is smaller than a radius.
    """
    from matplotlib.collections import EllipseCollection
    from matplotlib.colors import Normalize, TwoSlopeNorm
    from matplotlib.ticker import MaxNLocator

    scale = Scale.of(force, "force of a contact", "N")
    values, tense = scale(force), bool((force < 0.0).any())
    if tense:
        scale = scale._replace(name=f"{scale.name}, tension < 0")
        largest = float(np.abs(values).max())
        norm: Normalize = TwoSlopeNorm(0.0, float(values.min()), max(float(values.max()), 1e-3 * largest))
    else:
        norm = Normalize(0.0, float(values.max()))
    x, y, radius = discs
    size, crowded = 2.0 * np.maximum(radius, least), radius.size > _OTHERS
    contacts = EllipseCollection(
        size,
        size,
        np.zeros_like(size),
        units="xy",
        offsets=np.column_stack([x, y]),
        offset_transform=ax.transData,
        array=values,
        norm=norm,
        cmap=DIVERGING if tense else COLOUR_MAP,
        edgecolors="k",
        linewidths=0.0 if crowded else 0.3,
        rasterized=crowded,
        zorder=2,
    )
    ax.add_collection(contacts, autolim=False)
    bar = figure.colorbar(contacts, ax=ax, label=scale.label)
    if tense:  # compression and tension have scales of their own
        halves = [MaxNLocator(4).tick_values(*ends) for ends in ((norm.vmin, 0.0), (0.0, norm.vmax))]
        bar.set_ticks([tick for tick in np.unique(np.concatenate(halves)) if norm.vmin <= tick <= norm.vmax])


def _notes(now: Snapshot, frame: Frame, others: int, *, needed: bool) -> list[str]:
    """Return the numbers of a map in words, with the parts that are not to scale, or not ``needed`` for the result."""
    contacts, ensemble = now.contacts, now.ensemble
    on = contacts.active
    count, total = int(np.count_nonzero(on)), float(contacts.force.sum())
    numbers = f"{count} of {ensemble.height.size} asperities in contact, together {in_words(total, 'N')}"
    if ensemble.origin == "hills":
        numbers += "; hills: circles as stiff"
    least, drawn = frame.min_radius, []
    if count:
        small = int(np.count_nonzero(contacts.radius[on] < least))
        drawn.append(
            "discs to scale" + (f", {small} smaller than {in_words(least, 'm')} drawn as large" if small else "")
        )
    if others:
        rest = ensemble.height.size - count
        drawn.append("dots: no contact" + ("" if others == rest else f", the {others} highest of {rest}"))
    if not needed:
        drawn.append("no number of the result depends on the positions")
    return [numbers, "; ".join(drawn)]
