"""The union of asperities as a height map: the highest of all and of their images at each point."""

import numpy as np
import pytest
from scenes import WIDER_SHAPES

from roughmdr.elements.surface import POINTS, grid_shape, union_map
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.buried import drop
from roughmdr.numerics.arguments import Floats

SHAPES: dict[str, dict[str, tuple[float, float]]] = {
    "paraboloid": {"radius": (3e-5, 8e-5)},
    "cone": {"slope": (0.1, 0.2)},
    **WIDER_SHAPES,
}
SIDES = np.array([1e-4, 6e-5])


def asperities(shape: str, count: int = 12, unit: float = 1.0) -> Ensemble:
    rng = np.random.default_rng(5)
    ranges = SHAPES[shape].items()
    lengths = {"radius", "flat_radius", "blend_radius", "cap_radius", "edge_radius"}
    parameters = {name: rng.uniform(*limits, count) * (unit if name in lengths else 1.0) for name, limits in ranges}
    x, y = rng.uniform(-1.0, 2.0, (2, count)) * SIDES[:, None] * unit
    return Ensemble(shape, rng.normal(0.0, 1e-6, count) * unit, parameters, None, {"x": x, "y": y})


def slow_map(ensemble: Ensemble, shape: tuple[int, int]) -> Floats:
    """All asperities and images at all points, one by one."""
    grid = np.stack(
        np.meshgrid(*(np.arange(n) * side / n for n, side in zip(shape, SIDES, strict=True)), indexing="ij")
    )
    heights = np.full(shape, -np.inf)
    for i in range(ensemble.height.size):
        for image in np.ndindex(7, 7):
            at = np.array([ensemble.positions[name][i] for name in ("x", "y")]) + (np.array(image) - 3) * SIDES
            r = np.hypot(*(grid - at[:, None, None])).ravel()
            own = ensemble.height[i] - drop(ensemble, np.full(r.size, i), r).reshape(shape)
            heights = np.maximum(heights, own)
    return heights


@pytest.mark.few(2)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("depth", [1e-6, 3e-5])
def test_it_is_the_highest_of_all_images(shape: str, depth: float) -> None:
    ensemble, points = asperities(shape), (36, 22)
    floor = float(ensemble.height.min()) - depth
    expected = slow_map(ensemble, points)
    expected[expected < floor] = -np.inf
    np.testing.assert_allclose(union_map(ensemble, SIDES, points, floor), expected, rtol=1e-9, atol=1e-18)


def test_other_units_give_the_same_map() -> None:
    unit, points = 1e6, (36, 22)
    metres, micrometres = asperities("paraboloid"), asperities("paraboloid", unit=unit)
    small = union_map(metres, SIDES, points, -1e-5)
    np.testing.assert_allclose(union_map(micrometres, SIDES * unit, points, -1e-5 * unit), small * unit, rtol=1e-9)


def test_nothing_covers_what_lies_beyond_all_ends() -> None:
    assert np.isneginf(union_map(asperities("flat_punch"), SIDES, (36, 22), -1.0)).any()


def test_cells_are_about_square_and_even_in_number() -> None:
    assert grid_shape(np.array([1.0, 1.0]), POINTS) == (512, 512)
    x, y = grid_shape(np.array([3.0, 1.0]), POINTS)
    assert x % 2 == y % 2 == 0
    assert x / y == pytest.approx(3.0, rel=0.03)
    assert x * y == pytest.approx(POINTS**2, rel=0.05)


def test_an_asperity_below_the_floor_is_nowhere() -> None:
    assert np.isneginf(union_map(asperities("paraboloid"), SIDES, (36, 22), 1e-3)).all()
