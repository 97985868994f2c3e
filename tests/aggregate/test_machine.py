"""The flat on a machine: single contacts against closed forms, ensembles against a slow and plain twin."""

import math
from itertools import pairwise

import numba
import numpy as np
import pytest
import xarray as xr
from forms import large, large_where_compiled
from hypothesis import given, settings, strategies as st
from mpmath import mp, mpf
from twins.machine_path import BruteForce

import roughmdr as rm

UNITS = [(1.0, 1.0, 1.0 / (2.0 * math.pi)), (2e-5, 3e6, 0.05), (3.0, 2e9, 40.0)]
"""R [m], E* [Pa] and w [J/m2]; the first makes a0 = d0 = 1."""


def asperities(height, radius) -> xr.Dataset:
    height, radius = np.broadcast_arrays(np.atleast_1d(height).astype(float), np.atleast_1d(radius).astype(float))
    arrays = {"height": ("asperity", height, {"units": "m"}), "radius": ("asperity", radius, {"units": "m"})}
    return xr.Dataset(arrays, attrs={"shape": "paraboloid"})


def scales(radius: float, modulus: float, work: float) -> tuple[float, float, float]:
    """a0 and d0 [m] with a0^3 = 2 pi w R^2/E*, and the force 2 E* a0 d0 [N]."""
    a0 = float(np.cbrt(2.0 * math.pi * work * radius**2 / modulus))
    d0 = a0**2 / radius
    return a0, d0, 2.0 * modulus * a0 * d0


def fold(kappa: float) -> tuple[float, float, float]:
    """X/d0, h/d0 and F/(2 E* a0 d0) where one contact on a spring lets go: 4 t^5 + 4 kappa t^3 - 3 t^2 - kappa = 0."""
    with mp.workdps(40):
        k = mpf(kappa)
        t = mp.findroot(lambda t: 4 * t**5 + 4 * k * t**3 - 3 * t**2 - k, (mpf("0.6"), mpf("0.95")), solver="anderson")
        h, force = t - t**4, mpf(2) / 3 * t**6 - t**3
        return float(h - force / k), float(h), float(force)


def test_the_fold_in_the_units_of_the_contact() -> None:
    assert fold(1.0) == pytest.approx((0.736965161821414, 0.429471301717, -0.307493860104), abs=1e-12)


@pytest.mark.few(12)
@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
@pytest.mark.parametrize("kappa", np.geomspace(1e-4, 1e4, 20))
def test_one_contact_on_a_spring_lets_go_at_the_fold_of_both(radius, modulus, work, kappa) -> None:
    a0, d0, load = scales(radius, modulus, work)
    stiffness, (at, h, force) = 2.0 * modulus * a0 * kappa, fold(kappa)
    remote = d0 * np.array([0.0, at - 1e-10 * abs(at), at + 1e-10 * abs(at)])
    found = rm.load_separation(
        asperities(0.0, radius), remote=remote, machine_stiffness=stiffness, effective_modulus=modulus, work=work
    )
    np.testing.assert_array_equal(found.contact_count, [1.0, 1.0, 0.0])
    # 1e-10 before the fold the contact is the root of that before it, by whatever the two curvatures are.
    assert float(found.force[1]) / load == pytest.approx(force, abs=1e-4)
    assert float(found.separation[1]) / d0 == pytest.approx(h, abs=1e-4)
    assert float(found.separation[2]) == remote[2]
    np.testing.assert_allclose(
        found.force, stiffness * (found.separation - found.remote), atol=1e-12 * load + 1e-15 * stiffness * d0
    )


@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
def test_the_limits_of_the_spring_are_dead_load_and_fixed_grips(radius, modulus, work) -> None:
    force = math.pi * work * radius
    assert fold(1e-9)[2] == pytest.approx(-1.5 / 4.0, rel=1e-7)  # over 2 E* a0 d0 = 4 pi w R
    assert fold(1e9)[2] == pytest.approx(-5.0 / 6.0 / 4.0, rel=1e-4)
    loads = np.array([0.0, -1.5 * force * (1.0 - 1e-12), -1.5 * force * (1.0 + 1e-12), 0.0])
    found = rm.load_separation(asperities(0.0, radius), force=loads, effective_modulus=modulus, work=work)
    np.testing.assert_array_equal(found.contact_count, [1.0, 1.0, 0.0, 1.0])
    assert np.isnan(found.separation.values).tolist() == [False, False, True, False]


