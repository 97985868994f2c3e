"""[viscoelastic]: how the modulus relaxes, and how fast the flat moves."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, model_validator

from roughmdr.errors import Fault, SceneError
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.section import Section
from roughmdr.schema.units import format_quantity
from roughmdr.stages.stage import Contacts, Given, Law, Stage
from roughmdr.variables import DEFAULT_VARIABLES, TIME

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.loading.lateral import Path
    from roughmdr.numerics.arguments import Floats
    from roughmdr.stages.viscoelasticity.motion import FlatMotion

_Speed = Annotated[float, Quantity("m/s", above=0.0)]
_NOT_COMPUTED = ("stiffness", "energy", "dissipated_energy", "machine_dissipated_energy", "tangential_stiffness")
"""Variables that a viscoelastic law does not have."""


class RelaxationTerm(Section):
    """A term of the Prony series: the share of the instantaneous modulus that is lost, and its relaxation time."""

    time: Annotated[float, Quantity("s", above=0.0)]
    """Relaxation time."""
    share: Annotated[float, Quantity("1", at_least=0.0, at_most=1.0)]
    """Share of the instantaneous modulus that is lost; all together at most 1."""


class Viscoelastic(Stage):
    """[viscoelastic]: the modulus of the scene is the instantaneous one, and relaxes by 1 - exp(-t/time) of each share.

    ``dwell`` is spent at the lowest separation.
    """

    key = "viscoelastic"
    about = "Relaxation of the modulus while the flat moves in time; the bodies are elastic without it"
    examples: ClassVar[Mapping[str, str]] = {
        "relaxation": '[{ time = "10 ms", share = 0.5 }]',
        "speed": '"1 um/s"',
    }
    small_scene: ClassVar[Mapping[str, Any]] = {
        "viscoelastic": {"relaxation": [{"time": "1 s", "share": 0.5}], "speed": "1 um/s"},
        "path": {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 6}, "unload": True},
        "output": {"variables": ["force", "contact_area"]},
    }
    unlike = "bodies that relax"
    papers: ClassVar[Mapping[str, str]] = {"Lee1960": "viscoelastic", "Ting1966": "viscoelastic"}
    more_separations = 5000  # points of the integral over the time, where curves have kinks

    relaxation: Annotated[list[RelaxationTerm], Field(min_length=1)]
    """Terms of a Prony series: each takes share (1 - exp(-t/time)) of the instantaneous modulus away."""
    speed: _Speed
    """Speed of the flat while loading."""
    retraction_speed: _Speed | None = None
    """Speed of the flat while it rises. Default: speed."""
    dwell: Annotated[float, Quantity("s", at_least=0.0)] = 0.0
    """Time at the lowest separation, spread over path.hold and the repeated turning point."""

    @model_validator(mode="after")
    def _shares(self) -> "Viscoelastic":
        if (total := math.fsum(term.share for term in self.relaxation)) > 1.0:
            raise EntryError("relaxation", None, f"has shares of {total:g} together; they must be at most 1")
        return self

    @classmethod
    def usual_variables(cls, table: Mapping[str, Any]) -> list[str] | None:
        if table.get(cls.key) is None:
            return None
        return [name for name in DEFAULT_VARIABLES if name not in _NOT_COMPUTED]

    def check(self, scene: Given) -> None:
        """Raise a mismatch with adhesion, asperities that feel each other, other paths, and variables that it lacks."""
        others = {"adhesion": scene.work > 0.0, "interaction": scene.interaction is not None}
        others |= {stage.key: stage.on_grid for stage in scene.stages}
        for name, other in others.items():
            if other:
                raise mismatch(
                    name, "does not go with [viscoelastic]: its asperities are independent and do not adhere"
                )
        if scene.path.control != "separation":
            raise mismatch(f"path.{scene.path.key}", "does not go with [viscoelastic], which needs path.separation")
        if unknown := [name for name in scene.output.variables if name in _NOT_COMPUTED]:
            raise mismatch("output.variables", f"{', '.join(unknown)} cannot be computed with [viscoelastic]")

    def check_path(self, values: "Floats") -> None:
        """Raise SceneError unless separations [m] fall, stay at the lowest and rise, in a finite time."""
        _check_order(values)
        if self.dwell > 0.0 and np.argmin(values) == values.size - 1:
            message = "has no step to end at: path.hold adds steps at the lowest separation, path.unload a retraction"
            raise _fault("viscoelastic.dwell", message, format_quantity(self.dwell, "s"))
        motion = self.motion
        with np.errstate(over="ignore", invalid="ignore"):
            if not np.isfinite([*motion.time(values), motion.retraction_speed / motion.speed]).all():
                raise _fault("viscoelastic", "has speeds by which the path takes longer than a float holds")

    def coordinates(self, values: "Floats") -> "dict[str, Floats]":
        return {TIME.name: self.motion.time(values)}

    @classmethod
    def left_out(cls, scene: Given, section: "Viscoelastic | None") -> Iterator[str]:
        if section is None and scene.work == 0.0:
            if not scene.unlike:
                yield "hysteresis: without adhesion a contact has no memory"
            yield "time: elastic bodies do not relax; the scene has no [viscoelastic]"

    @property
    def motion(self) -> "FlatMotion":
        """The motion of the flat."""
        from roughmdr.stages.viscoelasticity.motion import FlatMotion

        back = self.speed if self.retraction_speed is None else self.retraction_speed
        return FlatMotion(self.speed, back, self.dwell)

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the viscoelastic law from the elastic one; SceneError where separations fall again after they rose."""
        from roughmdr.loading.path import LoadingPath
        from roughmdr.stages.viscoelasticity.law import Viscoelasticity, viscoelastic_law
        from roughmdr.stages.viscoelasticity.relaxation import Relaxation

        shares, times = (np.array([getattr(term, name) for term in self.relaxation]) for name in ("share", "time"))
        body = Viscoelasticity(Relaxation(shares, times), self.motion)

        def elastic(separation: "Floats", names: list[str]) -> "LoadSeparation":
            return contacts.law(LoadingPath.along(separation, unload=False, adhesive=False), names)

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            assert isinstance(path, LoadingPath)  # ``check`` makes sure
            _check_order(path.separation)
            clear = float(np.nextafter(contacts.highest(), np.inf))  # at first touch there is no contact yet
            area = contacts.nominal_area
            return viscoelastic_law(elastic, path.separation, names, body, clear=clear, nominal_area=area)

        return law


def _check_order(separation: "Floats") -> None:
    """Raise SceneError unless separations [m] fall, stay at the lowest and rise."""
    first, last = np.flatnonzero(separation == separation.min())[[0, -1]]
    step, change = np.arange(1, separation.size), np.diff(separation)
    wrong = step[np.where(step <= first, change >= 0.0, np.where(step <= last, change != 0.0, change <= 0.0))]
    if wrong.size:
        reached = format_quantity(float(separation[wrong[0]]), "m")
        message = "must fall to its lowest value and rise from there, once, with [viscoelastic]"
        raise _fault("path.separation", f"{message}; step {wrong[0]}, {reached}, is against that")


def _fault(key: str, message: str, value: str = "") -> SceneError:
    return SceneError.of([Fault(key, value, message)])
