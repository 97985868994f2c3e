"""source = "nayak": the summits of an isotropic Gaussian surface, as paraboloids."""

import math
from functools import cached_property, partial
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution, product_of_score
from roughmdr.ensemble.nodes import HEIGHT_END, Heights, Nodes, Rule, UpperTail
from roughmdr.ensemble.patch_source import MAX_COUNT, PatchSource
from roughmdr.ensemble.random.distribution_families import ndtri
from roughmdr.ensemble.streams import HEIGHT, PARAMETER, make_streams
from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.section import Length
from roughmdr.spectrum import HURST, Moments, SelfAffine

_MOMENTS = ("m0", "m2", "m4")
_WAVES = ("hurst", "long_wave", "short_wave")
_AMPLITUDES = ("rms_height", "rms_slope")
_EITHER = "takes m0, m2 and m4, or hurst, long_wave, short_wave and one of rms_height and rms_slope"
_RADII, _MAX_SCORE = 33, 9.0  # number of radii between their tails, and largest score of ``product_of_score``
SUMMIT_DISTANCE = 0.5
"""Least distance of two summits over their mean spacing, 1/sqrt(density), unless min_distance is given.

Points that are placed at random at least so far apart have about the mean distance to the nearest neighbour that the
summits of Gaussian maps have (``find_summits`` on periodic maps of 2048^2 points, 16 points to the shortest wave, two
each): over the mean spacing 0.88 at alpha = 1.5, 0.77 to 0.78 at 1.8, 0.66 to 0.72 at 2.5 to 2.7, 0.69 at 6 and 16
(Hurst exponent 0.3), 0.60 at 12 and 0.58 at 74 (0.8), 0.56 at 12 and 0.50 at 89 (1). Points at random have 0.50, at
least 0.3 apart 0.58, 0.4 0.62, 0.5 0.68, 0.6 0.74, 0.65 0.77, 0.75 0.83. So 0.5 is in the middle: summits of narrow
spectra lie farther apart; those of wide ones come in clusters on the long waves. One summit in ten of the maps has a
nearer neighbour than 0.5 at alpha 2.7, one in three at 12.
"""
_STREAMS = (HEIGHT, PARAMETER, PARAMETER + 1)  # for height, mean curvature and product of the curvatures


