"""Synthetic maps have the spectrum that they are asked for; their summits are found exactly and follow their law."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from figures.summits import FITTED, STATISTICS, summits
from oracles.gaussian_maps import Series, gaussian_map, rms_slope, wave_variances

import roughmdr as rm
from roughmdr.spectrum import SelfAffine

SCRIPT = Path(__file__).parents[2] / "data_gen" / "surface.py"
SPECTRUM = SelfAffine.of(hurst=0.7, long_wave=1e-5, short_wave=2.5e-6, rms_height=1e-7)


@pytest.mark.parametrize("unit", [1e-9, 1.0])
def test_maps_have_the_spectrum_on_average(unit: float) -> None:
    lengths = {"long_wave": 8.0 * unit, "short_wave": 2.0 * unit}
    spectrum = SelfAffine.of(hurst=0.7, rms_slope=0.1, **lengths)
    size, points, maps = 32.0 * unit, 64, 200
    wanted = wave_variances(spectrum, points, size)
    order = np.hypot(*np.meshgrid(*2 * [np.fft.fftfreq(points, 1.0 / points)]))
    assert ((wanted > 0.0) == ((order >= 4.0) & (order <= 16.0))).all()  # both limits are waves of the grid
    power = np.zeros_like(wanted)
    for seed in range(maps):
        power += np.abs(np.fft.fft2(gaussian_map(spectrum, points, size, seed)) / points**2) ** 2 / maps
    inside = wanted > 0.0
    assert power[~inside].max() < 1e-25 * power.max()
    ratio = power[inside] / wanted[inside]
    waves = 0.5 * ratio.size  # a wave and its opposite are one; the power of each has the spread of its mean
    assert ratio.mean() == pytest.approx(1.0, abs=4.0 / math.sqrt(waves * maps))
    assert ratio.std() == pytest.approx(1.0 / math.sqrt(maps), rel=0.15)
    assert math.sqrt(wanted.sum()) == pytest.approx(spectrum.rms_height, rel=0.05)


@pytest.mark.parametrize(("points", "size"), [(15, 2e-5), (40, 9e-6)])
def test_a_grid_that_cannot_hold_the_waves_is_refused(points: int, size: float) -> None:
    with pytest.raises(rm.OutOfRange, match="must lie between two spacings"):
        gaussian_map(SPECTRUM, points, size, 1)


def made(folder: Path, *options: str) -> xr.Dataset:
    subprocess.run([sys.executable, SCRIPT, "map.nc", "--points", "64", *options], cwd=folder, check=True)
    with xr.open_dataset(folder / "map.nc") as data:
        return data.load()


@pytest.mark.large
def test_a_map_is_scaled_to_its_height_or_its_slope(tmp_path: Path) -> None:
    usual = made(tmp_path)
    assert float(usual.height.std()) == pytest.approx(0.5e-6, rel=1e-13)
    assert usual.attrs["periodic"] == 1
    steep = made(tmp_path, "--slope", "0.2")
    assert rms_slope(steep.height.to_numpy(), 1e-4) == pytest.approx(0.2, rel=1e-13)
    q = 2.0 * np.pi * np.fft.rfftfreq(64, 1e-4 / 64)
    slopes = [
        np.fft.irfft(1j * q * np.fft.rfft(height, axis=1), axis=1)
        for height in (steep.height.to_numpy(), steep.height.to_numpy().T)
    ]
    assert math.sqrt(sum(np.mean(slope**2) for slope in slopes)) == pytest.approx(0.2, rel=1e-12)
    np.testing.assert_allclose(steep.height / steep.height.std(), usual.height / usual.height.std(), atol=1e-12)


@pytest.mark.large
def test_height_and_slope_together_are_refused(tmp_path: Path) -> None:
    command = [sys.executable, SCRIPT, "map.nc", "--rms", "1 um", "--slope", "0.1"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "takes --rms or --slope, not both" in done.stderr


def test_summits_of_an_egg_box_are_exact() -> None:
    size, at = 7e-6, 0.013
    x, y = (np.arange(32) / 32 + at)[:, None], (np.arange(32) / 32 - at)[None, :]
    height = 1e-8 * np.cos(2 * np.pi * 3 * x) * np.cos(2 * np.pi * 5 * y)
    found = Series.of(height, size, 5).summits(40)
    assert found.height.size == 2 * 3 * 5
    np.testing.assert_allclose(found.height, 1e-8, rtol=1e-11)
    scale = 1e-8 * (2 * np.pi / size) ** 2
    np.testing.assert_allclose(found.mean_curvature, scale * (9 + 25) / 2, rtol=1e-9)
    np.testing.assert_allclose(found.radius, 1.0 / (scale * 15), rtol=1e-9)


def test_summits_do_not_depend_on_the_grid_they_are_sought_on() -> None:
    size = 8e-5
    series = Series.of(gaussian_map(SPECTRUM, 64, size, 3), size, 32)
    coarse, fine = series.summits(16 * 32), series.summits(24 * 32)
    assert coarse.height.size == fine.height.size > 100
    np.testing.assert_allclose(np.sort(coarse.height), np.sort(fine.height), rtol=1e-9)


@pytest.mark.large
def test_detected_summits_follow_the_distribution() -> None:
    result = summits(3, (16,), 100_000)
    assert result.summit_height.size == result.attrs["summits"] > 3000
    tolerance = {"mean_height": 0.06, "height_variance": 0.08, "geometric_correlation": 0.15, "mean_correlation": 0.15}
    for name in STATISTICS:
        one, other, error = (float(result[part].sel(statistic=name)) for part in ("sampled", "detected", "error"))
        assert one == pytest.approx(other, rel=tolerance.get(name, 0.03)), name
        assert 0.0 < error < tolerance.get(name, 0.03) * one
    assert np.isfinite(result.bias.sel(statistic=list(FITTED))).all()
    assert float(result.bias.sel(statistic="geometric_curvature")[0]) == pytest.approx(-0.0144, abs=0.005)
