"""The part of a law that a table holds.

It is what a load, or a contact of a finite-element code, can follow: under load control equilibria are stable where the
pressure rises as the surfaces approach. A growing load passes the steps whose pressure is above all before, and jumps
over the others; a falling load those whose pressure is below all before, down to the deepest tension, where it pulls
off. The overclosure counts from the separation of zero pressure, which is that of first touch without adhesion.

Or it is the whole law of a body at given separations, tension and detachment with it, as codes of particles take it.
LAMMPS reads forces F at distances r of two centres. Its ``pair_style table linear`` with as many points as the file,
evenly spaced in r^2, takes F/r for linear in r^2; ``fix wall/table`` reads the same file for the distance from a wall.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.report.export.law import Law
from roughmdr.report.export.text import Column, rounded_up
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.loops import loops_of
from roughmdr.result.view import ResultView, step_blocks
from roughmdr.schema.units import format_quantity

_DOUBLINGS = 8
"""How often the number of points is doubled at most, from that of the steps."""


class StablePart(NamedTuple):
    """A law over its stable steps, from far to near: its pressure rises from point to point."""

    step: Floats
    """Number of the step of the law, a fraction between two at zero pressure: [point]."""
    overclosure: Floats
    """[m]: [point]; 0 at zero pressure, negative in tension."""
    pressure: Floats
    """[Pa]: [point]."""
    value: Floats
    """[point]."""
    standard_error: Floats
    """Standard error of ``value``: [point]."""
    datum: float
    """Separation of zero overclosure [m]."""
    rule: str
    """Which steps these are, in words."""
    departure: float
    """Largest difference of the pressure to that of steps left out between them [Pa]."""
    tension: float
    """Largest tension that is left out [Pa]."""


def stable_part(law: Law, branch: str, *, with_tension: bool, negligible: float) -> StablePart:
    """Return the stable part of a law; ``with_tension`` that of an unloading goes on to its deepest tension.

    StoreError where there is no pressure, or where the path begins at more than a ``negligible`` pressure [Pa].
    """
    pressure = law.pressure
    largest = float(pressure.max())
    if not largest > 0.0:
        raise StoreError(f"the mean pressure is nowhere above 0 on the {branch}: there is no law to export")
    loading = branch == "loading"
    without = np.flatnonzero(pressure <= 0.0)
    last = int(without[-1]) if without.size else -1
    if last == pressure.size - 1:
        raise StoreError(f"the {branch} comes closest in tension: the path must go on until it is in compression")
    if last < 0 and pressure[0] > negligible:
        raise StoreError(
            f"the {branch} begins at {format_quantity(float(pressure[0]), 'Pa')}, in contact: a table begins where "
            'contact does, as with path.separation.start = "clear"'
        )
    compressed = np.arange(last + 1, pressure.size)
    compressed = _passed(-pressure, compressed, 0.0) if loading else _passed(pressure, compressed[::-1], np.inf)[::-1]
    between = float(pressure[last] / (pressure[last] - pressure[last + 1])) if last >= 0 else 0.0

    def with_zero(values: Floats) -> Floats:
        at_zero = values[0] if last < 0 else values[last] + between * (values[last + 1] - values[last])
        kept = compressed if last >= 0 else compressed[compressed > 0]
        return np.concatenate([values[tense], [at_zero], values[kept]])

    tense: Ints = np.zeros(0, dtype=np.int64)
    if with_tension and not loading and last >= 0:
        lowest = int(pressure.argmin())
        tense = _passed(pressure, np.arange(last, lowest - 1, -1), 0.0)[::-1]
    separation = with_zero(law.separation)
    datum = float(separation[tense.size])
    stable = with_zero(pressure)
    stable[tense.size] = 0.0
    first = int(tense[0]) if tense.size else last + 1
    whole = np.interp(-law.separation[first:], -separation, stable)
    left_out = pressure[: last + 1] if not tense.size else pressure[:0]
    return StablePart(
        with_zero(np.arange(pressure.size, dtype=float)),
        datum - separation,
        stable,
        with_zero(law.value),
        with_zero(law.standard_error),
        datum,
        _rule(float(stable[0]), loading=loading),
        float(np.abs(whole - pressure[first:]).max()),
        float(-left_out.min(initial=0.0)),
    )


def _passed(pressure: Floats, steps: Ints, start: float) -> Ints:
    """Return the steps, in their order, that a falling load passes: with a pressure below ``start`` and all before."""
    lowest = np.minimum.accumulate(np.append(start, pressure[steps]))
    return steps[pressure[steps] < lowest[:-1]]


def _rule(lowest: float, *, loading: bool) -> str:
    if loading:
        return "loading, as a growing load follows it, from zero pressure on: steps with a pressure above all before"
    tension = f"the deepest tension, {format_quantity(-lowest, 'Pa')}, where it pulls off"
    end = tension if lowest < 0.0 else "zero pressure"
    return f"unloading, as a falling load follows it, down to {end}: steps at which the pressure is below all before"


def whole_part(law: Law, branch: str, negligible: float) -> StablePart:
    """Return the steps of a law in contact, over minus the separation, from the last with a ``negligible`` force [N].

    StoreError where there are none, or where the path begins at a larger one.
    """
    force = law.value
    felt = np.flatnonzero(np.abs(force) > negligible)
    if not felt.size:
        raise StoreError(f"the mean force is nowhere other than 0 on the {branch}: there is no law to export")
    if felt[0] == 0:
        there = f"in contact where its path is farthest, at {format_quantity(float(force[0]), 'N')}"
        raise StoreError(f'the {branch} is {there}: a table goes on to no contact, as path.separation.start = "clear"')
    first = int(felt[0]) - bool(force[felt[0] - 1])  # from 0 on it may jump
    steps, touching = np.arange(first, force.size, dtype=float), force[first:]
    rule = f"{branch}, at given separations, from where contact is {'made' if branch == 'loading' else 'lost'} on"
    return StablePart(
        steps, -law.separation[first:], touching, touching, law.standard_error[first:], 0.0, rule, 0.0, 0.0
    )


def even_points(x: Floats, y: Floats, tolerance: Floats, distance: float) -> tuple[Floats, Floats]:
    """Return overclosures at even steps of the squared distance, and the force at x that LAMMPS finds between them.

    The distance is ``distance`` minus the overclosure. StoreError where no number of points keeps within ``tolerance``.
    """
    if not distance > max(x[-1], 0.0):
        least, given = (format_quantity(float(length), "m") for length in (x[-1], distance))
        raise StoreError(f"distance is {given}; it must be above 0 and above the overclosure of the last step, {least}")
    r, counts = distance - x, [x.size << times for times in range(_DOUBLINGS)]
    for count in counts:
        squares = np.linspace(r[0] ** 2, r[-1] ** 2, count)
        at = distance - np.sqrt(squares)
        at[0], at[-1] = x[0], x[-1]
        read = r * np.interp(-(r**2), -squares, np.interp(at, x, y) / (distance - at))
        if (np.abs(read - y) <= tolerance).all():
            return at, read
    kept = f"{counts[-1]} points at even distances do not keep the error asked for"
    raise StoreError(f"{kept}: ask for a larger one, or make the steps of the path more, or more even")


class TangentStiffness(NamedTuple):
    """The slope of the mean force over the overclosure [N/m], at points of a table."""

    value: Floats
    error: Floats
    """How far it may be off, estimated from the steps around."""
    standard_error: Floats
    """Over the realisations; NaN of one, and of a result of statistics."""


def tangent_stiffness(overclosure: Floats, cell: ResultView, law: Law, count: int) -> TangentStiffness:
    """Return the slope over the neighbouring steps, of the last ``count`` steps of a law, at some overclosures.

    The error is twice the largest difference to the slope over the second neighbours, of a step and both beside it. It
    is as large as that by a jump, and on even steps six times that of a smooth law. At the ends the difference is
    added, which cancels the first order.
    """
    steps, x, y, points = law.steps[-count:], -law.separation[-count:], law.value[-count:], np.arange(count)
    (low, high), second = ((np.maximum(points - far, 0), np.minimum(points + far, count - 1)) for far in (1, 2))
    value, wide = ((y[up] - y[down]) / (x[up] - x[down]) for down, up in ((low, high), second))
    off = np.pad(value - wide, 1)
    value[[0, -1]] += off[[1, -2]]
    error = 2.0 * np.max(np.abs([off[1:-1], off[2:], off[:-2]]), axis=0)
    spread = np.full(count, np.nan)
    if "force" in cell.variables:
        runs, known = cell.variables["force"].values.reshape(-1, cell.sizes["step"]), cell.done.reshape(-1)
        for some in step_blocks(4 * known.size, count):
            rise = runs[:, steps[high[some]]] - runs[:, steps[low[some]]]
            spread[some] = mean_and_error(rise, known)[1] / (x[high[some]] - x[low[some]])
    return TangentStiffness(*(np.interp(overclosure, x, each) for each in (value, error, spread)))


def columns_of(
    part: StablePart, stiffness: TangentStiffness, units: UnitSystem, distance: float | None
) -> tuple[Column, ...]:
    """Return the columns of a table of forces: overclosure, or from near to far the distance, force, energy, others.

    The energy is the integral of the force as it is read between the points, 0 where contact is lost.
    """
    length, unit = units.length, units.force
    x, force, per_length = part.overclosure, part.value, f"{unit.name}/{length.name}"
    tangent = zip(("", "_error", "_standard_error"), stiffness, strict=True)
    r = np.ones_like(x) if distance is None else distance - x
    slices = np.diff(x) * (r[1:] + r[:-1]) * (force[1:] / r[1:] + force[:-1] / r[:-1]) / 4.0
    energy = np.concatenate([[0.0], np.cumsum(slices)])
    name, argument, order = ("overclosure", x, 1) if distance is None else ("distance", r, -1)
    return (
        Column(name, length.name, argument[::order] / length.size),
        Column("force", unit.name, force[::order] / unit.size),
        Column("energy", f"{unit.name} {length.name}", energy[::order] / (unit.size * length.size)),
        Column("separation", length.name, -x[::order] / length.size),
        Column("standard_error", unit.name, part.standard_error[::order] / unit.size),
        *(
            Column(f"tangent_stiffness{end}", per_length, each[::order] / unit.size * length.size)
            for end, each in tangent
        ),
    )


def whole_lines(cell: ResultView, part: StablePart, law: Law, units: UnitSystem) -> Iterator[tuple[str, str]]:
    """Yield what a code of particles needs to know of a law: its ends, tension, stiffness and loss."""
    length, unit = units.length, units.force
    x, force, names = part.overclosure / length.size, part.value / unit.size, f"{unit.name} {length.name}"
    lost = f"from {force[0]:.6g} {unit.name} at {x[0]:.9g} {length.name} on"
    yield "first force", f"{lost}; before that there is no force, from somewhere within the next step of the path"
    low = int(force.argmin())
    if force[low] < 0.0:
        deepest = f"the deepest at a step is {-law.value.min() / unit.size:.9g} {unit.name}"
        yield "tension", f"{-force[low]:.9g} {unit.name} at {x[low]:.9g} {length.name}; {deepest}"
    joule, steepest = 1.0 / (unit.size * length.size), np.max(np.diff(law.value) / -np.diff(law.separation))
    between = "between two steps of the path, for the time step of an integration"
    yield "stiffness", f"up to {steepest / unit.size * length.size:.4g} {unit.name}/{length.name} {between}"
    losses = [
        f"{loop.energy_lost * joule:.4g} {names} to {-loop.closest / length.size:.6g} {length.name} within "
        f"{rounded_up(loop.error * joule)} (loading takes {loop.work_of_loading * joule:.4g})"
        for loop in loops_of(cell, cell.cells[0])
        if np.isfinite(loop.energy_lost)
    ]
    if losses:
        yield "loss", f"{', '.join(losses)}, there and back; a table has no memory: loading and unloading are two"
