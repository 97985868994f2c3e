"""The memory of friction on lateral paths: properties that hold for any first curve."""

import numpy as np
from hypothesis import given, settings, strategies as st

from roughmdr.loading.masing import Masing, directions
from roughmdr.numerics.arguments import Floats

PATHS = st.lists(st.integers(-40, 40), min_size=1, max_size=60).map(lambda steps: np.array(steps, dtype=float) / 8.0)


def first_force(u: Floats) -> Floats:
    return 1.0 - np.exp(-u)


def first_loss(u: Floats) -> Floats:
    """2 ∫ T1 du - u T1, of Masing's springs: work less what they store."""
    return 2.0 * (u + np.exp(-u) - 1.0) - u * first_force(u)


def along(path: Floats) -> tuple[Floats, Floats]:
    memory = Masing.along(path)
    return memory.force(first_force(memory.amplitude)), memory.loss(first_loss(memory.amplitude))


def iwan(path: Floats, count: int = 4000) -> tuple[Floats, Floats]:
    """Springs of stiffness dT1'(limit) that slide at their limits, whose first force is T1: step by step."""
    share = (np.arange(count) + 0.5) / count
    most = -np.log(share)  # displacements at which they slide: exponentially spread
    shift, before, spent = np.zeros(count), 0.0, 0.0
    force, lost = np.empty(path.size), np.empty(path.size)
    for step, here in enumerate(path.tolist()):
        tried = shift + here - before
        shift = np.clip(tried, -most, most)
        spent += float(np.mean(most * np.abs(tried - shift)))
        force[step], lost[step], before = float(np.mean(shift)), spent, here
    return force, lost


@settings(deadline=None)
@given(path=PATHS)
def test_it_is_that_of_sliding_springs(path: Floats) -> None:
    force, lost = along(path)
    slow_force, slow_lost = iwan(path)
    np.testing.assert_allclose(force, slow_force, atol=1e-3)
    np.testing.assert_allclose(lost, slow_lost, atol=2e-3 * (1.0 + np.abs(np.diff(path, prepend=0.0)).sum()))


@settings(deadline=None)
@given(path=PATHS)
def test_it_is_odd_and_loses_energy_only(path: Floats) -> None:
    force, lost = along(path)
    mirrored, lost_again = along(-path)
    np.testing.assert_array_equal(mirrored, -force)
    np.testing.assert_array_equal(lost_again, lost)
    assert (np.diff(lost, prepend=0.0) >= 0.0).all()
    assert (np.abs(force) <= first_force(np.maximum.accumulate(np.abs(path)))).all()


@settings(deadline=None)
@given(path=PATHS, number=st.integers(1, 5))
def test_steps_between_change_nothing(path: Floats, number: int) -> None:
    begins = np.concatenate([[0.0], path[:-1]])
    finer = np.concatenate(
        [np.append(np.linspace(a, b, number, endpoint=False), b) for a, b in zip(begins, path, strict=True)]
    )
    force, lost = along(path)
    fine_force, fine_lost = along(finer)
    np.testing.assert_array_equal(fine_force[number :: number + 1], force)
    np.testing.assert_allclose(fine_lost[number :: number + 1], lost, rtol=1e-12, atol=1e-13)


def test_closed_loops_are_forgotten() -> None:
    """Bit for bit in the force; the energy keeps their loss, four times that of half their width."""
    there, loops, on = [0.5, 1.0, 2.0, 1.0], [1.5, 1.25, 1.375, 1.0], [0.25, -0.5, -2.0, -2.5, 3.0]
    force, lost = along(np.array(there + on))
    with_loops, lost_with = along(np.array(there + loops + on))
    np.testing.assert_array_equal(with_loops[len(there + loops) - 1 :], force[len(there) - 1 :])
    of_loops = 4.0 * first_loss(np.array([0.25, 0.0625])).sum()
    np.testing.assert_allclose(lost_with[len(there + loops) - 1 :] - lost[len(there) - 1 :], of_loops, rtol=1e-13)


def test_loops_between_the_same_displacements_are_congruent() -> None:
    loop = np.array([1.0, 0.75, 0.5, 0.75, 1.0])
    after_more, _ = along(np.concatenate([[3.0, -1.0], loop]))
    after_less, _ = along(np.concatenate([[1.5, 0.25], loop]))
    np.testing.assert_allclose(np.diff(after_more[-5:]), np.diff(after_less[-5:]), rtol=1e-13)
    assert abs(after_more[-1] - after_less[-1]) > 0.01


def test_the_first_curve_goes_on_beyond_the_largest_displacement_on_either_side() -> None:
    path = np.array([1.0, -0.5, 0.5, -1.0, -1.5, 0.0, 2.0])
    force, _ = along(path)
    np.testing.assert_array_equal(
        force[[0, 3, 4, 6]], np.sign(path)[[0, 3, 4, 6]] * first_force(np.abs(path))[[0, 3, 4, 6]]
    )


def test_a_turning_point_that_is_repeated_begins_the_branch_after_it() -> None:
    np.testing.assert_array_equal(directions(np.array([0.0, 1.0, 1.0, 0.0, 0.0])), [1.0, 1.0, -1.0, -1.0, -1.0])
    memory = Masing.along(np.array([0.0, 1.0, 1.0, 0.5]))
    assert memory.amplitude.tolist() == [0.0, 1.0, 0.0, 0.25]
    assert memory.origin.tolist() == [-1, -1, 1, 1]


def test_a_path_at_rest_has_no_force() -> None:
    force, lost = along(np.zeros(4))
    assert not force.any()
    assert not lost.any()


def test_what_is_lost_never_falls_by_roundings() -> None:
    memory = Masing.along(np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(memory.loss(np.array([1.0, 1.0 - 2e-16, 2.0])), [1.0, 1.0, 2.0])
