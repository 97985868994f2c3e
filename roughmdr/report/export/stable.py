"""The part of a law that a load, or a contact of a finite-element code, can follow.

Under load control equilibria are stable where the pressure rises as the surfaces approach. A growing load passes the
steps whose pressure is above all before, and jumps over the others; a falling load those whose pressure is below all
before, down to the deepest tension, where it pulls off. The overclosure counts from the separation of zero pressure,
which is that of first touch without adhesion.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.report.export.law import Law
from roughmdr.schema.units import format_quantity


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
