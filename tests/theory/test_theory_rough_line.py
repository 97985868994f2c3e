"""The rough line of Geike and Popov."""

import math

import numpy as np
import pytest

import roughmdr as rm
from roughmdr.spectrum import SelfAffine

WAVES = SelfAffine.of(hurst=0.7, long_wave=1e-4, short_wave=2e-6, rms_height=1e-6)
LINE = {"spectrum": WAVES, "length": 1e-3, "points": 4096, "seed": 3}


@pytest.mark.parametrize("hurst", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("length", [1e-4, 1.23e-3])
def test_every_line_is_as_high_as_its_surface(hurst: float, length: float) -> None:
    waves = SelfAffine.of(hurst=hurst, long_wave=1e-4, short_wave=2e-6, rms_height=3e-9)
    for seed in (0, 1):
        z = rm.theory.line_heights(spectrum=waves, length=length, points=2000, seed=seed)
        assert z.std() == pytest.approx(3e-9, rel=1e-10)
        assert abs(z.mean()) < 1e-13 * z.std()


def test_a_long_line_is_as_steep_as_its_surface() -> None:
    """Its slope is <|grad h|^2>, which is twice that of a profile."""
    z = rm.theory.line_heights(spectrum=WAVES, length=1e-2, points=200_000, seed=0)
    steep = np.mean((np.diff(z, append=z[0]) / 5e-8) ** 2)
    assert steep == pytest.approx(WAVES.rms_slope**2, rel=3e-3)


def test_phases_are_drawn_by_seed() -> None:
    first, again, other = (rm.theory.line_heights(**{**LINE, "seed": seed}) for seed in (3, 3, 4))
    assert (first == again).all()
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.5


def test_every_spring_counts() -> None:
    z = rm.theory.line_heights(**LINE)
    h = np.append(np.linspace(z.max(), z.min(), 50), [z.min() - 1e-6, 1.0])
    spring = 2e9 * 1e-3 / 4096
    deep = np.maximum(z - h[:, None], 0.0)
    line = rm.theory.rough_line(separation=h, effective_modulus=2e9, **LINE)
    np.testing.assert_allclose(line.force, spring * deep.sum(axis=1), rtol=1e-11)
    np.testing.assert_allclose(line.stiffness, spring * (deep > 0.0).sum(axis=1), rtol=1e-14)
    assert rm.theory.rough_line(separation=0.0, effective_modulus=2e9, **LINE).force.shape == ()


@pytest.mark.parametrize("hurst", [0.3, 0.5, 0.7, 0.9])
def test_stiffness_grows_as_a_power_of_force(hurst: float) -> None:
    """Exponent 1/(1 + H), R. Pohrt, V. L. Popov: mean of 40 lines, contact lengths of 0.3 % to 30 %."""
    waves = SelfAffine.of(hurst=hurst, long_wave=1e-3, short_wave=1e-3 / 4096, rms_height=1e-6)
    slopes = []
    for seed in range(40):
        line = rm.theory.rough_line(
            separation=np.linspace(4e-6, 0.0, 400),
            effective_modulus=1e9,
            spectrum=waves,
            length=1e-3,
            points=16384,
            seed=seed,
        )
        mid = (line.stiffness > 3e3) & (line.stiffness < 3e5)
        slopes.append(np.polyfit(np.log(line.force[mid]), np.log(line.stiffness[mid]), 1)[0])
    assert np.mean(slopes) == pytest.approx(1.0 / (1.0 + hurst), abs=0.05)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("points", 1000),
        ("points", 4096.5),
        ("seed", -1),
        ("length", 0.5e-4),
        ("length", math.inf),
        ("effective_modulus", 0.0),
        ("separation", [[1.0]]),
        ("spectrum", None),
    ],
)
def test_wrong_arguments_are_refused(name: str, value: object) -> None:
    with pytest.raises(rm.RoughmdrError, match=name):
        rm.theory.rough_line(**{"separation": 0.0, "effective_modulus": 1e9, **LINE, name: value})
