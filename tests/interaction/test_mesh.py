"""Displacements by the mesh against those of each pair summed: values, slopes, Laplacians and moments."""

import math

import numpy as np
import pytest
from scipy.special import erfcinv

from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import Periodic
from roughmdr.interaction.mesh import _MESH_PER_REACH as MESH_PER_REACH, Mesh
from roughmdr.numerics.arguments import Floats

ERRORS = 1e-3, 3e-7, 1e-9
SIDES = 1.0, 0.25, 3.0
BOUNDARIES = pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "free"])
Points = tuple[Floats, Floats]


def uniform(count: int, side_y: float, seed: int = 1) -> Points:
    rng = np.random.default_rng(seed)
    return rng.uniform(0.0, 1.0, count), rng.uniform(0.0, side_y, count)


def clustered(count: int) -> Points:
    """Half of the points in a spot of a thousandth of the patch, across its corner."""
    x, y = uniform(count, 1.0)
    half = count // 2
    x[:half], y[:half] = (1e-3 * (values[:half] - 0.5) % 1.0 for values in (x, y))
    return x, y


def across_the_edge(count: int) -> Points:
    """Points within a hundredth of the edges, and on them."""
    x, y = uniform(count, 1.0)
    x = 0.01 * (x - 0.5) % 1.0
    x[:4], y[:4] = [0.0, np.nextafter(1.0, 0.0), 0.3, 0.7], [0.5, 0.6, 0.0, np.nextafter(1.0, 0.0)]
    return x, y


def loads(count: int, seed: int = 2) -> Floats:
    """Return loads like those of contacts: none or positive, over two decades."""
    rng = np.random.default_rng(seed)
    return np.where(rng.uniform(size=count) < 0.7, 10.0 ** rng.uniform(-2.0, 0.0, count), 0.0)


def outputs(coupling: Dense | Mesh, count: int) -> dict[str, Floats]:
    load, tilts = loads(count), np.random.default_rng(3).normal(size=(2, count))
    field = coupling.field(load)
    return {
        "potential": coupling.potential(load),
        "of field": field[0],
        "slopes": field[1:3],
        "laplacian": field[3],
        "moments": coupling.of_moments(load, 0.01 * tilts[0] * load, 0.01 * tilts[1] * load),
    }


def assert_near(points: Points, side_y: float, periodic: bool, error: float) -> None:
    patch, count = Periodic.of(side_y), points[0].size
    exact = outputs(Dense(*points, patch, periodic), count)
    found = outputs(Mesh(*points, patch, periodic, error), count)
    for name, values in exact.items():
        off = np.sqrt(np.mean((found[name] - values) ** 2))
        assert off <= error * np.sqrt(np.mean(values**2)), name
    np.testing.assert_allclose(found["potential"], found["of field"], rtol=0.0, atol=1e-12 * found["potential"].max())


@pytest.mark.few(1)
@BOUNDARIES
@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize("side_y", SIDES)
def test_each_within_its_error_of_pairs_summed(side_y: float, error: float, periodic: bool) -> None:
    assert_near(uniform(600, side_y), side_y, periodic, error)


@pytest.mark.few(1)
@BOUNDARIES
@pytest.mark.parametrize("points", [clustered(500), across_the_edge(500)], ids=["clustered", "across"])
def test_where_points_lie_does_not_matter(points: Points, periodic: bool) -> None:
    assert_near(points, 1.0, periodic, 3e-7)