@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
def test_a_cycle_of_one_contact_on_a_spring_loses_the_energy_of_its_two_jumps(radius, modulus, work) -> None:
    a0, d0, load = scales(radius, modulus, work)
    found = rm.load_separation(
        asperities(0.0, radius),
        remote=d0 * np.linspace(1.0, -1.0, 7),
        machine_stiffness=2.0 * modulus * a0,
        effective_modulus=modulus,
        work=work,
        unload=True,
        variables=("energy", "dissipated_energy", "machine_dissipated_energy"),
    )
    lost = found.dissipated_energy.values[-1] / (load * d0)
    assert lost == pytest.approx(0.240488279597161, rel=1e-12)
    on, off = 0.6 / 4.0, 0.4 * 4.0 ** (-4.0 / 3.0) / 4.0  # pi w a0^2 is a quarter of 2 E* a0 d0^2
    assert lost - found.machine_dissipated_energy.values[-1] / (load * d0) == pytest.approx(on + off, rel=1e-12)


def test_a_flat_punch_lets_go_at_the_load_of_kendall() -> None:
    radius, modulus, work = 2e-6, 5e6, 0.03
    load = math.sqrt(8.0 * math.pi * modulus * work * radius**3)
    punch = xr.Dataset(
        {"height": ("asperity", [1e-7]), "radius": ("asperity", [radius])}, attrs={"shape": "flat_punch"}
    )
    material = {"effective_modulus": modulus, "work": work}
    held = rm.load_separation(punch, force=[0.0, -load * (1.0 - 1e-12), -load * (1.0 + 1e-12)], **material)
    np.testing.assert_array_equal(held.contact_count, [1.0, 1.0, 0.0])
    for ratio in (0.01, 1.0, 100.0):  # a punch is linear: with a spring in series it lets go at the same load
        stiffness = ratio * 2.0 * modulus * radius
        at = 1e-7 + load / (2.0 * modulus * radius) + load / stiffness
        found = rm.load_separation(
            punch,
            remote=[0.0, at - 1e-9 * load / stiffness, at + 1e-9 * load / stiffness],
            machine_stiffness=stiffness,
            **material,
        )
        np.testing.assert_array_equal(found.contact_count, [1.0, 1.0, 0.0])
        assert float(found.force[1]) == pytest.approx(-load, rel=1e-8)


def compare(height, radius, modulus, work, stiffness, controls) -> None:
    """Compare a path with the slow and plain one: dead loads where the stiffness is 0, else positions of its end."""
    machine = {"force": controls} if stiffness == 0.0 else {"remote": controls, "machine_stiffness": stiffness}
    found = rm.load_separation(asperities(height, radius), effective_modulus=modulus, work=work, **machine)
    twin = BruteForce(np.asarray(height), np.asarray(radius), modulus, work, stiffness)
    separation, force, count = twin.follow(-controls if stiffness == 0.0 else controls)
    held = np.isfinite(separation)
    np.testing.assert_array_equal(np.isfinite(found.separation), held)
    np.testing.assert_array_equal(found.contact_count, count)
    _, d0, load = zip(*(scales(each, modulus, work) for each in radius), strict=True)
    np.testing.assert_allclose(found.separation.values[held], separation[held], rtol=0.0, atol=1e-9 * min(d0))
    np.testing.assert_allclose(
        found.force.values[held], force[held], rtol=0.0, atol=1e-9 * max(sum(load), np.abs(force).max())
    )


