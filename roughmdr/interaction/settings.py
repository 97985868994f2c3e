"""[interaction] of a scene, and the same as an argument: which interaction of asperities is asked for."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from roughmdr.errors import RoughmdrError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.schema.faults import validated
from roughmdr.schema.quantities import EntryError, Quantity, WholeNumber
from roughmdr.schema.section import Section
from roughmdr.schema.wording import short_repr

Boundary = Literal["periodic", "free"]


class Interaction(Section):
    """[interaction]: how asperities feel each other."""

    examples: ClassVar[Mapping[str, str]] = {"model": '"pairwise"'}

    model: Literal["pairwise", "mean_field"]
    """"pairwise": each contact is displaced by each other one; "mean_field": by the mean pressure of all."""
    boundary: Boundary = "periodic"
    """"periodic": the patch repeats, and separations count from the mean plane of the deformed half-space; "free": the
    patch lies alone on a half-space, and separations count from its undeformed plane."""
    order: Annotated[int, WholeNumber(1, 2)] = 2
    """1: contacts are points to each other; 2: of finite size, on a surface that their neighbours tilt and curve."""
    error: Annotated[float, Quantity("1", at_least=1e-9, at_most=1e-2)] = 1e-6
    """Largest relative error of the force by the solver."""
    beyond: Literal["flag", "boundary_elements"] = "flag"
    """Where too many contacts overlap: "flag" marks the step, "boundary_elements" solves the realisation on a grid."""

    @classmethod
    def from_argument(cls, value: object) -> "Interaction | None":
        """Return the interaction that an argument asks for: None, the name of a model, or a table as in a scene.

        SceneError, with all faults, where it asks for what does not exist.
        """
        if value is None or isinstance(value, cls):
            return value
        table = {"model": value} if isinstance(value, str) else value
        if not isinstance(table, Mapping):
            names = ", ".join(cls.model_fields)
            raise RoughmdrError(f"interaction is {short_repr(value)}; it must be a model, or a table of {names}")
        asked: Interaction = validated(cls, {"model": "pairwise", **table}, "interaction")
        return asked

    @model_validator(mode="after")
    def _combination(self) -> "Interaction":
        if self.model != "pairwise":
            for key in ("order", "error", "beyond"):
                if key in self.model_fields_set:
                    raise EntryError(key, getattr(self, key), 'goes with model = "pairwise" only')
        if self.beyond == "boundary_elements" and self.boundary == "free":
            raise EntryError("beyond", self.beyond, 'does not go with boundary = "free": the grid repeats')
        return self


def reason_against_adhesion(interaction: Interaction, adhesion: Adhesion) -> str | None:
    """Return why an interaction does not go with an adhesion model; None where it does."""
    if adhesion.work == 0.0:
        return None
    if interaction.model != "pairwise":
        return f"model {interaction.model!r} does not go with adhesion (work > 0); 'pairwise' does"
    if adhesion.model != "jkr":
        return f"model 'pairwise' goes with adhesion 'jkr' only, not {adhesion.model!r}"
    if interaction.beyond != "flag":
        return f"beyond {interaction.beyond!r} does not go with adhesion (work > 0); 'flag' does"
    return None
