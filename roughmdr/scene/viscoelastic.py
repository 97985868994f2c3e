"""[viscoelastic]: how the modulus relaxes, and how fast the flat moves; what it does not go with."""

import math
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from roughmdr.schema.quantities import EntryError, Quantity, Section

_Speed = Annotated[float, BeforeValidator(Quantity("m/s", above=0.0))]


class RelaxationTerm(Section):
    """A term of the Prony series: the share of the instantaneous modulus that is lost, and its relaxation time."""

    time: Annotated[float, BeforeValidator(Quantity("s", above=0.0))]
    share: Annotated[float, BeforeValidator(Quantity("1", at_least=0.0, at_most=1.0))]


class ViscoelasticSection(Section):
    """[viscoelastic]: the modulus of the scene is the instantaneous one, and relaxes by 1 - exp(-t/time) of each share.

    ``dwell`` is spent at the lowest separation.
    """

    relaxation: Annotated[list[RelaxationTerm], Field(min_length=1)]
    speed: _Speed
    retraction_speed: _Speed | None = None
    dwell: Annotated[float, BeforeValidator(Quantity("s", at_least=0.0))] = 0.0

    @model_validator(mode="after")
    def _shares(self) -> "ViscoelasticSection":
        if (total := math.fsum(term.share for term in self.relaxation)) > 1.0:
            raise EntryError("relaxation", None, f"has shares of {total:g} together; they must be at most 1")
        return self

    @property
    def speed_of_retraction(self) -> float:
        """[m/s], that of loading unless it is given."""
        return self.speed if self.retraction_speed is None else self.retraction_speed
