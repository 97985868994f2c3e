"""The error of the conductance: against what was measured with boundary elements, and as it must grow."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scenes import ensemble as asperities_at

import roughmdr as rm
from roughmdr.asperity.validity import ValidityLimits
from roughmdr.ensemble.ensemble import Ensemble, Origin
from roughmdr.model_error.conductance import conductance_error, coupled_conductance_error
from roughmdr.model_error.parts import PARTS, Assumptions, ModelError

FRACTIONS = (0.01, 0.03, 0.1)
# Median errors at these contact fractions, as docs/guides/layers.md has them; so much above that the bound may be.
PAIRS: list[tuple[Origin, bool, tuple[float, ...], float]] = [
    ("asperities", False, (3e-4, 1.5e-3, 1.5e-3), 7.0),
    ("asperities", True, (1e-3, 1e-2, 1.8e-2), 10.0),
    ("hills", False, (0.018, 0.018, 0.024), 6.0),
    ("summits", False, (0.07, 0.12, 0.27), 4.0),
]
share = st.floats(0.0, 1.0)


def error(
    fraction: float, overlap: float, origin: Origin = "asperities", order: int = 2, **attrs: float | str
) -> float:
    attrs |= {"hills": {"asperity_model": "hills"}, "summits": {"of_surface": 1}, "asperities": {}}[origin]
    ensemble = Ensemble("paraboloid", np.zeros(1), {"radius": np.ones(1)}, attrs=attrs)
    assert ensemble.origin == origin
    return float(coupled_conductance_error(np.array([fraction]), np.array([overlap]), ensemble, order)[0])


def of_independent(fraction: float | None, origin: Origin = "asperities", **parts: float) -> float:
    assumptions = Assumptions(ValidityLimits(0.0, 0.0), origin=origin)
    named = dict.fromkeys(PARTS, 0.0) | parts
    model = ModelError(np.zeros(1), named)
    return conductance_error(assumptions, model, None if fraction is None else np.array([fraction, 0.0, math.nan]))


@pytest.mark.parametrize(("origin", "at_random", "measured", "factor"), PAIRS)
def test_that_of_pairs_is_above_the_median_that_was_measured_but_not_far(
    origin: Origin, at_random: bool, measured: tuple[float, ...], factor: float
) -> None:
    for fraction, median in zip(FRACTIONS, measured, strict=True):
        overlap = 1.0 - math.exp(-4.0 * fraction) if at_random else 0.0  # of equal contacts at random places
        assert median < error(fraction, overlap, origin) < factor * median


def test_that_of_independent_contacts_is_above_the_median_that_was_measured_but_not_far() -> None:
    for fraction, median in zip(FRACTIONS, (0.10, 0.23, 0.39), strict=True):
        assert median < of_independent(fraction) < 3.0 * median
        assert of_independent(fraction) < of_independent(fraction, "summits") <= of_independent(fraction, "hills")


@given(share, share, st.floats(0.0, 0.5), st.sampled_from(["asperities", "summits", "hills"]))
def test_it_grows_with_each_share_and_stays_a_fraction(
    fraction: float, overlap: float, more: float, origin: Origin
) -> None:
    here = error(fraction, overlap, origin)
    assert 0.0 <= here <= 1.0
    assert error(fraction + more, overlap, origin) >= here
    assert error(fraction, overlap + more, origin) >= here
    assert error(fraction, overlap, "summits") >= error(fraction, overlap)


@given(st.floats(1e-4, 0.1))
def test_the_first_order_is_worse_where_nothing_overlaps(fraction: float) -> None:
    """By (a/D)^3, which fades faster than the root of the contact fraction, and slower than its square."""
    first, second = error(fraction, 0.0, order=1), error(fraction, 0.0, order=2)
    assert first > second
    added, of_less = first - second, error(0.25 * fraction, 0.0, order=1) - error(0.25 * fraction, 0.0, order=2)
    assert 4.0 < added / of_less < 16.0


def test_that_of_hills_grows_with_their_anisotropy_and_is_none_without_contact() -> None:
    errors = [error(0.01, 0.3, "hills", anisotropy=ratio) for ratio in (1.0, 4.0, 1e6)]
    assert errors[1] == pytest.approx(2.0 * errors[0])
    assert errors[2] == 1.0
    for origin in ("asperities", "summits", "hills"):
        assert error(0.0, 0.0, origin) == of_independent(0.0, origin) == 0.0  # type: ignore[arg-type]


def test_the_other_parts_of_the_model_error_are_added_where_there_is_contact() -> None:
    """But for that by interaction, which the conductance has an own one of."""
    alone = of_independent(0.01)
    assert of_independent(0.01, slope_error=0.02, resolution_error=0.03) == pytest.approx(alone + 0.05)
    assert of_independent(0.01, interaction_error=0.2) == alone
    assert of_independent(0.01, border_error=2.0) == 1.0
    assert of_independent(0.0, slope_error=0.02) == 0.0
    assert math.isnan(of_independent(None))


@pytest.mark.parametrize("unit", [1e-6, 1e-3])
def test_a_lone_asperity_has_the_parts_that_are_not_by_neighbours(unit: float) -> None:
    one = asperities_at([0.0], area=1e4 * unit**2, shape="sphere", radius=10.0 * unit)
    given = {"effective_modulus": 1e9, "variables": ["force", "conductance_radius"]}
    pressed = rm.load_separation(one, separation=-4.0 * unit, **given)
    assert float(pressed.conductance_error) == float(pressed.slope_error) > 0.1
    apart = rm.load_separation(one, separation=unit, **given)
    assert float(apart.conductance_error) == 0.0
