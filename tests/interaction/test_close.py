"""Contacts that nearly touch or overlap: integrals over both springs, definite at any overlap, smooth in between."""

import itertools
import math

import numpy as np
import pytest
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st
from scenes import ensemble
from scipy.integrate import quad
from scipy.spatial.distance import pdist, squareform

import roughmdr as rm
from roughmdr.interaction import close
from roughmdr.numerics.arguments import Floats


def punches_by_quadrature(s: float, t: float, away: float) -> float:
    """∫∫ 1/sqrt(D² - (x - y)²) dx dy/(4 s t): the inner integral is an arcsine."""

    def inner(x: float) -> float:
        low, high = (min(max((x + side * t) / away, -1.0), 1.0) for side in (-1, 1))
        return math.asin(high) - math.asin(low)

    breaks = sorted({-s, s, *(z for z in (away - t, t - away, -away - t, away + t) if -s < z < s)})
    parts = itertools.pairwise(breaks)
    return sum(quad(inner, *part, epsabs=1e-14, epsrel=1e-12)[0] for part in parts) / (4.0 * s * t)


@pytest.mark.parametrize("away", [1e-3, 0.3, 1.0, 1.7, 2.0, 5.0, 100.0])
@pytest.mark.parametrize(("s", "t"), [(1.0, 1.0), (0.2, 1.5), (1.5, 0.2), (1e-3, 1.0)])
def test_two_punches_against_a_double_integral(s: float, t: float, away: float) -> None:
    assert close.punches(s, t, away) == pytest.approx(punches_by_quadrature(s, t, away), rel=1e-8)


def test_the_compliance_is_that_of_punches_that_are_one() -> None:
    """A punch is displaced by itself as the distance goes to none: π/(2 a), over π E* 1/(2 E* a)."""
    assert close.punches(0.7, 0.7, 1e-12) == pytest.approx(0.5 * math.pi / 0.7, rel=1e-9)
    assert close.punches(0.2, 0.7, 1e-12) == pytest.approx(0.5 * math.pi / 0.7, rel=1e-9)


def test_far_away_they_are_points_of_some_size() -> None:
    """1/D + (s² + t²)/(6 D³): a quarter of the Laplacian 1/D³ times M/P, 2/3 s² and 2/3 t²."""
    for away in (10.0, 20.0, 40.0):
        far = 1.0 / away + (0.5**2 + 1.2**2) / (6.0 * away**3)
        assert close.punches(0.5, 1.2, away) == pytest.approx(far, abs=2.0 / away**5)
    assert close.punches(1e-9, 1e-12, 1.0) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("excess", [2.0 / 3.0, 0.5, 0.4, 0.25, 1e-3])
def test_a_contact_is_a_sum_of_punches(excess: float) -> None:
    """With the second moment that was asked for: 2/5 is Hertz, 2/3 a punch."""
    away, a, s = 60.0, 1.0, 0.3
    far = 1.0 / away + (2.0 / 3.0 * s * s + excess * a * a) / (4.0 * away**3)
    assert close.punch_and_contact(s, a, excess, away) == pytest.approx(far, abs=2.0 / away**5 + 1e-13)
    away, ratio = 1.3, 1.5 * excess
    if ratio < 1.0:
        power = 0.5 * (1.0 - ratio) / ratio
        exact = quad(lambda load: close.punches(s, a * load**power, away), 0.0, 1.0, epsrel=1e-10, limit=400)[0]
        assert close.punch_and_contact(s, a, excess, away) == pytest.approx(exact, rel=2e-3)


def gram(at: Floats, radius: Floats) -> Floats:
    matrix = np.diag(0.5 * math.pi / radius)
    apart = squareform(pdist(at))
    for i in range(radius.size):
        for j in range(i):
            matrix[i, j] = matrix[j, i] = close.punches(radius[i], radius[j], apart[i, j])
    return matrix


