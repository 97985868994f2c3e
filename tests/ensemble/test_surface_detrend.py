"""Trends and short waves removed from height maps, the effect of gaps and edges, and the resolution of summits."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
import tomli_w
import xarray as xr
from command import roughmdr, said
from scenes import scene

import roughmdr as rm
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.detrend import remove_short_waves, remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap, map_statistics
from roughmdr.ensemble.maps.resolution import radius_uncertainty
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.errors import LimitWarning

approx = partial(pytest.approx, abs=0.0)
TRENDS = {"none": 0, "mean": 1, "plane": 3, "quadratic": 6}
"""How many of the terms 1, x, y, x x, x y, y y each removes."""


def terms(nx: int, ny: int) -> np.ndarray:
    x, y = np.linspace(-1.0, 1.0, nx)[:, None], np.linspace(-1.0, 1.0, ny)[None, :]
    one = np.ones((nx, ny))
    return np.stack([one, x * one, y * one, x * x * one, x * y, y * y * one])


def gaps(nx: int, ny: int) -> np.ndarray:
    """A scratch, a hole in a corner and single points."""
    undefined = np.random.default_rng(7).random((nx, ny)) < 0.05
    undefined[: nx // 3, : ny // 2] = True
    undefined[nx // 2] = True
    return undefined


def waves(points: int, shortest: float, longest: float, hurst: float = 0.8, seed: int = 1) -> np.ndarray:
    """A periodic self-affine map with waves from ``shortest`` to ``longest`` spacings, of r.m.s. height 1."""
    along = np.fft.fftfreq(points)
    q = np.hypot(along[:, None], along[None, :])
    amplitude = np.where((q * longest >= 1.0) & (q * shortest <= 1.0), np.maximum(q, 1e-9) ** (-1.0 - hurst), 0.0)
    white = np.random.default_rng(seed).normal(size=(points, points))
    height = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    return height / height.std()


def detrended(height: np.ndarray, trend: str) -> np.ndarray:
    found = height.copy()
    remove_trend(found, trend)
    return found


def smoothed(surface: HeightMap, cutoff: float) -> np.ndarray:
    found = surface._replace(height=surface.height.copy())
    remove_short_waves(found, cutoff)
    return found.height


@pytest.mark.parametrize("trend", TRENDS)
@pytest.mark.parametrize("gappy", [False, True])
@pytest.mark.parametrize("unit", [1e-9, 1.0])
def test_a_trend_is_removed_exactly(trend: str, gappy: bool, unit: float) -> None:
    """A trend makes no difference, however steep and far from 0, and nothing else is removed."""
    basis = terms(31, 42)[: TRENDS[trend]]
    rough = unit * np.random.default_rng(1).normal(size=(31, 42))
    rough[gaps(31, 42) if gappy else np.zeros((31, 42), dtype=bool)] = np.nan
    tilted = rough + np.tensordot(unit * np.array([1e4, 3e3, -2e3, 1e3, 4e3, -5e3])[: len(basis)], basis, axes=1)
    found, same = detrended(rough, trend), detrended(tilted, trend)
    np.testing.assert_allclose(same, found, atol=1e-11 * unit)
    np.testing.assert_array_equal(np.isnan(found), np.isnan(rough))
    known = ~np.isnan(rough)
    design = basis[:, known].T
    fit = design @ np.linalg.lstsq(design, rough[known], rcond=None)[0] if len(basis) else 0.0
    np.testing.assert_allclose(found[known], rough[known] - fit, atol=1e-13 * unit)


@pytest.mark.parametrize("unit", [1e-9, 1.0])
@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("spacings", [2.0, 8.0])
def test_the_gaussian_passes_half_at_its_cutoff(ratio: float, spacings: float, unit: float) -> None:
    """2^-(cutoff/wavelength)^2, far from the edges; ``ratio`` is wavelength over cutoff."""
    dx, dy, cutoff = 0.8 * unit, unit, spacings * unit
    length = max(ratio * cutoff, 2.5 * unit)
    x, y = np.arange(160) * dx, np.arange(130) * dy
    wave = np.cos(2 * np.pi * (x[:, None] * 0.6 + y[None, :] * 0.8) / length)
    passed = smoothed(HeightMap(wave, dx, dy), cutoff)
    inner = (slice(50, -50), slice(50, -50))
    np.testing.assert_allclose(passed[inner], 2.0 ** -((cutoff / length) ** 2) * wave[inner], atol=2e-3)


def test_the_filter_is_a_weighted_mean_of_defined_points() -> None:
    """Against the explicit sum, at edges and between gaps; a constant is unchanged."""
    height = np.random.default_rng(4).normal(size=(40, 30))
    height[gaps(40, 30)] = np.nan
    dx, dy, cutoff = 1.0, 1.3, 20.0
    found = smoothed(HeightMap(height, dx, dy), cutoff)
    known = ~np.isnan(height)
    x, y = np.arange(40)[:, None] * dx, np.arange(30)[None, :] * dy
    for i, j in ((0, 29), (39, 0), (21, 15), (13, 20)):
        weight = np.exp(-(np.pi**2) / np.log(2) * ((x - x[i]) ** 2 + (y - y[0, j]) ** 2) / cutoff**2)[known]
        expected = np.sum(weight * height[known]) / np.sum(weight)
        assert found[i, j] == approx(expected, rel=1e-12)
    constant = smoothed(HeightMap(np.where(known, 3.0, np.nan), dx, dy), cutoff)
    np.testing.assert_allclose(constant[known], 3.0, rtol=1e-11)
    np.testing.assert_array_equal(np.isnan(constant), ~known)


def test_a_periodic_map_is_cut_sharply() -> None:
    x = np.arange(48)[:, None] / 48
    y = np.arange(36)[None, :] / 36
    kept = np.cos(2 * np.pi * 6 * x + 1.0) + np.sin(2 * np.pi * (4 * x + 4 * y)) + 2.0
    cut = np.cos(2 * np.pi * 7 * y) + np.sin(2 * np.pi * (5 * x + 4 * y))
    surface = HeightMap(kept + cut, 1e-6 / 48, 1e-6 / 36, periodic=True)
    np.testing.assert_allclose(smoothed(surface, 1e-6 / 6), kept, atol=1e-13)
    surface.height[3, 4] = np.nan
    with pytest.raises(rm.SceneError, match="undefined points has no spectrum"):
        remove_short_waves(surface, 1e-6 / 6)


def rows(found: Ensemble, *, side: float) -> np.ndarray:
    """Summits in one order, with their positions around the cell."""
    x, y = found.positions["x"], found.positions["y"]
    assert min(x.min(), y.min()) >= 0.0
    assert max(x.max(), y.max()) < side
    table = np.stack([found.height, found.parameters["radius"], x, y], axis=1)
    return table[np.lexsort((found.parameters["radius"], found.height))]


def test_a_periodic_map_has_no_edges() -> None:
    """A map rolled by any distance has the same summits, moved by that distance."""
    height = waves(64, 5, 32)
    first = rows(find_summits(HeightMap(height, 0.5, 0.5, periodic=True)), side=32.0)
    assert len(first) > find_summits(HeightMap(height, 0.5, 0.5)).height.size
    for i, j in ((1, 0), (17, 40), (0, 63)):
        rolled = rows(find_summits(HeightMap(np.roll(height, (i, j), (0, 1)), 0.5, 0.5, periodic=True)), side=32.0)
        np.testing.assert_array_equal(rolled[:, :2], first[:, :2])
        way = (rolled[:, 2:] - first[:, 2:] - (0.5 * i, 0.5 * j)) % 32.0
        np.testing.assert_allclose(np.minimum(way, 32.0 - way), 0.0, atol=1e-12)


@pytest.mark.parametrize("corner", [(-0.3, 0.2), (0.3, -0.45), (0.0, 0.0)])
def test_a_paraboloid_across_the_corner_of_a_periodic_map(corner: tuple[float, float]) -> None:
    nx, ny, dx, dy = 16, 12, 2e-7, 3e-7
    x = ((np.arange(nx) - corner[0] + nx / 2) % nx - nx / 2)[:, None] * dx
    y = ((np.arange(ny) - corner[1] + ny / 2) % ny - ny / 2)[None, :] * dy
    found = find_summits(HeightMap(1e-8 - x * x / 2e-5 - y * y / 8e-5, dx, dy, periodic=True))
    assert found.height.tolist() == approx([1e-8], rel=1e-9)
    assert found.parameters["radius"].tolist() == approx([2e-5], rel=1e-9)
    assert found.positions["x"][0] == approx((corner[0] + 0.5) * dx % (nx * dx), rel=1e-6)
    assert found.positions["y"][0] == approx((corner[1] + 0.5) * dy % (ny * dy), rel=1e-6)


def test_a_top_across_the_edge_of_a_periodic_map_stands_at_the_other_edge() -> None:
    """Drops of 0 and 1 along one axis and 0.5 across: the fit peaks 0.83 of a spacing away."""
    height = np.full((5, 6), -9.0)
    height[1:4, 1:4] = [[-1e-9, -1e-9, -1e-9], [-0.5, 0.0, -0.5], [-1.0, -1.0, -1.0]]
    for rolled, places in ((height, ("x", "y")), (height.T, ("y", "x"))):
        surface = HeightMap(np.roll(rolled, (-2, -2), (0, 1)), 2.0, 2.0, periodic=True)
        found = find_summits(surface).positions
        across = 2.0 * (5 + 0.5 - 0.5 / 0.6)
        assert [found[place].tolist() for place in places] == [approx([across], rel=1e-8), approx([1.0], rel=1e-8)]


def test_a_summit_needs_all_its_neighbours() -> None:
    """Each of eight neighbours undefined in turn; one farther away, or none, does not change the fit."""
    x, y = np.arange(9.0)[:, None] - 4.2, np.arange(8.0)[None, :] - 3.1
    dome = 2e-6 - 1e-8 * (x * x + 4.0 * y * y)
    for i, j in np.ndindex(9, 8):
        height = dome.copy()
        height[i, j] = np.nan
        surface = HeightMap(height, 1e-6, 1e-6)
        if max(abs(i - 4), abs(j - 3)) <= 1:
            with pytest.raises(rm.SceneError, match="has no summit"):
                find_summits(surface)
            continue
        found = find_summits(surface)
        assert found.height[0] == approx(2e-6, rel=1e-12)
        assert found.parameters["radius"][0] == approx(1e-12 / 4e-8, rel=1e-9)
        assert found.nominal_area == approx(71e-12, rel=1e-12)
        assert found.attrs["points_per_summit"] == 71
        assert map_statistics(surface)["undefined_share"] == 1 / 72


def test_height_and_slope_of_a_wave() -> None:
    """cos(qx): r.m.s. height 1/sqrt 2; the slope of neighbours is q sin(qd/2)/(qd/2)/sqrt 2, to the edge and across."""
    d, n = 2e-9, 40
    wave = np.cos(2 * np.pi * np.arange(n) / n)[:, None] * np.ones((1, n)) * 1e-9
    slope = 2e-9 * np.sin(np.pi / n) / d / np.sqrt(2)
    for height in (wave, wave.T):
        found = map_statistics(HeightMap(height, d, d, periodic=True))
        assert found["rms_height"] == approx(1e-9 / np.sqrt(2), rel=1e-12)
        assert found["rms_slope"] == approx(slope, rel=1e-12)
    plane = np.add.outer(3.0 * np.arange(9), 4.0 * np.arange(7))
    plane[2, 3] = np.nan
    assert map_statistics(HeightMap(plane, 1.0, 1.0))["rms_slope"] == approx(5.0, rel=1e-12)


@pytest.mark.parametrize(("longest", "hurst"), [(16.5, 0.8), (128.0, 0.8), (128.0, 0.2)])
def test_sixteen_points_a_wave_are_enough(longest: float, hurst: float) -> None:
    found = find_summits(HeightMap(waves(256, 16, longest, hurst), 1.0, 1.0, periodic=True))
    assert found.attrs["points_per_summit"] > 200
    assert found.attrs["misfit"] < 0.03
    assert radius_uncertainty(found.attrs) < 0.03


def test_noise_has_few_points_a_summit() -> None:
    noise = np.random.default_rng(5).normal(size=(256, 256))
    found = find_summits(HeightMap(noise, 1.0, 1.0, periodic=True))
    assert found.attrs["points_per_summit"] == approx(9.5, abs=0.3)
    assert found.attrs["misfit"] == approx(1.1, abs=0.1)


def test_the_misfit_shows_noise_that_the_points_do_not() -> None:
    """Noise of 1 % of the height doubles no count, and makes the summits half as sharp again."""
    clean = waves(256, 16, 128)
    found = find_summits(HeightMap(clean, 1.0, 1.0, periodic=True))
    noisy = find_summits(HeightMap(clean + 0.01 * waves(256, 0.1, 256, -1.0), 1.0, 1.0, periodic=True))
    assert noisy.attrs["points_per_summit"] > 200
    assert np.mean(1.0 / noisy.parameters["radius"]) > 1.3 * np.mean(1.0 / found.parameters["radius"])
    assert noisy.attrs["misfit"] > 0.5


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a map of few points per summit, and a resolved periodic one."""
    monkeypatch.chdir(tmp_path)
    np.save("coarse.npy", 1e-6 * waves(64, 2, 16, 0.2))
    at = (np.arange(128) + 0.5) * 1e-6
    for periodic in (0, 1):
        data = xr.Dataset({"height": (("x", "y"), 1e-6 * waves(128, 16, 64))}, coords={"x": at, "y": at})
        data.assign_attrs(periodic=periodic).to_netcdf(f"fine{periodic}.nc")
    section = {"source": "surface", "file": "coarse.npy", "size": "64 um"}
    Path("s.toml").write_text(tomli_w.dumps(scene(asperities=section, batch=None)))
    return tmp_path


