"""One asperity on a spring in series, and on approach: closed forms, a slow twin, limits, and what is refused."""

import math
from functools import cache

import mpmath
import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st
from twins.spring_in_series import (
    DugdaleParaboloid,
    Held,
    Jkr,
    JkrPowerLaw,
    JkrPunch,
    JkrRoundedCone,
    JkrTruncatedCone,
)

import roughmdr as rm
from roughmdr.asperity.approach import branches_of
from roughmdr.asperity.contact import Contact
from roughmdr.asperity.stable_parts import stable_parts
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import spring
from roughmdr.shapes import Shape

E, WORK = 3e6, 0.04
UNITS = [(1e-8, 2e11, 1.3), (3e-5, 3e6, 0.04), (0.7, 5e4, 2e-3)]
"""Radius [m], E* [Pa] and w [J/m2]."""


@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
def test_a_jkr_paraboloid_detaches_from_a_spring_where_its_polynomial_says(
    radius: float, modulus: float, work: float
) -> None:
    """4 t^5 + 4 kappa t^3 - 3 t^2 - kappa = 0, t^2 = a/a0, at 20 stiffnesses from soft to stiff."""
    mp = mpmath.mp.clone()
    mp.dps = 40
    R, modulus_, work_ = mp.mpf(radius), mp.mpf(modulus), mp.mpf(work)
    a0 = mp.cbrt(2 * mp.pi * work_ * R**2 / modulus_)
    d0, stiffness = a0**2 / R, 2 * modulus_ * a0
    ends = mp.cbrt(mp.mpf(1) / 4), mp.cbrt(mp.mpf(3) / 4)
    for kappa in np.geomspace(1e-7, 1e9, 20):
        km = mp.mpf(float(kappa * stiffness))
        k = km / stiffness

        def slope(t: object, k: object = k) -> object:
            return 4 * t**5 + 4 * k * t**3 - 3 * t**2 - k

        t = mp.findroot(slope, ends, solver="anderson", tol=1e-60)
        delta, force = t**4 - t, mp.mpf(2) / 3 * t**6 - t**3
        off = rm.pull_off(
            rm.Paraboloid(radius),
            effective_modulus=modulus,
            work=work,
            control="remote",
            machine_stiffness=float(km),
        )
        assert abs(float(off.indentation) / d0 - delta) < 1e-12
        assert abs(float(off.force) / (stiffness * d0) - force) < 1e-12
        assert abs(float(off.contact_radius) / a0 - t**2) < 1e-12
        remote = delta + force / k
        assert abs(float(off.remote) / d0 / remote - 1) < 1e-13


B, SLOPE, R = 2e-6, 0.2, 3e-5
KAPPA_06 = math.sqrt(math.pi) / 2.0 * 0.6 * math.gamma(0.3) / math.gamma(0.8)


def _power(n: float, coefficient: float, g_coefficient: float) -> tuple[Shape, Jkr]:
    """A power law with its curve, in units of the radius where it detaches under fixed grips."""
    shape = rm.PowerLaw(exponent=n, coefficient=coefficient)
    size = float(rm.pull_off(shape, effective_modulus=E, work=WORK, control="displacement").contact_radius)
    return shape, JkrPowerLaw(E, WORK, size, largest=2e9 if n < 0.7 else 300.0, n=n, coefficient=g_coefficient)


def _flat_work(tension: float) -> float:
    """The work [J/m2] at which dl(b) is ``tension`` times the rise of the truncated cone."""
    return (tension * SLOPE * B) ** 2 * E / (2.0 * math.pi * B)


def _dugdale(tabor: float) -> DugdaleParaboloid:
    return DugdaleParaboloid(E, WORK, tabor * (E * E / (WORK * WORK * R)) ** (1 / 3) * WORK, R)