@settings(deadline=None, max_examples=60)
@given(st.integers(2, 25), st.floats(0.0, 6.0), st.floats(0.01, 3.0), st.integers(0, 2**32 - 1))
def test_compliances_and_couplings_are_positive_definite(count: int, decades: float, spread: float, seed: int) -> None:
    """The matrix of clusters of any overlap and radii is a Gram matrix."""
    rng = np.random.default_rng(seed)
    radius = 10.0 ** rng.uniform(-decades, 0.0, count)
    at = spread * rng.normal(size=(count, 2))
    matrix = gram(at, radius)
    unit = matrix / np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
    assert np.linalg.eigvalsh(unit).min() > -1e-9


@settings(deadline=None, max_examples=100)
@given(st.floats(1e-8, 1.0), st.floats(1e-8, 1.0), st.floats(1e-6, 10.0))
def test_it_is_symmetric_and_never_above_a_punch_on_itself(s: float, t: float, away: float) -> None:
    value = close.punches(s, t, away)
    assert value == pytest.approx(close.punches(t, s, away), rel=1e-12)
    assert 0.0 < value <= 0.5 * math.pi / max(s, t) * (1.0 + 1e-9)
    assert close.punches(s, t, 1.01 * away) <= value * (1.0 + 1e-9)


@large_where_compiled
def test_the_change_between_both_is_smooth() -> None:
    """The force of two paraboloids over their distance, through both ends of the change, has no jump and no kink."""

    def force(d: float) -> float:
        made = ensemble([0.0, 0.0], None, radius=1.0, x=[0.0, d], y=0.0)
        asked = {"model": "pairwise", "boundary": "free", "error": 1e-9}
        return float(rm.load_separation(made, separation=-1e-4, effective_modulus=1.0, interaction=asked).force[0])

    distance = np.linspace(1.2, 4.0, 281) * 1e-2
    values = np.array([force(d) for d in distance])
    assert (np.diff(values) > 0.0).all()

    def largest_change(every: int) -> float:
        """Return that of the slope from step to step: of a kink it does not fall with the step."""
        return float(np.abs(np.diff(np.diff(values[::every]) / np.diff(distance[::every]))).max())

    assert largest_change(1) < 0.6 * largest_change(2)


def test_pairs_are_those_within_reach() -> None:
    rng = np.random.default_rng(1)
    at = rng.uniform(0.0, 1.0, (300, 2))
    radius = np.where(rng.uniform(size=300) < 0.5, 10.0 ** rng.uniform(-4.0, -1.0, 300), 0.0)
    for sides in (None, np.ones(2)):
        found = close.find_pairs(at, radius, sides)
        apart = at[:, None] - at[None, :]
        if sides is not None:
            apart -= np.rint(apart)
        away = np.hypot(apart[..., 0], apart[..., 1])
        near = np.triu(away < close.NONE * (radius[:, None] + radius[None, :]), 1)
        asked = {(int(i), int(j)) for i, j in np.argwhere(near)}
        members = [tuple(pair) for pair in found.members.tolist()]
        assert asked <= set(members)
        assert len(set(members)) == len(members)
        np.testing.assert_allclose(found.apart[:, 2], [away[i, j] for i, j in members], rtol=1e-12)
        assert not found.outgrown(1.14 * radius)
        assert found.outgrown(1.16 * radius)
        close.update_shares(found, radius)
        full = {pair for pair, share in zip(members, found.share, strict=True) if share == 1.0}
        asked = {(int(i), int(j)) for i, j in np.argwhere(np.triu(away < close.FULL * (radius[:, None] + radius), 1))}
        assert full == asked


def test_overlaps_are_counted() -> None:
    """Four on a line: the first two overlap, the third is near the second, the fourth has no contact."""
    at, radius = np.array([[0.0, 0.0], [1.5, 0.0], [3.7, 0.0], [3.8, 0.0]]), np.array([1.0, 1.0, 1.0, 0.0])
    pairs = close.find_pairs(at, radius, None)
    close.update_shares(pairs, radius)
    overlapping = np.zeros(4, dtype=np.bool_)
    close.mark_overlaps(pairs, radius, overlapping)
    assert overlapping.tolist() == [True, True, False, False]
