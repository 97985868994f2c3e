"""rm.equilibria: every root of delta(a) = delta, and which of them hold under which control."""

import math

import numba
import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st

import roughmdr as rm

E = 3e6
b, S, R = 2e-6, 0.2, 1e-5
# Two branches: the dimensionless dl(b)/rise lies in the window where sqrt(a) g' has a fall that matters.
BRANCHED = {
    "corner inside, deeper": (rm.TruncatedCone(S, b), 4.6),
    "corner inside, less deep": (rm.TruncatedCone(S, b), 6.0),
    "truncated_paraboloid": (rm.TruncatedParaboloid(R, b), 6.6),
    "rounded_cone": (rm.RoundedCone(S, b), 3.8),
    "capped_paraboloid": (rm.CappedParaboloid(R, 40.0 * R, b), 7.0),
}


def work_for(shape: rm.TruncatedCone, tension: float) -> float:
    width, rise, _ = shape.nondimensional()
    return (tension * rise) ** 2 * E / (2.0 * math.pi * width)


def turns(shape: rm.TruncatedCone, work: float) -> np.ndarray:
    """Where delta(a) = g(a) - dl(a) turns, over a fine grid of contact radii: the indentations there."""
    a = b * np.exp(np.concatenate([np.linspace(-3.0, 0.0, 4001), np.geomspace(1e-9, 5.0, 40001)]))
    delta = shape.g(a) - np.sqrt(2.0 * math.pi * a * work / E)
    steps = np.sign(np.diff(delta))
    return delta[1:-1][steps[:-1] != steps[1:]]


@large_where_compiled
@pytest.mark.parametrize("case", BRANCHED)
def test_two_branches(case: str) -> None:
    shape, tension = BRANCHED[case]
    work = work_for(shape, tension)
    inner, top, outer = turns(shape, work)
    both = max(inner, outer) + 0.4 * (top - max(inner, outer))
    found = rm.equilibria(shape, effective_modulus=E, work=work, indentation=both)
    assert found.stable_displacement.values.tolist() == [False, True, False, True]
    assert (np.diff(found.contact_radius) > 0.0).all()
    a = found.contact_radius.to_numpy()
    np.testing.assert_allclose(shape.g(a) - np.sqrt(2.0 * math.pi * a * work / E), both, rtol=1e-11)
    retracted = rm.indent(shape, effective_modulus=E, work=work, indentation=both)
    assert float(retracted.contact_radius) == pytest.approx(a[-1], rel=1e-13)
    one = min(inner, outer) + 0.5 * (max(inner, outer) - min(inner, outer))
    left = rm.equilibria(shape, effective_modulus=E, work=work, indentation=one)
    assert left.stable_displacement.values.sum() == 1
    off = rm.pull_off(shape, effective_modulus=E, work=work, control="displacement")
    assert float(off.indentation) == pytest.approx(min(inner, outer), rel=1e-6)
    still = rm.indent(shape, effective_modulus=E, work=work, indentation=one)
    assert float(still.contact_radius) == pytest.approx(left.contact_radius[left.stable_displacement].item(), rel=1e-13)


ONE_BRANCH = [
    rm.Paraboloid(R),
    rm.Cone(S),
    rm.PowerLaw(3.3, width=R, rise=1e-6),
    rm.Sphere(100.0 * R),
    rm.RoundedPunch(b, R),
    rm.TruncatedCone(S, b),
    rm.PowerSeries({2.0: 1e4, 4.0: 1e14}),
]


@pytest.mark.parametrize("shape", [*ONE_BRANCH, rm.FlatPunch(b)], ids=str)
def test_between_pull_off_and_touch_there_are_two(shape: rm.Paraboloid) -> None:
    work = 1e-3
    off = rm.pull_off(shape, effective_modulus=E, work=work, control="displacement")
    dead = rm.pull_off(shape, effective_modulus=E, work=work, control="force")
    for part in (0.999, 0.7, 0.01):
        found = rm.equilibria(shape, effective_modulus=E, work=work, indentation=part * float(off.indentation))
        assert found.stable_displacement.values.tolist() == [False, True]
        assert found.stable_force.values.tolist()[0] is False
        holds = float(found.contact_radius[1]) >= float(dead.contact_radius)
        assert bool(found.stable_force[1]) == holds
        same = rm.indent(shape, effective_modulus=E, work=work, indentation=part * float(off.indentation))
        for name in ("contact_radius", "force", "stiffness"):
            assert float(found[name][1]) == float(same[name])
        if not (isinstance(shape, rm.FlatPunch | rm.TruncatedCone | rm.RoundedPunch)):
            a = float(found.contact_radius[0])
            inner = rm.indent(shape, effective_modulus=E, work=work, contact_radius=a)
            assert float(inner.indentation) == pytest.approx(part * float(off.indentation), rel=1e-11)


@large_where_compiled
def test_beyond_pull_off_there_is_none_and_pressed_there_is_one() -> None:
    for shape in (*ONE_BRANCH, rm.FlatPunch(b)):
        off = rm.pull_off(shape, effective_modulus=E, work=1e-3, control="displacement")
        assert rm.equilibria(
            shape, effective_modulus=E, work=1e-3, indentation=1.001 * float(off.indentation)
        ).sizes == {"equilibrium": 0}
        assert rm.equilibria(shape, effective_modulus=E, work=1e-3, indentation=1e-7).sizes == {"equilibrium": 1}
        assert rm.equilibria(shape, effective_modulus=E, work=0.0, indentation=1e-7).sizes == {"equilibrium": 1}
        assert rm.equilibria(shape, effective_modulus=E, work=0.0, indentation=-1e-7).sizes == {"equilibrium": 0}


def test_it_takes_one_number() -> None:
    with pytest.raises(rm.OutOfRange, match="indentation has 1 dimensions"):
        rm.equilibria(rm.Cone(0.1), effective_modulus=E, work=1e-3, indentation=[0.0])


def steps_of_table(rng: np.random.Generator) -> rm.Tabulated:
    """A convex staircase: gentle and steep rings in turn."""
    r = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.5, 12))]) * 1e-7
    slopes = np.sort(10.0 ** rng.uniform(-3.0, 0.0, 12))
    return rm.Tabulated(r, np.concatenate([[0.0], np.cumsum(slopes * np.diff(r))]))


@pytest.mark.large
@settings(deadline=None, max_examples=5 if numba.config.DISABLE_JIT else 30)  # uncompiled a table takes seconds
@given(seed=st.integers(0, 10**6), tension=st.floats(-2.0, 2.0), place=st.floats(1e-6, 1.0))
def test_a_table_of_any_convex_form_has_its_equilibria_in_turn(seed: int, tension: float, place: float) -> None:
    shape = steps_of_table(np.random.default_rng(seed))
    width, rise, _ = shape.nondimensional()
    work = (10.0**tension * rise) ** 2 * E / (2.0 * math.pi * width)
    off = rm.pull_off(shape, effective_modulus=E, work=work, control="displacement")
    found: xr.Dataset = rm.equilibria(
        shape, effective_modulus=E, work=work, indentation=(1.0 - place) * float(off.indentation)
    )
    held = found.stable_displacement.to_numpy()
    if place < 1.0:
        assert (held == (np.arange(held.size) % 2 == 1)).all()
        assert held[-1]
    a = found.contact_radius.to_numpy()
    excess = shape.g(a) - np.sqrt(2.0 * math.pi * a * work / E) - float(found.indentation)
    assert (np.abs(excess) <= 1e-11 * abs(float(off.indentation))).all()
