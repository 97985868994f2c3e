"""Errors of contacts that yield where a force, a pressure or a separation is given."""

from typing import Any

import numpy as np
import pytest
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.model_error.parts import PLASTIC_AT_FORCE, Yielding
from roughmdr.stages.plastic.body import Body
from roughmdr.stages.plastic.models import MODELS, compare

PATH = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 60}, "unload": True}
VARIABLES = ["force", "contact_area", "stiffness", "contact_radius_sum"]
BODY = Body(1e9, 1e6, 0.0, 0.3, np.inf, 0.0)


def law(hardness: float | None, model: str = "mdr", **changes: Any) -> Any:
    plasticity = None if hardness is None else {"hardness": hardness, "model": model}
    asked = {"path": PATH, "output": {"variables": VARIABLES}, "batch": {"realizations": 2}} | changes
    return rm.run(scene(adhesion=None, plasticity=plasticity, **asked))


def told(result: Any, given: str, values: Any, branch: str = "loading") -> dict[str, Any]:
    there = getattr(result.roughmdr, f"at_{given}")(values, branch=branch)
    return {str(name): there[name].to_numpy() for name in there if str(name).endswith("_model_error")}


@pytest.fixture(scope="module")
def hard_and_elastic() -> tuple[Any, Any]:
    return law(1e15), law(None)


@pytest.mark.parametrize("given", ["force", "separation", "contact_fraction"])
def test_where_nothing_yields_errors_are_those_of_elastic_contacts(
    hard_and_elastic: tuple[Any, Any], given: str
) -> None:
    hard, elastic = hard_and_elastic
    values = {"force": 0.3 * float(elastic.force.max()), "separation": 1.5e-6, "contact_fraction": 0.01}[given]
    found, expected = (told(each, given, values) for each in (hard, elastic))
    assert found.keys() == expected.keys()
    for name, each in expected.items():
        np.testing.assert_allclose(found[name], each, rtol=1e-6)


def test_the_error_of_the_force_by_interaction_falls_with_the_softness() -> None:
    """A lattice that yields is softer by the slope of its law, to first order exactly."""
    soft = law(1e5, path={**PATH, "unload": False})
    elastic = 2.0 * rm.effective_modulus("3 MPa", 0.49) * soft.contact_radius_sum[:, -1]
    share, fraction = (soft.stiffness[:, -1] / elastic).to_numpy(), soft.largest_contact_fraction.to_numpy()
    assert (share < 0.7).all()
    np.testing.assert_allclose(soft.plasticity_softness, share, rtol=0.02)  # of some of the asperities
    np.testing.assert_allclose(soft.interaction_error, share * (1.4 * np.sqrt(fraction) + fraction), rtol=0.1)


@pytest.mark.parametrize("model", [large(each) if each == "kogut-etsion" else each for each in MODELS])
def test_errors_of_areas_are_told_on_loading_alone(model: str) -> None:
    load = {"force": {"start": "0.1 mN", "stop": "2 mN", "steps": 5}, "unload": True}
    result = law(1e5, model, path=load)
    error = (result.contact_area_model_error / result.contact_area).to_numpy()
    loads = (result.branch == "loading").to_numpy()
    assert np.isnan(error[:, ~loads]).all()
    assert (error[:, loads] > result.plasticity_area_error.to_numpy()[:, None]).all()
    assert np.isfinite(result.separation_model_error).all()


def test_of_the_branches_of_a_law_loading_alone_has_errors_of_areas() -> None:
    result = law(1e5)
    up, down = (told(result, "force", 1e-3, branch) for branch in ("loading", "unloading"))
    assert np.isfinite(up["contact_area_model_error"]).all()
    assert np.isnan(down["contact_area_model_error"]).all()
    assert (up["separation_model_error"] > 0.0).all()
    assert (down["separation_model_error"] > 0.0).all()


def compared(model: str, scale: float = 1.0, body: Body = BODY) -> Yielding:
    heights, radii = np.random.default_rng(3).normal(0.0, 1e-6, 400), np.full(400, 1e-3)
    return compare(
        model, body, "paraboloid", scale * np.sort(heights)[::-1], scale * radii, scale * np.linspace(3e-6, 5e-7, 9)
    )


def test_models_differ_as_much_either_way_and_in_other_units() -> None:
    """Each of two models that differ most is the error of the other; the one in between has less."""
    found = np.array([compared(model).at_force for model in MODELS])
    assert (found > 0.0).all()
    assert (np.sort(found, axis=0)[1] > 0.6 * found.max(axis=0)).all()
    for model, each in zip(MODELS, found, strict=True):
        np.testing.assert_allclose(compared(model, 1e3).at_force, each, rtol=1e-9)
        stiffer = BODY._replace(
            effective_modulus=1e3 * BODY.effective_modulus, yield_strength=1e3 * BODY.yield_strength
        )
        np.testing.assert_allclose(compared(model, body=stiffer).at_force, each, rtol=1e-9)


def test_contacts_that_adhere_or_do_not_touch_tell_nothing() -> None:
    sticky = compared("mdr", body=BODY._replace(work=0.01))
    assert np.isnan(sticky.at_force).all()
    assert (sticky.softness == 1.0).all()
    apart = compare("mdr", BODY, "paraboloid", np.zeros(2), np.ones(2), np.array([1.0, 0.5]))
    assert apart.at_force == (0.0,) * len(PLASTIC_AT_FORCE)