@pytest.mark.large
@pytest.mark.parametrize("ratio", [0.0, large(0.02), 0.5, large(20.0)])
@pytest.mark.parametrize("height", [large([0.0, 0.0]), [0.0, -0.3], [0.2, 0.0, -1.5]])
def test_two_and_three_contacts_on_nested_loops(height, ratio) -> None:
    radius, modulus, work = 1e-5, 4e6, 0.05
    a0, d0, load = scales(radius, modulus, work)
    stiffness = ratio * 2.0 * modulus * a0 * len(height)
    turns = np.array([1.0, -1.0, 0.6, -0.4, 0.3, -2.0, 2.5]) * (d0 if ratio else load)
    turns = turns if ratio else -turns[1:]
    if ratio:
        turns = turns * (1.0 + 0.3 / ratio)
    controls = np.concatenate([np.linspace(a, b, 9)[:-1] for a, b in pairwise(turns)])
    compare(d0 * np.array(height), np.full(len(height), radius), modulus, work, stiffness, controls)


def random_paths(data) -> tuple:
    seed = data.draw(st.integers(0, 2**31), label="seed")
    rng = np.random.default_rng(seed)
    count, modulus, work = int(rng.integers(1, 9)), 10.0 ** rng.uniform(0, 9), 10.0 ** rng.uniform(-3, 1)
    radius = 10.0 ** rng.uniform(-6, 0) * rng.uniform(0.5, 2.0, count)
    a0, d0, load = np.array([scales(each, modulus, work) for each in radius]).T
    height = rng.normal(0.0, 10.0 ** rng.uniform(-1, 1), count) * d0.mean()
    if rng.random() < 0.3:
        turns, stiffness = np.append(0.0, rng.uniform(-0.5, 3.0, 4)) * load.sum(), 0.0
    else:
        stiffness = float(2.0 * modulus * a0.sum() * 10.0 ** rng.uniform(-2, 2))
        way = load.sum() / stiffness
        low, high = height.min() - 2.0 * d0.mean() - way, height.max() + d0.mean()
        turns = np.append(high, rng.uniform(low, high + 0.3 * way, 4))
    controls = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in pairwise(turns)])
    return height, radius, modulus, work, stiffness, controls


@large_where_compiled
@given(st.data())
@settings(deadline=None, max_examples=1, derandomize=True)
def test_random_ensembles_follow_the_slow_and_plain_path(data) -> None:
    compare(*random_paths(data))


@pytest.mark.large
@given(st.data())
@settings(deadline=None, max_examples=15)
def test_many_random_ensembles_follow_the_slow_and_plain_path(data) -> None:
    compare(*random_paths(data))


SECTION = {
    "source": "random",
    "shape": "paraboloid",
    "count": 200,
    "patch": "300 um",
    "radius": "5 um",
    "height": {"distribution": "normal", "std": "0.3 um"},
}


@pytest.mark.parametrize("control", ["force", "remote"])
@pytest.mark.parametrize("work", [0.0, 0.05])
def test_more_steps_on_a_leg_change_no_bit(control, work) -> None:
    ensemble, material = rm.generate(SECTION, seed=3), {"effective_modulus": 1e7, "work": work}
    machine = {"machine_stiffness": 2e3} if control == "remote" else {}
    turns = [1.5e-6, -1e-6, 0.5e-6, -0.2e-6, 2e-6] if control == "remote" else [0.0, 2e-3, -1e-4, 1e-3, -5e-3]
    every = np.concatenate([np.linspace(a, b, 13)[:-1] for a, b in pairwise(turns)] + [turns[-1:]])
    some = np.unique(np.concatenate([np.arange(0, every.size, 4), np.arange(0, every.size, 12)]))
    few, many = (
        rm.load_separation(ensemble, **{control: steps}, **machine, **material) for steps in (every[some], every)
    )
    for name in ("separation", "contact_area", "stiffness"):
        np.testing.assert_array_equal(few[name], many[name][some])


