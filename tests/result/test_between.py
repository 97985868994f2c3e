"""How far a curve may be off between its steps: parabolas, single jumps, random walks, on any scale."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from roughmdr.result.between import ANYWHERE, AT_A_PLACE, CONFIDENCE, REACH, off_line

STEPS = 2 * REACH + 2
INNER = st.lists(st.floats(0.3, 3.0), min_size=STEPS - 1, max_size=STEPS - 1)

EVEN = st.lists(st.floats(0.9, 1.1), min_size=STEPS - 1, max_size=STEPS - 1)


def off(path: NDArray[np.float64], curve: NDArray[np.float64], spreads: float = ANYWHERE) -> tuple[float, float]:
    bent, jumps = off_line(path, curve, spreads=spreads)
    return float(bent), float(jumps)


@settings(deadline=None)
@given(steps=INNER, down=st.booleans(), scale=st.sampled_from([1e-9, 1.0, 1e6]))
def test_a_parabola_bends_and_does_not_jump(steps: list[float], down: bool, scale: float) -> None:
    path = np.concatenate([[0.0], np.cumsum(steps)]) * scale * (-1.0 if down else 1.0)
    bent, jumps = off(path, 3.0 * (path / scale) ** 2 + 5.0 * path / scale)
    exact = 3.0 * float(np.diff(path)[REACH] / scale) ** 2 / 4.0
    assert bent == pytest.approx(1.1 * exact, rel=1e-6)
    assert jumps < 1e-6 * exact


@settings(deadline=None)
@given(steps=EVEN, slope=st.floats(-5.0, 5.0), jump=st.floats(0.1, 10.0), scale=st.sampled_from([1e-9, 1.0, 1e9]))
def test_a_single_jump_on_a_line_is_found_with_its_size(
    steps: list[float], slope: float, jump: float, scale: float
) -> None:
    path = np.concatenate([[0.0], np.cumsum(steps)])
    curve = scale * (slope * path + jump * (np.arange(STEPS) > REACH))
    _, jumps = off(path, curve)
    assert 0.95 * jump * scale < jumps < 1.2 * jump * scale
    assert off(path, -2.0 * curve)[1] == pytest.approx(2.0 * jumps)


@pytest.mark.parametrize("spreads", [ANYWHERE, AT_A_PLACE])
def test_a_random_walk_stays_within_and_is_not_far_from_it(spreads: float) -> None:
    """Rises of 64 parts each; what is between the middle steps against what the steps tell."""
    rng = np.random.default_rng(5)
    parts = rng.normal(size=(4000, STEPS - 1, 64))
    walk = np.cumsum(parts.reshape(4000, -1), axis=-1)
    steps = np.concatenate([np.zeros((4000, 1)), walk[:, 63::64]], axis=-1)
    bent, jumps = off_line(np.broadcast_to(np.arange(float(STEPS)), steps.shape), steps, spreads=spreads)
    inside = walk[:, 64 * REACH - 1 : 64 * (REACH + 1)]
    away = np.abs(inside - np.linspace(inside[:, 0], inside[:, -1], 65, axis=-1))
    away = away.max(axis=-1) if spreads == ANYWHERE else away[np.arange(4000), rng.integers(1, 64, 4000)]
    assert np.mean(away <= bent + jumps) > CONFIDENCE
    if spreads == ANYWHERE:
        assert np.median((bent + jumps) / away) < 3.0


def test_beyond_the_ends_nothing_is_needed_and_of_three_steps_nothing_is_known() -> None:
    path = np.arange(float(STEPS))
    curve = path**2
    for first, last in ((REACH, REACH + 4), (REACH - 2, REACH + 2), (REACH - 1, REACH + 3)):
        part = np.where((path >= first) & (path < last), curve, np.nan)
        assert sum(off(path, part)) == pytest.approx(0.275)
    assert np.isnan(sum(off(path, np.where((path >= REACH) & (path < REACH + 3), curve, np.nan))))


def test_a_path_that_stands_still_beside_is_no_slope() -> None:
    path = np.arange(float(STEPS))
    path[: REACH - 1] = path[REACH - 1]
    assert sum(off(path, path**2)) == pytest.approx(0.275)
