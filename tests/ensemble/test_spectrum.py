"""Source spectrum: moments of its maps, one surface on every grid, common draws, anisotropy, and what is refused."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large
from pydantic import ValidationError
from scipy.special import ndtri

import roughmdr as rm
from roughmdr.ensemble.maps.height_map import map_statistics, slope_ratio
from roughmdr.ensemble.spectral.section import SpectrumAsperities, Waves
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine

SURFACE = {
    "source": "spectrum",
    "patch": "100 um",
    "hurst": 0.8,
    "long_wave": "50 um",
    "short_wave": "8 um",
    "rms_slope": 0.05,
}


def section(**changes: Any) -> SpectrumAsperities:
    table = {key: value for key, value in (SURFACE | changes).items() if value is not None}
    return SpectrumAsperities.model_validate(table)


def heights(realization: int = 0, seed: int = 1, **changes: Any) -> Floats:
    return section(**changes).height_map(seed, realization).height


@pytest.mark.few(1)
@pytest.mark.parametrize("anisotropy", [1.0, 4.0])
@pytest.mark.parametrize("unit", [1.0, large(1e3)])
def test_the_mean_square_is_the_one_given(anisotropy: float, unit: float) -> None:
    lengths = {"patch": 1e-4 * unit, "long_wave": 4e-5 * unit, "short_wave": 8e-6 * unit, "anisotropy": anisotropy}
    for given in ({"rms_height": 1e-6 * unit}, {"rms_slope": 0.05}):
        one = section(**lengths, rms_slope=given.get("rms_slope"), rms_height=given.get("rms_height"), points=12)
        found = [map_statistics(one.height_map(1, k)) for k in range(100)]
        for name, value in given.items():
            mean = math.sqrt(np.mean([float(each[name]) ** 2 for each in found]))
            assert mean == pytest.approx(value, rel=0.05)  # of 100 maps; differences over 12 points take off 1 %


def test_summits_are_as_many_and_as_high_as_theory_says() -> None:
    one = section(model="summits", points=12)
    found = [one.ensemble(1, k) for k in range(40)]
    count = np.array([each.height.size for each in found])
    assert count.mean() == pytest.approx(one.expected_count, abs=4.0 * count.std() / math.sqrt(40))
    every = np.concatenate([each.height for each in found])
    assert every.std() == pytest.approx(one.sigma, rel=0.05)
    assert np.mean(every > one.summits.height_exceeded(0.1)) == pytest.approx(0.1, abs=0.03)


def test_a_surface_is_the_same_on_every_grid() -> None:
    """Its waves, from the middle of the cells, have the same amplitudes."""

    def amplitudes(points: float) -> Any:
        one = section(points=points)
        height, waves = one.height_map(3, 2).height, one._waves
        middle = np.exp(-1j * math.pi * (waves.i + waves.j) / height.shape[0])
        return np.fft.fft2(height, norm="forward")[waves.i, waves.j] * middle

    coarse, fine = amplitudes(4.0), amplitudes(12.0)
    np.testing.assert_allclose(coarse, fine, atol=1e-12 * np.abs(fine).max())


def test_shorter_waves_are_added_to_the_same_long_ones() -> None:
    """Every cell of a sweep of short_wave has the same draws."""
    spectrum = SelfAffine.of(hurst=0.8, long_wave=5e-5, short_wave=8e-6, rms_height=1e-7)
    long, short = (Waves.of(spectrum._replace(short_wave=each), 1e-4, 1.0, rms_slope=None) for each in (2e-5, 8e-6))
    np.testing.assert_array_equal(short.i[: long.i.size], long.i)
    np.testing.assert_array_equal(short.j[: long.i.size], long.j)


def test_realisations_and_seeds_differ_and_are_the_same_again() -> None:
    first = heights()
    np.testing.assert_array_equal(heights(), first)
    for other in (heights(1), heights(seed=2)):
        assert abs(np.corrcoef(first.ravel(), other.ravel())[0, 1]) < 0.8
        assert np.abs(other - first).max() > 0.1 * first.std()


@pytest.mark.parametrize("anisotropy", [1.0, 2.0, 4.0])
def test_waves_are_longer_along_x_by_the_ratio(anisotropy: float) -> None:
    ratios = [slope_ratio(section(anisotropy=anisotropy).height_map(1, k)) for k in range(8)]
    assert np.mean(ratios) == pytest.approx(anisotropy, rel=0.25)
    along_x, along_y = (float(np.std(np.diff(heights(anisotropy=anisotropy), axis=axis))) for axis in (0, 1))
    assert along_y / along_x == pytest.approx(anisotropy, rel=0.3)


def test_the_amplitude_of_a_wave_is_that_of_its_scores() -> None:
    """One wave by hand: 2 a cos(...) of two scores of variance 1 has the mean square of its variance."""
    waves = Waves(1.0, np.array([2]), np.array([1]), np.array([1.0]), np.array([4.0]))
    scores = ndtri((np.arange(400) + 0.5) / 400)
    squares = [np.mean(waves.map(np.array([[a], [0.0]]), 16).height ** 2) for a in scores]
    assert 2.0 * np.mean(squares) == pytest.approx(4.0, rel=0.02)


def test_generate_gives_hills_or_summits_with_positions() -> None:
    hills, summits = (rm.generate(SURFACE | {"model": model}, seed=1) for model in ("hills", "summits"))
    assert hills.attrs["shape"] == "mdr_table"
    assert summits.attrs["shape"] == "paraboloid"
    for found in (hills, summits):
        assert {"x", "y", "height"} <= set(found)
        assert found.attrs["patch_x"] == pytest.approx(1e-4)
    assert float(hills.height.max()) == pytest.approx(float(summits.height.max()), rel=0.02)


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        ({"patch": "40 um"}, "patch", "at least the longest wave"),
        ({"anisotropy": 9.0}, "patch", "longest wave, 0.00015 m along x"),
        ({"short_wave": "60 um"}, "short_wave", "below long_wave"),
        ({"short_wave": "1 nm"}, "patch", "at most 8192"),
        ({"rms_slope": None}, "", "one of rms_height and rms_slope"),
        ({"rms_height": "1 um"}, "", "one of rms_height and rms_slope"),
        ({"anisotropy": 0.5}, "anisotropy", "at least 1"),
        ({"points": 2.0}, "points", "at least 2.5"),
        ({"long_wave": "100 um", "short_wave": "90 um"}, "short_wave", "no surface with summits"),
    ],
)
def test_what_is_no_surface_is_refused(changes: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(rm.SceneError, match=message) as refused:
        rm.generate({k: v for k, v in (SURFACE | changes).items() if v is not None}, seed=1)
    assert f"asperities.{key}".rstrip(".") in str(refused.value)


def test_stratified_draws_and_the_expected_law_are_refused() -> None:
    one = section()
    assert "nothing is stratified" in one.reason_against("stratified")
    assert "nothing is expected" in one.reason_against("expected")
    assert one.limited_to(1).patch == pytest.approx(5e-5)
    assert one.limited_to(10**9) is one
    _ = one.height_map(1, 0), one.extremes(0.1)
    smaller = one.limited_to(1).height_map(1, 0)
    assert smaller.dx * smaller.height.shape[0] == pytest.approx(5e-5)
    with pytest.raises(ValidationError):
        section(hurst=1.5)


def test_a_sticky_scene_runs_from_clear_to_clear_and_to_an_asked_error() -> None:
    asperities = SURFACE | {"long_wave": "30 um", "short_wave": "15 um", "patch": "60 um", "model": "summits"}
    table = {
        "title": "Sticky maps",
        "material": {"effective_modulus": "1 MPa"},
        "adhesion": {"model": "jkr", "work": "1 mJ/m^2"},
        "asperities": asperities,
        "path": {"separation": {"start": "clear", "stop": {"contact_fraction": 0.01}, "steps": 12}, "unload": True},
        "batch": {"realizations": 4},
    }
    found = rm.run(table)
    assert (found["force"].isel(step=[0, -1]) == 0.0).all()
    assert float(found["pull_off_force"].mean()) < 0.0  # a patch without high summits may not touch
    reached = rm.run({**table, "accuracy": {"relative": 0.3}})
    assert float(reached["accuracy_reached"]) <= 0.3