@cache
def twins() -> dict[str, tuple[Shape, Jkr | DugdaleParaboloid]]:
    return {
        "paraboloid": _power(2.0, 0.5 / R, 1.0 / R),
        "cone": _power(1.0, SLOPE, 0.5 * math.pi * SLOPE),
        "steep": _power(3.4, 1e9, 1e9 * math.sqrt(math.pi) / 2 * 3.4 * math.gamma(1.7) / math.gamma(2.2)),
        "two parts": _power(0.6, 1e-2, 1e-2 * KAPPA_06),
        "punch": (rm.FlatPunch(B), JkrPunch(E, WORK, B)),
        "corner": (rm.TruncatedCone(SLOPE, B), JkrTruncatedCone(E, _flat_work(1.5), B, slope=SLOPE)),
        "two branches": (rm.TruncatedCone(SLOPE, B), JkrTruncatedCone(E, _flat_work(4.6), B, slope=SLOPE)),
        "outer fold": (rm.TruncatedCone(SLOPE, B), JkrTruncatedCone(E, _flat_work(6.0), B, slope=SLOPE)),
        "rounded_cone": (rm.RoundedCone(SLOPE, B), JkrRoundedCone(E, _flat_work(3.8), B, slope=SLOPE)),
        "long range": (rm.Paraboloid(R), _dugdale(0.2)),
        "middle range": (rm.Paraboloid(R), _dugdale(1.1)),
        "short range": (rm.Paraboloid(R), _dugdale(4.0)),
    }


TWINS = ("paraboloid", "cone", "steep", "two parts", "punch", "corner", "two branches", "outer fold", "rounded_cone")
TWINS_DUGDALE = ("long range", "middle range", "short range")


def numbers_of(curve: Jkr | DugdaleParaboloid) -> dict[str, object]:
    numbers: dict[str, object] = {"effective_modulus": curve.modulus, "work": curve.work}
    if isinstance(curve, DugdaleParaboloid):
        numbers |= {"adhesion": "dugdale", "strength": curve.strength}
    return numbers


def natural(shape: Shape, numbers: dict[str, object]) -> tuple[float, float]:
    """Pull-off force [N], and that over the indentation of detachment under fixed grips [N/m]."""
    force = float(rm.pull_off(shape, **numbers).force)
    return abs(force), force / float(rm.pull_off(shape, control="displacement", **numbers).indentation)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", TWINS + TWINS_DUGDALE)
def test_a_curve_looked_at_point_by_point_says_the_same(name: str) -> None:
    shape, curve = twins()[name]
    numbers = numbers_of(curve)
    force, k = natural(shape, numbers)
    for ratio in (1e-3, 0.04, 0.3, 1.0, 5.0, 200.0):
        held, spring = Held(curve, ratio * k), {**numbers, "machine_stiffness": ratio * k}
        size = force / k * max(1.0, 1.0 / ratio)
        least, state = held.detachment()
        off = rm.pull_off(shape, control="remote", **spring)
        assert float(off.remote) == pytest.approx(least, abs=2e-11 * size)
        assert float(off.force) == pytest.approx(float(state.force), abs=3e-5 * force)
        assert float(rm.indent(shape, remote=least - 1e-6 * size, **spring).force) == 0.0
        begin = -curve.work / curve.strength if isinstance(curve, DugdaleParaboloid) else 0.0
        remotes = np.array([*np.linspace(least + 1e-3 * size, 2.0 * size, 12), begin + 1e-9 * size])
        for approach in (False, True):
            found = rm.indent(shape, remote=remotes, approach=approach, **spring)
            for i, remote in enumerate(remotes):
                if approach and remote < begin:
                    assert float(found.force[i]) == float(found.contact_radius[i]) == 0.0
                    assert float(found.indentation[i]) == remote
                    continue
                exact = held.approached(remote) if approach else held.retracted(remote)
                assert float(found.force[i]) == pytest.approx(float(exact.force), abs=1e-9 * force), (ratio, remote)
                assert float(found.indentation[i]) == pytest.approx(float(exact.delta), abs=1e-9 * size)
                assert float(found.contact_radius[i]) == pytest.approx(float(exact.a), rel=1e-8)