@pytest.mark.few(1)
@BOUNDARIES
@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize("apart", [0.0, 1e-6, 0.01, 0.5])
def test_one_or_two_loads_among_many_points(apart: float, error: float, periodic: bool) -> None:
    """Loads like those at first touch are right to the error of the displacement at the mean distance of the points,
    and its derivatives to that times the highest wave of the mesh for each; the second, which a narrow window aliases,
    to twice that.
    """
    count = 400
    x, y = uniform(count, 1.0)
    x[0], y[0], x[1], y[1] = 0.3, 0.98, 0.3 + apart if apart else 0.6, 0.98
    load, none = np.zeros(count), np.zeros(count)
    load[: 2 if apart else 1] = 1.0
    patch, spacing = Periodic.of(1.0), 1.0 / math.sqrt(count)
    dense, mesh = Dense(x, y, patch, periodic), Mesh(x, y, patch, periodic, error)
    exact, found = (np.vstack([each.field(load), each.of_moments(load, none, none)]) for each in (dense, mesh))
    highest = math.pi * MESH_PER_REACH * float(erfcinv(error))
    for row, power in ((0, 0), (1, 1), (2, 1), (3, 2), (4, 2)):
        scale = np.abs(exact[row, :2]).max() if apart == 1e-6 else 0.0  # the derivatives of 1/r there lose digits
        aliased = 2.0 if power == 2 else 1.0
        bound = aliased * load.sum() * error * highest**power / spacing ** (power + 1) + 1e-10 * scale
        assert np.abs(found - exact)[row].max() <= bound, row


@pytest.mark.parametrize("error", [1e-4, 3e-7])
def test_moving_all_changes_nothing_beyond_its_error(error: float) -> None:
    x, y = uniform(400, 1.0)
    here = outputs(Mesh(x, y, Periodic.of(1.0), True, error), x.size)
    for shift in ((0.1234, 0.777), (1e-3, 0.5), (3.3, -8.1)):
        there = outputs(Mesh((x + shift[0]) % 1.0, (y + shift[1]) % 1.0, Periodic.of(1.0), True, error), x.size)
        for name, values in here.items():
            off = np.sqrt(np.mean((there[name] - values) ** 2))
            assert off <= 2.0 * error * np.sqrt(np.mean(values**2)), name


@BOUNDARIES
def test_it_is_linear_and_symmetric(periodic: bool) -> None:
    """p . G q = q . G p: without this conjugate gradients would not converge."""
    x, y = uniform(350, 1.0)
    mesh = Mesh(x, y, Periodic.of(1.0), periodic, 3e-7)
    p, q = np.random.default_rng(5).normal(size=(2, x.size))
    scale = np.linalg.norm(p) * np.linalg.norm(mesh.potential(q))
    assert p @ mesh.potential(q) == pytest.approx(q @ mesh.potential(p), abs=1e-13 * scale)
    both = 2.0 * mesh.potential(p) - 3.0 * mesh.potential(q)
    np.testing.assert_allclose(mesh.potential(2.0 * p - 3.0 * q), both, rtol=0.0, atol=1e-12 * np.abs(both).max())
    field = mesh.field(p)
    moments = mesh.of_moments(q, np.zeros_like(q), np.zeros_like(q))
    assert q @ field[3] == pytest.approx(p @ moments, abs=1e-11 * np.linalg.norm(q) * np.linalg.norm(field[3]))
    slope = mesh.of_moments(np.zeros_like(q), q, np.zeros_like(q))
    assert q @ field[1] == pytest.approx(-(p @ slope), abs=1e-11 * np.linalg.norm(q) * np.linalg.norm(field[1]))


@BOUNDARIES
@pytest.mark.parametrize("points", [uniform(200, 1.0), clustered(200)], ids=["uniform", "clustered"])
def test_the_least_displacement_is_below_that_at_any_place(points: Points, periodic: bool) -> None:
    """Point loads press; asperities that do not touch yet stand elsewhere."""
    patch = Periodic.of(1.0)
    grid = np.linspace(0.0, 1.0, 41)[:-1] + 0.0061
    x, y = (np.concatenate([p, q.ravel()]) for p, q in zip(points, np.meshgrid(grid, grid), strict=True))
    touching = loads(200)
    everywhere = Mesh(x, y, patch, periodic, 1e-6).potential(np.concatenate([touching, np.zeros(grid.size**2)]))
    for coupling in (Dense(*points, patch, periodic), Mesh(*points, patch, periodic, 1e-6)):
        assert coupling.least_displacement(touching) <= everywhere[200:].min()


def test_the_same_bits_twice() -> None:
    x, y = uniform(500, 1.0)
    first, second = (outputs(Mesh(x, y, Periodic.of(1.0), True, 3e-7), 500) for _ in range(2))
    for name, values in first.items():
        assert values.tobytes() == second[name].tobytes()
