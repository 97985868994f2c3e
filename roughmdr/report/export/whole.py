"""The whole law of a body at given separations, tension and detachment with it, as codes of particles take it.

LAMMPS reads forces F at distances r of two centres. Its ``pair_style table linear`` with as many points as the file,
evenly spaced in r^2, takes F/r for linear in r^2; ``fix wall/table`` reads the same file for the distance from a wall.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.export.law import Law, Quantity
from roughmdr.report.export.stable import StablePart
from roughmdr.report.export.text import Column
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.view import ResultView
from roughmdr.schema.units import format_quantity
from roughmdr.variables import SEPARATION

_DOUBLINGS = 8
"""How often the number of points is doubled at most, from that of the steps."""


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


def columns_of(part: StablePart, units: UnitSystem, distance: float | None) -> tuple[Column, ...]:
    """Return the columns of a table of forces: overclosure, or from near to far the distance, force, energy, others.

    The energy is the integral of the force as it is read between the points, 0 where contact is lost.
    """
    x, force, length, unit = part.overclosure, part.value, units.length, units.force
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
    )


def whole_lines(
    cell: ResultView, part: StablePart, law: Law, quantity: Quantity, units: UnitSystem
) -> Iterator[tuple[str, str]]:
    """Yield what a code of particles needs to know of a law: its ends, tension, stiffness and loss."""
    length, unit = units.length, units.force
    x, force, names = part.overclosure / length.size, part.value / unit.size, f"{unit.name} {length.name}"
    lost = f"from {force[0]:.6g} {unit.name} at {x[0]:.9g} {length.name} on"
    yield "first force", f"{lost}; before that there is no force, from somewhere within the next step of the path"
    low = int(force.argmin())
    if force[low] < 0.0:
        deepest = f"the deepest at a step is {-law.value.min() / unit.size:.9g} {unit.name}"
        yield "tension", f"{-force[low]:.9g} {unit.name} at {x[low]:.9g} {length.name}; {deepest}"
    yield "stiffness", f"up to {np.max(np.diff(force) / np.diff(x)):.4g} {unit.name}/{length.name}, for the time step"
    losses = [
        f"{lost:.4g} {names} to {to:.6g} {length.name} (loading takes {on:.4g})" for to, lost, on in _loops(cell, units)
    ]
    if losses:
        yield "loss", f"{', '.join(losses)}, there and back; a table has no memory: loading and unloading are two"


def _loops(cell: ResultView, units: UnitSystem) -> Iterator[tuple[float, float, float]]:
    """Yield of each loading that its unloading undoes the overclosure reached, the energy lost, and what it takes."""
    length, energy = units.length.size, units.force.size * units.length.size
    separation, force = cell.coordinates[SEPARATION.name].values.reshape(-1), cell.mean("force")[0].reshape(-1)
    for there, back in pairwise(cell.legs):
        returns = separation[back.steps[-1]] >= separation[there.steps[0]]
        if (there.branch, back.branch) == ("loading", "unloading") and returns:
            joined = np.concatenate([there.steps[-1:], back.steps])
            taken, regained = (np.trapezoid(force[steps], -separation[steps]) for steps in (there.steps, joined))
            if np.isfinite([taken, regained]).all():
                yield -float(separation[joined].min()) / length, max(taken + regained, 0.0) / energy, taken / energy
