"""Adhesion between the surfaces: the model that is asked for, and the Tabor number, which tells which model holds."""

import math
from typing import Literal, NamedTuple, get_args

from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import check_number

Model = Literal["jkr", "dugdale"]


class Adhesion(NamedTuple):
    """An adhesion model with its parameters."""

    work: float = 0.0
    """w [J/m2]; 0 for none."""
    model: Literal["jkr", "dugdale", "auto"] = "jkr"
    strength: float = math.inf
    """sigma0 [Pa], the stress of the attraction (Dugdale); inf where it is not given."""
    error: float = 0.0
    """The error that "auto" may make, over the largest force."""

    def __str__(self) -> str:
        strength = f", strength {self.strength:g} Pa" if self.strength < math.inf else ""
        return f"work {self.work:g} J/m^2{strength}"

    @property
    def cohesive(self) -> bool:
        """Whether the attraction has a range."""
        return self.work > 0.0 and self.model == "dugdale"

    @property
    def range(self) -> float:
        """The adhesion range w/sigma0 [m]; 0 where the model has none."""
        return self.work / self.strength if self.cohesive else 0.0

    @property
    def tabor_known(self) -> bool:
        """Whether the Tabor number is known."""
        return self.work > 0.0 and self.strength < math.inf

    @property
    def candidates(self) -> tuple[Model, ...]:
        """The models that may be taken."""
        return ("jkr", "dugdale") if self.model == "auto" else (self.model,)

    def resolved(self, jkr_error: float) -> "Adhesion":
        """Return the model itself: for "auto" the cheapest that is right enough where JKR is off by ``jkr_error``."""
        if self.model != "auto":
            return self
        return self._replace(model="jkr" if jkr_error <= self.error else "dugdale")

    @classmethod
    def checked(cls, model: Model, work: float, strength: float | None) -> "Adhesion":
        """Return the model asked for; w [J/m2], sigma0 [Pa] or None where it is not given.

        RoughmdrError for an unknown model or a missing strength, OutOfRange for a number.
        """
        work = check_number("work", work, "J/m^2", zero=True)
        if model not in get_args(Model):
            raise RoughmdrError(f"adhesion is {model!r}; it must be 'jkr' or 'dugdale'")
        if strength is None and model == "dugdale":
            raise RoughmdrError("strength is missing: adhesion 'dugdale' needs the stress of the attraction [Pa]")
        return cls(work, model, math.inf if strength is None else check_number("strength", strength, "Pa"))


def release_stretch(radius: float, effective_modulus: float, work: float) -> float:
    """dl [m], the stretch of the edge of a JKR contact of this radius [m]: sqrt(2 pi a w/E*) (H 44)."""
    return math.sqrt(2.0 * math.pi * radius) * math.sqrt(work) / math.sqrt(effective_modulus)


def tabor_number(radius: float, effective_modulus: float, work: float, strength: float) -> float:
    """The Tabor number [1] of a JKR contact that detaches at this radius [m]: dl(radius) strength/(pi^(2/3) work)."""
    return float(release_stretch(radius, effective_modulus, work) / work * strength / math.pi ** (2.0 / 3.0))
