"""Conductances of a rough layer: from the conductance radius, in scenes, batches and beside the reference."""

import math
from typing import Any

import numpy as np
import pytest
from scenes import ASPERITIES, CONDUCTION, scene

import roughmdr as rm
from roughmdr.stages.conduction import Conduction

NAMES = ["conductance_radius", "thermal_conductance", "electrical_conductance"]
PLACED = {**ASPERITIES, "count": 50, "placement": "hard_core", "min_distance": "60 um"}
PAIRS = {"adhesion": None, "asperities": PLACED, "interaction": {"model": "pairwise"},
         "path": {"separation": ["2 um", "1 um"]}, "batch": {"realizations": 2}}  # fmt: skip


def conducting(conduction: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """A scene with all conductances."""
    output = {"variables": ["force", *NAMES]} | changes.pop("output", {})
    return scene(conduction=CONDUCTION if conduction is None else conduction, output=output, **changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"batch": {"realizations": 2}},
        {"batch": {"estimator": "stratified"}},
        {"batch": {"estimator": "expected"}},
        {"adhesion": None, "interaction": {"model": "mean_field"}, "batch": {"estimator": "expected"},
         "path": {"separation": ["2 um", "1 um"]}},
        PAIRS,
        {"adhesion": None, "batch": None, "path": {"force": {"stop": "1 mN", "steps": 4}}},
        {"batch": None, "path": {"preload": "10 mN", "steps": 5, "unload": True}},
    ],
    ids=["drawn", "stratified", "expected", "mean field", "pairs", "dead load", "preload"],
)  # fmt: skip
def test_they_are_the_radius_times_the_conductivity(changes: dict[str, Any]) -> None:
    result = rm.run(conducting(**changes))
    radius = result.conductance_radius
    assert float(radius.max()) > 0.0
    np.testing.assert_allclose(result.thermal_conductance, 2.0 * 400.0 * radius, rtol=1e-14)
    np.testing.assert_allclose(result.electrical_conductance, 4.0 / 47e-9 * radius, rtol=1e-14)
    assert {name: result[name].attrs["units"] for name in NAMES} == dict(zip(NAMES, ("m", "W K-1", "S"), strict=True))
    assert (result.conductance_error > 0.0).all()


def test_two_bodies_conduct_by_the_harmonic_mean() -> None:
    """Resistances in series: 1/(4 k a) of each."""
    result = rm.run(conducting({"conductivity": 400.0, "counter_conductivity": 15.0, "resistivity": 1e-8}, batch=None))
    k = 2.0 / (1.0 / 400.0 + 1.0 / 15.0)
    np.testing.assert_allclose(result.thermal_conductance, 2.0 * k * result.conductance_radius, rtol=1e-14)
    np.testing.assert_allclose(result.electrical_conductance, 2e8 * result.conductance_radius, rtol=1e-14)


def test_one_alone_is_the_same_and_nothing_else_is_there() -> None:
    every = rm.run(conducting(batch=None))
    alone = rm.run(conducting({"conductivity": 400.0}, batch=None, output={"variables": ["thermal_conductance"]}))
    np.testing.assert_array_equal(alone.thermal_conductance, every.thermal_conductance)
    assert "conductance_radius" not in alone
    assert "conductance_error" in alone
    without = rm.run(scene(batch=None))
    assert "conductance_error" not in without
    assert "conductances: the scene has no [conduction]" in without.attrs["left_out"]


def test_what_is_asked_for_besides_changes_no_bit() -> None:
    asked = ["force", "contact_radius_sum", "stiffness"]
    plain = rm.run(scene(**PAIRS, output={"variables": asked}))
    more = rm.run(scene(**PAIRS, conduction=CONDUCTION, output={"variables": [*asked, *NAMES]}))
    for name in asked:
        np.testing.assert_array_equal(more[name], plain[name])


def test_statistics_are_those_of_the_curves() -> None:
    curves, kept = (rm.run(conducting(output={"keep": keep})) for keep in ("curves", "statistics"))
    mean = curves.thermal_conductance.mean("realization")
    np.testing.assert_allclose(kept.thermal_conductance_mean, mean, rtol=1e-12)
    np.testing.assert_array_equal(kept.conductance_error, curves.conductance_error.max("realization"))


@pytest.mark.large
def test_boundary_elements_beside_it() -> None:
    result = rm.run(conducting(**PAIRS | {"reference": {"model": "boundary_elements", "error": 0.02}}))
    for name in NAMES:
        np.testing.assert_allclose(result[name], result[f"reference_{name}"], rtol=0.05)
    np.testing.assert_allclose(
        result.reference_thermal_conductance, 2.0 * 400.0 * result.reference_conductance_radius, rtol=1e-14
    )


@pytest.mark.parametrize(
    ("conduction", "message"),
    [
        ({"resistivity": 1e-8}, "output.variables: thermal_conductance needs conduction.conductivity"),
        ({"conductivity": 1.0}, "output.variables: electrical_conductance needs conduction.resistivity"),
        ({}, "conduction: needs conductivity, resistivity, or both"),
        ({"counter_conductivity": 1.0}, "conduction.counter_conductivity = 1.0: goes with conductivity only"),
        ({"conductivity": 0.0, "resistivity": 1.0}, "conduction.conductivity = 0.0: must be above 0"),
        ({"conductivity": 1.0, "resistivity": "3 W/m/K"}, "conduction.resistivity"),
        ({"conductivity": 1e308, "resistivity": 1.0}, "conduction.conductivity = 1e+308: is beyond"),
        ({"conductivity": 1.0, "resistivity": 1e-320}, "conduction.resistivity = 1e-320: is beyond"),
    ],
)
def test_what_is_missing_or_wrong_is_refused(conduction: dict[str, Any], message: str) -> None:
    with pytest.raises(rm.SceneError) as caught:
        rm.run(conducting(conduction))
    assert message in str(caught.value)


def test_without_a_section_it_is_refused() -> None:
    with pytest.raises(rm.SceneError, match=r"output\.variables: thermal_conductance needs conduction\.conductivity"):
        rm.run(scene(output={"variables": ["thermal_conductance"]}))
    data = rm.generate(PLACED, seed=1)
    with pytest.raises(rm.SceneError, match=r"thermal_conductance.*conductance_radius"):
        rm.load_separation(data, separation=[0.0], effective_modulus=1e9, variables=["thermal_conductance"])


def test_what_no_float_holds_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="thermal_conductance is not representable"):
        Conduction(conductivity=5e299).conductances(np.array([0.0, 1e300]))
    with pytest.raises(rm.OutOfRange, match="thermal_conductance is not representable"):
        Conduction(conductivity=5e-321).conductances(np.array([0.0, 1e-5]))
    found = Conduction(conductivity=0.5).conductances(np.array([0.0, math.nan]))["thermal_conductance"]
    np.testing.assert_array_equal(found, [0.0, math.nan])
