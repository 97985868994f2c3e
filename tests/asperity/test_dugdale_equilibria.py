"""rm.equilibria under adhesion with a range: every crossing of the curve, and which of them hold."""

import math
from itertools import pairwise

import numpy as np
import pytest
from forms import large_where_compiled
from twins.spring_in_series import DugdaleParaboloid

import roughmdr as rm
from roughmdr.shapes import Shape

E, WORK, R = 3e6, 0.04, 3e-5
B, SLOPE = 2e-6, 0.2


def strength_for(shape: Shape, tabor: float) -> float:
    return tabor / rm.tabor(shape, effective_modulus=E, work=WORK, strength=1.0)


@pytest.mark.parametrize("tabor", [0.1, 0.8, 3.0])
def test_the_paraboloid_has_all_that_maugis_has(tabor: float) -> None:
    tip = rm.Paraboloid(R)
    curve = DugdaleParaboloid(E, WORK, strength_for(tip, tabor), R)
    grid = curve.grid
    state = curve.at(grid)
    numbers = {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": curve.strength}
    low, gap = state.delta.min(), WORK / curve.strength
    for delta in (1.001 * low, 0.999 * low, 0.5 * (low - gap), -1.001 * gap, -0.999 * gap, 0.0, 3.0 * gap):
        found = rm.equilibria(tip, indentation=delta, **numbers)
        crossing = np.flatnonzero((state.delta[:-1] - delta) * (state.delta[1:] - delta) < 0.0)
        assert found.sizes == {"equilibrium": crossing.size}
        rising = state.delta[crossing + 1] > state.delta[crossing]
        assert found.stable_displacement.values.tolist() == rising.tolist()
        pushed = rising & (state.force[crossing + 1] > state.force[crossing])
        assert found.stable_force.values.tolist() == pushed.tolist()
        part = (delta - state.delta[crossing]) / np.diff(state.delta)[crossing]
        for name, values in (("force", state.force), ("contact_radius", state.a)):
            exact = values[crossing] + part * np.diff(values)[crossing]
            np.testing.assert_allclose(found[name], exact, rtol=1e-4, atol=1e-5 * np.abs(values[:5000]).max())


SHAPES = [
    rm.Paraboloid(R),
    rm.Cone(SLOPE),
    rm.PowerLaw(3.3, width=1e-5, rise=1e-6),
    rm.Sphere(10.0 * R),
    rm.FlatPunch(B),
    rm.TruncatedCone(SLOPE, B),
    rm.RoundedPunch(B, R),
]


def gap_at_edge(shape: Shape, c: float, delta: float, numbers: dict[str, object], a: float) -> float:
    """The gap at the cohesive radius, by quadrature of u1 over x = c sin(phi)."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    beta = 2.0 * float(numbers["strength"]) / E
    ends = [0.0, *sorted({math.asin(min(x, c) / c) for x in (a, B) if x > 0.0}), 0.5 * math.pi]
    total = 0.0
    for low, high in pairwise(ends):
        z = 0.5 * (1.0 + nodes)
        phi = low + (high - low) * z**3 * (10.0 - 15.0 * z + 6.0 * z * z)
        weight = 15.0 * (z * (1.0 - z)) ** 2 * (high - low) * weights
        x = c * np.sin(phi)
        touching = delta - shape.g(np.minimum(x, c)) if not isinstance(shape, rm.FlatPunch) else delta + 0.0 * x
        total += float(np.sum(weight * np.where(x < a, touching, -beta * c * np.cos(phi))))
    f = 0.0 if isinstance(shape, rm.FlatPunch) else float(shape.f(c))
    return f - delta + 2.0 / math.pi * total


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("tabor", [0.3, 2.0])
def test_each_is_an_equilibrium_whose_gap_ends_at_the_range(shape: Shape, tabor: float) -> None:
    numbers = {
        "effective_modulus": E,
        "work": WORK,
        "adhesion": "dugdale",
        "strength": strength_for(shape, tabor),
    }
    gap = WORK / numbers["strength"]
    low = float(rm.pull_off(shape, control="displacement", **numbers).indentation)
    jumps = low < -gap * (1.0 + 1e-9)
    between = (0.99 * low - 0.01 * gap, 0.7 * low - 0.3 * gap) if jumps else ()
    for delta in (*between, -0.2 * gap):
        found = rm.equilibria(shape, indentation=delta, **numbers)
        assert found.stable_displacement.values.sum() == 1
        assert found.sizes["equilibrium"] == (2 if jumps and delta < -gap else 1)
        for i in range(found.sizes["equilibrium"]):
            a, c = float(found.contact_radius[i]), float(found.cohesive_radius[i])
            opened = gap_at_edge(shape, c, delta, numbers, a)
            if isinstance(shape, rm.FlatPunch) and c == B:
                assert opened <= gap * (1.0 + 1e-9)
            else:
                assert opened == pytest.approx(gap, rel=1e-7)
        held = rm.indent(shape, indentation=delta, **numbers)
        stable = found.isel(equilibrium=int(np.flatnonzero(found.stable_displacement)[-1]))
        for name in ("force", "contact_radius", "cohesive_radius", "stiffness"):
            assert float(stable[name]) == pytest.approx(float(held[name]), rel=1e-13)
    assert rm.equilibria(shape, indentation=low - 0.01 * gap, **numbers).sizes == {"equilibrium": 0}
    dead = rm.pull_off(shape, control="force", **numbers)
    both = rm.equilibria(shape, indentation=float(dead.indentation) + 1e-3 * gap, **numbers)
    assert bool(both.stable_force[-1])


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_the_stiffness_of_each_is_the_slope_of_its_branch(shape: Shape) -> None:
    numbers = {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": strength_for(shape, 1.0)}
    gap = WORK / numbers["strength"]
    low = float(rm.pull_off(shape, control="displacement", **numbers).indentation)
    delta, step = 0.6 * low - 0.4 * gap, 1e-5 * gap
    low_side, middle, high_side = (
        rm.equilibria(shape, indentation=at, **numbers) for at in (delta - step, delta, delta + step)
    )
    slope = (high_side.force.to_numpy() - low_side.force.to_numpy()) / (2.0 * step)
    np.testing.assert_allclose(middle.stiffness, slope, rtol=1e-5)


def test_a_long_zone_is_jkr() -> None:
    tip, given = rm.Paraboloid(R), {"effective_modulus": E, "work": WORK}
    low = float(rm.pull_off(tip, control="displacement", **given).indentation)
    given["indentation"] = 0.5 * low
    jkr = rm.equilibria(tip, **given)
    assert jkr.sizes == {"equilibrium": 2}
    assert "cohesive_radius" not in jkr
    errors = []
    for tabor in (30.0, 300.0):
        strength = strength_for(tip, tabor)
        near = rm.equilibria(tip, adhesion="dugdale", strength=strength, **given)
        errors.append(np.abs(near.force / jkr.force - 1.0).to_numpy()[1])
        assert near.stable_displacement.values.tolist() == [False, True]
    assert errors[1] < 0.15 * errors[0]
    assert errors[1] < 2e-2


def test_the_range_stands_for_the_strength_and_auto_says_what_it_took() -> None:
    tip, given = rm.Paraboloid(R), {"effective_modulus": E, "work": WORK, "indentation": 0.0}
    one = rm.equilibria(tip, adhesion="dugdale", strength=WORK / 3e-8, **given)
    assert one.identical(rm.equilibria(tip, adhesion="dugdale", range=3e-8, **given))
    assert rm.equilibria(tip, adhesion="auto", range="1 um", **given).attrs["adhesion"] == "dugdale"
    with pytest.raises(rm.RoughmdrError, match="adhesion model 'dugdale' needs strength"):
        rm.equilibria(tip, adhesion="dugdale", **given)


@large_where_compiled
def test_where_attraction_begins_without_a_jump_there_is_nothing_yet() -> None:
    tip, strength = rm.Cone(SLOPE), 1e5
    numbers = {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": strength}
    gap = WORK / strength
    assert rm.equilibria(tip, indentation=-gap, **numbers).sizes == {"equilibrium": 0}
    just = rm.equilibria(tip, indentation=-gap * (1.0 - 1e-6), **numbers)
    assert just.sizes == {"equilibrium": 1}
    assert float(just.contact_radius[0]) == 0.0 < float(just.cohesive_radius[0])
    assert just.stable_displacement.values.tolist() == [True]
    assert just.stable_force.values.tolist() == [False]
