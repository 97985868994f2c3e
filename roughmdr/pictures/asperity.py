"""One asperity pressed into the half-space, the same on its row of springs, and its pressure.

After the figures of M. Heß, "On the reduction method of dimensionality: the exact mapping of axisymmetric contact
problems with and without adhesion" (2012).
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from roughmdr.ensemble import Ensemble
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.one_contact import OneContact
from roughmdr.pictures.request import Place
from roughmdr.pictures.snapshot import Snapshot
from roughmdr.pictures.style import BRANCH_COLOURS, Scale, in_words, new_figure, set_title
from roughmdr.result.view import ResultView
from roughmdr.shapes import SHAPES, Shape

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BODY, _LINE, _FREE = "#e4e0d8", "#4a4a4a", "#9a9a9a"
_COMPRESSED, _STRETCHED = BRANCH_COLOURS["loading"], BRANCH_COLOURS["unloading"]
_SIZE = 7.4, 8.6  # width and height of the figure [inches]
_NEAR = 0.985  # radius over the contact radius up to which the axis of pressure shows all values
_VISIBLE = 0.06  # least length with a name, over the height of a panel
_POINTS = 25  # points of a drawn spring
_STRAIGHT = 2  # straight points at each end of a drawn spring


def draw_asperity(
    result: ResultView, file: Path | None = None, *, asperity: int | None = None, **place: Unpack[Place]
) -> "Figure":
    """Draw one asperity of a realisation at a step: profile and surface, MDR profile and springs, and pressure.

    By default the one with the largest force, at the first step at which the flat is closest, in the first cell;
    asperities are numbered from the highest down. ``file`` is that of the result, if any. StoreError where it is not in
    contact; others as ``Snapshot.of``.
    """
    now = Snapshot.of(result, file, placed=False, **place)
    force, active, count = now.contacts.force, now.contacts.active, now.ensemble.height.size
    if not active.any():
        raise StoreError(f"no asperity is in contact at {now.place}; give another step")
    largest = int(np.flatnonzero(active)[force[active].argmax()])
    number = largest if asperity is None else asperity
    if not 0 <= number < count:
        raise StoreError(
            f"asperity is {number}; the realisation has asperities 0 to {count - 1}, from the highest down"
        )
    if not active[number]:
        raise StoreError(
            f"asperity is {number}, which is not in contact at {now.place}; {active.sum()} are, with the largest force "
            f"asperity {largest}"
        )
    shape, contacts = _shape_of(now.ensemble, number), now.contacts
    contact = OneContact.of(
        shape,
        now.scene.effective_modulus,
        contacts.adhesion,
        radius=float(contacts.radius[number]),
        force=float(force[number]),
        indentation=float(now.ensemble.height[number] - now.separation),
    )
    which = f"asperity {number} of {count} ({shape.name.replace('_', ' ')})"
    notes = [now.place, which + (", that with the largest force" if number == largest else "")]
    if now.scene.needs_positions:
        notes.append("force and radius are those among its neighbours; it is drawn as if alone with that radius")
    return draw_contact(contact, float(force[number]), result.attrs["title"], notes)


def _shape_of(ensemble: Ensemble, number: int) -> Shape:
    """Return the shape of an asperity."""
    if ensemble.shared_profile is not None:
        return ensemble.shared_profile
    given: dict[str, Any] = {name: values[number] for name, values in ensemble.parameters.items()}
    return SHAPES[ensemble.shape](**given)


def draw_contact(contact: OneContact, force: float, title: str, notes: list[str]) -> "Figure":
    """Draw a contact that bears a force [N], with a title and notes, to which its numbers are added."""
    figure = new_figure(*_SIZE)
    profile, row, load = figure.subplots(3, 1, sharex=True)
    length = Scale.of([contact.half_width], "distance from the axis, r or x", "m")
    heights = [_draw_profile(profile, contact, length), _draw_springs(row, contact, length)]
    _draw_pressure(load, contact, length)
    half = float(length(contact.half_width))
    load.set(xlim=(-half, half), xlabel=length.label)
    set_title(figure, title, [*notes, *_numbers(contact, force)])
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    figure.draw_without_rendering()  # panels are laid out here
    names = "profile and surface of the half-space", "MDR profile g(x) on its row of springs"
    for ax, height, name in zip((profile, row), heights, names, strict=True):
        ax.set_title(f"{name}; {_exaggeration(ax, height, length)}", fontsize=9, loc="left")
    load.set_title("pressure", fontsize=9, loc="left")
    return figure


def _numbers(contact: OneContact, force: float) -> tuple[str, str]:
    """Return the numbers of a contact, and those of its material, in words."""
    state, adhesion = contact.state, contact.adhesion
    numbers = f"force {in_words(force, 'N')}, indentation {in_words(state.indentation, 'm')}"
    numbers += f", contact radius {in_words(state.radius, 'm')}"
    material = f"E* = {in_words(contact.modulus, 'Pa')}, "
    material += f"w = {in_words(adhesion.work, 'J/m^2')}" if adhesion.work > 0.0 else "no adhesion"
    if adhesion.cohesive:
        numbers += f", cohesive radius {in_words(state.reach, 'm')}"
        material += f", strength {in_words(adhesion.strength, 'Pa')}"
    return numbers, material


def _exaggeration(ax: "Axes", height: Scale, length: Scale) -> str:
    """Return the factor by which heights of a panel are exaggerated."""
    box, (left, right), (low, high) = ax.get_window_extent(), ax.get_xlim(), ax.get_ylim()
    ratio = box.height / ((high - low) * height.size) / (box.width / ((right - left) * length.size))
    return f"heights drawn {ratio:.2g} times as large as widths"


def _mirrored(r: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return a curve from the axis outwards with its other half."""
    return np.append(-r[::-1], r), np.append(values[::-1], values)