@large_where_compiled
def test_where_the_stiffness_has_two_extremes_a_branch_has_two_parts_on_a_spring() -> None:
    """With tau^2 = a/a_c, k = 2 E* a (tau^0.2 - 3)/(tau^0.2 - 1): extremes at tau^0.2 = 1.9 -+ sqrt(0.61)."""
    shape, curve = twins()["two parts"]
    spring = {**numbers_of(curve)}
    u = 1.9 + math.sqrt(0.61) * np.array([-1.0, 1.0])
    peak, trough = 2.0 * E * curve.size * u**10 * (u - 3.0) / (u - 1.0)
    assert trough < peak < 0.0
    spring["machine_stiffness"] = math.sqrt(peak * trough)
    held = Held(curve, spring["machine_stiffness"])
    grid = np.geomspace(3.0, 2e4, 200001)
    top = float(held.remote(grid).max())
    remotes = top + abs(top) * np.array([-1e-2, -1e-5, 1e-5, 1e-2])
    found = rm.indent(shape, remote=remotes, approach=True, **spring)
    for i, remote in enumerate(remotes):
        exact = held.approached(remote)
        assert float(found.contact_radius[i]) == pytest.approx(float(exact.a), rel=1e-7)
    assert float(found.contact_radius[2]) > 100.0 * float(found.contact_radius[1])
    back = rm.indent(shape, remote=remotes, **spring)
    np.testing.assert_allclose(back.force[2:], found.force[2:], rtol=1e-9)
    assert (back.contact_radius[:2] > 100.0 * found.contact_radius[:2]).all()


@pytest.mark.parametrize("beyond", [1e-6, 1e-4, 1e-2])
def test_a_part_is_found_however_short_it_is(beyond: float) -> None:
    shape, curve = twins()["two parts"]
    contact = Contact.of(shape, E, Adhesion(WORK))
    u = 1.9 + math.sqrt(0.61) * np.array([-1.0, 1.0])
    peak, trough = -2.0 * E * curve.size * u**10 * (u - 3.0) / (u - 1.0)

    def parts(stiffness: float) -> int:
        return len(stable_parts(contact, spring(stiffness), branches_of(contact)[0]))

    assert [parts(peak * (1.0 + sign * beyond)) for sign in (-1.0, 1.0)] == [1, 2]
    assert [parts(trough * (1.0 + sign * beyond)) for sign in (-1.0, 1.0)] == [2, 1]


@large_where_compiled
@pytest.mark.few(1)
@pytest.mark.parametrize("name", TWINS + TWINS_DUGDALE)
def test_what_goes_out_comes_back(name: str) -> None:
    shape, curve = twins()[name]
    numbers = numbers_of(curve)
    force, k = natural(shape, numbers)
    for ratio in (0.02, 0.7, 30.0):
        spring = {**numbers, "machine_stiffness": ratio * k}
        off = rm.pull_off(shape, control="remote", **spring)
        size = force / k * max(1.0, 1.0 / ratio)
        remotes = np.concatenate([[float(off.remote)], np.linspace(float(off.remote) + 1e-3 * size, 3.0 * size, 9)])
        held = rm.indent(shape, remote=remotes, **spring)
        pulled = ratio * k * (remotes - held.indentation.to_numpy())
        np.testing.assert_allclose(held.force, pulled, rtol=0, atol=1e-12 * force * max(ratio, 1.0))
        assert float(held.force[0]) == float(off.force)
        assert float(held.indentation[0]) == float(off.indentation)
        if name not in ("two branches", "outer fold", "rounded_cone"):  # there grips may be on another branch
            grips = rm.indent(shape, indentation=held.indentation.to_numpy(), **numbers)
            np.testing.assert_allclose(grips.force.to_numpy()[1:], held.force.to_numpy()[1:], rtol=0, atol=1e-9 * force)
        for i, remote in enumerate(remotes):
            one = rm.indent(shape, remote=float(remote), **spring)
            assert one.force.dims == ()
            assert float(one.force) == pytest.approx(float(held.force[i]), abs=1e-14 * force)


@pytest.mark.few(6)
@pytest.mark.parametrize("name", TWINS + TWINS_DUGDALE)
def test_a_soft_spring_is_a_dead_load_and_a_stiff_one_fixed_grips(name: str) -> None:
    shape, curve = twins()[name]
    numbers = numbers_of(curve)
    _, k = natural(shape, numbers)
    for control, ratio in (("force", 1e-9), ("displacement", 1e13)):
        limit = rm.pull_off(shape, control=control, **numbers)
        off = rm.pull_off(shape, control="remote", machine_stiffness=ratio * k, **numbers)
        at = "force" if control == "force" else "indentation"
        assert float(off[at]) == pytest.approx(float(limit[at]), rel=1e-9)
        assert float(off.force) == pytest.approx(float(limit.force), rel=1e-5)


