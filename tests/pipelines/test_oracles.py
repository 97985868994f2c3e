"""The profiles of the oracles are the integrals over their slope f' that they should be."""

import numpy as np
import pytest
from oracles.multiprecision import Number, mp
from oracles.profiles import MdrTableProfile, Profile, closed_profile
from studies.asperity_error import DRAW

import roughmdr as rm


def slope(profile: Profile, r: Number) -> Number:
    """f' [1] at r [m]."""
    if profile.end is not None:
        return r / mp.sqrt((profile.end - r) * (profile.end + r))
    piece = next(piece for piece in profile.pieces if piece.hi is None or r < piece.hi)
    return mp.fsum(c * r ** mp.mpf(power) for c, power in piece.terms)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", sorted(set(DRAW) - {"flat_punch", "mdr_table"}))
def test_g_and_its_integral_are_those_of_the_slope(kind: str) -> None:
    rng = np.random.default_rng(11)
    shape = None
    while shape is None:
        try:
            with np.errstate(all="ignore"):
                shape = DRAW[kind](rng)
        except rm.RoughmdrError:
            continue
    profile = closed_profile(shape)
    base = profile.end or max(profile.kinks, default=mp.mpf(1e-6))
    for a in (base * mp.mpf("0.3"), base * mp.mpf("0.97"), *([] if profile.end else [base * mp.mpf("1.6"), base * 40])):
        g, steepness, G = profile.mdr(a)
        edges = sorted({mp.mpf(0), mp.pi / 2, *(mp.acos(b / a) for b in profile.kinks if b < a)})
        with mp.workdps(30):
            for exact, weight in ((g / a, lambda psi: 1), (G / a**2, lambda psi: mp.sin(psi) ** 2)):
                found = mp.quad(lambda psi, w=weight, a=a: slope(profile, a * mp.cos(psi)) * w(psi), edges)
                assert abs(found - exact) <= mp.mpf("1e-12") * abs(exact)
        assert abs(mp.diff(lambda x: profile.mdr(x)[0], a) - steepness) <= mp.mpf("1e-15") * abs(steepness)


@pytest.mark.large
@pytest.mark.parametrize("x", ["0.1", "0.4", "1.7", "5.0"])
def test_mdr_tables_are_integrals_and_rise_through_their_points(x: str) -> None:
    a, g = np.array([0.3, 0.5, 1.2, 2.0]), np.array([0.1, 0.4, 0.5, 3.0])
    profile = MdrTableProfile(a, g)
    for radius, value in zip(a, g, strict=True):
        assert abs(profile.mdr(mp.mpf(radius))[0] - value) < 1e-30
    there = mp.mpf(x)
    g_there, slope_there, G = profile.mdr(there)
    pieces = [mp.mpf(0), *(b for b in profile.kinks if b < there), there]
    assert abs(mp.quad(lambda y: profile.mdr(y)[0], pieces) - G) <= mp.mpf("1e-25") * G
    assert abs(mp.diff(lambda y: profile.mdr(y)[0], there) - slope_there) <= mp.mpf("1e-15") * slope_there
    assert slope_there > 0
    assert g_there > 0
