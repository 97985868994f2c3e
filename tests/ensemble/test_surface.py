"""Summits of height maps: exact on surfaces that are known, right on a measured one."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st

import roughmdr as rm
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits

OPTICAL = Path(__file__).parents[3] / "shared" / "surfaces" / "optical.nc"


def write_map(path: Path, height: np.ndarray, units: str = "m", **coordinates: object) -> Path:
    nx, ny = height.shape
    x, y = np.arange(nx) * 1e-6, np.arange(ny) * 2e-6
    data = xr.Dataset({"height": (("x", "y"), height, {"units": units})}, coords={"x": x, "y": y})
    data.assign_coords(coordinates).to_netcdf(path)
    return path


@settings(deadline=None)
@given(
    kx=st.floats(0.05, 2.0),
    ky=st.floats(0.05, 2.0),
    twist=st.floats(-0.9, 0.9),
    at=st.tuples(st.floats(-0.45, 0.45), st.floats(-0.45, 0.45)),
    unit=st.sampled_from([1e-9, 1e-6, 1.0]),
)
def test_a_paraboloid_is_found_exactly(
    kx: float, ky: float, twist: float, at: tuple[float, float], unit: float
) -> None:
    dx, dy = 0.5 * unit, 0.7 * unit
    x = (np.arange(9) - 4 - at[0])[:, None] * dx
    y = (np.arange(11) - 5 - at[1])[None, :] * dy
    k1, k2, k12 = kx / unit, ky / unit, twist * np.sqrt(kx * ky) / unit
    height = 3.0 * unit - 0.5 * (k1 * x * x + 2.0 * k12 * x * y + k2 * y * y)
    inner = height[3:6, 4:7]
    if np.argmax(inner) != 4:
        return  # a long ridge across the grid: its top is not above all eight neighbours
    found = find_summits(HeightMap(height, dx, dy))
    radius = 1.0 / np.sqrt(k1 * k2 - k12 * k12)
    best = int(np.argmin(np.abs(found.height - 3.0 * unit)))
    assert found.parameters["radius"][best] == pytest.approx(radius, rel=1e-9)
    assert found.height[best] == pytest.approx(3.0 * unit, rel=1e-9)
    assert found.positions["x"][best] == pytest.approx((4.5 + at[0]) * dx, rel=1e-7)
    assert found.positions["y"][best] == pytest.approx((5.5 + at[1]) * dy, rel=1e-7)


def test_the_radius_converges_with_the_grid_on_an_egg_box() -> None:
    """Heights cos(qx x) cos(qy y): curvatures qx^2 and qy^2 at every summit; the error goes as the spacing squared."""
    errors = []
    for points in (64, 128, 256):
        x = np.arange(points) / points + 0.003
        height = np.cos(2 * np.pi * 3 * x)[:, None] * np.cos(2 * np.pi * 5 * x)[None, :]
        found = find_summits(HeightMap(height, 1.0 / points, 1.0 / points))
        radius = 1.0 / ((2 * np.pi) ** 2 * 15.0)
        errors.append(float(np.max(np.abs(found.parameters["radius"] / radius - 1.0))))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.7).all()
    assert errors[-1] < 0.01


def surface(path: Path) -> xr.Dataset:
    return rm.generate({"source": "surface", "file": str(path)}, seed=0)


@pytest.mark.skipif(not OPTICAL.exists(), reason="the measured surface is not here")
def test_the_measured_surface_has_about_140_summits() -> None:
    """Its heights are multiples of 7.45 nm, more than the drop from a summit to its neighbours."""
    with pytest.warns(rm.errors.LimitWarning, match="^optical.nc: radii uncertain by a factor of about 2.1: noise, or"):
        data = surface(OPTICAL)
    assert 130 <= data.sizes["asperity"] <= 145
    assert 400 < data.attrs["points_per_summit"] < 460
    assert data.attrs["rms_slope"] == pytest.approx(0.09, abs=0.005)
    assert 0.9 < data.attrs["misfit"] < 1.0
    assert data.attrs["rms_height_raw"] == pytest.approx(7.69e-6, rel=0.01)
    assert float(data.height.std()) == pytest.approx(0.28e-6, rel=0.05)
    assert 1e-6 < float(data.radius.min()) < float(data.radius.max()) < 1e-4
    path = np.linspace(1.2e-6, 0.0, 60)
    for work in (0.0, 0.05):
        law = rm.load_separation(data, separation=path, effective_modulus=6.6e6, work=work, unload=True)
        assert float(law.force.max()) > 0.0
        assert (float(law.force.min()) < 0.0) == (work > 0.0)


def test_area_positions_and_saddles_are_counted() -> None:
    x, y = np.arange(20.0)[:, None], np.arange(30.0)[None, :]
    bumps = np.zeros((20, 30))
    for at_x, at_y in ((5, 6), (12, 20)):
        bumps += np.maximum(0.0, 1.0 - 0.1 * ((x - at_x) ** 2 + (y - at_y) ** 2))
    # Above all eight neighbours, yet the fit through it is a saddle: a ridge along the diagonal, dented beside it.
    bumps[15:18, 3:6] = [[0.99, -9.0, -9.0], [-0.01, 1.0, -0.01], [-9.0, -9.0, 0.99]]
    found = find_summits(HeightMap(bumps, 0.5, 2.0))
    assert found.height.size == 2
    assert found.attrs["saddles"] == 1
    assert found.nominal_area == 20 * 0.5 * 30 * 2.0
    assert sorted(found.positions["x"]) == pytest.approx([5.5 * 0.5, 12.5 * 0.5])


@pytest.mark.parametrize(("side", "top"), [(0.5, 0.25**0.5 * 0.5 / (2 * 0.6)), (0.8, 0.0)])
def test_a_top_beyond_the_neighbours_is_not_trusted(side: float, top: float) -> None:
    """Drops of 0 and 1 along one axis, ``side`` across: the fit peaks 0.83 of a spacing away, or 1.39 away."""
    height = np.full((5, 5), -9.0)
    height[1:4, 1:4] = [[-1.0, -1.0, -1.0], [-side, 0.0, -side], [-1e-9, -1e-9, -1e-9]]
    found = find_summits(HeightMap(height, 1.0, 1.0))
    assert found.height.tolist() == [pytest.approx(top, abs=1e-8)]


@settings(deadline=None)
@given(drops=st.lists(st.floats(0.01, 1.0), min_size=8, max_size=8), unit=st.sampled_from([1e-9, 1.0]))
def test_the_paraboloid_goes_through_the_point_and_is_fitted_to_its_eight_neighbours(
    drops: list[float], unit: float
) -> None:
    """Against least squares over the neighbours alone, in which the height of the point itself is no unknown."""
    height = np.full((5, 5), -9.0)
    height[1:4, 1:4] = -np.insert(drops, 4, 0.0).reshape(3, 3)
    x, y = (axis.ravel() for axis in np.meshgrid([-0.5, 0.0, 0.5], [-0.7, 0.0, 0.7], indexing="ij"))
    design = np.stack([x, y, 0.5 * x * x, x * y, 0.5 * y * y], axis=1)
    others = np.arange(9) != 4
    _, _, A, B, C = np.linalg.lstsq(design[others], height[1:4, 1:4].ravel()[others])[0]
    if not (A * C - B * B > 1e-6 and A < 0.0):
        return  # no dome
    found = find_summits(HeightMap(unit * height, 0.5 * unit, 0.7 * unit))
    assert found.parameters["radius"].tolist() == [pytest.approx(unit / np.sqrt(A * C - B * B), rel=1e-9)]


def test_rounding_is_not_roughness(tmp_path: Path) -> None:
    x, y = np.arange(60.0)[:, None], np.arange(50.0)[None, :]
    for name, height in (("plane", 1e-3 * x + 2e-3 * y), ("dome", -((x - 30.0) ** 2) - (y - 25.0) ** 2)):
        path = write_map(tmp_path / f"{name}.nc", 1e-9 * height)
        with pytest.raises(rm.SceneError, match="no summit"):
            surface(path)


def test_one_summit_has_no_sigma(tmp_path: Path) -> None:
    height = np.zeros((9, 9))
    height[4, 4] = 1e-6
    path = write_map(tmp_path / "spike.nc", height)
    asked = {
        "material": {"effective_modulus": "1 MPa"},
        "asperities": {"source": "surface", "file": str(path)},
        "path": {"separation": {"start": "4 sigma", "stop": "0 sigma", "steps": 4}},
    }
    with pytest.raises(rm.SceneError, match="standard deviation is 0 m"):
        rm.run(asked)
    assert surface(path).attrs["seed"] == 0
