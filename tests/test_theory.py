"""Named laws against mpmath, and sampled ensembles against the named laws."""

import math

import mpmath as mp
import numpy as np
import pytest
from scenes import ASPERITIES

import roughmdr as rm

GW = {"modulus": 4e6, "radius": 5e-5, "std": 1e-6, "density": 2e9}


def f_3_2(h: float) -> float:
    """F_3/2 of Greenwood and Williamson for a standard normal."""
    pressure = rm.theory.greenwood_williamson(separation=h * GW["std"], **GW)
    return float(pressure) / (4.0 / 3.0 * GW["modulus"] * math.sqrt(GW["radius"]) * GW["density"] * GW["std"] ** 1.5)


def test_the_integral_of_greenwood_and_williamson() -> None:
    assert f_3_2(1.0) == pytest.approx(0.07566817739097507, rel=1e-13)
    assert f_3_2(3.0) == pytest.approx(2.639675542694673e-4, rel=1e-13)
    for h in (-3.0, -0.5, 0.0, 4.5, 6.0):
        exact = mp.quad(lambda s, h=h: (s - h) ** 1.5 * mp.npdf(s), [h, h + 0.5, h + 2, h + 5, h + 10, h + 20])
        assert f_3_2(h) == pytest.approx(float(exact), rel=1e-11)


def fuller_tabor_by_mpmath(h: float, lowest: float, work: float) -> float:
    """The same integral over the contact radius, where the JKR force is a polynomial in sqrt(a)."""
    modulus, radius, std, density = (mp.mpf(GW[key]) for key in ("modulus", "radius", "std", "density"))
    fold = mp.cbrt(mp.pi * work * radius**2 / (8 * modulus))

    def stretch(a: mp.mpf) -> mp.mpf:
        return mp.sqrt(2 * mp.pi * a * work / modulus)

    def delta(a: mp.mpf) -> mp.mpf:
        return a * a / radius - stretch(a)

    def integrand(a: mp.mpf) -> mp.mpf:
        force = 2 * modulus * a * (2 * a * a / (3 * radius) - stretch(a))
        return force * mp.npdf(h + delta(a), 0, std) * (2 * a / radius - stretch(a) / (2 * a))

    first = (
        fold if lowest - h <= delta(fold) else mp.findroot(lambda a: delta(a) - (lowest - h), (fold * 1.01, fold * 9))
    )
    far = mp.sqrt(radius * 16 * std) + 6 * fold
    return float(density * mp.quad(integrand, [first + (far - first) * k / 8 for k in range(9)]))


@pytest.mark.parametrize("h", [-0.5e-6, 0.3e-6, 1e-6, 2e-6])
def test_the_integral_of_fuller_and_tabor(h: float) -> None:
    work, turning = 0.05, -0.6e-6
    inward = rm.theory.fuller_tabor(separation=h, work=work, **GW)
    outward = rm.theory.fuller_tabor(separation=h, work=work, turning=turning, **GW)
    scale = GW["density"] * math.pi * work * GW["radius"]
    assert float(inward) == pytest.approx(fuller_tabor_by_mpmath(h, h, work), abs=1e-11 * scale)
    assert float(outward) == pytest.approx(fuller_tabor_by_mpmath(h, turning, work), abs=1e-11 * scale)
    assert outward < inward


def test_without_work_the_second_tends_to_the_first() -> None:
    h = np.array([0.0, 1e-6, 2e-6])
    hertz = rm.theory.greenwood_williamson(separation=h, **GW)
    gaps = [
        np.max(np.abs(rm.theory.fuller_tabor(separation=h, work=w, **GW) / hertz - 1.0)) for w in (1e-8, 1e-10, 1e-12)
    ]
    assert gaps[0] > 50 * gaps[1] > 2500 * gaps[2]


@pytest.mark.parametrize(
    ("name", "value"), [("std", 0.0), ("density", -1.0), ("radius", math.nan), ("separation", math.inf)]
)
def test_wrong_arguments_are_refused(name: str, value: float) -> None:
    with pytest.raises(rm.RoughmdrError, match=name):
        rm.theory.greenwood_williamson(**{"separation": 0.0, **GW, name: value})


def test_separations_below_the_turning_point_are_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="turning"):
        rm.theory.fuller_tabor(separation=[0.0, 1e-6], work=0.1, turning=0.5e-6, **GW)


@pytest.mark.parametrize("work", [0.0, 0.05])
def test_sampled_ensembles_agree_within_three_standard_errors(work: float) -> None:
    """Four separations a branch; the seed is fixed, so that this either holds or does not."""
    h = np.array([2.0, 1.0, 0.3, -0.5]) * 1e-6
    section = {**ASPERITIES, "count": 2000, "radius": "50 um"}
    forces = []
    for realization in range(64):
        data = rm.generate(section, seed=3, realization=realization)
        forces.append(rm.load_separation(data, separation=h, modulus=4e6, work=work, unload=True).force)
    pressure = np.array(forces) / 1e-6
    mean, error = pressure.mean(axis=0), pressure.std(axis=0, ddof=1) / math.sqrt(64)
    if work:
        inward = rm.theory.fuller_tabor(separation=h, work=work, **GW)
        outward = rm.theory.fuller_tabor(separation=h[::-1], work=work, turning=h[-1], **GW)
        assert (np.abs(inward - outward[::-1])[:3] > 3.0 * error[:3]).all()
    else:
        inward = rm.theory.greenwood_williamson(separation=h, **GW)
        outward = inward[::-1]
    deviation = (mean - np.concatenate([inward, outward])) / error
    assert (np.abs(deviation) < 3.0).all(), deviation