class NayakAsperities(PatchSource):
    """[asperities] with source = "nayak": the summits of a surface with these moments or this spectrum.

    Their number is density times area, rounded; their heights are from the mean plane of the surface. Positions, where
    they are needed, are independent of the heights, which those of a surface are not: its high summits cluster. Unless
    another placement is given, they are a hard core apart, by default ``SUMMIT_DISTANCE`` of the mean spacing.
    """

    of_surface: ClassVar[bool] = True
    papers: ClassVar[dict[str, str]] = dict.fromkeys(("LonguetHiggins1957", "Nayak1971", "Greenwood2006"), "roughness")
    has_usual_distance: ClassVar[bool] = True

    source: Literal["nayak"]
    shape: Literal["paraboloid"] = "paraboloid"
    placement: Literal["random", "hard_core", "square", "hexagonal"] = "hard_core"
    m0: Annotated[float, Quantity("m2", above=0.0)] | None = None
    """Mean square of the heights of a profile of the surface."""
    m2: Annotated[float, Quantity("1", above=0.0)] | None = None
    """Mean square of its slopes."""
    m4: Annotated[float, Quantity("m-2", above=0.0)] | None = None
    """Mean square of its curvatures."""
    hurst: Annotated[float, HURST] | None = None
    """Hurst exponent of the spectrum."""
    long_wave: Length | None = None
    """Longest wave of the spectrum."""
    short_wave: Length | None = None
    """Shortest wave of the spectrum."""
    rms_height: Length | None = None
    """Root mean square of the heights of the surface."""
    rms_slope: Annotated[float, Quantity("1", above=0.0)] | None = None
    """Root mean square of its slopes, in place of rms_height."""

    @field_validator(*_WAVES, *_AMPLITUDES)
    @classmethod
    def _check_entry(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is None:
            return None
        moments = [key for key in _MOMENTS if info.data.get(key) is not None]
        if moments:
            raise RoughmdrError(f"does not go with {' and '.join(moments)}; source 'nayak' {_EITHER}")
        long_wave = info.data.get("long_wave")
        if info.field_name == "short_wave" and long_wave is not None and not value < long_wave:
            raise RoughmdrError(f"must be below long_wave, {long_wave:g} m")
        if info.field_name == "rms_slope" and info.data.get("rms_height") is not None:
            raise RoughmdrError("does not go with rms_height; either determines the other")
        return value

    @model_validator(mode="after")
    def _check_surface(self) -> "NayakAsperities":
        moments, waves = self._given(_MOMENTS), self._given(_WAVES + _AMPLITUDES)
        if not moments and not waves:
            raise RoughmdrError(_EITHER)
        missing = [key for key in (_MOMENTS if moments else _WAVES) if key not in {**moments, **waves}]
        if waves and not self._given(_AMPLITUDES):
            missing.append("rms_height or rms_slope")
        if missing:
            raise RoughmdrError(f"needs {' and '.join(missing)}; source 'nayak' {_EITHER}")
        try:
            expected = self._mean_count
        except ArithmeticError:
            raise RoughmdrError("no float can hold the moments of this spectrum") from None
        if not expected > 0.5:
            side = 1.0 / math.sqrt(self.summits.density)
            message = f"holds {expected:.3g} summits; at least one is needed: on average on a side of {side:.3g} m"
            raise EntryError("patch", self.patch, message)
        if expected > MAX_COUNT:
            raise EntryError("patch", self.patch, f"holds {expected:.3g} summits; at most {MAX_COUNT:g} are allowed")
        self.check_lattice()
        return self

    def _given(self, keys: tuple[str, ...]) -> dict[str, float]:
        entries = {key: getattr(self, key) for key in keys}
        return {key: entry for key, entry in entries.items() if entry is not None}

    @cached_property
    def summits(self) -> SummitDistribution:
        """The distribution of the summits; OutOfRange where no surface has such moments, or ArithmeticError."""
        moments = Moments(**self._given(_MOMENTS)) if self.spectrum is None else self.spectrum.moments
        return SummitDistribution(Moments.checked(*moments))

    @property
    def core_distance(self) -> float:
        if self.min_distance is not None or self.placement != "hard_core":
            return self.min_distance or 0.0
        return SUMMIT_DISTANCE / math.sqrt(self.summits.density)

    @property
    def spectrum(self) -> SelfAffine | None:
        """The spectrum of the surface; None where only its moments are known."""
        waves = self._given(_WAVES + _AMPLITUDES)
        return SelfAffine.of(**waves) if waves else None

    @property
    def count(self) -> int:
        """The number of summits."""
        return round(self._mean_count)

    @property
    def _mean_count(self) -> float:
        return self.summits.density * self.patch * self.patch

    def limited_to(self, count: int) -> "NayakAsperities":
        fewer = self.at_most(count)
        return self.model_copy(update={"patch": self.patch * math.sqrt(min(1.0, fewer / self.count))})

    @property
    def expected_count(self) -> float:
        return float(self.count)

    @property
    def sigma(self) -> float:
        return self.summits.sigma

    @property
    def node_axes(self) -> tuple[int, ...]:
        return (1,)  # the product of the curvatures

    @property
    def heights_depend(self) -> bool:
        return True

    def nodes(self, *rules: Rule) -> Nodes:
        """Return nodes at products of curvatures of these normal scores."""
        (rule,) = rules
        v = product_of_score(rule.scores)
        return Nodes(rule.weights, {"radius": self.summits.radius(v)}, tuple(map(self._heights, v.tolist())))

    def _heights(self, v: float) -> Heights:
        """Return the heights of the summits with the product of curvatures v."""
        edges = self.summits.height_range(v, HEIGHT_END)
        tail = UpperTail(0.0, 0.0)  # the tail is lighter than the normal one
        return Heights(partial(self.summits.height_density, v=v), None, edges, self.summits.height_spread, tail, 0.0)

    def extremes(self, chance: float) -> Ensemble:
        far = float(ndtri(np.array([chance]))[0])
        v = product_of_score(np.linspace(far, -far, _RADII).clip(-_MAX_SCORE, _MAX_SCORE))
        highest = np.full(_RADII, self.summits.height_exceeded(chance))
        return Ensemble(self.shape, highest, {"radius": self.summits.radius(v)}, self.nominal_area)

    def ensemble(
        self, seed: int, realization: int, *, stratified: bool = False, with_positions: bool = False
    ) -> Ensemble:
        streams = make_streams(seed, realization, _STREAMS if stratified else ())
        summits = self.summits.draw(*(streams(stream, self.count) for stream in _STREAMS))
        positions = self.positions(streams, self.count) if with_positions else {}
        attrs: dict[str, float | int | str] = {**self.patch_attrs, "seed": seed, "realization": realization}
        attrs |= {"of_surface": 1, "density": self.summits.density, "alpha": self.summits.moments.alpha}
        attrs |= self.summits.moments._asdict()
        radii = {"radius": summits.radius}
        return Ensemble(self.shape, summits.height, radii, self.nominal_area, positions, attrs).sorted()
