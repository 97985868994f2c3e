"""Contacts near to each other, and flanks of buried summits within a contact: what they cost, and that it is told."""

import math
import warnings
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES, ensemble

import roughmdr as rm
from roughmdr.elements.path import solve_on_grid
from roughmdr.elements.surface import surface_of_asperities
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction import totals
from roughmdr.interaction.buried import buried
from roughmdr.interaction.neighbours import within_reach
from roughmdr.interaction.totals import crowding

POINTS = 192


def errors(asperities: xr.Dataset, h: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """The true error of the force of pairs, by boundary elements without the error of their grid, and the stated."""
    coupling: dict[str, Any] = {"model": "pairwise", "order": order}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        pairs = rm.load_separation(
            asperities, separation=h, effective_modulus=1e9, interaction=coupling,
            variables=["force", "model_error_curve"],
        )  # fmt: skip
    surface = surface_of_asperities(Ensemble.from_dataset(asperities), float(h.min()), periodic=True)
    fine, coarse = (
        np.array([step.force for step in solve_on_grid(surface, h, 1e9, (n, n), stiffness=False).steps])
        for n in (POINTS, POINTS // 2)
    )
    exact = fine + (fine - coarse) / 3.0
    return np.abs(pairs.force.values / exact - 1.0), (pairs.model_error_curve - pairs.slope_error).values


@pytest.mark.large
@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_the_first_order_tells_its_own_error_on_a_lattice(unit: float) -> None:
    """From 4 to 35 % contact; the second order would tell a thirtieth of it."""
    one = ensemble([0.0], area=unit**2, radius=1e3 * unit, x=[0.5 * unit], y=[0.5 * unit])
    h = -unit * np.array([1e-5, 3e-5, 5e-5])
    true, stated = errors(one, h, order=1)
    assert true[-1] > 0.1
    assert (true <= stated).all()
    assert (stated <= 3.0 * true).all()


@pytest.mark.large
def test_a_buried_summit_whose_flank_comes_out_within_a_contact_is_told() -> None:
    """Contacts do not overlap; the lower summit widens the higher one's contact to one side."""
    radius, side, apart, lower = 1e3, 1.0, 0.06, 2.5e-6
    pair = ensemble(
        [0.0, -lower], area=side**2, radius=radius, x=[0.4, 0.4 + apart], y=[0.5, 0.5],
    )  # fmt: skip
    h = np.array([-1.5e-5, -3e-5])
    true, stated = errors(pair, h, order=2)
    alone, _ = errors(ensemble([0.0], area=side**2, radius=radius, x=[0.4], y=[0.5]), h, order=2)
    assert (true > 5.0 * alone).all()
    assert (true <= stated).all()
    assert (stated <= 5.0 * true).all()


def test_the_flank_of_a_buried_paraboloid_comes_out_where_both_meet() -> None:
    """At D/2 + R dz/D on the line of both; nothing of a summit that is no part of the surface at all."""
    radius, apart, lower = 50e-6, 4e-6, 0.3e-6
    pair = Ensemble.from_dataset(ensemble([0.0, -lower], area=1e-6, radius=radius))
    found = buried(pair, np.array([[0.0, 0.0], [apart, 0.0]]), None)
    assert found.hidden.tolist() == [False, True]
    assert found.emerging[0] == pytest.approx(0.5 * apart + radius * lower / apart, rel=1e-6)
    assert math.isinf(found.emerging[1])
    cones = Ensemble.from_dataset(ensemble([0.0, -lower], area=1e-6, shape="cone", slope=0.05))
    found = buried(cones, np.array([[0.0, 0.0], [apart, 0.0]]), None)
    assert found.hidden.tolist() == [False, True]
    assert np.isinf(found.emerging).all()


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 30), st.integers(0, 2**31), st.sampled_from([1, 2]), st.booleans())
def test_pairs_are_summed_as_one_by_one(count: int, seed: int, order: int, repeats: bool) -> None:
    rng = np.random.default_rng(seed)
    at, radius, load = rng.random((count, 2)), 0.1 * rng.random(count), rng.random(count) * (rng.random(count) > 0.3)
    emerging = np.where(rng.random(count) < 0.3, 0.1 * rng.random(count), np.inf)
    whole = radius * np.where(rng.random(count) < 0.3, 1.0 + rng.random(count), 1.0)
    found = crowding(at, radius, load, np.ones(2) if repeats else None, emerging, order, whole)
    plain = 0.0
    for i in np.flatnonzero(load):
        share = load[i] / load.sum()
        plain += 0.22 * share * max(1.0 - emerging[i] / radius[i], 0.0)
        plain += 0.4 * share * (1.0 - radius[i] / whole[i]) ** 1.5
        for j in np.flatnonzero(load):
            apart = at[i] - at[j]
            away = math.hypot(*(apart - np.rint(apart) if repeats else apart)) / (radius[i] + radius[j])
            if i != j and away < 2.5:
                near = 0.02 / max(away, 1.0) ** 3 if order == 1 else 0.004 / max(away, 1.0) ** 6
                plain += share * (near + 0.45 * max(1.0 - away, 0.0))
    assert found == pytest.approx(plain, rel=1e-9, abs=1e-12)