@pytest.mark.parametrize("stiffness", [1e-6, 1.0, 1e9])
def test_a_flat_punch_detaches_at_kendalls_point_from_any_spring(stiffness: float) -> None:
    off = rm.pull_off(rm.FlatPunch(B), effective_modulus=E, work=WORK, control="remote", machine_stiffness=stiffness)
    kendall = -math.sqrt(8.0 * math.pi * E * WORK * B**3)
    assert float(off.force) == pytest.approx(kendall, rel=1e-14)
    assert float(off.remote) == pytest.approx(kendall / (2.0 * E * B) + kendall / stiffness, rel=1e-14)


@settings(deadline=None, max_examples=60)
@given(
    radius=st.floats(-9.0, 0.5),
    modulus=st.floats(3.0, 12.0),
    work=st.floats(-6.0, 1.0),
    ratio=st.floats(-8.0, 10.0),
    part=st.floats(1e-6, 5.0),
)
def test_springs_and_tips_of_any_size(radius: float, modulus: float, work: float, ratio: float, part: float) -> None:
    tip, numbers = rm.Paraboloid(10.0**radius), {"effective_modulus": 10.0**modulus, "work": 10.0**work}
    force, k = natural(tip, numbers)
    spring = {**numbers, "machine_stiffness": k * 10.0**ratio}
    off = rm.pull_off(tip, control="remote", **spring)
    remote = (1.0 - part) * float(off.remote)
    held = rm.indent(tip, remote=remote, **spring)
    pulled = spring["machine_stiffness"] * (remote - float(held.indentation))
    assert float(held.force) == pytest.approx(pulled, abs=1e-11 * force * max(1.0, 10.0**ratio))
    assert float(held.stiffness) > -spring["machine_stiffness"]
    assert float(held.contact_radius) > float(off.contact_radius)
    past = rm.indent(tip, remote=(1.0 + part) * float(off.remote), **spring)
    assert float(past.force) == float(past.contact_radius) == float(past.contact_area) == 0.0
    assert float(past.indentation) == (1.0 + part) * float(off.remote)


@pytest.mark.parametrize("shape", [rm.Paraboloid(R), rm.FlatPunch(B), rm.TruncatedCone(SLOPE, B)], ids=str)
def test_without_adhesion_a_spring_only_shares_the_way(shape: Shape) -> None:
    remotes = np.array([3e-7, -1e-8, 0.0, 1e-60, 1e-9])
    numbers = {"effective_modulus": E, "machine_stiffness": 2.0}
    held = rm.indent(shape, remote=remotes, **numbers)
    assert held.identical(rm.indent(shape, remote=remotes, approach=True, **numbers))
    np.testing.assert_allclose(
        held.force, 2.0 * np.maximum(remotes - held.indentation.to_numpy(), 0.0), rtol=1e-9, atol=1e-75
    )
    grips = rm.indent(shape, effective_modulus=E, indentation=held.indentation.to_numpy())
    np.testing.assert_allclose(grips.force, held.force, rtol=1e-13)
    assert float(held.indentation[1]) == -1e-8
    off = rm.pull_off(shape, work=0.0, control="remote", **numbers)
    assert all(float(off[name]) == 0.0 for name in off.variables)
    assert "remote" in off.variables


def test_a_results_dimension_is_the_control() -> None:
    tip = rm.Paraboloid(R)
    held = rm.indent(tip, effective_modulus=E, work=WORK, remote=["1 nm", "-1 um", "0 nm"], machine_stiffness="3 N/m")
    assert held.sizes == {"remote": 3}
    assert set(held.coords) == {"remote"}
    assert set(held.data_vars) == {"force", "indentation", "contact_radius", "contact_area", "stiffness"}
    assert held.remote.attrs["units"] == "m"
    np.testing.assert_allclose(held.contact_area, math.pi * held.contact_radius.to_numpy() ** 2, rtol=1e-15)
    empty = rm.indent(tip, effective_modulus=E, work=WORK, remote=[], machine_stiffness=3.0)
    assert empty.sizes == {"remote": 0}
    off = rm.pull_off(tip, effective_modulus=E, work=WORK, control="remote", machine_stiffness=3.0)
    assert set(off.variables) == {"force", "indentation", "contact_radius", "remote"}
    assert off.force.attrs["long_name"].endswith("at the point of detachment on the spring")
    cohesive = rm.indent(
        tip, effective_modulus=E, work=WORK, remote=0.0, machine_stiffness=3.0, adhesion="dugdale", range="30 nm"
    )
    assert float(cohesive.cohesive_radius) > float(cohesive.contact_radius) > 0.0


