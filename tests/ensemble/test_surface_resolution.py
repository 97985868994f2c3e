"""How far the radii of a map are off, judged by the map: against the summits of the same surface on a finer grid."""

from pathlib import Path

import numpy as np
import pytest
from batches import write_scene
from command import said
from hypothesis import given, settings, strategies as st
from scenes import scene
from test_surface_detrend import waves

import roughmdr as rm
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.resolution import MAX_UNCERTAINTY, radius_errors, radius_uncertainty, verdict
from roughmdr.ensemble.maps.summits import find_summits

FINE = 32  # spacings of the finest grid in a shortest wave


def judged(height: np.ndarray) -> tuple[float, dict[str, float | int | str]]:
    """The mean curvature in spacings, and the attributes of a periodic map."""
    found = find_summits(HeightMap(height.copy(), 1.0, 1.0, periodic=True))
    return float(np.mean(1.0 / found.parameters["radius"])), found.attrs


@pytest.mark.few(1)
@pytest.mark.parametrize(("longest", "hurst"), [(FINE * 1.1, 0.8), (FINE * 8.0, 0.8), (FINE * 8.0, 0.3)])
@pytest.mark.parametrize("coarser", [1, 2, 4, 8])
def test_the_estimate_is_near_the_error_of_the_curvature(longest: float, hurst: float, coarser: int) -> None:
    """At 32 to 4 points a shortest wave, with noise from none to a tenth of the height.

    Noise makes summits too sharp and a coarse grid too blunt; where both errors cancel, the estimate is of the larger.
    Beyond a factor of 4 the misfit no longer tells how much is noise.
    """
    height = waves(1024, FINE, longest, hurst)
    right, part = judged(height)[0] * coarser**2, height[::coarser, ::coarser]
    without_noise = abs(judged(part)[0] / right - 1.0)
    for noise in (0.0, 1e-3, 1e-2, 1e-1):
        found, attrs = judged(part + noise * np.random.default_rng(2).normal(size=part.shape))
        error, estimate = abs(found / right - 1.0), radius_uncertainty(attrs)
        assert estimate > MAX_UNCERTAINTY or error < 0.2
        if 0.05 < error < 3.0:
            assert 0.5 * error < estimate < 4.0 * max(error, without_noise), (noise, attrs)
        assert error < 3.0 or estimate > 1.5


@pytest.mark.parametrize("step", [1e-2, 3e-2])
def test_steps_of_the_heights_are_seen(step: float) -> None:
    height = waves(512, 24, 200)
    right = judged(height)[0]
    tilt = np.add.outer(np.arange(512), 0.7 * np.arange(512)) * 3e-3  # so that steps are at other heights everywhere
    stepped = np.round((height + tilt) / step) * step - tilt
    found = find_summits(HeightMap(stepped, 1.0, 1.0))
    error = float(np.mean(1.0 / found.parameters["radius"])) / right - 1.0
    assert error > MAX_UNCERTAINTY
    assert 0.4 < radius_uncertainty(found.attrs) / error < 3.0
    assert found.attrs["points_per_summit"] > 200
    assert "steps of its heights" in verdict(found.attrs)


@settings(deadline=None)
@given(points=st.floats(4.0, 1e8), misfit=st.floats(0.0, 2.0), more=st.floats(1.0, 10.0))
def test_a_larger_misfit_is_no_better_and_more_points_are_no_worse(points: float, misfit: float, more: float) -> None:
    def errors(points: float, misfit: float) -> dict[str, float]:
        return radius_errors({"points_per_summit": points, "misfit": misfit})

    assert all(0.0 <= error <= 9.0 + 1e-12 for error in errors(points, misfit).values())
    assert errors(points, misfit * more)["noise"] >= errors(points, misfit)["noise"]
    assert errors(points, misfit * more)["sampling"] >= errors(points, misfit)["sampling"]
    assert errors(points * more, misfit)["sampling"] <= errors(points, misfit)["sampling"]