def test_two_contacts_are_found_however_their_distance_is_rounded() -> None:
    """They span all there is: none is farther, but for rounding."""
    for at in np.random.default_rng(1).random((100, 2, 2)):
        near = crowding(at, np.full(2, 0.5 * math.dist(*at)), np.ones(2), None, np.full(2, np.inf), 2)
        assert near == pytest.approx(0.004, rel=1e-6)


def test_equal_contacts_count_once_a_pair() -> None:
    at = np.array([[0.0, 0.0], [1.0, 0.0]])
    both = [
        sorted((int(i[k]), int(j[k]))) for i, j, _ in within_reach(at, np.full(2, 2.0), None) for k in range(i.size)
    ]
    assert len(both) == 2  # in both orders
    near = crowding(at, np.full(2, 0.5), np.ones(2), None, np.full(2, np.inf), 2)
    assert near == pytest.approx(0.004)


def test_a_machine_asks_for_the_errors_of_its_steps_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """And not of the separations at which it looks for them; a mean field has no error by distances."""
    calls = list[int]()

    def counted(*arguments: Any) -> float:
        calls.append(arguments[0].shape[0])
        return crowding(*arguments)

    monkeypatch.setattr(totals, "crowding", counted)
    monkeypatch.setattr("roughmdr.aggregate.neighbours_error.error_by_distances", None)
    asperities = rm.generate({**ASPERITIES, "count": 30, "patch": "0.5 mm", "placement": "random"}, seed=1)
    path = {"remote": ["1 um", "0.5 um", "0 um"], "machine_stiffness": "1000 N/m"}
    for model, most in (("pairwise", 3), ("mean_field", 0)):
        made = rm.load_separation(asperities, **path, effective_modulus=1e9, interaction={"model": model})
        assert float(made.force[-1]) > 0.0
        assert len(calls) == most
        calls.clear()