def approach(shape: Shape, curve: Jkr | DugdaleParaboloid, **control: object) -> xr.Dataset:
    return rm.indent(shape, approach=True, **control, **numbers_of(curve))


@pytest.mark.parametrize("name", TWINS)
def test_jkr_has_no_contact_before_first_touch(name: str) -> None:
    shape, curve = twins()[name]
    _, k = natural(shape, numbers_of(curve))
    found = approach(shape, curve, indentation=[-1e-9, -5e-324, 0.0, -1e-7])
    assert (found.force.to_numpy()[[0, 1, 3]] == 0.0).all()
    assert (found.contact_radius.to_numpy() > 0.0).tolist() == [False, False, True, False]
    assert (approach(shape, curve, remote=-1e-12, machine_stiffness=k).force == 0.0).all()
    assert (approach(shape, curve, remote=0.0, machine_stiffness=k).contact_radius > 0.0).all()


@pytest.mark.parametrize("name", ["two branches", "outer fold", "rounded_cone"])
def test_an_approach_skips_an_inner_branch_that_ends_before_first_touch(name: str) -> None:
    """On the first stable root from a = 0 up, by a look at all radii."""
    shape, curve = twins()[name]
    numbers = numbers_of(curve)
    state = curve.at(curve.grid)
    rises = np.diff(state.delta) > 0.0
    depth = float(rm.pull_off(shape, control="displacement", **numbers).indentation)
    indentations = -depth * np.array([-0.5, -1e-9, 0.0, 0.3, 2.0])
    found = rm.indent(shape, approach=True, indentation=indentations, **numbers)
    assert (found.force[:2] == 0.0).all()
    assert (found.contact_radius[:2] == 0.0).all()
    assert (rm.indent(shape, indentation=indentations[:2], **numbers).contact_radius > 0.0).all()
    for i, wanted in list(enumerate(indentations))[2:]:
        first = int(np.argmax(rises & (state.delta[1:] >= wanted)))
        assert float(found.contact_radius[i]) == pytest.approx(state.a[first], rel=2e-3)
        assert float(found.force[i]) == pytest.approx(state.force[first], abs=5e-3 * np.abs(state.force[:20000]).max())


@pytest.mark.parametrize("name", TWINS_DUGDALE)
def test_dugdale_attracts_from_its_range_on(name: str) -> None:
    shape, curve = twins()[name]
    gap = WORK / curve.strength
    state = curve.at(curve.grid)
    indentations = np.array([-1.0001 * gap, -0.9999 * gap, -0.5 * gap, 0.0, 2.0 * gap])
    found = approach(shape, curve, indentation=indentations)
    assert float(found.cohesive_radius[0]) == float(found.force[0]) == 0.0
    for i, wanted in list(enumerate(indentations))[1:]:
        stiff = Held(curve, 1e30)
        exact = stiff.approached(wanted)
        assert float(found.force[i]) == pytest.approx(float(exact.force), rel=1e-10)
    assert float(found.cohesive_radius[1]) > 0.0
    assert state.delta.min() < -gap  # so that it jumps


