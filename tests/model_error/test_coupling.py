"""The error of coupled asperities: it grows with crowding, and says so from certain shares on."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.model_error.coupling import (
    WARNED_FRACTION,
    WARNED_SHARE,
    adhesive_hills_error,
    coupling_error,
    coupling_warnings,
)

share = st.floats(0.0, 1.0)


def error(fraction: float, overlap: float, **attrs: float | str) -> float:
    columns = (np.array([value]) for value in (fraction, overlap))
    ensemble = Ensemble("paraboloid", np.zeros(1), {"radius": np.ones(1)}, attrs={**attrs})
    return float(coupling_error(*columns, ensemble)[0])


@given(share, share)
def test_it_is_that_of_asperities_on_a_plane_where_nothing_else_is_known(fraction: float, overlap: float) -> None:
    assert error(fraction, overlap) == float(coupling_error(np.array([fraction]), np.array([overlap]))[0])


def test_that_of_hills_grows_with_their_anisotropy() -> None:
    errors = [error(0.01, 0.3, asperity_model="hills", anisotropy=ratio) for ratio in (1.0, 4.0, 1e6)]
    assert 0.05 < errors[0] < errors[1] < errors[2] == 1.0
    assert error(0.0, 0.0, asperity_model="hills") == 0.0


@given(share, share, st.floats(0.0, 0.5))
def test_it_grows_with_each_share_and_stays_a_fraction(fraction: float, overlap: float, more: float) -> None:
    here = error(fraction, overlap)
    assert 0.0 <= here <= 1.0
    for grown in ((fraction + more, overlap), (fraction, overlap + more)):
        assert error(*grown) >= here
    assert error(fraction, overlap, of_surface=1) >= here


@given(st.just(0.0) | st.floats(1e-9, 1e3), st.floats(1e-9, 1e3), st.floats(1e-6, 1e6))
def test_adhesive_hills_are_off_by_a_share_of_the_pull_off_forces(
    pull_offs: float, largest: float, unit: float
) -> None:
    """All of those that may be in contact and are not, or overlap; without any force nothing is known."""
    forces = pull_offs * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    doubted, held, none = adhesive_hills_error(*(unit * forces), unit * largest)
    assert doubted == pytest.approx(min(pull_offs / largest, 1.0), rel=1e-9)
    assert held == pytest.approx(min(0.13 * pull_offs / largest, 1.0), rel=1e-9)
    assert none == 0.0
    assert adhesive_hills_error(*forces, 0.0).tolist() == [pull_offs > 0.0, pull_offs > 0.0, 0.0]


def test_without_contact_there_is_none() -> None:
    assert error(0.0, 0.0) == error(0.0, 0.0, of_surface=1) == 0.0


def test_separated_contacts_are_within_what_the_lattice_showed() -> None:
    """On a square lattice it is off by 8e-5 at 6.4 % of area, 6e-4 at 12.8 % and 2.6e-3 at 21 %."""
    for fraction, measured in ((0.064, 8e-5), (0.128, 6e-4), (0.21, 2.6e-3)):
        assert measured < error(fraction, 0.0) < 6.0 * measured


@given(share)
def test_the_first_order_of_separated_contacts_has_the_larger_error(fraction: float) -> None:
    columns = np.array([fraction]), np.zeros(1)
    assert coupling_error(*columns, order=1)[0] >= coupling_error(*columns)[0]


def test_the_first_order_on_a_lattice_is_off_as_measured() -> None:
    """By boundary elements 0.29 % at 3.8 % of area, 3.3 % at 15 % and 25 % at 35 %."""
    for fraction, measured in ((0.038, 0.0029), (0.147, 0.0329), (0.353, 0.25)):
        assert measured < float(coupling_error(np.array(fraction), np.array(0.0), order=1)) < 2.0 * measured


def test_warnings_come_from_their_limits_on() -> None:
    assert coupling_warnings(WARNED_FRACTION, WARNED_SHARE, 0.0) == []
    assert len(coupling_warnings(1.1 * WARNED_FRACTION, 0.0, 0.0)) == 1
    assert len(coupling_warnings(0.0, 1.1 * WARNED_SHARE, 0.0)) == 1
    assert "3 steps" in coupling_warnings(0.0, 0.0, 3.0)[0]


@pytest.mark.parametrize("fraction", [0.1, 0.2])
def test_of_marked_steps_only_causes_that_may_be_are_told(fraction: float) -> None:
    """The contact fraction is the largest one; the overlap is that at closest approach, and may have been larger."""
    *_, line = coupling_warnings(fraction, 0.0, 3.0)
    assert ("of the area in contact" in line) == (fraction > 0.15)
    assert "of the force in overlapping contacts" in line
    assert "without an equilibrium" in line