def warned(caught: list[object]) -> list[str]:
    return [str(each.message) for each in caught if each.category is LimitWarning and "points a summit" in str(each)]


def test_the_warning_of_a_coarse_map_goes_along(folder: Path, recwarn: pytest.WarningsRecorder) -> None:
    works = ["10 mJ/m^2", "50 mJ/m^2"]
    result = rm.run("s.toml", "out.nc")
    swept = rm.run(rm.scene.read("s.toml", [f'sweep={{"adhesion.work"={works}}}']))
    made = rm.generate({"source": "surface", "file": "coarse.npy", "size": "64 um"}, seed=0)
    law = rm.load_separation(made, separation=[1e-6], effective_modulus=1e6)
    for each in (result, swept, made, law):
        assert each.attrs["warnings"].count("coarse.npy: ") == each.attrs["warnings"].count("points a summit") == 1
    assert len(warned(recwarn.list)) == 4
    for arguments in (["generate", "s.toml", "-o", "made.nc"], ["run", "s.toml", "-o", "out2.nc"], ["info", "out.nc"]):
        assert roughmdr(*arguments).stdout.count("the map does not resolve its summits (") == 1, arguments
    with xr.open_dataset("made.nc") as written:
        assert written.attrs["warnings"] == made.attrs["warnings"]


