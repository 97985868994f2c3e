"""Which interaction of asperities a scene or a caller asks for."""

from collections.abc import Mapping
from numbers import Integral, Real
from typing import Literal, NamedTuple, get_args

from roughmdr.errors import RoughmdrError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.schema.wording import short_repr

Model = Literal["pairwise", "mean_field"]
Boundary = Literal["periodic", "free"]
Beyond = Literal["flag", "boundary_elements"]
_NAMED = (Model, Boundary, Beyond)
DEFAULT_ERROR, LEAST_ERROR, MOST_ERROR = 1e-6, 1e-9, 1e-2


class Interaction(NamedTuple):
    """How asperities feel each other."""

    model: Model = "pairwise"
    """"pairwise": each contact is displaced by each other one; "mean_field": by the mean pressure of all."""
    boundary: Boundary = "periodic"
    """"periodic": the patch repeats, and separations count from the mean plane of the deformed half-space; "free": the
    patch lies alone on a half-space, and separations count from its undeformed plane."""
    order: int = 2
    """1: contacts are points to each other; 2: of finite size, on a surface that their neighbours tilt and curve."""
    error: float = DEFAULT_ERROR
    """Largest relative error of the force by the solver [1]."""
    beyond: Beyond = "flag"
    """Where too many contacts overlap: "flag" marks the step, "boundary_elements" solves the realisation on a grid."""

    @classmethod
    def from_argument(cls, value: object) -> "Interaction | None":
        """Return the interaction that an argument asks for: None, the name of a model, or a table as in a scene.

        RoughmdrError where it asks for what does not exist.
        """
        if value is None or isinstance(value, cls):
            return value
        table = {"model": value} if isinstance(value, str) else value
        if not isinstance(table, Mapping) or not set(table) <= set(cls._fields):
            names = ", ".join(cls._fields)
            raise RoughmdrError(f"interaction is {short_repr(value)}; it must be a model, or a table of {names}")
        asked = cls(**table)
        allowed = {name: get_args(kind) for name, kind in zip(("model", "boundary", "beyond"), _NAMED, strict=True)}
        allowed["order"] = (1, 2)
        for name, values in allowed.items():
            value, kind = getattr(asked, name), Integral if name == "order" else str
            if isinstance(value, bool) or not isinstance(value, kind) or value not in values:
                given = short_repr(value)
                raise RoughmdrError(f"interaction.{name} is {given}; there are {', '.join(map(repr, values))}")
        if asked.beyond == "boundary_elements" and (asked.model, asked.boundary) != ("pairwise", "periodic"):
            raise RoughmdrError(
                f"interaction.beyond is {asked.beyond!r}; it goes with model 'pairwise' and boundary 'periodic' only"
            )
        if (
            isinstance(asked.error, bool)
            or not isinstance(asked.error, Real)
            or not LEAST_ERROR <= asked.error <= MOST_ERROR
        ):
            given = short_repr(asked.error)
            raise RoughmdrError(f"interaction.error is {given}; it must be from {LEAST_ERROR:g} to {MOST_ERROR:g}")
        return asked


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
