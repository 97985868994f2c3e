"""The model error of results: its parts, its curve, and that it does not depend on units, estimators or workers."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from scenes import ensemble, scene

import roughmdr as rm
from roughmdr.model_error.interaction import interaction_error
from roughmdr.model_error.parts import PARTS, TRUSTED_FRACTION

HERTZ = scene(adhesion=None, path={"separation": {"start": "4 sigma", "stop": "0.5 sigma", "steps": 30}})
VARIABLES = ["force", "contact_area", "contact_fraction", "model_error_curve"]


def test_the_error_of_independence_is_that_of_the_contact_fraction_at_each_step() -> None:
    made = rm.run({**HERTZ, "output": {"variables": VARIABLES}})
    of_model = ("slope_error", "profile_end_error", "adhesion_range_error", "resolution_error", "border_error")
    constant = sum(made[name] for name in of_model)
    f = made.contact_area / 1e-6
    expected = 1.4 * np.sqrt(f) + f + constant
    np.testing.assert_allclose(made.model_error_curve, expected.where(made.force != 0.0, 0.0), rtol=1e-12)
    np.testing.assert_array_equal(made.model_error, made.model_error_curve.max("step"))
    np.testing.assert_array_equal(made.largest_contact_fraction, made.contact_fraction.max("step"))


def test_up_to_the_trusted_separation_the_contact_fraction_is_small() -> None:
    made = rm.run({**HERTZ, "output": {"variables": VARIABLES}})
    h = made.trusted_separation
    assert np.isfinite(h).all()
    assert (made.contact_fraction.where(made.separation > h, 0.0) <= TRUSTED_FRACTION).all()
    assert (made.contact_fraction.where(made.separation == h).max("step") > TRUSTED_FRACTION).all()


def test_without_contact_there_is_no_error() -> None:
    lone = ensemble([1e-6], area=1.0, radius=50e-6)
    none = rm.load_separation(lone, separation=[2e-6], effective_modulus="1 GPa")
    assert float(none.model_error) == 0.0
    assert math.isnan(float(none.trusted_separation))


def test_without_a_nominal_area_the_model_error_is_not_known() -> None:
    made = rm.load_separation(ensemble([1e-6], area=None, radius=1e-6), separation=[0.5e-6], effective_modulus=1e9)
    assert all(math.isnan(made[name]) for name in ("model_error", "interaction_error", "largest_contact_fraction"))
    with pytest.raises(rm.SceneError, match="model_error_curve"):
        rm.load_separation(
            ensemble([1e-6], area=None, radius=1e-6),
            separation=[0.5e-6],
            effective_modulus=1e9,
            variables="model_error_curve",
        )


@pytest.mark.large
@pytest.mark.parametrize("slope", [0.01, 0.1, 0.3])
def test_the_error_by_slopes_grows_as_their_square(slope: float) -> None:
    made = rm.load_separation(
        ensemble([1e-6], area=1.0, shape="cone", slope=slope), separation=[0.0], modulus=1e9, poisson=0.3
    )
    assert float(made.slope_error) == pytest.approx(slope**2 / 3.0)


def test_slopes_count_by_the_force_that_their_contacts_bear() -> None:
    """One needle among blunt asperities has the largest slope, and no force."""
    radius = np.array([1e-9, *[50e-6] * 20])
    made = rm.load_separation(ensemble(np.full(21, 1e-6), radius=radius), separation=[0.9e-6], effective_modulus=1e9)
    assert float(made.slope_error) < 1e-3
    assert float(made.profile_end_error) < 1e-3
    alone = rm.load_separation(ensemble([1e-6], radius=1e-9), separation=[0.9e-6], effective_modulus=1e9)
    assert float(alone.slope_error) == 1.0
    assert float(alone.profile_end_error) == 1.0


def test_jkr_is_off_where_adhesion_reaches_far_whether_its_range_is_told_or_not() -> None:
    def error(unit: float, **adhesion: Any) -> float:
        """The error for asperities of 100 nm at an equal Tabor number, with all lengths in some unit."""
        asperities = ensemble(np.linspace(0.0, 20e-9, 40) * unit, area=1e-8 * unit**2, radius=100e-9 * unit)
        made = rm.load_separation(asperities, separation=[0.0], effective_modulus=1e9, work=0.05 * unit, **adhesion)
        return float(made.adhesion_range_error)

    known = error(1.0, strength=0.05 / 0.4e-9)
    assert 0.0 < known < 0.1
    assert error(1.0) == pytest.approx(known, rel=1e-12)  # the range that is assumed
    assert error(1e3, strength=0.05 / 0.4e-9) == pytest.approx(known, rel=1e-9)
    assert error(1.0, strength=0.05 / 0.2e-9) == pytest.approx(known / 2.0**1.3, rel=1e-9)
    assert error(1.0, adhesion="dugdale", strength=0.05 / 0.4e-9) == 0.0


@pytest.mark.large
@pytest.mark.parametrize("work", [5e-324, 1e-300, 1e-170, 1e-30])
def test_an_adhesion_that_is_next_to_nothing_has_an_error_of_next_to_nothing(work: float) -> None:
    """The square of its Tabor number is 0 to a float."""
    asperities = ensemble(np.linspace(0.0, 1.0, 5), area=1e4, shape="power_law", exponent=10.0, coefficient=1.0)
    made = rm.load_separation(asperities, separation=[-1e-3], effective_modulus=1e3, work=work)
    assert float(made.adhesion_range_error) < 1e-9


@pytest.mark.large
def test_two_of_the_largest_floats_are_refused_without_their_sum() -> None:
    pair = ensemble([0.0, 0.0], area=1e8, shape="cone", slope=1.7e308)
    with pytest.raises(rm.OutOfRange, match="contact of an asperity is not representable"):
        rm.load_separation(pair, separation=[0.0], effective_modulus=1e3, work=1e3)


@pytest.mark.parametrize("separation", [20.0, 0.0, -20.0])
def test_the_error_of_jkr_bounds_what_dugdale_differs_by(separation: float) -> None:
    """A sticky film whose Tabor number is 1.1, retracting from deep contact."""
    height = np.linspace(0.0, 20e-9, 40)
    asperities = ensemble(height, area=1e-8, radius=120e-9)
    given = {"separation": [-25e-9, separation * 1e-9], "effective_modulus": 2.2e9, "work": 0.06}
    jkr = rm.load_separation(asperities, **given)
    dugdale = rm.load_separation(asperities, **given, adhesion="dugdale", strength=0.06 / 0.4e-9)
    off = abs(jkr.force - dugdale.force).values[1] / abs(jkr.force).max().item()
    assert off <= float(jkr.adhesion_range_error) <= 0.3


@pytest.mark.parametrize("estimator", ["sampled", "stratified", "expected"])
def test_all_estimators_tell_about_one_model_error(estimator: str) -> None:
    realizations = 1 if estimator == "expected" else 8
    made = rm.run({**HERTZ, "batch": {"estimator": estimator, "realizations": realizations}})
    fraction = math.pi * 50e-6 * 1e9 * 1e-6 * 0.19780  # pi R density std <(z/std - 0.5)+>
    overlap = -math.expm1(-2.0 * fraction * (1.0 + math.pi / 4.0))  # of areas that are exponential, nearly
    assert float(made.interaction_error.mean()) == pytest.approx(1.4 * math.sqrt(fraction) + fraction, rel=0.03)
    assert float(made.overlap_fraction.mean()) == pytest.approx(overlap, rel=0.15)


def test_statistics_keep_the_largest_of_each_cell() -> None:
    curves = rm.run(HERTZ)
    kept = rm.run({**HERTZ, "output": {"keep": "statistics"}})
    for name in ("model_error", *PARTS, "largest_contact_fraction", "trusted_separation", "overlap_fraction"):
        assert float(kept[name]) == float(curves[name].max()), name


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e4])
def test_the_model_error_is_that_in_other_units_of_length(unit: float) -> None:
    table = copy.deepcopy(HERTZ)
    table["asperities"] |= {
        "patch": 1e-3 * unit,
        "height": {"distribution": "normal", "std": 1e-6 * unit},
        "radius": {"distribution": "lognormal", "mean": 50e-6 * unit, "std": 5e-6 * unit},
    }
    made, plain = rm.run(table), rm.run(HERTZ)
    np.testing.assert_allclose(made.model_error, plain.model_error, rtol=1e-9)


def test_an_error_is_at_most_the_whole_force() -> None:
    assert interaction_error(np.array([0.0, 1e-4, 0.5, 4.0])).tolist() == pytest.approx([0.0, 0.0141, 1.0, 1.0])


@pytest.mark.parametrize(
    ("side", "stiffening"), [(20.0, 1.145247762211), (12.0, 1.273263599777), (8.0, 1.489602436784)]
)
def test_the_error_is_bounded_closely_for_equal_contacts_on_a_square_lattice(side: float, stiffening: float) -> None:
    """One paraboloid, R = delta = 1, in a periodic patch: force over that of a lone one, by boundary elements."""
    error = 1.0 - 1.0 / stiffening
    estimate = float(interaction_error(np.array(math.pi / side**2)))
    assert error <= estimate <= 1.15 * error