def test_a_resolved_map_is_not_warned_of(folder: Path) -> None:
    for periodic, trend in ((0, "quadratic"), (1, "mean")):
        made = rm.generate({"source": "surface", "file": f"fine{periodic}.nc"}, seed=0)
        assert "warnings" not in made.attrs
        assert (made.attrs["periodic"], made.attrs["detrend"]) == (periodic, trend)
    over = rm.generate({"source": "surface", "file": "fine1.nc", "periodic": False, "detrend": "plane"}, seed=0)
    assert (over.attrs["periodic"], over.attrs["detrend"]) == (0, "plane")
    told = said("generate", "s.toml", "-o", "e.nc", "--set", 'asperities.cutoff="8 um"')
    assert "detrended: quadratic, without waves below 8 um" in told


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("cutoff", ["6 um", "12 um", "24 um"]),
        ("size", ["32 um", "64 um"]),
        ("unit", ["mm", "m"]),
        ("detrend", ["none", "quadratic"]),
    ],
)
def test_keys_of_a_map_can_be_swept(folder: Path, key: str, values: list[str]) -> None:
    asperities = {"source": "surface", "file": "coarse.npy", "size": "64 um"}
    path = {"separation": {"start": "3 sigma", "stop": "2 sigma", "steps": 10}}
    swept = rm.run(
        scene(asperities=asperities, batch=None, adhesion=None, path=path, sweep={f"asperities.{key}": values})
    )
    for i, value in enumerate(values):
        alone = rm.run(scene(asperities={**asperities, key: value}, batch=None, adhesion=None, path=path))
        np.testing.assert_array_equal(swept.force.isel({f"asperities_{key}": i}), alone.force)
    assert not np.array_equal(swept.force[0], swept.force[-1])


def test_the_same_map_in_other_units_is_the_same_physics(folder: Path) -> None:
    """All lengths smaller by 1000, with gaps and a filter: the same asperities, 1000 times smaller."""
    height = 1e-6 * waves(64, 2.5, 32)
    height[5:9, 20:40] = np.nan
    np.save("large.npy", height)
    np.save("small.npy", 1e-3 * height)
    large = rm.generate({"source": "surface", "file": "large.npy", "size": "64 um", "cutoff": "5 um"}, seed=0)
    small = rm.generate({"source": "surface", "file": "small.npy", "size": "64 nm", "cutoff": "5 nm"}, seed=0)
    for name in ("height", "radius", "x", "y"):
        np.testing.assert_allclose(1e3 * small[name], large[name], rtol=1e-9, atol=1e-15)
    for name in ("points_per_summit", "misfit", "undefined_share", "rms_slope", "saddles"):
        assert small.attrs[name] == approx(large.attrs[name], rel=1e-9)
    assert 1e3 * small.attrs["cutoff"] == approx(large.attrs["cutoff"], rel=1e-12)
