"""Sections of a scene: their keys, defaults and bounds."""

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from roughmdr.errors import RoughmdrError
from roughmdr.interaction.settings import DEFAULT_ERROR as DEFAULT_SOLVER_ERROR
from roughmdr.interaction.settings import LEAST_ERROR, MOST_ERROR, Beyond, Boundary, Interaction, Model
from roughmdr.kernels.adhesion import DEFAULT_ERROR, Adhesion, AskedModel, check_combination, strength_of
from roughmdr.schema.material import check_one_body
from roughmdr.schema.quantities import EntryError, Quantity, Section, WholeNumber
from roughmdr.variables import (
    DEFAULT_VARIABLES,
    LAW_VARIABLES,
    OUTPUT_VARIABLES,
    PULL_OFF,
    RUN_DIAGNOSTICS,
    STEP_COORDINATES,
)

_MAX_REALIZATIONS = 1_000_000_000
_Modulus = Annotated[float, BeforeValidator(Quantity("Pa", above=0.0))]
_Poisson = Annotated[float, BeforeValidator(Quantity("1", above=-1.0, at_most=0.5))]


class Body(Section):
    """[counter]: an elastic body."""

    modulus: _Modulus
    poisson: _Poisson


class MaterialSection(Section):
    """[material]: effective_modulus alone, or modulus and poisson."""

    effective_modulus: _Modulus | None = None
    modulus: _Modulus | None = None
    poisson: _Poisson | None = None

    @model_validator(mode="after")
    def _effective_or_youngs(self) -> "MaterialSection":
        check_one_body(self.effective_modulus, self.modulus, self.poisson)
        return self


class AdhesionSection(Section):
    """[adhesion]: work of adhesion of the pair, not the surface energy of one side; strength, or range = work/strength.

    "auto" uses JKR if its force differs from Dugdale's by at most ``error`` of the largest force.
    """

    model: AskedModel
    work: Annotated[float, BeforeValidator(Quantity("J/m^2", at_least=0.0))]
    strength: Annotated[float, BeforeValidator(Quantity("Pa", above=0.0))] | None = None
    range: Annotated[float, BeforeValidator(Quantity("m", above=0.0))] | None = None
    error: Annotated[float, BeforeValidator(Quantity("1", above=0.0, at_most=1.0))] | None = None

    @model_validator(mode="after")
    def _combination(self) -> "AdhesionSection":
        check_combination(self.model, self.strength, self.range, self.error)
        _ = self.adhesion_model
        return self

    @property
    def adhesion_model(self) -> Adhesion:
        """Adhesion model with its parameters."""
        strength = math.inf if self.strength is None else self.strength
        if self.range is not None:
            strength = strength_of(self.work, self.range)
        error = 0.0 if self.model != "auto" else (DEFAULT_ERROR if self.error is None else self.error)
        return Adhesion(self.work, self.model, strength, error)


class InteractionSection(Section):
    """[interaction]: how asperities feel each other; see ``Interaction``."""

    model: Model
    boundary: Boundary = "periodic"
    order: Annotated[int, BeforeValidator(WholeNumber(1, 2))] = 2
    error: Annotated[float, BeforeValidator(Quantity("1", at_least=LEAST_ERROR, at_most=MOST_ERROR))] = (
        DEFAULT_SOLVER_ERROR
    )
    beyond: Beyond = "flag"

    @model_validator(mode="after")
    def _combination(self) -> "InteractionSection":
        if self.model != "pairwise":
            for key in ("order", "error", "beyond"):
                if key in self.model_fields_set:
                    raise EntryError(key, getattr(self, key), 'goes with model = "pairwise" only')
        if self.beyond == "boundary_elements" and self.boundary == "free":
            raise EntryError("beyond", self.beyond, 'does not go with boundary = "free": the grid repeats')
        return self

    @property
    def interaction_model(self) -> Interaction:
        """Interaction with its parameters."""
        return Interaction(self.model, self.boundary, self.order, self.error, self.beyond)


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
    keep: Literal["curves", "statistics"] = "curves"

    @field_validator("variables")
    @classmethod
    def _unique(cls, value: list[str]) -> list[str]:
        return list(dict.fromkeys(value))


class Batch(Section):
    """[batch]: number of realisations and how each is made.

    "sampled" draws asperities at random, "stratified" draws them evenly spread over their distribution, "expected"
    integrates over the distribution.
    """

    estimator: Literal["sampled", "stratified", "expected"] = "sampled"
    realizations: Annotated[int, BeforeValidator(WholeNumber(1, _MAX_REALIZATIONS))] = 1


class Accuracy(Section):
    """[accuracy]: realisations are added until the mean force is known well enough.

    That is when its standard error, divided by the largest mean force, is at most ``relative``.

    ``method`` "auto" uses the cheaper of stratified draws and the expected law, if the latter is accurate enough.
    """

    relative: Annotated[float, BeforeValidator(Quantity("1", above=0.0, at_most=1.0))]
    max_realizations: Annotated[int, BeforeValidator(WholeNumber(2, _MAX_REALIZATIONS))] = 10_000
    method: Literal["auto", "sampled", "stratified", "expected"] = "auto"
