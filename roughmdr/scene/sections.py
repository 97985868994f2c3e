"""Sections of a scene: their keys, defaults and bounds."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from roughmdr.errors import RoughmdrError
from roughmdr.kernels.adhesion import ERROR, RANGE, STRENGTH, WORK, Adhesion, AskedModel, check_combination
from roughmdr.scene.asked import Asked
from roughmdr.schema.faults import mismatch
from roughmdr.schema.material import MODULUS, POISSON, check_one_body
from roughmdr.schema.quantities import Quantity, WholeNumber
from roughmdr.schema.section import Section
from roughmdr.variables import (
    DEFAULT_VARIABLES,
    LAW_VARIABLES,
    OUTPUT_VARIABLES,
    PULL_OFF,
    RUN_DIAGNOSTICS,
    STEP_COORDINATES,
)

_MAX_REALIZATIONS = 1_000_000_000
_SHARE = 1e-2
"""Relative error of the force that goes with a separation that is asked for, about."""
_Modulus = Annotated[float, MODULUS]
_Poisson = Annotated[float, POISSON]
_Hardness = Annotated[float, Quantity("Pa", above=0.0)]


class Body(Section):
    """[counter]: an elastic body."""

    examples: ClassVar[Mapping[str, str]] = {"modulus": '"70 GPa"', "poisson": "0.22"}

    modulus: _Modulus
    """Young's modulus."""
    poisson: _Poisson
    """Poisson's ratio."""


class MaterialSection(Section):
    """[material]: effective_modulus alone, or modulus and poisson."""

    examples: ClassVar[Mapping[str, str]] = {"modulus": '"3 MPa"', "poisson": "0.49"}

    effective_modulus: _Modulus | None = None
    """E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; in place of all others."""
    modulus: _Modulus | None = None
    """Young's modulus."""
    poisson: _Poisson | None = None
    """Poisson's ratio."""
    hardness: _Hardness | None = None
    """Hardness of the softer body, the mean pressure at which contacts flow: says how far the elastic law holds."""

    @model_validator(mode="after")
    def _effective_or_youngs(self) -> "MaterialSection":
        check_one_body(self.effective_modulus, self.modulus, self.poisson)
        return self


class AdhesionSection(Section):
    """[adhesion]: work of adhesion of the pair, not the surface energy of one side; strength, or range = work/strength.

    "auto" uses JKR if its force differs from Dugdale's by at most ``error`` of the largest force.
    """

    examples: ClassVar[Mapping[str, str]] = {"model": '"jkr"', "work": '"50 mJ/m^2"'}

    model: AskedModel
    """"jkr" where the Tabor number is large, "dugdale" of finite range, "auto": JKR where it is right."""
    work: Annotated[float, WORK]
    """Work of adhesion of the pair, not the surface energy of one side."""
    strength: Annotated[float, STRENGTH] | None = None
    """Stress of the attraction, for "dugdale" and "auto"."""
    range: Annotated[float, RANGE] | None = None
    """Range of the attraction, work/strength, in place of strength."""
    error: Annotated[float, ERROR] | None = None
    """For "auto": JKR is used where its force is off by less, over the largest force. Default: 0.01."""

    @model_validator(mode="after")
    def _combination(self) -> "AdhesionSection":
        check_combination(self.model, self.strength, self.range, self.error)
        _ = self.adhesion_model
        return self

    @property
    def adhesion_model(self) -> Adhesion:
        """Adhesion model with its parameters."""
        return Adhesion.of(self.model, self.work, self.strength, self.range, self.error)


def _check_variable(value: object) -> object:
    if isinstance(value, str) and value not in OUTPUT_VARIABLES:
        if value.removeprefix("reference_") in OUTPUT_VARIABLES:
            raise RoughmdrError(f"not to be asked for: [reference] adds it to {value.removeprefix('reference_')}")
        if value in LAW_VARIABLES | RUN_DIAGNOSTICS | PULL_OFF or value in STEP_COORDINATES:
            raise RoughmdrError("not to be asked for: every result that can have it holds it")
    if not isinstance(value, str) or value not in OUTPUT_VARIABLES:
        raise RoughmdrError(f"no such variable; there are {', '.join(OUTPUT_VARIABLES)}")
    return value


_VARIABLE = Annotated[str, BeforeValidator(_check_variable), WithJsonSchema({"enum": list(OUTPUT_VARIABLES)})]


class Output(Section):
    """[output]: variables of the result, as curves of every realisation or as statistics."""

    variables: Annotated[list[_VARIABLE], Field(min_length=1)] = Field(default=list(DEFAULT_VARIABLES))
    """Variables over the steps that are computed and stored."""
    keep: Literal["curves", "statistics"] = "curves"
    """"curves" of each realisation, or their "statistics": mean, standard error, least and greatest."""

    derivatives: list[str] = Field(default=[])
    """Keys of numbers of the scene, with respect to which an expected law is differentiated."""

    @field_validator("variables", "derivatives")
    @classmethod
    def _unique(cls, value: list[str]) -> list[str]:
        return list(dict.fromkeys(value))


class Batch(Section):
    """[batch]: number of realisations and how each is made.

    "sampled" draws asperities at random, "stratified" draws them evenly spread over their distribution, "expected"
    integrates over the distribution.
    """

    estimator: Literal["sampled", "stratified", "expected"] = "sampled"
    """"sampled" at random, "stratified": evenly spread, "expected": the mean law by integration."""
    realizations: Annotated[int, WholeNumber(1, _MAX_REALIZATIONS)] = 1
    """Number of random ensembles."""


class Accuracy(Section):
    """[accuracy]: realisations are added until the mean force, or the quantity ``of`` interest, is known well enough.

    That is when its standard error, divided by the largest mean force, is at most ``relative``, or when the whole error
    of the quantity is as small as asked: the method is chosen for it too.

    ``method`` "auto" uses the cheaper of stratified draws and the expected law, if the latter is accurate enough.
    """

    examples: ClassVar[Mapping[str, str]] = {"relative": "1e-2"}

    relative: Annotated[float, Quantity("1", above=0.0, at_most=1.0)] | None = None
    """Standard error of the mean force over its largest value."""
    of: Asked | None = None
    """A quantity with its whole error, in place of ``relative``: how asperities feel each other is chosen for it."""
    max_realizations: Annotated[int, WholeNumber(2, _MAX_REALIZATIONS)] = 10_000
    """Most realisations of a cell."""
    method: Literal["auto", "sampled", "stratified", "expected"] = "auto"
    """"auto": the cheaper of draws and the expected law; or an estimator."""

    @model_validator(mode="after")
    def _relative_or_of(self) -> "Accuracy":
        if self.relative is None and self.of is None:
            raise mismatch("accuracy.relative", "is missing")
        if self.relative is not None and self.of is not None:
            raise mismatch("accuracy.of", "does not go with accuracy.relative: one error is asked for")
        return self

    @property
    def share(self) -> float:
        """Relative error that is asked for; of a separation, which has no natural zero, ``_SHARE``."""
        of_quantity = _SHARE if self.of is None or self.of.absolute else self.of.tolerance
        return of_quantity if self.relative is None else self.relative