@large_where_compiled
def test_a_tip_that_is_steep_is_attracted_without_a_jump_by_grips_but_not_by_a_soft_spring() -> None:
    tip, strength = rm.Cone(SLOPE), 1e5
    assert 4.0 * strength / (math.pi * E) < SLOPE
    gap = WORK / strength
    numbers = {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": strength}
    force, k = natural(tip, {**numbers})
    indentations = np.linspace(-1.1 * gap, 2.0 * gap, 32)
    grips = rm.indent(tip, indentation=indentations, approach=True, **numbers)
    back = rm.indent(tip, indentation=indentations, **numbers)
    np.testing.assert_allclose(grips.force, back.force, rtol=1e-13, atol=1e-13 * force)
    near = {"remote": -gap * (1.0 - 1e-9), "approach": True, **numbers}
    assert abs(float(rm.indent(tip, machine_stiffness=100.0 * abs(k), **near).force)) < 1e-6 * force
    assert abs(float(rm.indent(tip, machine_stiffness=1e-3 * abs(k), **near).force)) < 1e-6 * force
    jumped = rm.indent(tip, machine_stiffness=1e-4 * abs(k), remote=-0.999 * gap, approach=True, **numbers)
    assert float(jumped.contact_radius) > 0.0


@pytest.mark.few(5)
@pytest.mark.parametrize("name", TWINS + TWINS_DUGDALE)
def test_a_load_of_an_approach_is_reached_at_the_first_indentation(name: str) -> None:
    shape, curve = twins()[name]
    numbers = numbers_of(curve)
    scale, _ = natural(shape, numbers)
    forces = scale * np.array([0.0, 1e-3, 0.4, 30.0])
    found = approach(shape, curve, force=forces)
    np.testing.assert_array_equal(found.force, forces)
    begin = -curve.work / curve.strength if isinstance(curve, DugdaleParaboloid) else 0.0
    path = np.linspace(begin - 1e-6 * abs(begin), 1.5 * float(found.indentation[-1]), 4000)
    law = rm.indent(shape, approach=True, indentation=path, **numbers).force.to_numpy()
    for i, force in enumerate(forces):
        reached = np.flatnonzero((law >= force) & ((force > 0.0) | (path > begin + 1e-3 * abs(begin) * (begin < 0.0))))[
            0
        ]
        step = path[1] - path[0]
        assert path[reached] - 1.001 * step <= float(found.indentation[i]) <= path[reached] + 1e-9 * step
        grips = approach(shape, curve, indentation=float(found.indentation[i]))
        assert float(grips.force) == pytest.approx(force, abs=1e-9 * scale)
    if name not in ("two branches", "outer fold", "rounded_cone", "two parts"):
        back = rm.indent(shape, force=forces, **numbers)
        for quantity in ("indentation", "contact_radius", "stiffness"):
            np.testing.assert_allclose(found[quantity], back[quantity], rtol=1e-9)


TIP = {"effective_modulus": E, "work": WORK}


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"remote": 0.0}, "machine_stiffness is missing; remote needs it"),
        ({"indentation": 0.0, "machine_stiffness": 1.0}, "machine_stiffness goes with remote only"),
        ({"remote": 0.0, "indentation": 0.0, "machine_stiffness": 1.0}, "indentation and remote"),
        ({"remote": 0.0, "machine_stiffness": 0.0}, "machine_stiffness is 0"),
        ({"remote": 0.0, "machine_stiffness": "soft"}, "machine_stiffness is 'soft'"),
        ({"remote": 0.0, "machine_stiffness": 1e200}, "machine_stiffness is 1e.200.*natural stiffness"),
        ({"remote": [0.0, math.nan], "machine_stiffness": 1.0}, "remote is nan"),
        ({"force": [1.0, -2e-9], "approach": True}, r"force is -2e-09 N; on approach it must be at least 0 N"),
        ({"contact_radius": 1e-9, "approach": True}, "approach is True; with contact_radius"),
        ({"indentation": 0.0, "approach": "yes"}, "approach is 'yes'; it must be True or False"),
        ({"indentation": 0.0, "approach": True, "method": "springs", "springs": 100}, "approach is True; with method"),
        (
            {"remote": 0.0, "machine_stiffness": 1.0, "method": "springs", "springs": 100},
            "remote is given; with",
        ),
    ],
)
def test_what_is_refused(given: dict[str, object], message: str) -> None:
    with pytest.raises(rm.RoughmdrError, match=message):
        rm.indent(rm.Paraboloid(R), **TIP, **given)


def test_pull_off_takes_a_stiffness_with_remote_alone() -> None:
    with pytest.raises(rm.RoughmdrError, match="machine_stiffness is missing"):
        rm.pull_off(rm.Paraboloid(R), control="remote", **TIP)
    with pytest.raises(rm.RoughmdrError, match="machine_stiffness goes with remote only"):
        rm.pull_off(rm.Paraboloid(R), machine_stiffness=1.0, **TIP)
