"""Boundary elements: a periodic paraboloid, another program's solution, contacts, stiffness, and runs on the grid."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray
from oracles.boundary_elements import HeightMap
from scenes import scene

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.elements.path import solve_on_grid
from roughmdr.elements.surface import POINTS, grid_shape, surface_of_asperities
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.numerics.arguments import Floats

OVER_HERTZ = {20.0: 1.145247762211, 12.0: 1.273263599777, 8.0: 1.489602436784, 6.0: 1.814344884220, 5.0: 2.2277808930}
"""Force of a periodic paraboloid over 4/3 for E* = R = delta = 1, by the side of the square."""
CROWDED = {
    "source": "random",
    "shape": "paraboloid",
    "count": 100,
    "patch": "200 um",
    "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
    "height": {"distribution": "normal", "std": "1 um"},
    "placement": "random",
}
GRID = {"model": "pairwise", "beyond": "boundary_elements"}


def paraboloid(side: float, points: int) -> Floats:
    x = np.arange(points) * side / points
    x = np.minimum(x, side - x)
    return -0.5 * (x[:, None] ** 2 + x**2)


def on_grid(ensemble: Ensemble, separation: Floats, modulus: float, points: int, *, stiffness: bool = False) -> Any:
    surface = surface_of_asperities(ensemble, float(separation.min()), periodic=True)
    return solve_on_grid(surface, separation, modulus, grid_shape(surface.sides, points), stiffness=stiffness).steps


def crowded(**changes: Any) -> Any:
    return rm.generate({**CROWDED, **changes}, seed=3)


@pytest.mark.large
@pytest.mark.parametrize("side", OVER_HERTZ)
def test_a_periodic_paraboloid(side: float) -> None:
    expected = 4.0 / 3.0 * OVER_HERTZ[side]
    grid = BoundaryElements(paraboloid(side, 256), np.array([side, side]))
    assert grid.press(-1.0) == pytest.approx(expected, rel=1e-4)
    patches = grid.patches()
    assert patches.contacts == 1
    assert patches.radius_sum == pytest.approx(math.sqrt(patches.area / math.pi))
    rates = [BoundaryElements(grid.height, grid.sides).press(-1.0 + change) for change in (-0.1, 0.1)]
    assert grid.stiffness(-1.0) == pytest.approx((rates[0] - rates[1]) / 0.2, rel=0.01)


@pytest.mark.large
def test_another_program_finds_the_same_forces_and_pressures() -> None:
    rng = np.random.default_rng(2)
    waves = np.hypot(np.fft.fftfreq(64)[:, None], np.fft.rfftfreq(64)) * 64
    amplitude = np.where((waves > 1.5) & (waves < 12.0), np.maximum(waves, 1.0) ** -1.8, 0.0)
    height = np.fft.irfft2(amplitude * np.fft.rfft2(rng.normal(size=(64, 64))))
    height *= 1e-8 / height.std()
    side = 3e-6
    ours, theirs = BoundaryElements(height / side, np.ones(2)), HeightMap(height, side)
    for share in (2.5, 1.5, 0.5, 0.1):
        separation = share * 1e-8
        force, other = ours.press(separation / side) * side**2, theirs.press(separation).force
        assert force == pytest.approx(other, rel=2e-5)
        np.testing.assert_allclose(ours.pressure, theirs.pressure, atol=2e-4 * float(ours.pressure.max()))
    assert math.isnan(ours.press(-1e-9 / side))


def test_a_rectangular_patch_of_two_squares_bears_twice_the_force() -> None:
    one = paraboloid(6.0, 96)
    single = BoundaryElements(one, np.array([6.0, 6.0]))
    double = BoundaryElements(np.concatenate([one, one], axis=1), np.array([6.0, 12.0]))
    assert double.press(-1.0) == pytest.approx(2.0 * single.press(-1.0), rel=1e-5)
    assert double.patches().contacts == 2


def test_the_area_of_a_contact_is_that_of_hertz_on_average() -> None:
    """Wherever it lies between the points of the grid: cells at its edge that touch are not in it as a whole."""
    points, side, rng = 64, 4.0, np.random.default_rng(1)
    x = (np.arange(points) - points / 2) * side / points
    areas, touched = [], []
    for _ in range(6):
        at = rng.uniform(-0.5, 0.5, 2) * side / points
        grid = BoundaryElements(
            -0.5 * ((x[:, None] - at[0]) ** 2 + (x - at[1]) ** 2), np.array([side, side]), periodic=False
        )
        assert grid.press(-1.0) == pytest.approx(4.0 / 3.0, rel=2e-3)
        areas.append(grid.patches().area / math.pi)
        touched.append(np.count_nonzero(grid.pressure) * grid.cell_area / math.pi)
    assert np.mean(touched) > 1.01
    assert np.mean(areas) == pytest.approx(1.0, abs=5e-3)


def test_contacts_are_connected_across_the_rim() -> None:
    grid = BoundaryElements(np.zeros((8, 8)), np.ones(2))
    grid.pressure[[0, 7, 0, 7, 4], [0, 0, 7, 7, 4]] = 1.0
    assert grid.patches().contacts == 2


def test_without_overlap_there_is_no_force_and_later_the_start_is_as_good() -> None:
    height = paraboloid(8.0, 64)
    grid = BoundaryElements(height, np.array([8.0, 8.0]))
    assert grid.press(0.5) == 0.0
    assert grid.patches() == (0, 0.0, 0.0, 0.0)
    assert grid.stiffness(0.5) == 0.0
    for h in (-0.02, -0.05, -0.2, -0.3, -1.0):  # of one cell, which is at rest at once, from the first on
        assert grid.press(h) == pytest.approx(BoundaryElements(height, grid.sides).press(h), rel=1e-5)


@pytest.mark.parametrize("seed", range(6))
def test_a_path_from_first_touch_on_loses_no_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at, tops = rng.uniform(0.0, 8.0, (2, 16)), rng.uniform(-0.3, 0.0, 16)
    along = (np.arange(64) + 0.5) * 8.0 / 64
    apart = [np.abs((along - each[:, None] + 4.0) % 8.0 - 4.0) for each in at]
    height = (tops[:, None, None] - 0.5 * (apart[0][:, :, None] ** 2 + apart[1][:, None, :] ** 2)).max(axis=0)
    grid = BoundaryElements(height, np.array([8.0, 8.0]))
    for h in (-0.001, -0.01, -0.05, -0.1, -0.3):
        assert grid.press(h) == pytest.approx(BoundaryElements(height, grid.sides).press(h), rel=1e-5)


@pytest.mark.parametrize("offset", [0.0, 0.25, 0.5])
@pytest.mark.parametrize("h", [-1.0, -0.05, -0.02, -0.005])
def test_the_error_of_the_grid_covers_that_of_a_paraboloid(h: float, offset: float) -> None:
    """Its summit anywhere between points, light contacts too, of which the grid has one cell or none."""
    place = np.full(1, offset * 20.0 / 64)
    ensemble = Ensemble("paraboloid", np.zeros(1), {"radius": np.ones(1)}, 400.0, {"x": place, "y": place})
    step = on_grid(ensemble, np.array([h]), 1.0, 64)[0]
    exact = 4.0 / 3.0 * (-h) ** 1.5 * (OVER_HERTZ[20.0] if h == -1.0 else 1.0)
    assert abs(step.force - exact) <= step.error + 0.02 * exact * (h != -1.0)  # 0.014 of it by the images at -0.05
    assert step.error <= (0.1 if h == -1.0 else 1.5) * max(step.force, exact) + 20.0 / 64 * -h


def test_the_order_of_the_path_changes_nothing() -> None:
    ensemble, path = Ensemble.from_dataset(crowded()), np.array([2e-6, 0.5e-6, 1e-6, 0.5e-6])
    found = on_grid(ensemble, path, 1e6, 64, stiffness=True)
    back = on_grid(ensemble, path[::-1], 1e6, 64, stiffness=True)[::-1]
    assert found == back
    assert found[1] == found[3]
    assert 0.0 < found[0].force < found[2].force < found[1].force


def test_a_deeper_map_changes_nothing() -> None:
    """A map that reaches farther down, as a longer path has it, gives the force that the first one does."""
    ensemble = Ensemble.from_dataset(crowded(count=16))
    deep, far = np.array([-8e-6]), np.array([-8e-6, -40e-6])
    one, both = (on_grid(ensemble, path, 1e6, 64) for path in (deep, far))
    assert both[0].force == pytest.approx(one[0].force, rel=1e-4)


@pytest.mark.large
def test_a_marked_path_is_computed_on_the_grid_as_a_whole() -> None:
    separation = [2.2e-6, 1e-6, 0.0]
    asked = {"separation": separation, "effective_modulus": 1e6, "variables": ["force", "contact_area", "stiffness"]}
    with pytest.warns(rm.LimitWarning):
        pairs = rm.load_separation(crowded(), interaction="pairwise", **asked)
    with pytest.warns(rm.LimitWarning, match="boundary elements on a grid of 512 x 512 points"):
        grid = rm.load_separation(crowded(), interaction=GRID, **asked)
    assert pairs.marked_steps > 0.0
    assert grid.marked_steps == 0.0
    assert grid.overlap_count == pairs.overlap_count
    assert grid.interaction_error == 0.0
    assert 0.0 < grid.numerical_error < 0.02
    np.testing.assert_allclose(grid.force[0], pairs.force[0], rtol=0.01)  # where next to nothing overlaps
    steps = on_grid(Ensemble.from_dataset(crowded()), np.array(separation), 1e6, POINTS)
    np.testing.assert_allclose(grid.force, [step.force for step in steps], rtol=1e-5)


def test_a_path_without_marks_stays_with_pairs() -> None:
    asked = {"separation": [3e-6, 2.2e-6], "effective_modulus": 1e6}
    pairs, grid = (rm.load_separation(crowded(), interaction=each, **asked) for each in ("pairwise", GRID))
    assert grid.identical(pairs)


@pytest.mark.large
def test_a_run_says_which_grid_it_used() -> None:
    table = scene(
        adhesion=None,
        asperities=CROWDED,
        interaction=GRID,
        path={"separation": ["2 um", "0.5 um"]},
        batch={"realizations": 2},
    )
    result = rm.run(table)
    assert (result["marked_steps"] == 0.0).all()
    assert np.isfinite(result["force"]).all()
    assert "boundary elements on a grid of 512 x 512 points" in result.attrs["warnings"]


def test_a_free_patch_has_no_grid() -> None:
    with pytest.raises(rm.SceneError, match='does not go with boundary = "free": the grid repeats'):
        rm.load_separation(crowded(), separation=1e-6, effective_modulus=1e6, interaction={**GRID, "boundary": "free"})


@pytest.mark.large
@given(
    arrays(bool, array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=9)),
    st.sampled_from([1e-18, 1.0, 1e6]),
)
@settings(deadline=None)
def test_the_error_of_the_area_is_of_the_sides_at_the_edges(loaded: NDArray[np.bool_], unit: float) -> None:
    """Twice as many edges have at most twice the error, and at least that of sides which err each on its own."""
    grid = BoundaryElements(np.zeros(loaded.shape), unit * np.array(loaded.shape, dtype=float))
    grid.pressure = np.where(loaded, 1.0, 0.0)
    one = grid.patches()
    two = BoundaryElements(np.zeros((2 * loaded.shape[0], loaded.shape[1])), grid.sides * np.array([2.0, 1.0]))
    two.pressure = np.tile(grid.pressure, (2, 1))
    both = two.patches()
    assert both.area == pytest.approx(2.0 * one.area, rel=1e-12)
    assert 1.41 * one.area_error <= both.area_error <= 2.0 * one.area_error
    assert (one.area_error == 0.0) == (loaded.all() or not loaded.any())
    turned = BoundaryElements(np.zeros(loaded.T.shape), grid.sides[::-1])
    turned.pressure = grid.pressure.T
    assert turned.patches().area_error == pytest.approx(one.area_error, rel=1e-12)


@pytest.mark.large
@pytest.mark.parametrize("unit", [1e-9, 1e3])
def test_nearly_all_hertzian_areas_and_stiffnesses_are_within_their_errors(unit: float) -> None:
    """At given force, of paraboloids of 2 to 12 cells in radius, alone and anywhere between the points."""
    rng, within = np.random.default_rng(5), list[tuple[bool, bool]]()
    for points in np.linspace(32, 72, 40).astype(int).tolist():
        cell, depth = 4.0 / points, rng.uniform(0.02, 0.5)
        x, y = ((np.arange(points) + 0.5 - shift) * cell - 2.0 for shift in rng.uniform(size=2))
        height = -0.5 * (x[:, None] ** 2 + y**2) * unit
        grid = BoundaryElements(height, unit * np.array([4.0, 4.0]), periodic=False)
        force = grid.press(-depth * unit) / unit**2
        found, radius = grid.patches(), (0.75 * force) ** (1.0 / 3.0)
        stated = found.area_error / found.area
        off = (
            found.area / unit**2 / (math.pi * radius**2) - 1.0,
            grid.stiffness(-depth * unit) / unit / (2 * radius) - 1,
        )
        within.append((abs(off[0]) <= stated, abs(off[1]) <= 0.5 * stated))
        assert stated < 0.45
    assert (np.mean(within, axis=0) >= 0.9).all()
