"""Isotropic Gaussian roughness: the moments of its spectrum, and the self-affine spectrum.

The spectrum C(q) [m4] over the wave vector is such that <h^2> = ∫ C d^2q = 2 pi ∫ q C dq.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, exactly_one
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.quantities import Quantity

__all__ = ["Moments", "SelfAffine", "Spectrum"]


def __dir__() -> list[str]:
    return sorted(__all__)


HURST = Quantity("1", at_least=0.0, at_most=1.0)
MIN_ALPHA = 1.5
"""Nayak's parameter alpha of waves of one length in all directions; every other isotropic surface has a larger one."""


class Moments(NamedTuple):
    """Moments of the spectrum of a profile (M. S. Longuet-Higgins, Phil. Trans. R. Soc. A 249 (1957) 321)."""

    m0: float  # <h^2> [m2]
    m2: float  # <(dh/dx)^2> [1]; the r.m.s. slope of the surface is sqrt(2 m2)
    m4: float  # <(d2h/dx2)^2> [1/m2]

    @classmethod
    def checked(cls, m0: float | str, m2: float, m4: float | str) -> Moments:
        """Return the moments; OutOfRange unless all are above 0 and m0 m4/m2^2 above 3/2."""
        moments = cls(check_number("m0", m0, "m2"), check_number("m2", m2, "1"), check_number("m4", m4, "m-2"))
        if not MIN_ALPHA < moments.alpha < math.inf:
            raise OutOfRange(
                f"alpha = m0 m4/m2^2 is {moments.alpha:g}; it must be above 3/2, as it is for every isotropic surface"
            )
        return moments

    @property
    def alpha(self) -> float:
        """Breadth of the spectrum, m0 m4/m2^2 [1] (P. R. Nayak, J. Lubr. Technol. 93 (1971) 398)."""
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


def check_wavelengths(long_wave: float | str, short_wave: float | str) -> tuple[float, float]:
    """Return both wavelengths [m]; OutOfRange unless they are above 0 and in order."""
    long_wave, short_wave = check_number("long_wave", long_wave, "m"), check_number("short_wave", short_wave, "m")
    if not short_wave < long_wave:
        raise OutOfRange(f"short_wave is {short_wave:g} m; it must be below long_wave, {long_wave:g} m")
    return long_wave, short_wave


class SelfAffine(NamedTuple):
    """A self-affine spectrum: C(q) = level (q/q0)^(-2 - 2 hurst) between the wave numbers q0 and q1, 0 elsewhere."""

    hurst: float  # exponent [1]
    long_wave: float  # 2 pi/q0 [m]
    short_wave: float  # 2 pi/q1 [m]
    level: float  # C(q0) [m4]

    @classmethod
    @named_keywords
    def of(
        cls,
        *,
        hurst: float,
        long_wave: float | str,
        short_wave: float | str,
        rms_height: float | str | None = None,
        rms_slope: float | None = None,
    ) -> SelfAffine:
        """Make the spectrum with a given r.m.s. height or r.m.s. slope.

        Parameters
        ----------
        hurst : float
            Hurst exponent [1], from 0 to 1.
        long_wave, short_wave : float or str
            Longest and shortest wavelength [m].
        rms_height, rms_slope : float or str, optional
            One of sqrt(<h^2>) [m] and ``sqrt(<|grad h|^2>)`` [1].

        Returns
        -------
        SelfAffine
            The spectrum: a function C(q) [m4] with ``moments``, ``rms_height`` [m] and ``rms_slope`` [1].

        Raises
        ------
        OutOfRange, RoughmdrError
            Where a number is out of its range; RoughmdrError unless exactly one of rms_height and rms_slope is given.

        References
        ----------
        .. [1] B. N. J. Persson and others, J. Phys. Condens. Matter 17 (2005) R1.

        Examples
        --------
        >>> import roughmdr as rm
        >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
        >>> f"{surface.rms_height:.3g} m, alpha {surface.moments.alpha:.3g}"
        '5.21e-07 m, alpha 15.3'
        """
        hurst = HURST.argument("hurst", hurst)
        long_wave, short_wave = check_wavelengths(long_wave, short_wave)
        one = cls(hurst, long_wave, short_wave, 1.0)
        name, value = exactly_one("a self-affine spectrum", rms_height=rms_height, rms_slope=rms_slope)
        unit = {"rms_height": "m", "rms_slope": "1"}[name]
        return one._replace(level=(check_number(name, value, unit) / getattr(one, name)) ** 2)

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
        """Root of ``<|grad h|^2>`` [1]."""
        return math.sqrt(2.0 * self.moments.m2)


class MapSpectrum(NamedTuple):
    """The spectrum of a height map: waves of some wave numbers."""

    q: Floats  # wave numbers [1/m], ascending
    variance: Floats  # <h^2> of the waves of each [m2]

    @property
    def rms_slope(self) -> float:
        """Root of ``<|grad h|^2>`` [1]."""
        return math.sqrt(float(np.sum(self.q * self.q * self.variance)))
