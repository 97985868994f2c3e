"""source = "nayak": the summits of an isotropic Gaussian surface, as paraboloids."""

import math
from functools import cached_property, partial
from typing import Annotated, Literal

from pydantic import BeforeValidator, ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution, product_of_score
from roughmdr.ensemble.nodes import END as HEIGHT_END
from roughmdr.ensemble.nodes import Heights, Nodes, Rule, UpperTail
from roughmdr.ensemble.patch import PatchSource
from roughmdr.ensemble.streams import HEIGHT, PARAMETER, independent, spread
from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import EntryError, Length, Quantity
from roughmdr.spectrum import Moments, SelfAffine

_MOMENTS = ("m0", "m2", "m4")
_WAVES = ("hurst", "long_wave", "short_wave")
_AMPLITUDES = ("rms_height", "rms_slope")
_EITHER = "takes m0, m2 and m4, or hurst, long_wave, short_wave and one of rms_height and rms_slope"
_MOST = 1_000_000_000
_STREAMS = (HEIGHT, PARAMETER, PARAMETER + 1)
"""Of the heights, the mean curvatures and the products of the curvatures."""


class NayakAsperities(PatchSource):
    """[asperities] with source = "nayak": the summits of a surface with these moments or this spectrum.

    There are as many as the density says, rounded; their heights are from the mean plane of the surface.
    """

    source: Literal["nayak"]
    shape: Literal["paraboloid"] = "paraboloid"
    m0: Annotated[float, BeforeValidator(Quantity("m2", above=0.0))] | None = None
    m2: Annotated[float, BeforeValidator(Quantity("1", above=0.0))] | None = None
    m4: Annotated[float, BeforeValidator(Quantity("m-2", above=0.0))] | None = None
    hurst: Annotated[float, BeforeValidator(Quantity("1", at_least=0.0, at_most=1.0))] | None = None
    long_wave: Length | None = None
    short_wave: Length | None = None
    rms_height: Length | None = None
    rms_slope: Annotated[float, BeforeValidator(Quantity("1", above=0.0))] | None = None

    @field_validator(*_WAVES, *_AMPLITUDES)
    @classmethod
    def _moments_stand_alone(cls, value: float | None, info: ValidationInfo) -> float | None:
        moments = [key for key in _MOMENTS if info.data.get(key) is not None]
        if value is not None and moments:
            raise RoughmdrError(f"does not go with {' and '.join(moments)}; source 'nayak' {_EITHER}")
        return value

    @field_validator("short_wave")
    @classmethod
    def _short_is_below_long(cls, value: float | None, info: ValidationInfo) -> float | None:
        long_wave = info.data.get("long_wave")
        if value is not None and long_wave is not None and not value < long_wave:
            raise RoughmdrError(f"must be below long_wave, {long_wave:g} m")
        return value

    @field_validator("rms_slope")
    @classmethod
    def _one_amplitude(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and info.data.get("rms_height") is not None:
            raise RoughmdrError("does not go with rms_height; either tells the other")
        return value

    @model_validator(mode="after")
    def _one_whole_description(self) -> "NayakAsperities":
        moments, waves = self._given(_MOMENTS), self._given(_WAVES + _AMPLITUDES)
        if not moments and not waves:
            raise RoughmdrError(_EITHER)
        missing = [key for key in (_MOMENTS if moments else _WAVES) if key not in {**moments, **waves}]
        if waves and not self._given(_AMPLITUDES):
            missing.append("rms_height or rms_slope")
        if missing:
            raise RoughmdrError(f"needs {' and '.join(missing)}; source 'nayak' {_EITHER}")
        return self

    @model_validator(mode="after")
    def _there_is_such_a_surface(self) -> "NayakAsperities":
        try:
            _ = self.law
        except ArithmeticError:
            raise RoughmdrError("no float can hold the moments of this spectrum") from None
        return self

    @model_validator(mode="after")
    def _the_patch_holds_some(self) -> "NayakAsperities":
        expected = self._on_average
        if not expected > 0.5:
            side = 1.0 / math.sqrt(self.law.density)
            raise EntryError(
                "patch",
                self.patch,
                f"holds {expected:.3g} summits; at least one is needed: on average on a side of {side:.3g} m",
            )
        if expected > _MOST:
            raise EntryError("patch", self.patch, f"holds {expected:.3g} summits; at most {_MOST:g} are allowed")
        return self

    def _given(self, keys: tuple[str, ...]) -> dict[str, float]:
        entries = {key: getattr(self, key) for key in keys}
        return {key: entry for key, entry in entries.items() if entry is not None}

    @cached_property
    def law(self) -> SummitDistribution:
        """The law of the summits; OutOfRange where no surface has such moments, ArithmeticError where no float has."""
        moments = Moments(**self._given(_MOMENTS)) if self.spectrum is None else self.spectrum.moments
        return SummitDistribution(Moments.checked(*moments))

    @property
    def spectrum(self) -> SelfAffine | None:
        """The spectrum of the surface; None where only its moments are known."""
        waves = self._given(_WAVES + _AMPLITUDES)
        return SelfAffine.of(**waves) if waves else None

    @property
    def count(self) -> int:
        """How many summits there are: the whole number nearest to density times area."""
        return round(self._on_average)

    @property
    def _on_average(self) -> float:
        """How many summits a patch of this size has."""
        return self.law.density * self.patch * self.patch

    def sampled(self, count: int) -> "NayakAsperities":
        """The same on a patch that holds at most ``count`` asperities."""
        part = min(1.0, count / self.count)
        return self.model_copy(update={"patch": self.patch * math.sqrt(part)})

    @property
    def expected_count(self) -> float:
        """How many summits there are."""
        return float(self.count)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights over the law [m]."""
        return self.law.sigma

    @property
    def one_parameter(self) -> bool:
        """The product of the curvatures alone says what contacts bear."""
        return True

    def node_count(self, order: int) -> int:
        """One for each of their scores."""
        return order

    def nodes(self, rule: Rule) -> Nodes:
        """Nodes at products of curvatures of these normal scores."""
        v = product_of_score(rule.scores)
        return Nodes(rule.weights, {"radius": self.law.radius(v)}, tuple(map(self._heights, v.tolist())))

    def _heights(self, v: float) -> Heights:
        """The heights of the summits that have a product of curvatures v."""
        low, high = self.law.height_range(v, HEIGHT_END)
        tail = UpperTail(0.0, 0.0)  # lighter than the normal one
        return Heights(partial(self.law.height_density, v=v), None, (low, high), self.law.height_spread, tail, 0.0)

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of one realization."""
        draws = spread(seed, realization, _STREAMS) if stratified else independent(seed, realization)
        summits = self.law.draw(*(draws(stream, self.count) for stream in _STREAMS))
        attrs: dict[str, float | int | str] = {
            "patch": self.patch,
            "seed": seed,
            "realization": realization,
            "density": self.law.density,
            "alpha": self.law.moments.alpha,
            **self.law.moments._asdict(),
        }
        radii = {"radius": summits.radius}
        positions = self.positions(draws, self.count) if placed else {}
        return Ensemble.sorted(self.shape, summits.height, radii, self.nominal_area, positions, attrs)
