"""source = "spectrum": the hills or summits of maps of a periodic Gaussian surface, isotropic or not."""

import math
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.section import MapSource, Model, asperities_on
from roughmdr.ensemble.random.distribution_families import ndtri
from roughmdr.ensemble.source import Patch
from roughmdr.ensemble.streams import WAVES, make_streams
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.section import Length
from roughmdr.spectrum import HURST, Moments, SelfAffine

_LARGEST_MAP = 8192  # most points along a side
_MARGIN = 1.02  # least number of points over twice the waves along a side
_ROUNDING = 1e-13  # rounding error of the Fourier transform, over the r.m.s. height


class Waves(NamedTuple):
    """The waves of a spectrum on a square patch: one of each two opposite wave vectors 2 pi (i, j)/patch.

    They are in the order of ``q``, so that a spectrum with shorter waves begins with those of a spectrum without.
    """

    patch: float  # [m]
    i: NDArray[np.int64]
    j: NDArray[np.int64]
    q: Floats  # wave number of the isotropic surface that is stretched [1/m]
    variance: Floats  # <h^2> of a wave and its opposite [m2]

    @classmethod
    def of(cls, spectrum: SelfAffine, patch: float, anisotropy: float, *, rms_slope: float | None) -> "Waves":
        """Return the waves of a spectrum, lengths along x stretched by the root of ``anisotropy``, along y compressed.

        The mean of h^2 over realisations is that of the spectrum, or the mean square slope that of ``rms_slope``.
        """
        unit, stretch = 2.0 * math.pi / patch, math.sqrt(anisotropy)
        most = math.floor(patch / spectrum.short_wave * stretch) + 1
        i, j = np.meshgrid(np.arange(-most, most + 1), np.arange(most + 1), indexing="ij")
        half = (j > 0) | (i > 0)
        i, j = i[half], j[half]
        q = unit * np.hypot(i * stretch, j / stretch)
        density = spectrum(q)
        there = density > 0.0
        i, j, q, density = i[there], j[there], q[there], density[there]
        order = np.lexsort((j, i, q))
        i, j, q, variance = i[order], j[order], q[order], 2.0 * unit * unit * density[order]
        if rms_slope is None:
            variance *= spectrum.moments.m0 / math.fsum(variance)
        else:
            variance *= rms_slope**2 / math.fsum(variance * unit * unit * (i * i + j * j))
        return cls(patch, i, j, q, variance)

    @property
    def moments(self) -> Moments:
        """Moments of a profile of the isotropic surface; stretched, its summits keep heights, density and radii."""
        squared = self.q * self.q
        m0, m2, m4 = (math.fsum(self.variance * squared**k) for k in range(3))
        return Moments(m0, 0.5 * m2, 0.375 * m4)

    def map(self, scores: Floats, points: int) -> HeightMap:
        """Return a map with so many points along a side from two normal scores of each wave [2, wave].

        Points are in the middle of cells: on every grid the surface is the same.
        """
        from scipy import fft

        if points <= 2 * max(int(np.abs(self.i).max()), int(self.j.max())):
            raise AssertionError(f"{points} points do not hold the waves")
        middle = np.exp(1j * math.pi * (self.i + self.j) / points)
        amplitude = np.sqrt(0.25 * self.variance) * (scores[0] + 1j * scores[1]) * middle
        waves = np.zeros((points, points // 2 + 1), dtype=np.complex128)
        waves[self.i, self.j] = amplitude
        along_x = self.j == 0
        waves[-self.i[along_x], 0] = np.conj(amplitude[along_x])
        height = fft.irfft2(waves, s=(points, points), norm="forward", overwrite_x=True)
        spacing = self.patch / points
        return HeightMap(np.asarray(height), spacing, spacing, True)


class SpectrumAsperities(MapSource):
    """[asperities] with source = "spectrum": maps of a Gaussian surface that repeats with ``patch``, and their hills.

    The spectrum is self-affine between ``long_wave`` and ``short_wave``, and 0 elsewhere: that of source "nayak". With
    ``anisotropy`` lengths along x are stretched by the root of it, and those along y compressed. A map has ``points`` a
    shortest wave. The mean over realisations of <h^2>, or of the squared slope, is the one given.
    """

    source: Literal["spectrum"]
    model: Model = "hills"
    patch: Patch
    """Side of the square nominal area, or of the square of the same area where a lattice has an oblong one."""
    hurst: Annotated[float, HURST]
    """Hurst exponent of the spectrum."""
    long_wave: Length
    """Longest wave of the spectrum."""
    short_wave: Length
    """Shortest wave of the spectrum."""
    rms_height: Length | None = None
    """Root mean square of the heights of the surface."""
    rms_slope: Annotated[float, Quantity("1", above=0.0)] | None = None
    """Root mean square of its slopes, in place of rms_height."""
    anisotropy: Annotated[float, Quantity("1", at_least=1.0, at_most=100.0)] = 1.0
    """Stretch of lengths along x over that along y."""
    points: Annotated[float, Quantity("1", at_least=2.5, at_most=64.0)] = 6.0
    """Points of a map for a shortest wave."""

    @field_validator("short_wave")
    @classmethod
    def _shorter(cls, value: float, info: ValidationInfo) -> float:
        long_wave = info.data.get("long_wave")
        if long_wave is not None and not value < long_wave:
            raise RoughmdrError(f"must be below long_wave, {long_wave:g} m")
        return value

    @model_validator(mode="after")
    def _check_surface(self) -> "SpectrumAsperities":
        if (self.rms_height is None) == (self.rms_slope is None):
            raise RoughmdrError("source 'spectrum' takes one of rms_height and rms_slope")
        longest = self.long_wave * math.sqrt(self.anisotropy)
        if longest > self.patch:
            message = f"must be at least the longest wave, {longest:.3g} m along x"
            raise EntryError("patch", self.patch, message)
        if self._points > _LARGEST_MAP:
            message = f"takes a map of {self._points:.3g} points along a side; at most {_LARGEST_MAP} are allowed"
            raise EntryError("patch", self.patch, message)
        try:
            _ = self.summits
        except (OutOfRange, ArithmeticError, ValueError) as error:
            raise EntryError("short_wave", self.short_wave, f"leaves no surface with summits: {error}") from None
        return self

    @property
    def _points(self) -> int:
        """Points along a side of a map."""
        from scipy.fft import next_fast_len

        shortest = self.short_wave / math.sqrt(self.anisotropy)
        least = max(self.points, 2.0 * _MARGIN) * self.patch / shortest
        return 2 * next_fast_len(math.ceil(0.5 * least) + 1, real=True) if least < _LARGEST_MAP else math.ceil(least)

    @property
    def map_points(self) -> int:
        return self._points**2

    @cached_property
    def _waves(self) -> Waves:
        height = 1.0 if self.rms_height is None else self.rms_height
        spectrum = SelfAffine.of(
            hurst=self.hurst, long_wave=self.long_wave, short_wave=self.short_wave, rms_height=height
        )
        return Waves.of(spectrum, self.patch, self.anisotropy, rms_slope=self.rms_slope)

    @cached_property
    def summits(self) -> SummitDistribution:
        """The distribution of the summits of such surfaces without end."""
        return SummitDistribution(Moments.checked(*self._waves.moments))

    @property
    def shape_name(self) -> str:
        return "paraboloid" if self.model == "summits" else "mdr_table"

    @property
    def expected_count(self) -> float:
        return max(self.summits.density * self.nominal_area, 1.0)

    @property
    def nominal_area(self) -> float:
        return self.patch * self.patch

    @property
    def sigma(self) -> float:
        return self.summits.sigma

    def reason_against(self, estimator: str) -> str:
        return f"source 'spectrum' draws whole maps, of which nothing is {estimator}"

    def limited_to(self, count: int) -> "SpectrumAsperities":
        side = self.patch * math.sqrt(min(1.0, count / self.expected_count))
        patch = max(side, self.long_wave * math.sqrt(self.anisotropy))
        if not patch < self.patch:
            return self
        return self.model_validate({**self.model_dump(exclude_none=True), "patch": patch})

    def height_map(self, seed: int, realization: int) -> HeightMap:
        """Return the map of a realisation."""
        waves = self._waves
        scores = ndtri(make_streams(seed, realization)(WAVES, 2 * waves.i.size)).reshape(-1, 2).T
        return waves.map(scores, self._points)

    def ensemble(
        self, seed: int, realization: int, *, stratified: bool = False, with_positions: bool = False
    ) -> Ensemble:
        surface = self.height_map(seed, realization)
        noise = _ROUNDING * math.sqrt(float(np.sum(self._waves.variance)))
        found = asperities_on(surface, noise, self.model, "the map of the spectrum", {"detrend": "none"})
        return replace(found, attrs={**found.attrs, "seed": seed, "realization": realization})

    @cached_property
    def _usual(self) -> Ensemble:
        return self.limited_to(1).ensemble(0, 0)

    def extremes(self, chance: float) -> Ensemble:
        """Return asperities of a small map, of the height that one exceeds with this chance."""
        usual = self._usual
        return replace(usual, height=np.full(usual.height.size, self.summits.height_exceeded(chance)))