def _draw_body(ax: "Axes", r: Floats, height: Floats, top: float) -> None:
    """Draw a body above its profile, with a wall where it ends, and the undeformed surface."""
    ended = np.isnan(height)
    x, z = _mirrored(r, np.where(ended, top, height).clip(max=top))
    ax.fill_between(x, z, top, color=_BODY, lw=0.0, zorder=1)
    ax.plot(x, np.where(z < top, z, np.nan), color=_LINE, lw=1.3, zorder=3)
    if ended.any():
        last = int(np.argmax(ended)) - 1
        for side in (-1.0, 1.0):
            ax.plot([side * r[last]] * 2, [height[last], top], color=_LINE, lw=1.3, zorder=3)
    ax.axhline(0.0, color="0.45", lw=0.8, ls=(0, (6, 4)), zorder=0)


def _draw_profile(ax: "Axes", contact: OneContact, length: Scale) -> Scale:
    """Draw the body and the deformed surface; return the scale of the heights."""
    r, z = contact.surface()
    body = contact.body(r)
    top = _top(r, body, contact, float(z.max()))
    height = Scale.of([top, z.min()], "height", "m")
    _draw_body(ax, length(r), height(body), float(height(top)))
    x, surface = _mirrored(length(r), height(z))
    low = float(height(z.min() - 0.45 * (top - z.min())))
    ax.fill_between(x, low, surface, color=_COMPRESSED, alpha=0.12, lw=0.0, zorder=2)
    ax.plot(x, surface, color=_COMPRESSED, lw=1.8, zorder=4, label="surface of the half-space")
    _mark_edge(ax, contact, length)
    ax.set(ylim=(low, float(height(top))), ylabel=height.label)
    return height


def _top(r: Floats, body: Floats, contact: OneContact, lifted: float) -> float:
    """Return the height up to which a body is drawn [m]: at 1.6 times the radius of its pressure, and above all."""
    inside = np.isfinite(body) & (r <= 1.6 * contact.state.reach)
    depth = max(abs(contact.state.indentation), abs(contact.stretch), lifted, float(np.ptp(body[inside])) / 3.0)
    return max(float(body[inside].max()), lifted + 0.4 * depth, 0.3 * depth)


