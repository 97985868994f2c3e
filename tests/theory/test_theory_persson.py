"""Persson's area and mean gap: against plain integrals, and at small and large pressures."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from scipy.special import erf

import roughmdr as rm
from roughmdr.spectrum import SelfAffine

MODULUS = 1e9
WAVES = SelfAffine.of(hurst=0.8, long_wave=1e-4, short_wave=1e-6, rms_height=1e-6)


class RolledOff:
    """White up to ``knee`` times the smallest wave number, then self-affine with H = 0.8."""

    long_wave, short_wave, level, knee = 1e-4, 2e-6, 1e-23, 4.4

    def __call__(self, q: np.ndarray) -> np.ndarray:
        return self.level * np.maximum(q * self.long_wave / (2.0 * math.pi * self.knee), 1.0) ** -3.6

    def flattened(self, q: float) -> float:
        """pi ∫ q^3 C dq from the longest wave."""
        q0, knee = 2.0 * math.pi / self.long_wave, self.knee * 2.0 * math.pi / self.long_wave
        white = (min(q, knee) ** 4 - q0**4) / 4.0
        return math.pi * self.level * (white + knee**3.6 * (max(q, knee) ** 0.4 - knee**0.4) / 0.4)


def gap(pressure: float, **others: object) -> float:
    return float(
        rm.theory.persson_separation(
            **{"pressure": pressure, "effective_modulus": MODULUS, "spectrum": WAVES, **others}
        )
    )


@pytest.mark.parametrize("load", [1e-6, 1e-2, 1.0])
def test_the_mean_gap_without_a_correction_is_one_integral(load: float) -> None:
    """gamma = 1, where the integral over pressures is that of an exponential."""
    pressure = load * MODULUS * WAVES.rms_slope
    q0, H = 2 * mp.pi / mp.mpf(WAVES.long_wave), mp.mpf(WAVES.hurst)
    most = mp.sqrt(mp.log(mp.mpf(WAVES.long_wave) / WAVES.short_wave))

    def over_waves(v: mp.mpf) -> mp.mpf:
        q, u, k = q0 * mp.exp(v * v), v * v, 2 - 2 * H
        w = (mp.pi * WAVES.level * q0**4 * mp.expm1(k * u) / k) ** -0.5
        level = WAVES.level * (q / q0) ** (-2 - 2 * H)
        return mp.sqrt(mp.pi) * q**3 * level * w * mp.e1((w * pressure / MODULUS) ** 2) / 2 * 2 * v

    exact = mp.quad(over_waves, [most * mp.mpf(2) ** -k for k in (45, 30, 20, 15, 12, 9, 7, 5, 3, 2, 1, 0)])
    assert gap(pressure, gamma=1.0) == pytest.approx(float(exact), rel=1e-12)


def test_the_mean_gap_is_the_work_of_the_pressure_on_the_elastic_energy() -> None:
    """u(p) = ∫_p^∞ (dU/dp')/p' dp' by parts, U = pi/2 E* ∫ dq q^2 C P [gamma + (1 - gamma) P^2], over a kink."""
    surface, gamma, pressure = RolledOff(), 0.45, 2e5
    q0, knee, q1 = (2.0 * math.pi / wave for wave in (1e-4, 1e-4 / surface.knee, surface.short_wave))

    def per_wave(q: float) -> float:
        w = surface.flattened(q) ** -0.5

        def part(p: float) -> float:
            P = erf(w * p / MODULUS)
            return P * (gamma + (1.0 - gamma) * P * P)

        x = w * pressure / MODULUS
        # ∫ dW/dp'/p' dp' = [W - W(p)]/p' + ∫ [W - W(p)]/p'^2 dp', over log p'; at 7/w all is flat.
        least = part(pressure)
        if x >= 7.0:
            return 0.0
        tail = (1.0 - least) / 7.0
        inner = quad(
            lambda t: (part(MODULUS * math.exp(t) / w) - least) * math.exp(-t),
            math.log(x),
            math.log(7.0),
            epsrel=1e-10,
            epsabs=1e-13,
        )[0]
        return q * q * float(surface(np.array(q))) * w / MODULUS * (inner + tail)

    energy = (
        math.pi
        / 2.0
        * MODULUS
        * sum(quad(per_wave, *ends, epsrel=1e-10, epsabs=0.0)[0] for ends in ((q0, knee), (knee, q1)))
    )
    assert gap(pressure, spectrum=surface, gamma=gamma) == pytest.approx(energy, rel=1e-8)


def test_small_pressures_close_the_gap_by_their_logarithm() -> None:
    q0, H = 2.0 * math.pi / WAVES.long_wave, WAVES.hurst
    over_slopes = quad(
        lambda s: (1.0 + s * s) ** (-1.0 / (2.0 - 2.0 * H)), 0.0, math.sqrt(100.0 ** (2.0 - 2.0 * H) - 1.0)
    )[0]
    # dm = pi q^3 C dq, so that sqrt(pi) ∫ q^2 C w dq = 2/sqrt(pi) ∫ d sqrt(m)/q.
    unit = 2.0 / math.sqrt(math.pi) * over_slopes * math.sqrt(math.pi * WAVES.level * q0**4 / (2.0 - 2.0 * H)) / q0
    for gamma in (0.4, 1.0):
        fall = gap(1e-12 * MODULUS, gamma=gamma) - gap(1e-11 * MODULUS, gamma=gamma)
        assert fall == pytest.approx(gamma * unit * math.log(10.0), rel=1e-9)


def test_large_pressures_leave_no_gap() -> None:
    full = MODULUS * WAVES.rms_slope
    gaps = rm.theory.persson_separation(
        pressure=full * np.array([0.1, 1.0, 3.0, 10.0, 1e200]), effective_modulus=MODULUS, spectrum=WAVES
    )
    assert (np.diff(gaps[:4]) < 0.0).all()
    assert gaps[3] < 1e-80
    assert gaps[4] == 0.0


@given(load=st.floats(1e-9, 3.0), size=st.floats(1e-9, 1e9), hurst=st.floats(0.0, 1.0), octaves=st.floats(0.1, 15.0))
@settings(deadline=None, max_examples=15)
def test_the_laws_hold_at_every_size(load: float, size: float, hurst: float, octaves: float) -> None:
    one, other = (
        SelfAffine.of(hurst=hurst, long_wave=a * 1e-4, short_wave=a * 1e-4 * 2.0**-octaves, rms_slope=0.1)
        for a in (1.0, size)
    )
    pressure = load * 0.1 * MODULUS
    assert gap(pressure, spectrum=other) == pytest.approx(size * gap(pressure, spectrum=one), rel=1e-10)
    assert gap(8.0 * pressure, effective_modulus=8.0 * MODULUS, spectrum=one) == pytest.approx(
        gap(pressure, spectrum=one), rel=1e-13
    )


def test_the_area_of_contact() -> None:
    """Small pressures: p/(E* h') times sqrt(8/pi), which is 2/pi of the asymptote of Bush, Gibson and Thomas."""
    ask = {"effective_modulus": MODULUS, "rms_slope": 0.2}
    small = 1e-7 * MODULUS
    area = float(rm.theory.persson_contact_fraction(pressure=small, **ask))
    assert area == pytest.approx(math.sqrt(8.0 / math.pi) * 5e-7, rel=1e-12)
    linear = float(rm.theory.bush_gibson_thomas_asymptote(pressure=small, **ask))
    assert area / linear == pytest.approx(2.0 / math.pi, rel=1e-12)
    loads = np.array([0.0, 0.05, 0.2, 1.0, 1e290])
    areas = rm.theory.persson_contact_fraction(pressure=loads * MODULUS * 0.2, **ask)
    np.testing.assert_allclose(areas, [float(mp.erf(mp.sqrt(2) * load)) for load in loads], rtol=1e-14)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("pressure", 0.0, "pressure"),
        ("pressure", [1.0, -1.0], "pressure"),
        ("pressure", math.nan, "pressure"),
        ("effective_modulus", 0.0, "effective_modulus"),
        ("gamma", -0.1, "gamma"),
        ("gamma", 1.1, "gamma"),
        ("spectrum", 3.0, "spectrum"),
        ("spectrum", WAVES._replace(level=0.0), "spectrum"),
        ("spectrum", WAVES._replace(level=math.nan), "spectrum"),
        ("spectrum", WAVES._replace(short_wave=1e-3), "short_wave"),
    ],
)
def test_wrong_arguments_are_refused(name: str, value: object, said: str) -> None:
    with pytest.raises(rm.RoughmdrError, match=said):
        gap(**{"pressure": 1e6, name: value})
