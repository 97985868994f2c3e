"""Isotropic Gaussian roughness: the moments of its spectrum, and the self-affine spectrum.

The spectrum C(q) [m4] over the wave vector is such that <h^2> = ∫ C d^2q = 2 pi ∫ q C dq.
"""

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats, check_number

MIN_ALPHA = 1.5
"""Nayak's parameter alpha of waves of one length in all directions; every other isotropic surface has a larger one."""


class Moments(NamedTuple):
    """Moments of the spectrum of a profile (M. S. Longuet-Higgins, Phil. Trans. R. Soc. A 249 (1957) 321)."""

    m0: float
    """<h^2> [m2]."""
    m2: float
    """<(dh/dx)^2> [1]; the r.m.s. slope of the surface is sqrt(2 m2)."""
    m4: float
    """<(d2h/dx2)^2> [1/m2]."""

    @classmethod
    def checked(cls, m0: float, m2: float, m4: float) -> "Moments":
        """Return the moments; OutOfRange unless all are above 0 and m0 m4/m2^2 above 3/2."""
        moments = cls(check_number("m0", m0, "m2"), check_number("m2", m2, "1"), check_number("m4", m4, "1/m2"))
        if not MIN_ALPHA < moments.alpha < math.inf:
            raise OutOfRange(
                f"alpha = m0 m4/m2^2 is {moments.alpha:g}; it must be above 3/2, as it is for every isotropic surface"
            )
        return moments

    @property
    def alpha(self) -> float:
        """Breadth of the spectrum, m0 m4/m2^2 (P. R. Nayak, J. Lubr. Technol. 93 (1971) 398)."""
        return (self.m0 / self.m2) * (self.m4 / self.m2)

    @property
    def summit_density(self) -> float:
        """Summits per unit area, m4/(6 pi sqrt(3) m2) [1/m2] (Nayak)."""
        return self.m4 / self.m2 / (6.0 * math.pi * math.sqrt(3.0))


class Spectrum(Protocol):
    """An isotropic spectrum between two wavelengths, such as ``SelfAffine``."""

    @property
    def long_wave(self) -> float:
        """Longest wavelength [m]."""

    @property
    def short_wave(self) -> float:
        """Shortest wavelength [m]."""

    def __call__(self, q: Floats) -> Floats:
        """Return C(q) [m4] at wave numbers q [1/m] between those of the two."""


def wave_number_range(spectrum: Spectrum) -> tuple[float, float]:
    """Return the smallest and the largest wave number [1/m] of a spectrum.

    RoughmdrError unless it is a spectrum, OutOfRange unless its wavelengths are above 0 and in order.
    """
    if not (callable(spectrum) and hasattr(spectrum, "long_wave") and hasattr(spectrum, "short_wave")):
        raise RoughmdrError(
            f"spectrum is {spectrum!r}; it must be C(q) with long_wave and short_wave, as SelfAffine is"
        )
    long_wave, short_wave = check_wavelengths(spectrum.long_wave, spectrum.short_wave)
    return 2.0 * math.pi / long_wave, 2.0 * math.pi / short_wave


def spectral_density(spectrum: Spectrum, q: Floats) -> Floats:
    """Return C(q) [m4]; OutOfRange unless it is finite and at least 0."""
    density = np.asarray(spectrum(q), dtype=np.float64)
    if not (np.isfinite(density).all() and (density >= 0.0).all()):
        raise OutOfRange("spectrum has values that are not finite or below 0; C(q) must be finite and at least 0")
    return density


def check_wavelengths(long_wave: float, short_wave: float) -> tuple[float, float]:
    """Return both wavelengths [m]; OutOfRange unless they are above 0 and in order."""
    long_wave, short_wave = check_number("long_wave", long_wave, "m"), check_number("short_wave", short_wave, "m")
    if not short_wave < long_wave:
        raise OutOfRange(f"short_wave is {short_wave:g} m; it must be below long_wave, {long_wave:g} m")
    return long_wave, short_wave


class SelfAffine(NamedTuple):
    """C(q) = level (q/q0)^(-2 - 2 hurst) from q0 = 2 pi/long_wave to q1 = 2 pi/short_wave, 0 elsewhere."""

    hurst: float
    long_wave: float
    short_wave: float
    level: float
    """C(q0) [m4]."""

    @classmethod
    def of(
        cls,
        *,
        hurst: float,
        long_wave: float,
        short_wave: float,
        rms_height: float | None = None,
        rms_slope: float | None = None,
    ) -> "SelfAffine":
        """Return the spectrum with this r.m.s. height [m] or this r.m.s. slope sqrt(<|grad h|^2>) [1].

        hurst is from 0 to 1, the wavelengths are [m]. OutOfRange where a number is not allowed, RoughmdrError unless
        exactly one of r.m.s. height and slope is given.
        """
        hurst = check_number("hurst", hurst, "1", zero=True)
        if hurst > 1.0:
            raise OutOfRange(f"hurst is {hurst:g}; it must be from 0 to 1")
        long_wave, short_wave = check_wavelengths(long_wave, short_wave)
        unit = cls(hurst, long_wave, short_wave, 1.0)
        if rms_height is not None and rms_slope is None:
            return unit._replace(level=(check_number("rms_height", rms_height, "m") / unit.rms_height) ** 2)
        if rms_slope is not None and rms_height is None:
            return unit._replace(level=(check_number("rms_slope", rms_slope, "1") / unit.rms_slope) ** 2)
        raise RoughmdrError("a self-affine spectrum takes either rms_height or rms_slope")

    def __call__(self, q: ArrayLike) -> Floats:
        """Return C(q) [m4] at wave numbers q [1/m] of at least 0."""
        x = np.asarray(q, dtype=np.float64) * self.long_wave / (2.0 * np.pi)
        inside = (x >= 1.0) & (x <= self.long_wave / self.short_wave)
        return np.where(inside, self.level * np.where(inside, x, 1.0) ** (-2.0 - 2.0 * self.hurst), 0.0)

    def _integral(self, k: int) -> float:
        """Return ∫ q^k C dq."""
        q0, log_range = 2.0 * math.pi / self.long_wave, math.log(self.long_wave / self.short_wave)
        p = (k - 1.0 - 2.0 * self.hurst) * log_range
        return self.level * q0 ** (k + 1) * log_range * (math.expm1(p) / p if p else 1.0)

    @property
    def moments(self) -> Moments:
        """Moments of a profile: 2 pi ∫ q C dq, pi ∫ q^3 C dq and (3 pi/4) ∫ q^5 C dq."""
        one, three, five = (self._integral(k) for k in (1, 3, 5))
        return Moments(2.0 * math.pi * one, math.pi * three, 0.75 * math.pi * five)

    @property
    def rms_height(self) -> float:
        """Root of <h^2> [m]."""
        return math.sqrt(self.moments.m0)

    @property
    def rms_slope(self) -> float:
        """Root of <|grad h|^2> [1]."""
        return math.sqrt(2.0 * self.moments.m2)
