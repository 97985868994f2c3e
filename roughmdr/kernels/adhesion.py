"""Adhesion between the surfaces: the model that is asked for, and the Tabor number, on which its validity depends."""

import math
from typing import Literal, NamedTuple, get_args

from roughmdr.errors import RoughmdrError
from roughmdr.schema.material import MaterialArguments
from roughmdr.schema.quantities import Quantity

Model = Literal["jkr", "dugdale"]
AskedModel = Literal[Model, "auto"]
PAPERS = {"jkr": ("Johnson1971",), "dugdale": ("Maugis1992", "Dugdale1960")}  # keys in report/papers.bib, by model
DEFAULT_ERROR = 0.01  # default error of the force of "auto", over the largest force
WORK = Quantity("J/m^2", at_least=0.0)
STRENGTH = Quantity("Pa", above=0.0)
RANGE = Quantity("m", above=0.0)
ERROR = Quantity("1", above=0.0, at_most=1.0)


class AdhesiveMaterial(MaterialArguments, total=False):
    """The elastic constants and how the surfaces attract each other, as keyword arguments."""

    adhesion: AskedModel
    strength: float | str | None
    range: float | str | None
    error: float | None


class Adhesion(NamedTuple):
    """An adhesion model with its parameters."""

    work: float = 0.0
    """w [J/m2]; 0 for none."""
    model: AskedModel = "jkr"
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
        """Return the model to use: for "auto" JKR if its error ``jkr_error`` is small enough, else Dugdale."""
        if self.model != "auto":
            return self
        return self._replace(model="jkr" if jkr_error <= self.error else "dugdale")

    @classmethod
    def checked(
        cls,
        model: AskedModel,
        work: float | str,
        strength: float | str | None = None,
        range: float | str | None = None,  # noqa: A002 - as in a scene
        error: float | None = None,
    ) -> "Adhesion":
        """Return the model asked for; w [J/m2], sigma0 [Pa] or w/sigma0 [m], the error [1]: None where not given.

        RoughmdrError for an unknown model or arguments that exclude each other, OutOfRange for a number.
        """
        work = WORK.argument("work", work)
        if model not in get_args(AskedModel):
            raise RoughmdrError(f"adhesion is {model!r}; it must be 'jkr', 'dugdale' or 'auto'")
        try:
            check_combination(model, strength, range, error)
        except RoughmdrError as fault:
            raise RoughmdrError(f"adhesion {fault}") from None
        given = {"strength": (STRENGTH, strength), "range": (RANGE, range), "error": (ERROR, error)}
        numbers = {name: reader.argument(name, value) for name, (reader, value) in given.items() if value is not None}
        return cls.of(model, work, **numbers)

    @classmethod
    def of(
        cls,
        model: AskedModel,
        work: float,
        strength: float | None = None,
        range: float | None = None,  # noqa: A002 - as in a scene
        error: float | None = None,
    ) -> "Adhesion":
        """Return the model of numbers in SI that go together; OutOfRange where no float can hold work over range."""
        stress = strength_of(work, range) if range is not None else (math.inf if strength is None else strength)
        limit = DEFAULT_ERROR if error is None else error
        return cls(work, model, stress, limit if model == "auto" else 0.0)

    @classmethod
    def from_arguments(cls, work: float | str, material: AdhesiveMaterial) -> "Adhesion":
        """Return the adhesion that the keyword arguments of a function describe; errors as ``checked``."""
        return cls.checked(
            material.pop("adhesion", "jkr"),
            work,
            material.pop("strength", None),
            material.pop("range", None),
            material.pop("error", None),
        )


def check_combination(model: str, strength: object, range: object, error: object) -> None:  # noqa: A002
    """Raise RoughmdrError where an adhesion model excludes an argument that is given (not None), or lacks one."""
    if strength is not None and range is not None:
        raise RoughmdrError("takes strength or range, not both")
    if model != "jkr" and strength is None and range is None:
        raise RoughmdrError(f"model {model!r} needs strength, the stress of the attraction, or its range")
    if error is not None and model != "auto":
        raise RoughmdrError("takes error only with model 'auto'")


def strength_of(work: float, range: float) -> float:  # noqa: A002
    """Return sigma0 = w/range [Pa], inf without adhesion; OutOfRange where no float can hold it."""
    return STRENGTH.argument("work over range", work / range) if work > 0.0 else math.inf


def release_stretch(radius: float, effective_modulus: float, work: float) -> float:
    """dl [m], the stretch of the edge of a JKR contact of this radius [m]: sqrt(2 pi a w/E*) (H 44)."""
    return math.sqrt(2.0 * math.pi * radius) * math.sqrt(work) / math.sqrt(effective_modulus)


def tabor_number(radius: float, effective_modulus: float, work: float, strength: float) -> float:
    """The Tabor number [1] of a JKR contact that detaches at this radius [m]: dl(radius) strength/(pi^(2/3) work)."""
    return float(release_stretch(radius, effective_modulus, work) / work * strength / math.pi ** (2.0 / 3.0))
