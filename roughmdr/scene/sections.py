"""What a scene may ask for: its sections, their keys and defaults."""

import math
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import (
    BeforeValidator,
    Field,
    InstanceOf,
    PrivateAttr,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from roughmdr.ensemble import Asperities
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.scene.path import FlatPath
from roughmdr.scene.sweep import Sweep
from roughmdr.schema.arguments import check_number
from roughmdr.schema.material import check_one_body, effective_modulus
from roughmdr.schema.quantities import Quantity, Section, WholeNumber
from roughmdr.variables import CURVE_VARIABLES, DEFAULT_VARIABLES

_Modulus = Annotated[float, BeforeValidator(Quantity("Pa", above=0.0))]
_ERROR = 0.01  # of the largest force, by which "auto" may be off unless the scene says otherwise
_MOST = 1_000_000_000  # realisations
_UNSEEN = 0.01  # of the error that is asked for
_Poisson = Annotated[float, BeforeValidator(Quantity("1", above=-1.0, most=0.5))]


class Body(Section):
    """[counter]: an elastic body."""

    modulus: _Modulus
    poisson: _Poisson


class Material(Section):
    """[material]: effective_modulus alone, or modulus and poisson."""

    effective_modulus: _Modulus | None = None
    modulus: _Modulus | None = None
    poisson: _Poisson | None = None

    @model_validator(mode="after")
    def _one_way(self) -> "Material":
        check_one_body(self.effective_modulus, self.modulus, self.poisson)
        return self


class AdhesionSection(Section):
    """[adhesion]: work is the work of adhesion, not the surface energy of one side.

    The attraction's stress is ``strength``, or work over its ``range``; "auto" may be off by ``error``.
    """

    model: Literal["jkr", "dugdale", "auto"]
    work: Annotated[float, BeforeValidator(Quantity("J/m^2", least=0.0))]
    strength: Annotated[float, BeforeValidator(Quantity("Pa", above=0.0))] | None = None
    range: Annotated[float, BeforeValidator(Quantity("m", above=0.0))] | None = None
    error: Annotated[float, BeforeValidator(Quantity("1", above=0.0, most=1.0))] | None = None

    @model_validator(mode="after")
    def _goes_together(self) -> "AdhesionSection":
        if self.strength is not None and self.range is not None:
            raise RoughmdrError("takes strength or range, not both")
        if self.model != "jkr" and self.strength is None and self.range is None:
            raise RoughmdrError(f"model {self.model!r} needs strength, the stress of the attraction, or its range")
        if self.error is not None and self.model != "auto":
            raise RoughmdrError("takes error only with model 'auto'")
        if self.range is not None and self.work > 0.0:
            check_number("work over range", self.work / self.range, "Pa")
        return self

    @property
    def adhesion_model(self) -> Adhesion:
        """What is asked for."""
        strength = self.strength
        if self.range is not None and self.work > 0.0:
            strength = self.work / self.range
        error = 0.0 if self.model != "auto" else (_ERROR if self.error is None else self.error)
        return Adhesion(self.work, self.model, math.inf if strength is None else strength, error)


def _known_variable(value: object) -> object:
    if not isinstance(value, str) or value not in CURVE_VARIABLES:
        raise RoughmdrError(f"no such variable; there are {', '.join(CURVE_VARIABLES)}")
    return value


class Output(Section):
    """[output]: what the result holds."""

    variables: Annotated[list[Annotated[str, BeforeValidator(_known_variable)]], Field(min_length=1)] = Field(
        default=list(DEFAULT_VARIABLES)
    )
    keep: Literal["curves", "statistics"] = "curves"

    @field_validator("variables")
    @classmethod
    def _no_variable_twice(cls, value: list[str]) -> list[str]:
        return list(dict.fromkeys(value))


class Batch(Section):
    """[batch]: how many realisations, and how each is made.

    "sampled" draws asperities, "stratified" draws them evenly spread, "expected" integrates over their distribution.
    """

    estimator: Literal["sampled", "stratified", "expected"] = "sampled"
    realizations: Annotated[int, BeforeValidator(WholeNumber(1, _MOST))] = 1


class Accuracy(Section):
    """[accuracy]: realisations are added until the standard error of the mean force, over its largest value, is met.

    ``method`` "auto" takes the cheaper of evenly spread draws and the expected law, where that is right enough.
    """

    relative: Annotated[float, BeforeValidator(Quantity("1", above=0.0, most=1.0))]
    max_realizations: Annotated[int, BeforeValidator(WholeNumber(2, _MOST))] = 10_000
    method: Literal["auto", "sampled", "stratified", "expected"] = "auto"


def _misfit(key: str, message: str) -> PydanticCustomError:
    return PydanticCustomError("misfit", "{message}", {"key": key, "message": message})


def _one_line(value: object) -> str:
    if not isinstance(value, str) or not value.isprintable():
        raise RoughmdrError("must be a text on one line, of characters that can be printed")
    return value


class Scene(Section):
    """A whole scene. ``roughmdr.scene.read`` makes one from a file or a dictionary."""

    title: Annotated[str, BeforeValidator(_one_line)]
    seed: Annotated[int, BeforeValidator(WholeNumber(0, 2**63 - 1))] = 0
    material: Material
    counter: Body | None = None
    adhesion: AdhesionSection | None = None
    asperities: Asperities
    path: FlatPath
    output: Output = Output()
    batch: Batch = Batch()
    accuracy: Accuracy | None = None
    sweep: InstanceOf[Sweep] = Sweep()

    _table: dict[str, Any] = PrivateAttr(default_factory=dict)
    _file: FilePath | None = PrivateAttr(default=None)
    _cells: "tuple[Scene, ...]" = PrivateAttr(default=())

    @classmethod
    def of(
        cls,
        table: dict[str, Any],
        file: FilePath | None,
        ready: dict[str, Any] | None = None,
        cells: "tuple[Scene, ...]" = (),
    ) -> "Scene":
        """The scene of a table, which was read from ``file`` if from one; pydantic's ValidationError if it is none.

        ``ready`` are parts of it that are read already, ``cells`` what its sweep makes of it.
        """
        scene = cls.model_validate(table | (ready or {}))
        scene._table, scene._file, scene._cells = table, file, cells
        return scene

    @property
    def cells(self) -> "tuple[Scene, ...]":
        """The scenes without a sweep that this one stands for, the last swept key fastest; itself if it has none."""
        return self._cells or (self,)

    @model_validator(mode="after")
    def _parts_fit(self) -> "Scene":
        if self.counter is not None and self.material.effective_modulus is not None:
            raise _misfit("counter", "does not go with material.effective_modulus, which holds both bodies already")
        try:
            _ = self.effective_modulus
        except OutOfRange as error:
            raise _misfit("material.modulus", str(error)) from None
        if not self.asperities.drawn and self.batch.realizations > 1:
            source = self.asperities.source
            raise _misfit("batch.realizations", f"must be 1 with source {source!r}: nothing of it is drawn")
        if self.batch.estimator != "sampled" and (reason := self.asperities.unfit_for(self.batch.estimator)):
            raise _misfit("batch.estimator", f"cannot be {self.batch.estimator!r}: {reason}")
        self._accuracy_fits()
        if self.batch.estimator == "expected" and self.batch.realizations > 1:
            raise _misfit("batch.realizations", "must be 1 with estimator 'expected': there is only one expected law")
        if not self.asperities.drawn:
            return self
        sigma = self.asperities.sigma
        if self.path.uses_sigma and not 0.0 < sigma < math.inf:
            raise _misfit(
                "path.separation", f"cannot be given in sigma: the heights' standard deviation is {sigma:g} m"
            )
        exponent = self.asperities.least_exponent
        if self.work > 0.0 and not exponent > 0.5:
            key = "terms" if self.asperities.fixed is not None else "exponent"
            raise _misfit(
                f"asperities.{key}",
                f"can be as low as {exponent:g}; with adhesion it must be above 0.5",
            )
        return self

    def _accuracy_fits(self) -> None:
        if self.accuracy is None:
            return
        if not self.asperities.drawn:
            raise _misfit("accuracy", f"does not go with source {self.asperities.source!r}: nothing of it is drawn")
        if "estimator" in self.batch.model_fields_set:
            raise _misfit("batch.estimator", "is chosen by accuracy.method where there is an [accuracy]")
        if self.batch.realizations > self.accuracy.max_realizations:
            most = self.accuracy.max_realizations
            raise _misfit("batch.realizations", f"must be at most accuracy.max_realizations, {most}")
        method = self.accuracy.method
        if method != "auto" and (reason := self.asperities.unfit_for(method)):
            raise _misfit("accuracy.method", f"cannot be {method!r}: {reason}")

    @property
    def estimators(self) -> tuple[str, ...]:
        """How its realisations may be made: in one way, or with accuracy.method "auto" by draws or the expected law.

        Evenly spread draws come to an error sooner. Their number is rounded, which must not count beside it.
        """
        if self.accuracy is None:
            return (self.batch.estimator,)
        if self.accuracy.method != "auto":
            return (self.accuracy.method,)
        count = self.asperities.expected_count
        whole = abs(count - round(count)) <= _UNSEEN * self.accuracy.relative * count
        drawn = "stratified" if whole else "sampled"
        return (drawn,) if self.asperities.unfit_for("expected") else (drawn, "expected")

    @property
    def effective_modulus(self) -> float:
        """E* [Pa] (H 43)."""
        material = self.material
        if material.effective_modulus is not None:
            return material.effective_modulus
        if material.modulus is None or material.poisson is None:
            raise AssertionError("validated above")
        if self.counter is None:
            return effective_modulus(material.modulus, material.poisson)
        return effective_modulus(material.modulus, material.poisson, self.counter.modulus, self.counter.poisson)

    @property
    def work(self) -> float:
        """Work of adhesion [J/m^2]; 0 without adhesion."""
        return 0.0 if self.adhesion is None else self.adhesion.work

    @property
    def adhesion_model(self) -> Adhesion:
        """The law of adhesion that is asked for."""
        return Adhesion() if self.adhesion is None else self.adhesion.adhesion_model

    @property
    def file(self) -> FilePath | None:
        """The file that the scene was read from, if from one."""
        return self._file

    @property
    def inputs(self) -> tuple[FilePath, ...]:
        """The files that the scene is read from."""
        own = () if self._file is None else (self._file,)
        return (*own, *{file for cell in self.cells for file in cell.asperities.inputs})

    @property
    def toml(self) -> str:
        """The scene as it was asked for, in TOML."""
        return tomli_w.dumps(_without_none(self._table))


def _without_none(table: dict[str, Any]) -> dict[str, Any]:
    return {
        key: _without_none(value) if isinstance(value, dict) else value
        for key, value in table.items()
        if value is not None
    }
