"""The model errors of values that are read off a result: where they vanish, add up and agree."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given as drawn, settings, strategies as st
from scenes import ASPERITIES, CONDUCTION, ensemble, scene

import roughmdr as rm
from roughmdr.model_error.at_force import (
    METHODS,
    NAMES,
    QUANTITIES,
    ByInteraction,
    pull_off_error,
    range_error,
    relative_at_force,
)
from roughmdr.result.model_errors import errors_along
from roughmdr.result.view import ResultView
from roughmdr.variables import MODEL_ERROR

_VARIABLES = ["force", "pressure", "contact_area", "stiffness", "conductance_radius", "contact_radius_sum"]
_PATH = {"separation": {"start": "4 sigma", "stop": "0.5 sigma", "steps": 60}}


def run(**changes: Any) -> xr.Dataset:
    variables = [*_VARIABLES, *changes.pop("more", [])]
    sections = {"adhesion": None, "path": _PATH, "batch": {"realizations": 2}} | changes
    return rm.run(scene(**sections, output={"variables": variables}))


def over_truth(found: xr.Dataset, name: str) -> xr.DataArray:
    """The error of a value over the true one, where the value is too small by it."""
    error = found[f"{name}{MODEL_ERROR}"]
    return error / (error + found[name])


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return run(more=["model_error_curve"])


def test_at_a_given_force_the_force_has_no_error_and_the_area_that_of_its_share(result: xr.Dataset) -> None:
    there = result.roughmdr.at_pressure([50.0, 500.0])
    assert bool((there[f"force{MODEL_ERROR}"] == 0.0).all())
    own = result.roughmdr.at_separation(there.separation.values[0], branch="loading").isel(realization=0)
    interaction = over_truth(own, "force") - float(result.slope_error[0])
    share = METHODS["asperities", False].errors[QUANTITIES["contact_area"]].share
    expected = share * interaction + float(result.slope_error[0])
    found = there.isel(realization=0)
    np.testing.assert_allclose(over_truth(found, "contact_area"), expected, rtol=2e-2)
    for name in ("contact_area", "separation", "stiffness"):
        assert f"{name}{MODEL_ERROR}" in there[name].attrs["ancillary_variables"]
        assert there[f"{name}{MODEL_ERROR}"].attrs["units"] == there[name].attrs["units"]


def test_at_a_given_separation_the_error_of_the_force_is_that_of_the_curve(result: xr.Dataset) -> None:
    steps = result.isel(step=[20, 40, 55], realization=0)
    there = result.roughmdr.at_separation(steps.separation.values).isel(realization=0)
    for name in ("force", "pressure"):
        np.testing.assert_allclose(over_truth(there, name), steps.model_error_curve, rtol=1e-9)


def test_the_separation_is_off_by_the_error_of_the_force_over_the_slope(result: xr.Dataset) -> None:
    one = result.isel(realization=0)
    errors = errors_along(ResultView(result))[f"force{MODEL_ERROR}"].values[0, [30, 45]]
    found = one.roughmdr.at_force(one.force.values[[30, 45]])[f"separation{MODEL_ERROR}"]
    np.testing.assert_allclose(found, errors / one.stiffness.values[[30, 45]], rtol=1e-6)
    force, h = one.force.values, one.separation.values
    slope = np.diff(force)[[29, 44]] / np.diff(h)[[29, 44]]  # slope over the step that ends there
    found = one.drop_vars("stiffness").roughmdr.at_force(force[[30, 45]])[f"separation{MODEL_ERROR}"]
    np.testing.assert_allclose(found, errors / np.abs(slope), rtol=1e-6)


@pytest.mark.parametrize("interaction", [None, {"model": "mean_field"}], ids=["independent", "mean field"])
def test_without_the_curve_of_the_error_the_errors_are_those_with_it(interaction: dict[str, str] | None) -> None:
    """A result stores the largest error alone; along the path it follows from the contact fraction: the curve itself is
    a line between steps.
    """
    with_it, without = (run(interaction=interaction, more=more) for more in (["model_error_curve"], []))
    for found, expected in zip(
        (without.roughmdr.at_pressure([50.0, 500.0]), without.roughmdr.at_contact_fraction([1e-3])),
        (with_it.roughmdr.at_pressure([50.0, 500.0]), with_it.roughmdr.at_contact_fraction([1e-3])),
        strict=True,
    ):
        for name in (name for name in found.data_vars if name.endswith(MODEL_ERROR)):
            np.testing.assert_allclose(found[name], expected[name], rtol=5e-3, err_msg=str(name))


def test_a_lone_asperity_is_off_by_its_slope_alone() -> None:
    lone = ensemble([1e-6], area=1.0, radius=50e-6)
    law = rm.load_separation(
        lone, separation=np.linspace(1.1e-6, 0.5e-6, 13), effective_modulus=1e9, variables=_VARIABLES
    )
    there = law.roughmdr.at_force(0.5 * float(law.force.max()))
    for name in ("contact_area", "stiffness", "contact_radius_sum"):
        assert float(over_truth(there, name)) == pytest.approx(float(law.slope_error), rel=1e-9)


def test_units_do_not_matter() -> None:
    def shares(length: float, modulus: float) -> dict[str, float]:
        made = rm.generate(
            {"source": "random", "shape": "paraboloid", "count": 300, "patch": 1e-3 * length, "radius": 5e-5 * length,
             "height": {"distribution": "normal", "std": 1e-6 * length}}, seed=3,
        )  # fmt: skip
        h = np.linspace(4e-6, 0.5e-6, 50) * length
        law = rm.load_separation(made, separation=h, effective_modulus=modulus, variables=_VARIABLES)
        there = law.roughmdr.at_pressure(1e-4 * modulus)
        return {str(name): float(there[name] / abs(there[str(name).removesuffix(MODEL_ERROR)])) for name in there
                if str(name).endswith(MODEL_ERROR) and "force" not in str(name)}  # fmt: skip

    first, other = shares(1.0, 1e6), shares(1e-6, 1e11)
    assert first.keys() == other.keys()
    assert list(first.values()) == pytest.approx(list(other.values()), rel=1e-6)


def test_under_a_given_force_a_result_stores_the_errors_of_what_follows(dead_load: xr.Dataset) -> None:
    """They are those of the same values found on a path of separations."""
    loads = ["1 uN", "0.1 mN", "1 mN", "2 mN"]
    under = run(path={"force": loads}, batch={"realizations": 1})
    assert {"separation_model_error", "contact_area_model_error", "stiffness_model_error"} <= set(under.data_vars)
    along = run(batch={"realizations": 1})
    found, expected = under.isel(step=slice(1, None)), along.roughmdr.at_force(loads[1:])
    for name in ("contact_area", "stiffness"):
        share = over_truth(found, name).values - float(under.slope_error[0])
        of_path = over_truth(expected, name).values - float(along.slope_error[0])
        np.testing.assert_allclose(share, of_path, rtol=0.02)
    single = run(path={"force": ["1 mN"]}, batch={"realizations": 1})  # by the stiffness, as there is no other step
    among = under.separation_model_error.isel(step=2)
    np.testing.assert_allclose(single.separation_model_error[:, 0], among, rtol=0.05)
    off = dead_load.separation.isnull()
    assert bool(dead_load.contact_area_model_error.where(~off).notnull().equals(~off & (dead_load.contact_area > -1)))


def test_conductances_have_the_error_of_their_radius() -> None:
    table = scene(
        adhesion=None, path=_PATH, batch=None, conduction=CONDUCTION,
        output={"variables": ["force", "conductance_radius", "thermal_conductance", "electrical_conductance"]},
    )  # fmt: skip
    there = rm.run(table).isel(realization=0).roughmdr.at_force("1 mN")
    shares = {float(there[f"{name}{MODEL_ERROR}"] / there[name]) for name in table["output"]["variables"][1:]}
    assert max(shares) == pytest.approx(min(shares), rel=1e-9)


def test_under_a_body_nothing_is_stated() -> None:
    """The error of its law is that of the layer where it is pressed most."""
    table = scene(
        adhesion=None, nominal={"radius": "10 mm", "error": 1e-2}, batch={"estimator": "expected"},
        path={"separation": ["3 um", "1 um", "0 um"]},
    )  # fmt: skip
    there = rm.run(table).roughmdr.at_force("1 uN")
    assert not [name for name in there if str(name).endswith(MODEL_ERROR)]


def test_a_result_in_chunks_stays_lazy_and_has_the_same_errors(result: xr.Dataset) -> None:
    lazy = result.chunk(realization=1).roughmdr.at_pressure([50.0, 500.0])
    assert lazy[f"contact_area{MODEL_ERROR}"].chunks is not None
    xr.testing.assert_allclose(lazy.compute(), result.roughmdr.at_pressure([50.0, 500.0]))


@pytest.mark.large
def test_statistics_of_a_result_in_chunks_that_is_controlled_by_force_stay_lazy() -> None:
    made = run(path={"force": ["10 uN", "20 uN", "50 uN"]}, batch={"realizations": 3})
    lazy, eager = made.chunk(realization=1).roughmdr.statistics(), made.roughmdr.statistics()
    name = f"separation_mean{MODEL_ERROR}"
    assert lazy[name].chunks is not None
    assert bool((eager[name] > 0.0).all())
    xr.testing.assert_identical(lazy.compute(), eager)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_a_lone_asperity_shares_its_load_with_nobody(boundary: str) -> None:
    """Alone on a half-space only its slopes are in doubt; where the patch repeats it has neighbours."""
    one = ensemble([0.0], area=1e-10, radius=1e-5).assign(
        {name: ("asperity", [5e-6], {"units": "m"}) for name in ("x", "y")}
    )
    law = rm.load_separation(
        one, separation=np.linspace(0.0, -1e-7, 6), effective_modulus=1e9, variables=_VARIABLES,
        interaction={"model": "pairwise", "boundary": boundary},
    )  # fmt: skip
    assert (float(law.interaction_error) == 0.0) == (boundary == "free")
    there = law.roughmdr.at_force(0.5 * float(law.force.max()))
    for name in ("contact_area", "stiffness", "contact_radius_sum"):
        of_slopes = float(over_truth(there, name)) == pytest.approx(float(law.slope_error), rel=1e-6)
        assert of_slopes == (boundary == "free"), name


def test_of_a_reference_that_is_given_the_errors_are_those_at_its_separation() -> None:
    table = scene(
        adhesion=None, batch=None, path={"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 6}},
        asperities={"source": "random", "shape": "paraboloid", "count": 16, "patch": "0.2 mm", "radius": "50 um",
                    "height": {"distribution": "normal", "std": "1 um"}, "placement": "square"},
        reference={"model": "boundary_elements", "error": 0.3},
    )  # fmt: skip
    made = rm.run(table).isel(realization=0)
    given = 0.5 * float(made.reference_force.max())
    there = made.roughmdr.at_force(given, reference=True)
    own = made.roughmdr.at_separation(float(there.separation))
    assert float(there[f"force{MODEL_ERROR}"]) == pytest.approx(float(own[f"force{MODEL_ERROR}"]), rel=0.05)
    assert float(there[f"contact_area{MODEL_ERROR}"]) == pytest.approx(
        float(own[f"contact_area{MODEL_ERROR}"]), rel=0.2
    )


def test_where_contacts_jump_the_area_is_as_well_known_as_elsewhere() -> None:
    """From step to step the force may hardly change where the area does."""
    found = rm.run(scene(asperities={**ASPERITIES, "count": 40}, output={"variables": ["force", "contact_area"]}))
    errors = errors_along(ResultView(found))
    force, area = (found[name].values for name in ("force", "contact_area"))
    load = np.maximum(np.abs(force), (-force).max(axis=-1, keepdims=True))
    of_force, of_area = (errors[f"{name}{MODEL_ERROR}"].values for name in ("force", "contact_area"))
    there = area > 0.0
    ratio = (of_area[there] / area[there]) / (of_force[there] / load[there])
    assert 0.5 < np.median(ratio) < ratio.max() < 5.0


def test_holds_plateaus_and_zero_loads_have_errors_too() -> None:
    """Only the separation needs the slope of the law; contacts that push and pull leave some error of their sum."""
    held = run(path={"separation": ["2 um", "1 um", "1 um", "1 um"]}, more=["model_error_curve"]).isel(realization=0)
    errors = errors_along(ResultView(held))
    expected = held.force * held.model_error_curve / (1.0 - held.model_error_curve)
    np.testing.assert_allclose(errors[f"force{MODEL_ERROR}"].values, expected, rtol=1e-9)
    loads = run(path={"force": ["1 mN", "2 mN", "2 mN", "2 mN"]})
    for name in ("contact_area", "stiffness", "separation"):
        assert np.isfinite(loads[f"{name}{MODEL_ERROR}"]).all()
    sticky = {"adhesion": {"model": "jkr", "work": "50 mJ/m^2"}, "path": {**_PATH, "unload": True}}
    free = run(**sticky).roughmdr.at_force(0.0, branch="unloading")
    assert bool((free[f"separation{MODEL_ERROR}"] > 1e-10).all())


def test_the_order_of_dimensions_does_not_matter() -> None:
    swept = run(path={"force": ["0.1 mN", "1 mN"]}, sweep={"material.modulus": ["3 MPa", "5 MPa"]})
    turned = swept.transpose("step", "realization", "material_modulus")
    errors = errors_along(ResultView(turned))
    for name in (f"{each}{MODEL_ERROR}" for each in ("contact_area", "separation", "stiffness")):
        array = xr.DataArray(errors[name].values, dims=errors[name].dims)
        np.testing.assert_allclose(array.transpose(*swept[name].dims), swept[name], rtol=1e-12)


def sticky(work: float, reach: float | None, length: float = 1.0, modulus: float = 1e6) -> xr.Dataset:
    """Return a law with JKR, pressed and pulled off, with lengths and the modulus in some unit."""
    made = rm.generate(
        {"source": "random", "shape": "paraboloid", "count": 30, "patch": 1e-3 * length, "radius": 5e-5 * length,
         "height": {"distribution": "normal", "std": 1e-6 * length}}, seed=3,
    )  # fmt: skip
    kept = {} if reach is None else {"range": reach * length}
    h = np.linspace(4e-6, 0.5e-6, 200) * length
    return rm.load_separation(
        made, separation=h, unload=True, effective_modulus=modulus, work=work * length * modulus, variables=_VARIABLES,
        **kept,
    )  # fmt: skip


def read_loads(law: xr.Dataset) -> dict[str, list[float]]:
    """Return the relative errors of a law, pressed, at zero load and at half of the largest tension."""
    loads = np.array([float(law.force.max()), 0.0, 0.5 * float(law.force.min())])
    there = law.roughmdr.at_force(loads, branch="unloading")
    found = {name: (there[f"{name}{MODEL_ERROR}"] / there[name]).to_numpy().tolist() for name in NAMES}
    return found | {"separation": (there[f"separation{MODEL_ERROR}"] / 1e-6).to_numpy().tolist()}


def test_errors_by_range_fall_with_the_tabor_number_to_what_is_left_without() -> None:
    """At all loads the error is finite and known, and larger the farther attraction reaches."""
    found = [read_loads(sticky(1e-9, reach)) for reach in (3e-8, 1e-8, 1e-9, 1e-14, 1e-15)]
    for name in (*NAMES, "separation"):
        errors = np.array([each[name] for each in found])
        assert np.isfinite(errors).all()
        assert (errors > 0.0).all()
        assert (np.diff(errors, axis=0) < 0.0).all() or name == "stiffness"  # at half of the tension it may be 1
        np.testing.assert_allclose(errors[3], errors[4], rtol=1e-4)
    tabor = np.array([1.0, 2.0, 100.0, np.inf])
    assert range_error(tabor)[-1] == 0.0
    assert range_error(0.0) == range_error(1e-3) == pytest.approx(1.0 / 3.0)


def test_with_next_to_no_adhesion_errors_are_those_without() -> None:
    """They fall slowly, as the root of the root of the tension over the load."""
    laws = [sticky(work, 1e-9) for work in (1e-14, 1e-20, 1e-30, 0.0)]
    loads = np.array([0.3, 0.9]) * float(laws[-1].force.max())
    there = [law.roughmdr.at_force(loads) for law in laws]
    for name in (*NAMES, "separation"):
        errors = [each[f"{name}{MODEL_ERROR}"].to_numpy() for each in there]
        assert (np.diff(errors, axis=0) <= 0.0).all()
        np.testing.assert_allclose(errors[2], errors[3], rtol=1e-3)


def test_errors_of_adhesive_contacts_are_the_same_in_other_units() -> None:
    first, other = read_loads(sticky(1e-9, 1e-7)), read_loads(sticky(1e-9, 1e-7, 1e-3, 1e11))
    for name in NAMES:
        assert first[name] == pytest.approx(other[name], rel=1e-6)


@settings(deadline=None)
@drawn(st.floats(0.0, 1.0), st.floats(0.0, 0.3), st.floats(0.0, 1.0 / 3.0), st.floats(1e-12, 1.0))
def test_errors_by_range_grow_with_it_and_the_stiffness_is_lost_at_the_largest_tension(
    interaction: float, fraction: float, by_jkr: float, left: float
) -> None:
    def errors(by_jkr: float, left: float) -> list[float]:
        own, none = np.array([interaction]), np.zeros(1)
        known = (np.array([value]) for value in (by_jkr, left, 0.0, 0.0))
        found = relative_at_force(ByInteraction(own, own, 1.0), np.array([fraction]), [none] * len(NAMES), *known)
        return [float(each[0]) for each in found]

    found, without, far = errors(by_jkr, left), errors(0.0, left), errors(by_jkr, 1.0)
    assert all(0.0 <= low <= each <= 1.0 for low, each in zip(without, found, strict=True))
    assert far[1] <= found[1]
    assert far[0] == found[0]
    if by_jkr > 1e-3 and fraction > 0.0:
        assert errors(by_jkr, 1e-6)[1] == 1.0


def test_the_pull_off_force_of_a_law_has_the_error_by_range_too() -> None:
    """That of a range that is not given is left out."""
    told, untold = (sticky(1e-9, reach) for reach in (1e-7, None))
    errors = [float(law.roughmdr.pull_off()["force_model_error"]) for law in (told, untold)]
    assert errors[0] > errors[1] > 0.0
    numbers = (told[name].to_numpy() for name in ("interaction_error", "slope_error", "asperity_origin"))
    fraction, tabor = (told[name].to_numpy() for name in ("pull_off_contact_fraction", "tabor_number"))
    share = float(pull_off_error(fraction, tabor, *numbers, np.array(np.nan)))
    assert errors[0] == pytest.approx(share * abs(float(told.pull_off_force)), rel=1e-12)
