"""[viscoelastic]: how the modulus relaxes, and how fast the flat moves; what it does not go with."""

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import BeforeValidator, Field, model_validator

from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity, Section
from roughmdr.variables import DEFAULT_VARIABLES

if TYPE_CHECKING:
    from roughmdr.scene.scene import Scene


_UNKNOWN = ("stiffness", "energy", "dissipated_energy", "machine_dissipated_energy")
"""Variables that a viscoelastic law does not have."""
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


def without_unknown() -> list[str]:
    """Return the variables of a scene with [viscoelastic] that names none."""
    return [name for name in DEFAULT_VARIABLES if name not in _UNKNOWN]


def check_viscoelastic(scene: "Scene") -> None:
    """Raise a mismatch where [viscoelastic], if it is there, does not go with another section of a scene."""
    if scene.viscoelastic is None:
        return
    path = scene.path
    others = {"adhesion": scene.work > 0.0, "interaction": scene.interaction, "reference": scene.reference}
    for name, other in others.items():
        if other:
            raise mismatch(name, "does not go with [viscoelastic]: its asperities are independent and do not adhere")
    if path.control != "separation":
        raise mismatch(f"path.{path.key}", "does not go with [viscoelastic], which needs path.separation")
    if unknown := [name for name in scene.output.variables if name in _UNKNOWN]:
        raise mismatch("output.variables", f"{', '.join(unknown)} cannot be computed with [viscoelastic]")
