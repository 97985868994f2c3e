"""One contact that yields by the method of dimensionality reduction: limits, continuity, energies and memory."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from single import Single

from roughmdr.aggregate.totals import DISSIPATED, ENERGY, FORCE
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss
from roughmdr.stages.plastic.body import LIMIT, SQUARE, Body
from roughmdr.stages.plastic.mdr import kernels, yield_pressure
from roughmdr.stages.plastic.total import add_up

few = settings(deadline=None, max_examples=30)
STIFF = st.floats(0.0, 8.0).map(lambda power: 10.0**power)  # E*/Y
STICKY = st.one_of(st.just(0.0), st.floats(-9.0, -1.0).map(lambda power: 10.0**power))  # w/(E* R)
SQUARED = st.sampled_from([0.0, 1.0])


class Contact(Single):
    """One asperity of radius 1 m on a body with E* = 1 Pa, in units of a length [m] and a pressure [Pa]."""

    def __init__(self, stiff: float, sticky: float, squared: float = 0.0, units: Any = (1.0, 1.0)) -> None:
        length, pressure = units
        body = Body(pressure, pressure / stiff, sticky * length * pressure, 0.3, math.inf, squared)
        super().__init__(kernels(adhesive=sticky > 0.0), length, body)
        self.limit = float(self.row[LIMIT])

    def along(self, indentation: Floats) -> Floats:
        rows = {FORCE, ENERGY, DISSIPATED}
        return add_up(self.kernels, np.zeros(1), self.rows, -np.asarray(indentation), self.body, rows).total


@few
@given(STIFF, STICKY, SQUARED)
def test_it_yields_at_the_pressure_of_yielding_without_a_jump(stiff: float, sticky: float, squared: float) -> None:
    contact = Contact(stiff, sticky, squared)
    assume(contact.limit < 1.0)
    before, after = contact.state(contact.limit), contact.state(contact.limit * (1.0 + 1e-15))
    scale = before.force + math.pi * sticky + before.radius**3 * 4.0 / 3.0
    assert after.radius == pytest.approx(before.radius, rel=1e-14)
    flow = math.pi * before.radius**2 * yield_pressure(contact.limit, contact.row, contact.body)
    assert max(abs(before.force - flow), abs(after.force - before.force)) < 1e-14 * scale
    assert before.stored - after.stored > 0.0  # plastic flow takes energy, also where the force does not jump


def test_weak_adhesion_leaves_the_dry_contact() -> None:
    """The force that w adds goes with its square root, as the stretch of the springs does."""
    dry = Contact(300.0, 0.0)
    for deepest, rise in ((1.5, 0.0), (5.0, 0.0), (5.0, 1.0), (20.0, 3.0)):
        d, up = deepest * dry.limit, rise * dry.limit
        there = dry.state(d, up)
        off = [abs(Contact(300.0, sticky).state(d, up).force / there.force - 1.0) for sticky in (1e-12, 1e-14, 1e-16)]
        assert off[0] < 1e-3
        assert off[1] < 0.15 * off[0]
        assert off[2] < 0.15 * off[1]
        assert Contact(300.0, 1e-16).lost(d) == pytest.approx(dry.lost(d), rel=1e-4)


def test_strong_adhesion_pins_the_edge_until_the_pull_off_of_a_flat_punch() -> None:
    """K. Kendall, J. Phys. D 4 (1971) 1186, less the pressure that the dent was made with."""
    contact = Contact(1e3, 1e-2)
    for deepest in (1.5 * contact.limit, 4.0 * contact.limit):
        b = contact.mark(deepest).first
        pushing, kendall = contact.state(deepest).force, math.sqrt(8.0 * math.pi * 1e-2 * b**3)
        loss = contact.ends(deepest)[1]
        assert contact.state(deepest, loss).force == pytest.approx(pushing - kendall, rel=1e-2)
        assert contact.state(deepest, 0.5 * loss).stiffness == pytest.approx(2.0 * b, rel=1e-14)


@few
@given(STIFF, STICKY, SQUARED, st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_the_stiffness_is_a_slope(stiff: float, sticky: float, squared: float, way: float, back: float) -> None:
    contact = Contact(stiff, sticky, squared)
    assume(contact.limit < 0.9)
    for deepest in (way * contact.limit, contact.limit ** (1.0 - way)):
        rise = back * contact.ends(deepest)[0]
        small = 1e-5 * min(rise, contact.ends(deepest)[1] - rise, abs(deepest - contact.limit), 1.0)
        for up in (0.0, rise) if deepest > contact.limit else (0.0,):
            more, less = ((deepest, up + sign * small) if up else (deepest - sign * small,) for sign in (-1.0, 1.0))
            slope = (contact.state(*more).force - contact.state(*less).force) / (2.0 * small)
            there = contact.state(deepest, up)
            natural = 2.0 * there.radius + 1e-15 * abs(there.force) / small
            assert abs(slope - there.stiffness) < 1e-4 * natural


def _leg(begin: float, end: float, kinks: list[float]) -> tuple[Floats, Floats]:
    """Return nodes and weights of a leg from one indentation to another; roots at the ends of its parts are smooth."""
    inner = [kink for kink in kinks if min(begin, end) < kink < max(begin, end)]
    stops = [begin, *sorted(inner, reverse=begin > end), end]
    y, weight = gauss(40)
    angle = 0.5 * math.pi * (y + 1.0)
    parts = [
        (a + (b - a) * 0.5 * (1.0 - np.cos(angle)), (b - a) * 0.25 * math.pi * weight * np.sin(angle))
        for a, b in pairwise(stops)
    ]
    return tuple(np.concatenate(each) for each in zip(*parts, strict=True))


@pytest.mark.large
@few
@given(STIFF, STICKY, SQUARED, st.lists(st.floats(0.0, 1.0), min_size=5, max_size=5))
def test_the_work_of_the_flat_is_stored_or_lost(stiff: float, sticky: float, squared: float, ways: Any) -> None:
    contact = Contact(stiff, sticky, squared)
    assume(contact.limit < 0.5)
    first, second = sorted(contact.limit ** (1.0 - way) for way in ways[:2])
    assume(second > 1.001 * first and first > 1.001 * contact.limit)
    part = first - ways[2] * contact.ends(first)[0]
    off = [deepest - (1.0 + 0.1 * ways[3]) * contact.ends(deepest)[1] for deepest in (first, second)]
    turns = [0.1 * contact.limit, first, part, second, off[1], second * (1.0 - 1e-3 * ways[4])]
    turns += [off[1], min(1.3 * second, 1.0), 1.29 * second if 1.29 * second < 1.0 else 0.99]
    path, weight, ends, lowest = [np.array([-contact.limit])], [np.zeros(1)], [0], 0.0
    for begin, end in zip([-contact.limit, *turns[:-1]], turns, strict=True):
        lowest = max(lowest, begin)
        kinks = [0.0, contact.limit, lowest]
        if lowest > contact.limit:
            mark, (made, loss) = contact.mark(lowest), contact.ends(lowest)
            pinned = math.sqrt(2.0 * math.pi * mark.first * sticky)
            kinks += [lowest - pinned, lowest - (made if end > begin else loss)]
        nodes, weights = _leg(begin, end, kinks)
        path.append(np.append(nodes, end))
        weight.append(np.append(weights, 0.0))
        ends.append(ends[-1] + nodes.size + 1)
    total = contact.along(np.concatenate(path))
    work = np.cumsum(np.concatenate(weight) * total[FORCE])[ends]
    kept = (total[ENERGY] + total[DISSIPATED])[ends]
    scale = np.abs(total[ENERGY]).max() + total[DISSIPATED].max()
    np.testing.assert_allclose(work, kept, rtol=0.0, atol=1e-10 * scale)
    assert (np.diff(total[DISSIPATED]) >= -1e-2 * scale).all()  # next to the onset: as the test below


@few
@given(STIFF, STICKY, SQUARED)
def test_yielding_takes_ever_more_energy(stiff: float, sticky: float, squared: float) -> None:
    """From the onset to 1.08 times its indentation the dent stores more than the flat does, as the model has it."""
    contact = Contact(stiff, sticky, squared)
    assume(contact.limit < 1.0)
    deepest = np.geomspace(contact.limit * (1.0 + 1e-9), 1.0, 60)
    lost = np.array([contact.lost(d) for d in deepest.tolist()])
    radius = math.sqrt(contact.row[SQUARE])
    stored = 0.3 * (math.pi * yield_pressure(contact.limit, contact.row, contact.body)) ** 2 * radius**3  # by Hertz
    assert (lost > 0.08 * stored).all()
    assert (np.diff(lost)[deepest[:-1] > 1.1 * contact.limit] > 0.0).all()


@few
@given(STIFF, STICKY, SQUARED, st.sampled_from([1e-9, 1e-6, 1e3]), st.sampled_from([1e3, 1e12]))
def test_other_units(stiff: float, sticky: float, squared: float, length: float, pressure: float) -> None:
    one, other = Contact(stiff, sticky, squared), Contact(stiff, sticky, squared, (length, pressure))
    for deepest, rise in ((0.5, 0.1), (0.5, 0.45), (0.9, 0.0), (2.0 * one.limit, one.limit)):
        if one.ends(deepest)[1] * 0.99 > rise:
            here, there = one.state(deepest, rise), other.state(deepest * length, rise * length)
            units = (length**2 * pressure, length, length * pressure, length**3 * pressure)
            natural = here.radius**2 + here.radius * one.ends(deepest)[1]
            scales = natural, here.radius, max(abs(here.stiffness), here.radius), natural
            for a, b, unit, scale in zip(here, there, units, scales, strict=True):
                assert abs(b / unit - a) <= 1e-11 * scale + 1e-12 * abs(a)


@few
@given(STIFF, STICKY, SQUARED, st.floats(-12.0, 2.0), st.floats(0.0, 2.0))
def test_no_number_is_missing(stiff: float, sticky: float, squared: float, deep: float, back: float) -> None:
    for shear in (math.inf, 0.4):
        contact = Contact(stiff, sticky, squared)
        contact.body = contact.body._replace(shear_modulus=shear)
        deepest = 10.0**deep
        made, loss = contact.ends(deepest)
        assert 0.0 < made <= loss * (1.0 + 1e-14)
        for rise in (0.0, min(back, 1.0 - 1e-9) * loss, back * made if sticky == 0.0 else made):
            assert all(map(math.isfinite, (*contact.state(deepest, rise), contact.lost(deepest))))