@pytest.mark.large
@pytest.mark.parametrize(("given", "early"), [({}, True), ({"range": "0.2 um"}, True), ({"range": "5 nm"}, False)])
def test_the_error_of_an_adhesive_hill_goes_by_whether_it_may_have_jumped_on(
    given: dict[str, str], early: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before touch, where JKR has no force, unless the range is short; not once it has parted, 0.8 um above.

    How near contacts are is not asked.
    """
    monkeypatch.setattr(totals, "crowding", None)
    hill = ensemble([0.0], area=1.0, radius=1e3, x=[0.2], y=[0.5])
    hill.attrs["asperity_model"] = "hills"
    path: dict[str, Any] = {"separation": 1e-6 * np.array([1.0, 0.5, -1.0, 0.5, 1.0])}
    asked: dict[str, Any] = {"variables": ["force", "model_error_curve"], "interaction": {"model": "pairwise"}, **given}
    law = rm.load_separation(hill, **path, **asked, effective_modulus=1e9, work=0.01)
    force, error = law.force.values, law.model_error_curve.values
    assert (force != 0.0).tolist() == [False, False, True, True, False]
    alone = 1.5 * np.pi * 0.01 * 1e3 / np.abs(force).max()
    np.testing.assert_allclose(error[2:4], 0.06 + float(law.adhesion_range_error) + 0.13 * alone, rtol=1e-3)
    np.testing.assert_allclose(error[[0, 1, 4]], [0.0, min(alone, 1.0) if early else 0.0, 0.0], rtol=1e-3)
    machine = {"remote": path["separation"], "machine_stiffness": "1e15 N/m"}
    stiff = rm.load_separation(hill, **machine, **asked, effective_modulus=1e9, work=0.01)
    np.testing.assert_allclose(stiff.model_error_curve, error, rtol=1e-3)


@pytest.mark.large
def test_a_hill_far_below_a_flat_that_a_dead_load_has_pulled_off_is_in_no_doubt() -> None:
    """A hill that is no paraboloid detaches at another depth than one; the flat has flown away at all steps but one."""
    at = {name: ("asperity", [value], {"units": "m"}) for name, value in {"x": 0.2, "y": 0.5, "height": 0.0}.items()}
    form = {"exponent": ("asperity", [1.2], {"units": "1"}), "width": ("asperity", [0.1], {"units": "m"})}
    hill = xr.Dataset(
        {**at, **form, "rise": ("asperity", [5e-6], {"units": "m"})},
        attrs={"shape": "power_law", "patch": 1.0, "asperity_model": "hills"},
    )
    law = rm.load_separation(
        hill, force=[-1.0, 10.0, -1e4], effective_modulus=1e9, work=0.01, interaction={"model": "pairwise"},
        variables=["model_error_curve"],
    )  # fmt: skip
    assert np.isnan(law.separation.values).tolist() == [True, False, True]
    assert (law.model_error_curve.values > 0.0).tolist() == [False, True, False]


def test_overlapping_contacts_of_adhesive_hills_are_in_doubt_as_a_whole() -> None:
    """Contacts of a radius of 5 cm: 6 cm apart they overlap, 40 cm apart they do not."""

    def error(apart: float) -> tuple[float, float]:
        pair = ensemble([0.0, 0.0], area=1.0, radius=1e3, x=[0.3, 0.3 + apart], y=[0.5, 0.5])
        pair.attrs["asperity_model"] = "hills"
        law = rm.load_separation(
            pair, separation=[-2e-6], effective_modulus=1e9, work=0.01, interaction={"model": "pairwise"}
        )
        assert float(law.contact_count[0]) == 2.0
        alone = 2.0 * 1.5 * np.pi * 0.01 * 1e3 / abs(float(law.force[0]))
        return (float(law.model_error) - 0.06 - float(law.adhesion_range_error)) / alone, alone

    (far, _), (near, alone) = error(0.4), error(0.06)
    assert alone < 0.9
    assert far == pytest.approx(0.13, rel=1e-3)
    assert near == pytest.approx(1.0, rel=1e-3)


def test_of_hills_nothing_is_asked_for_that_their_error_does_not_use(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(totals, "crowding", None)
    pair = ensemble([0.0, -1e-6], area=1.0, radius=1e3, x=[0.2, 0.7], y=[0.5, 0.5])
    pair.attrs["asperity_model"] = "hills"
    law = rm.load_separation(pair, separation=[-1e-5], effective_modulus=1e9, interaction={"model": "pairwise"})
    assert float(law.interaction_error) > 0.0