def test_after_a_nested_loop_all_is_as_before() -> None:
    ensemble = rm.generate(SECTION, seed=4)
    down, back, inner = np.linspace(1.5e-6, -1e-6, 11), 0.4e-6, np.array([0.9e-6, 0.2e-6, 0.7e-6])
    unloading = np.linspace(-1e-6, back, 5)
    steps = np.concatenate([down, unloading, inner[:1] * 0.0 - 0.3e-6, [back]])  # down and back up to the same place
    found = rm.load_separation(
        ensemble,
        remote=steps,
        machine_stiffness=2e3,
        effective_modulus=1e7,
        work=0.05,
        variables=("contact_count", "contact_area"),
    )
    for name in ("separation", "force", "contact_count", "contact_area"):
        assert found[name].values[-1] == pytest.approx(found[name].values[-3], rel=1e-12)


@pytest.mark.parametrize("kind", ["paraboloid", "cone", large("sphere"), "power_law"])
@pytest.mark.parametrize("scale", [1.0, 1e-7])
def test_the_separation_at_a_force_is_the_inverse_of_the_force_at_a_separation(kind, scale) -> None:
    parameters = {
        "paraboloid": {"radius": 3.0 * scale},
        "cone": {"slope": 0.2},
        "sphere": {"radius": 5.0 * scale},
        "power_law": {"exponent": 1.5, "width": scale, "rise": 0.1 * scale},
    }[kind]
    height = scale * np.array([0.11, 0.05, 0.04, 0.0, -0.3])
    arrays = {name: ("asperity", np.full(5, value)) for name, value in parameters.items()}
    ensemble = xr.Dataset({"height": ("asperity", height), **arrays}, attrs={"shape": kind})
    separation = scale * np.linspace(0.1, -0.4, 23)
    force = rm.load_separation(ensemble, separation=separation, effective_modulus=7e5).force
    found = rm.load_separation(ensemble, force=force.values, effective_modulus=7e5)
    touch_depth = height[0] - separation
    assert (np.abs(found.separation.values - separation) <= 1e-12 * touch_depth + 1e-15 * scale).all()


def test_pressure_is_force_over_the_nominal_area() -> None:
    ensemble = rm.generate(SECTION, seed=5)
    area = float(ensemble.attrs["nominal_area"])
    by_pressure = rm.load_separation(ensemble, pressure=["1 kPa", "5 kPa"], effective_modulus=1e7, work=0.05)
    by_force = rm.load_separation(ensemble, force=np.array([1e3, 5e3]) * area, effective_modulus=1e7, work=0.05)
    np.testing.assert_array_equal(by_pressure.separation, by_force.separation)
    assert list(by_pressure.pressure.values) == [1e3, 5e3]
    with pytest.raises(rm.SceneError, match="nominal_area is missing; pressure needs it"):
        rm.load_separation(asperities(0.0, 1e-6), pressure=[1e3], effective_modulus=1e7)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "got none; load_separation takes exactly one of separation, force, pressure, remote"),
        ({"force": [1.0], "remote": [0.0]}, "got force and remote"),
        ({"remote": [0.0]}, "machine_stiffness is missing; remote needs it"),
        ({"force": [1.0], "machine_stiffness": 1.0}, "machine_stiffness goes with remote or a preload only"),
        ({"remote": [0.0], "machine_stiffness": 0.0}, "machine_stiffness is 0 N/m"),
        ({"force": []}, "force is empty"),
        ({"force": [math.nan]}, "force is nan; it must be finite"),
    ],
)
def test_a_machine_that_is_not_one_is_refused(arguments, message) -> None:
    with pytest.raises(rm.RoughmdrError, match=message):
        rm.load_separation(asperities(0.0, 1.0), effective_modulus=1.0, **arguments)


PRELOADS = {"preload": ("force", 2e-4), "preload_pressure": ("pressure", 3e3), "preload_contact_fraction": (None, 2e-3)}