@pytest.mark.parametrize(
    ("points", "misfit", "text"),
    [
        (1e4, 0.001, "radii right to about 1 %: the map resolves its summits"),
        (200.0, 0.05, "radii right to about 5 %: the map resolves its summits"),
        (19.8, 0.40, "radii uncertain by about 40 %: the map does not resolve its summits"),
        (1e3, 0.75, "radii uncertain by about 40 %: noise, or the steps of its heights, sets them"),
        (9.5, 1.08, "radii uncertain by a factor of about 10 or more: noise, or the steps of its heights, sets them"),
    ],
)
def test_the_verdict_in_words(points: float, misfit: float, text: str) -> None:
    assert verdict({"points_per_summit": points, "misfit": misfit}) == text


def section(folder: Path, height: np.ndarray, **keys: object) -> dict[str, object]:
    np.savez(folder / "map.npz", height=1e-7 * height, size=height.shape[0] * 1e-7)
    return {"source": "surface", "file": str(folder / "map.npz"), "periodic": True, **keys}


@pytest.mark.large
def test_a_cutoff_that_changes_the_radii_is_warned_of(tmp_path: Path) -> None:
    clean = waves(512, 24, 200)
    noisy = clean + 0.01 * np.random.default_rng(0).normal(size=clean.shape)
    right = rm.generate(section(tmp_path, clean), seed=0)
    assert "warnings" not in right.attrs
    assert "uncut_rms_slope" not in right.attrs
    nothing_lost = rm.generate(section(tmp_path, clean, cutoff="2.3 um"), seed=0)
    assert nothing_lost.attrs["radius_uncertainty"] == pytest.approx(right.attrs["radius_uncertainty"], abs=1e-9)
    with pytest.warns(rm.errors.LimitWarning, match="the cutoff sets them.*was measured to be noise"):
        real = rm.generate(section(tmp_path, clean, cutoff="6 um"), seed=0)
    lost = 1.0 - float(np.mean(1.0 / real.radius) / np.mean(1.0 / right.radius))
    assert real.attrs["radius_uncertainty"] == pytest.approx(lost, rel=0.05)
    with pytest.warns(rm.errors.LimitWarning, match="noise, or the steps of its heights, sets them"):
        uncut = rm.generate(section(tmp_path, noisy), seed=0)
    with pytest.warns(rm.errors.LimitWarning, match="the cutoff sets them"):  # nothing tells that it takes noise alone
        cut = rm.generate(section(tmp_path, noisy, cutoff="2.3 um"), seed=0)
    assert cut.attrs["uncut_rms_slope"] == uncut.attrs["rms_slope"] > cut.attrs["rms_slope"]
    assert cut.attrs["uncut_mean_curvature_radius"] == pytest.approx(1.0 / float(np.mean(1.0 / uncut.radius)))


def test_heights_before_and_after_the_trend(tmp_path: Path) -> None:
    height = waves(128, 16, 64)
    tilted = height + 5.0 * np.linspace(-1.0, 1.0, 128)[:, None]
    found = rm.generate(section(tmp_path, tilted, periodic=False), seed=0)
    assert found.attrs["rms_height_raw"] == pytest.approx(1e-7 * np.std(tilted), rel=1e-12)
    assert found.attrs["rms_height"] == pytest.approx(1e-7, rel=0.2)


def test_the_uncertainty_stays_with_a_saved_ensemble_and_is_of_maps_alone(tmp_path: Path) -> None:
    made = rm.generate(section(tmp_path, waves(128, 16, 64)), seed=0)
    made.to_netcdf(tmp_path / "saved.nc")
    saved = {"source": "file", "file": str(tmp_path / "saved.nc")}
    again = rm.generate(saved, seed=0)
    assert isinstance(made.attrs["radius_uncertainty"], float)
    assert again.attrs["radius_uncertainty"] == made.attrs["radius_uncertainty"]
    write_scene(tmp_path, scene(asperities=saved, batch=None))
    said("generate", "scene.toml", "-o", "a.nc", cwd=tmp_path)
    made.assign_attrs(radius_uncertainty=-1.0).to_netcdf(tmp_path / "saved.nc")
    with pytest.raises(rm.SceneError, match="attribute radius_uncertainty is -1"):
        rm.generate(saved, seed=0)
    nayak = {"source": "nayak", "patch": 1e-4, "m0": 1e-12, "m2": 1e-2, "m4": 1e9}
    assert "radius_uncertainty" not in rm.generate(nayak, seed=0).attrs