def _draw_springs(ax: "Axes", contact: OneContact, length: Scale) -> Scale:
    """Draw the MDR profile on its row of springs; return the scale of the heights."""
    from matplotlib.collections import LineCollection

    r, (positions, stretched) = np.linspace(0.0, contact.half_width, 801), contact.springs()
    profile = contact.mdr_profile(r)
    top, lowest = _top(r, profile, contact, float(stretched.max())), float(stretched.min())
    bottom = lowest - 0.6 * (top - lowest)
    height = Scale.of([top, bottom], "height", "m")
    _draw_body(ax, length(r), height(profile), float(height(top)))
    x, ends, base = length(positions), height(stretched), float(height(bottom))
    held = np.abs(positions) < contact.state.reach
    for mask, colour, label in (
        (held & (ends <= 0.0), _COMPRESSED, "compressed springs"),
        (held & (ends > 0.0), _STRETCHED, "springs under tension"),
        (~held, _FREE, "free springs"),
    ):
        if mask.any():
            lines = coils(x[mask], ends[mask], base, 0.18 * (x[1] - x[0]))
            ax.add_collection(
                LineCollection(lines, colors=colour, linewidths=0.9, label=label, zorder=2), autolim=False
            )
            ax.scatter(x[mask], ends[mask], s=7, color=colour, zorder=4)
    _mark_edge(ax, contact, length)
    if contact.adhesion.work > 0.0 and contact.stretch > _VISIBLE * (top - bottom) and not contact.adhesion.cohesive:
        at, stretch = float(length(contact.state.radius)), float(height(contact.stretch))
        ax.annotate(
            "", (at, stretch), (at, 0.0), arrowprops={"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0}, zorder=5
        )
        ax.annotate("Δℓ(a)", (at, 0.5 * stretch), (7, 0), textcoords="offset points", va="center", fontsize=9, zorder=5,
                    bbox={"facecolor": "w", "edgecolor": "none", "alpha": 0.8, "pad": 1.0})  # fmt: skip
    ax.set(ylim=(base, float(height(top))), ylabel=height.label)
    return height


def _mark_edge(ax: "Axes", contact: OneContact, length: Scale, *, named: bool = False) -> None:
    """Mark the edge of the contact, and that of the cohesive zone; in the legend where ``named``."""
    a, reach = contact.state.radius, contact.state.reach
    edges = [(a, ":", "edge of the contact")] if a > 0.0 else []
    edges += [(reach, "-.", "edge of the cohesive zone")] if reach > a else []
    for radius, style, label in edges:
        at = float(length(radius))
        ax.axvline(-at, color="0.35", lw=0.8, ls=style, zorder=1.5)
        ax.axvline(at, color="0.35", lw=0.8, ls=style, zorder=1.5, label=label if named else None)


def _draw_pressure(ax: "Axes", contact: OneContact, length: Scale) -> None:
    """Draw the pressure, and an arrow where it is infinite."""
    r, p, infinite = contact.pressure()
    shown = np.abs(p) >= 0.0
    for radius in infinite:
        shown &= np.abs(r - radius) > (1.0 - _NEAR) * contact.state.radius
    low, high = min(float(p[shown].min()), 0.0), max(float(p[shown].max()), 0.0)
    scale = Scale.of([low, high], "pressure", "Pa")
    x, y = _mirrored(length(r), scale(p))
    ax.fill_between(x, y, 0.0, where=list(y >= 0.0), color=_COMPRESSED, alpha=0.25, lw=0.0)
    ax.fill_between(x, y, 0.0, where=list(y <= 0.0), color=_STRETCHED, alpha=0.25, lw=0.0)
    ax.plot(x, y, color=_LINE, lw=1.5)
    ax.axhline(0.0, color="0.45", lw=0.8, zorder=0)
    _mark_edge(ax, contact, length, named=True)
    margin = 0.12 * float(scale(high - low))
    ends = float(scale(low)) - margin, float(scale(high)) + margin
    ax.set(ylim=ends, ylabel=scale.label)
    for radius in infinite:
        up = bool(p[np.argmin(np.where(p != 0.0, np.abs(r - radius), np.inf))] > 0.0)
        for at in {-float(length(radius)), float(length(radius))}:
            ax.annotate(
                "∞" if up else "−∞", (at, ends[up]), (4, -10 if up else 4), textcoords="offset points", fontsize=9
            )


def coils(positions: Floats, ends: Floats, bottom: float, width: float) -> list[Floats]:
    """Return each spring as a line, [point, 2], from ``bottom`` to its end, ``width`` to both sides."""
    swing = np.zeros(_POINTS)
    swing[_STRAIGHT:-_STRAIGHT:2], swing[_STRAIGHT + 1 : -_STRAIGHT : 2] = width, -width
    return [
        np.column_stack([x + swing, np.linspace(bottom, end, _POINTS)]) for x, end in zip(positions, ends, strict=True)
    ]