@pytest.mark.few(8)
@pytest.mark.parametrize("name", PRELOADS)
@pytest.mark.parametrize("stiffness", [None, 2e3, 20.0])
@pytest.mark.parametrize("work", [0.0, 0.05])
def test_a_preload_is_reached_first_at_the_turning_point_and_all_detach_after_it(name, stiffness, work) -> None:
    ensemble, (control, value) = rm.generate(SECTION, seed=6), PRELOADS[name]
    material = {"effective_modulus": 1e7, "work": work}
    spring = {} if stiffness is None else {"machine_stiffness": stiffness}
    found = rm.load_separation(
        ensemble,
        **{name: value},
        **spring,
        **material,
        steps=30,
        unload=True,
        variables=("pressure", "contact_fraction", "contact_count"),
    )
    np.testing.assert_array_equal(found.travel, np.r_[np.linspace(0.0, 1.0, 30), np.linspace(0.0, 1.0, 30)[::-1]])
    assert found.contact_count.values[[0, -1]].tolist() == [0.0, 0.0]
    assert np.isfinite(found.pull_off_force)
    reached = {"force": found.force, "pressure": found.pressure, None: found.contact_fraction}[control]
    if control is not None:
        assert float(reached[29]) == pytest.approx(value, rel=1e-12)
        loaded = rm.load_separation(ensemble, **{control: [value]}, **material)
        assert float(found.separation[29]) == pytest.approx(float(loaded.separation[0]), rel=1e-13)
    else:  # it may be stepped over where a contact is made, never reached before
        higher = float(found.separation[29]) + 1e-13
        above = rm.load_separation(ensemble, separation=[higher], variables="contact_fraction", **material)
        assert float(above.contact_fraction[0]) < value <= float(reached[29])
        assert float(reached[29]) < 1.1 * value
    if stiffness is not None:
        np.testing.assert_allclose(
            found.force, stiffness * (found.separation - found.remote), atol=1e-12 * float(found.force.max())
        )


def test_a_preload_without_a_spring_is_the_path_of_those_separations() -> None:
    ensemble, material = rm.generate(SECTION, seed=7), {"effective_modulus": 1e7, "work": 0.05}
    found = rm.load_separation(ensemble, preload="0.2 mN", steps=40, unload=True, **material)
    same = rm.load_separation(ensemble, separation=found.separation.values, **material)
    for name in ("force", "contact_area", "stiffness", "pull_off_force"):
        np.testing.assert_array_equal(found[name], same[name])


@pytest.mark.large
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="it takes minutes")
@pytest.mark.parametrize("model", ["pairwise", "mean_field"])
def test_asperities_that_feel_each_other_are_loaded_to_the_same_preload(model) -> None:
    ensemble = rm.generate({**SECTION, "placement": "random"}, seed=8)
    material = {"effective_modulus": 1e7, "interaction": model}
    found = rm.load_separation(ensemble, preload=2e-4, machine_stiffness=1e3, steps=12, **material)
    assert float(found.force[-1]) == pytest.approx(2e-4, rel=1e-6)  # the error that pairs are solved to
    loaded = rm.load_separation(ensemble, force=[2e-4], **material)
    assert float(found.separation[-1]) == pytest.approx(float(loaded.separation[0]), rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"preload": 1e-3, "force": [1.0]}, "got force and preload"),
        ({"preload": -1.0}, "preload is -1 N; it must be a finite number above 0 N"),
        ({"preload": 1e-3, "steps": 1}, "steps is 1; it must be a whole number from 2 to 10000000"),
        ({"force": [1.0], "steps": 9}, "steps goes with a preload only; force holds its own"),
        ({"preload_pressure": 1e3}, "nominal_area is missing; preload_pressure needs it"),
    ],
)
def test_a_preload_that_is_none_is_refused(arguments, message) -> None:
    with pytest.raises(rm.RoughmdrError, match=message):
        rm.load_separation(asperities(0.0, 1.0), effective_modulus=1.0, **arguments)


def test_more_contact_fraction_than_there_is_patch_is_refused() -> None:
    with pytest.raises(rm.OutOfRange):
        rm.load_separation(rm.generate(SECTION, seed=6), preload_contact_fraction=1.5, effective_modulus=1e7)
