"""The pull-off of ensembles: against the plain way, a force at every detachment and at many separations between."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import WIDER_SHAPES, detachment_depths, ensemble

import roughmdr as rm
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import unloadings
from roughmdr.loading.staircase import risen, staircase

E, W = 4e6, 0.05
b = 2e-6
COLUMNS: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": (3e-5, 8e-5)},
    "cone": {"slope": (0.1, 0.2)},
    "power_law": {"exponent": (1.2, 4.0), "rise": (1e-7, 3e-7), "width": (1e-6, 3e-6)},
    **WIDER_SHAPES,
}
CASES = [(kind, {}) for kind in COLUMNS] + [("paraboloid", {"adhesion": "dugdale", "strength": 2e5})]
FINE = np.linspace(0.0, 1.0, 120)[1:-1]


def plain(asperities: xr.Dataset, path: np.ndarray, law: dict[str, Any]) -> float:
    """The largest tension of all rises of the flat along a path."""
    off, lowest = asperities.height.to_numpy() + detachment_depths(asperities, **law), 0.0
    rises = [i for i in range(1, path.size) if path[i] > path[i - 1]]
    for i in rises:
        low, high = path[i - 1], path[i]
        inside = np.sort(off[(off > low) & (off < high)])
        ends = np.concatenate([[low], inside, [high]])
        tiny = 4.0 * np.spacing(np.abs(path).max())
        points = [np.array([ends[1:] - tiny, ends[:-1] + tiny]).ravel(), [high]]
        points += [q - (q - p) * FINE * FINE for p, q in pairwise(ends)]
        for _ in range(4):
            more = np.unique(np.concatenate(points))
            more = more[(more > low) & (more <= high)]
            curve = rm.load_separation(asperities, separation=[*path[:i], *more], variables="force", **law)
            force = curve.force.to_numpy()[i:]
            best = int(np.argmin(force))
            lowest = min(lowest, float(force[best]))
            points = [np.linspace(more[max(best - 1, 0)], more[min(best + 1, more.size - 1)], 40)]
    return lowest


def rough(kind: str, count: int, seed: int, std: float = 1e-7) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    columns = {name: rng.uniform(*ends, count) for name, ends in COLUMNS[kind].items()}
    return ensemble(rng.normal(0.0, std, count), shape=kind, **columns)


@pytest.mark.few(3)
@pytest.mark.filterwarnings("ignore::roughmdr.errors.LimitWarning")
@pytest.mark.parametrize(("kind", "extra"), CASES, ids=lambda each: each if isinstance(each, str) else "".join(each))
@pytest.mark.parametrize(("count", "steps"), [(1, 3), large(2, 6), (7, 9), large(25, 40)])
def test_it_is_that_of_the_plain_way(kind: str, extra: dict[str, Any], count: int, steps: int) -> None:
    law: dict[str, Any] = {"effective_modulus": E, "work": W, **extra}
    for seed in range(3):
        asperities = rough(kind, count, seed)
        off = asperities.height.to_numpy() + detachment_depths(asperities, **law)
        loading = np.linspace(off.max() * 1.1 + 1e-7, float(asperities.height.min()) - 1e-7, steps)
        found = rm.load_separation(asperities, separation=loading, unload=True, **law)
        path = np.concatenate([loading, loading[::-1]])
        exact = plain(asperities, path, law)
        assert exact < 0.0
        assert float(found.pull_off_force) == pytest.approx(exact, rel=1e-6)
        there = rm.load_separation(asperities, separation=[loading[-1], float(found.pull_off_separation)], **law)
        assert float(there.force[-1]) == float(found.pull_off_force)
        assert float(there.contact_count[-1]) == float(found.pull_off_contacts)
        assert float(there.contact_area[-1]) == float(found.pull_off_contact_area)


def test_of_one_paraboloid_it_is_that_of_jkr() -> None:
    for steps in (2, 3, 20, 200):
        path = np.linspace(1e-6, -2e-6, steps)
        curve = rm.load_separation(
            ensemble([0.0], radius=5e-5), separation=path, unload=True, effective_modulus=E, work=W
        )
        assert float(curve.pull_off_force) == pytest.approx(-1.5 * math.pi * W * 5e-5, rel=1e-7)
        exact = rm.pull_off(rm.Paraboloid(5e-5), effective_modulus=E, work=W)
        assert float(curve.pull_off_force) == pytest.approx(float(exact.force), rel=1e-7)


@pytest.mark.few(1)
@pytest.mark.parametrize("count", [1, 6, 40])
def test_of_several_unloadings_it_is_the_largest(count: int) -> None:
    law: dict[str, Any] = {"effective_modulus": E, "work": W}
    rng = np.random.default_rng(3)
    for seed in range(4):
        asperities = rough("paraboloid", count, seed)
        z = asperities.height.to_numpy()
        top, low = (z + detachment_depths(asperities, **law)).max() + 1e-8, z.min() - 3e-7
        turns = rng.uniform(low, top, 7)
        path = np.unique(np.round(turns, 12))[rng.permutation(np.unique(np.round(turns, 12)).size)]
        path = np.concatenate([[top], path, [low, top]])
        found = rm.load_separation(asperities, separation=path, **law)
        assert float(found.pull_off_force) == pytest.approx(plain(asperities, path, law), rel=1e-6)


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_it_does_not_depend_on_the_unit_of_length(unit: float) -> None:
    forces = []
    for scale in (1.0, unit):
        one = rough("paraboloid", 30, 5)
        asperities = ensemble(one.height * scale, area=1e-4 * scale**2, radius=one.radius * scale)
        path = np.linspace(3e-6, -5e-7, 25) * scale
        curve = rm.load_separation(asperities, separation=path, unload=True, effective_modulus=E, work=W * scale)
        forces.append(float(curve.pull_off_force) / scale**2)
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)


def test_a_thousand_asperities_many_of_which_detach_within_a_step() -> None:
    rng = np.random.default_rng(8)
    asperities = ensemble(rng.normal(0.0, 3e-7, 1000), radius=rng.uniform(3e-5, 8e-5, 1000))
    law: dict[str, Any] = {"effective_modulus": E, "work": W}
    forces = []
    for steps in (8, 60, 900):
        path = np.linspace(3e-6, -1e-6, steps)
        forces.append(float(rm.load_separation(asperities, separation=path, unload=True, **law).pull_off_force))
    np.testing.assert_allclose(forces, min(forces), rtol=1e-6)


def test_an_unloading_that_ends_in_contact_has_none() -> None:
    asperities = rough("paraboloid", 20, 1)
    law: dict[str, Any] = {"effective_modulus": E, "variables": "force"}
    ends = {"in contact": [3e-6, -1e-7, 1e-8], "loading": [3e-6, 0.0]}
    stopped = rm.load_separation(asperities, separation=ends["in contact"], work=W, **law)
    assert np.isnan([stopped.pull_off_force, stopped.pull_off_separation, stopped.pull_off_contacts]).all()
    assert "pull_off_force" not in rm.load_separation(asperities, separation=ends["loading"], work=W, **law)
    again = rm.load_separation(asperities, separation=[*ends["in contact"], -2e-7, 3e-6, 0.0], work=W, **law)
    assert float(again.pull_off_force) < 0.0  # the second ends out of contact
    parted = rm.load_separation(asperities, separation=[3e-6, 0.0, 3e-6], work=0.0, **law)
    assert float(parted.pull_off_force) == 0.0
    assert np.isnan(parted.pull_off_separation)
    pressed = rm.load_separation(asperities, separation=[3e-6, -1e-6, 0.0], work=0.0, **law)
    assert np.isnan(pressed.pull_off_force)
    never = rm.load_separation(asperities, separation=[3e-6, 2e-6, 3e-6], work=W, **law)
    assert float(never.pull_off_force) == 0.0


@settings(deadline=None, max_examples=200)
@given(st.lists(st.integers(-20, 20), min_size=2, max_size=12), st.lists(st.integers(1, 60), min_size=1, max_size=6))
def test_a_rise_by_turning_points_remembers_what_the_whole_path_does(steps: list[int], rises: list[int]) -> None:
    path = np.array([*steps, *np.sort(rises) * 0.37 + min(steps[-1], 20)], dtype=float)
    path = path[np.append(True, np.diff(path) != 0.0)]
    whole = LoadingPath.along(path, unload=False, adhesive=True)
    for rise in unloadings(path, np.zeros(path.size)):
        found = rise.path(rise.separation[1:])
        expected = staircase(found.separation)
        for one, other in zip(found.memory, expected, strict=True):
            np.testing.assert_array_equal(one, other)
        begin, count = rise.last - rise.separation.size + 2, rise.separation.size - 1
        for k in range(count):
            mine = slice(*found.memory.first[rise.turns.size + k : rise.turns.size + k + 2])
            theirs = slice(*whole.memory.first[begin + k : begin + k + 2])
            np.testing.assert_array_equal(found.memory.bottom[mine], whole.memory.bottom[theirs])
            np.testing.assert_array_equal(found.memory.top[mine], whole.memory.top[theirs])
    assert risen(np.array([2.0]), np.array([3.0])).top.tolist() == [2.0, 3.0]
