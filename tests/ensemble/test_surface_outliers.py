"""Heights that were not measured are named and left out, or kept; true peaks of rough and of steep maps are none."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from oracles.gaussian_maps import gaussian_map

import roughmdr as rm
from roughmdr.ensemble.maps.outliers import leave_out_outliers
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.spectrum import SelfAffine

SHARED = Path(__file__).parents[3] / "shared"
SIZE = ["64 um", "96 um"]
Change = Callable[[np.ndarray], None]


def rough(seed: int = 4, hurst: float = 0.8, short: float = 8.0, points: int = 96) -> np.ndarray:
    """Return a Gaussian map [nm], of which 64 x ``points`` points are taken."""
    waves = SelfAffine.of(hurst=hurst, long_wave=48e-6, short_wave=short * 1e-6, rms_height=20e-9)
    height = gaussian_map(waves, points, points * 1e-6, seed)
    return np.round(1e9 * height[:64], 5)


def scattered(value: float, share: float = 0.01) -> Change:
    def change(height: np.ndarray) -> None:
        at = np.random.default_rng(1).choice(height.size, int(share * height.size), replace=False)
        height.flat[at] = value

    return change


def block(value: float) -> Change:
    def change(height: np.ndarray) -> None:
        height[10:16, 30:42] = value

    return change


def spikes(sigmas: float) -> Change:
    def change(height: np.ndarray) -> None:
        size = sigmas * height.std()
        for k, at in enumerate(((5, 5), (20, 60), (40, 40), (60, 90))):
            height[at] += (-1) ** k * size

    return change


def coordinates(height: np.ndarray) -> None:
    height[0], height[:, 0] = 0.5 * np.arange(96), 0.5 * np.arange(64)


def generate(path: Path, height: np.ndarray, **keys: object) -> xr.Dataset:
    np.save(path / "map.npy", height)
    section = {"source": "surface", "file": str(path / "map.npy"), "size": SIZE, "unit": "nm", **keys}
    return rm.generate(section, seed=0)


@pytest.mark.parametrize(
    ("change", "count", "value"),
    [
        (scattered(-9999.0), 61, "-9999"),
        (scattered(0.0), 61, "0"),
        (scattered(1e38), 61, r"1e\+38"),
        (scattered(np.finfo(np.float64).max), 61, r"1.79769e\+308"),
        (scattered(32767.0), 61, "32767"),
        (scattered(-70.0), 61, "-70"),
        (scattered(-9999.0, 0.3), 1843, "-9999"),
        (block(-9999.0), 72, "-9999"),
        (block(0.0), 72, "0"),
        (block(80.0), 72, "80"),
    ],
)
def test_marks_of_undefined_points_are_found(tmp_path: Path, change: Change, count: int, value: str) -> None:
    height = rough()
    change(height)
    with pytest.raises(rm.SceneError, match=f"{count} heights, the first at .* are exactly {value} nm, far from"):
        generate(tmp_path, height)
    left_out = generate(tmp_path, height, outliers="undefined")
    assert left_out.attrs["outliers"] == count
    known = rough()
    changed = height != known
    assert changed.sum() >= count - 1  # a height may be that value by itself
    known[changed] = np.nan
    if changed.sum() == count:
        xr.testing.assert_equal(left_out, generate(tmp_path, known))


def test_several_marks_and_spikes_are_found_together(tmp_path: Path) -> None:
    height = rough()
    for change in (block(-9999.0), scattered(32767.0), spikes(8.0)):
        change(height)
    with pytest.raises(rm.SceneError, match=r"-9999 nm.*32767 nm|32767 nm.*-9999 nm"):
        generate(tmp_path, height)
    assert generate(tmp_path, height, outliers="undefined").attrs["outliers"] == pytest.approx(72 + 61 + 4, abs=2)


@pytest.mark.parametrize("sigmas", [5.0, 8.0, 1000.0])
@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_spikes_are_found(tmp_path: Path, sigmas: float, hurst: float) -> None:
    height = rough(hurst=hurst)
    spikes(sigmas)(height)
    with pytest.raises(rm.SceneError, match=r"far (above|from) neighbouring heights.*outliers = \"undefined\" leaves"):
        generate(tmp_path, height)
    assert generate(tmp_path, height, outliers="undefined").attrs["outliers"] == 4
    kept = generate(tmp_path, height, outliers="kept")
    assert "outliers" not in kept.attrs
    assert float(kept.height.max()) > 2.0 * float(generate(tmp_path, rough(hurst=hurst)).height.max()) or sigmas < 8.0


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("shape", [(1, 2), (2, 1), (2, 2)])
@pytest.mark.parametrize("corner", [(0, 20), (30, 40), (62, 50), (20, 62)])
def test_spikes_of_up_to_two_by_two_points_are_found(
    shape: tuple[int, int], corner: tuple[int, int], *, periodic: bool
) -> None:
    height = rough(points=64)
    at = np.ix_(*(start + np.arange(n) for start, n in zip(corner, shape, strict=True)))
    height[at] += 8.0 * height.std() + np.random.default_rng(0).normal(size=shape)
    left_out = height.copy()
    assert leave_out_outliers(left_out, "undefined", "nm", periodic=periodic) == {"outliers": shape[0] * shape[1]}
    assert np.isnan(left_out[at]).all()
    with pytest.raises(rm.RoughmdrError, match=f"{shape[0] * shape[1]} heights, the first at point {corner[0] + 1} "):
        leave_out_outliers(height, None, "nm", periodic=periodic)


def test_pits_of_one_point_are_only_told_of(tmp_path: Path) -> None:
    height = rough()
    height[20, 30] -= 6.0 * height.std()
    with pytest.warns(rm.errors.LimitWarning, match="point 21 along x and 31 along y is .* nm, far below"):
        found = generate(tmp_path, height)
    assert found.sizes["asperity"] <= generate(tmp_path, rough()).sizes["asperity"]


def test_a_clipped_top_is_refused_and_a_clipped_bottom_told_of(tmp_path: Path) -> None:
    height = rough()
    top, bottom = np.quantile(height, [0.98, 0.02])
    for keys in ({}, {"outliers": "undefined"}):
        with pytest.raises(rm.SceneError, match=r"its highest part is clipped: .* are exactly .* larger range"):
            generate(tmp_path, np.minimum(height, top), **keys)
    with pytest.warns(rm.errors.LimitWarning, match="its lowest part is clipped"):
        lowest = generate(tmp_path, np.maximum(height, bottom))
    assert lowest.sizes["asperity"] == pytest.approx(generate(tmp_path, height).sizes["asperity"], abs=2)
    assert generate(tmp_path, np.minimum(height, top), outliers="kept").sizes["asperity"] > 0


def levelled(height: np.ndarray, degree: int) -> np.ndarray:
    """Return heights without the polynomial that instruments remove."""
    x, y = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in height.shape), indexing="ij")
    powers = np.stack([x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i)], axis=-1)
    flat = powers.reshape(height.size, -1)
    return height - powers @ np.linalg.lstsq(flat, height.ravel(), rcond=None)[0]


def clipped(tilt: float, degree: int, noise: float = 0.0, share: float = 0.05) -> np.ndarray:
    """Return a map [nm] of a detector at the end of its range, levelled after that, with noise over its r.m.s."""
    height = rough()
    height += tilt * height.std() * np.arange(64.0)[:, None] / 64.0
    height = levelled(np.minimum(height, np.quantile(height, 1.0 - share)), degree)
    return height + noise * height.std() * np.random.default_rng(0).normal(size=height.shape)


@pytest.mark.parametrize(("tilt", "degree"), [(1.0, 1), (4.0, 1), (1.0, 2), (0.0, 2)])
@pytest.mark.parametrize("digits", [3, 16])
def test_a_clipped_top_that_was_levelled_is_refused(tmp_path: Path, tilt: float, degree: int, digits: int) -> None:
    height = np.round(clipped(tilt, degree), digits)
    says = r"highest part is clipped, and was levelled after that: (\d+) heights, the first at point .* larger range"
    for keys in ({}, {"outliers": "undefined"}):
        with pytest.raises(rm.SceneError, match=says) as refused:
            generate(tmp_path, height, **keys)
        count = re.search(says, str(refused.value))
        assert count is not None
        assert 0.7 < int(count[1]) / (0.05 * height.size) < 1.1
    assert generate(tmp_path, height, outliers="kept").sizes["asperity"] > 0
    assert leave_out_outliers(-height, None, "nm", periodic=False) == {}  # of pits nothing follows


@pytest.mark.parametrize("tilt", [0.0, 2.0])
@pytest.mark.parametrize("noise", [0.003, 0.01])
def test_flat_tops_with_noise_are_told_of_as_clipped_or_worn(tmp_path: Path, tilt: float, noise: float) -> None:
    height = clipped(tilt, 1, noise, share=0.15)
    with pytest.warns(rm.errors.LimitWarning, match=r"tops are flat: .* nm on one smooth plane .* Either .* or they"):
        found = generate(tmp_path, height)
    told = re.search(r"noise of ([\d.]+) nm", found.attrs["doubtful"])
    assert told is not None
    assert float(told[1]) == pytest.approx(noise * height.std(), rel=0.3)


def test_tops_with_a_roughness_of_their_own_are_not_clipped() -> None:
    """Lapped and honed faces, spheres, domes: their tops are smooth, but neither planes nor white noise."""
    x, y = np.arange(64.0)[:, None], np.arange(96.0)[None, :]
    for seed, own in itertools.product(range(4), (0.003, 0.03, 0.1)):
        height = rough(seed)
        lapped = np.minimum(height, height.std() * (0.5 + own * rough(seed + 50) / height.std()))
        assert leave_out_outliers(lapped, None, "nm", periodic=False) == {}, (seed, own)
        for radius in (60.0, 100.0, 1000.0):
            ball = np.sqrt(np.maximum(radius**2 - (x - 32.0) ** 2 - (y - 48.0) ** 2, 0.0))
            assert leave_out_outliers(ball + own * height / height.std(), None, "nm", periodic=False) == {}


def test_coordinates_among_the_heights_are_refused(tmp_path: Path) -> None:
    height = rough()
    coordinates(height)
    for keys in ({}, {"outliers": "undefined"}):
        with pytest.raises(rm.SceneError, match=r"first row and first column .* by 0.5 and 0.5: .* 63 x 95 heights"):
            generate(tmp_path, height, **keys)
    height[0], height[:, 0] = np.round(0.039 * np.arange(96), 2), np.round(0.039 * np.arange(64), 2)
    with pytest.raises(rm.SceneError, match="first row and first column"):
        generate(tmp_path, height)
    with pytest.raises(rm.SceneError, match=r"the first column of numbers.* 64 x 95 heights"):
        generate(tmp_path, np.insert(rough()[:, 1:], 0, np.arange(64.0), axis=1))


def grains(seed: int) -> np.ndarray:
    """Return steep caps of spheres, close together."""
    draws = np.random.default_rng(seed)
    x, height = np.arange(96.0), np.zeros((64, 96))
    for at_x, at_y, radius in draws.uniform([0.0, 0.0, 2.0], [64.0, 96.0, 8.0], (400, 3)):
        square = radius**2 - (x[:64, None] - at_x) ** 2 - (x - at_y) ** 2
        height = np.maximum(height, np.sqrt(np.maximum(square, 0.0)))
    return height + draws.normal(scale=0.02, size=height.shape)


@settings(deadline=None, max_examples=20)
@given(
    seed=st.integers(0, 1000),
    hurst=st.floats(0.1, 1.0),
    short=st.floats(2.1, 20.0),
    step=st.sampled_from([1e-6, 0.1, 5.0]),
    unit=st.sampled_from([1e-9, 1.0, 1e9]),
)
def test_rough_maps_have_no_outliers(seed: int, hurst: float, short: float, step: float, unit: float) -> None:
    height = unit * step * np.round(rough(seed, hurst, short) / step)
    same = height.copy()
    assert leave_out_outliers(height, None, "m", periodic=False) == {}
    np.testing.assert_array_equal(height, same)


def test_other_true_surfaces_have_no_outliers() -> None:
    """White noise, grains, pillars, an egg box, a plane, a dome, steps."""
    x, y = np.arange(64.0)[:, None], np.arange(96.0)[None, :]
    noise = np.random.default_rng(0).normal(size=(64, 96))
    surfaces = [
        noise,
        *(grains(seed) for seed in range(4)),
        50.0 * ((x % 16 < 5) & (y % 16 < 5)) + noise,
        np.sin(np.pi * x / 8.0) * np.sin(np.pi * y / 8.0),
        3.0 * x + 2.0 * y,
        1e3 * x + noise,
        -((x - 30.0) ** 2) - (y - 50.0) ** 2,
        np.floor((x + y) / 7.0),
        np.zeros((64, 96)),
    ]
    for number, height in enumerate(surfaces):
        for periodic in (False, True):
            assert leave_out_outliers(height.copy(), None, "m", periodic=periodic) == {}, number


@pytest.mark.skipif(not SHARED.exists(), reason="the measured surfaces are not here")
@pytest.mark.parametrize("name", ["surfaces/optical.nc", "surfaces/afm_film.di", "cases/true_map.nc"])
def test_measured_maps_are_read_to_the_last_bit_as_if_kept(name: str) -> None:
    if name.endswith(".di"):
        pytest.importorskip("SurfaceTopography")
    found, kept = (read_map(SHARED / name, outliers=treatment) for treatment in (None, "kept"))
    assert found.attrs == {}
    np.testing.assert_array_equal(found.height, kept.height)


@pytest.mark.skipif(not (SHARED / "cases").exists(), reason="the cases are not here")
def test_a_map_with_a_mark_presses_as_the_true_one() -> None:
    cases, pressures = SHARED / "cases", []
    marked = {"file": str(cases / "sentinel_heights" / "sentinel.txt"), "size": ["5 um", "10 um"], "unit": "nm"}
    for asperities in ({"file": str(cases / "true_map.nc")}, {**marked, "outliers": "undefined"}):
        scene = {
            "material": {"modulus": "5 MPa", "poisson": 0.49},
            "asperities": {"source": "surface", **asperities},
            "path": {"separation": {"stop": {"contact_fraction": 0.02}, "steps": 3}},
            "output": {"variables": ["pressure"]},
        }
        pressures.append(float(rm.run(scene).pressure[0, -1]))
    assert pressures[0] == pytest.approx(8383.0, rel=1e-4)
    assert pressures[1] == pytest.approx(pressures[0], rel=5e-3)
