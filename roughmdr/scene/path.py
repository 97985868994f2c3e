"""[path]: the separations of the rigid flat, or what the machine does that moves it."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from pydantic import Discriminator, Field, StrictBool, Tag, model_validator

from roughmdr.errors import SceneError
from roughmdr.loading.machine import PRELOAD, STEPS, STIFFNESS, Preload, travel
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.lateral import Lateral, check_held, check_single_values, kind_of
from roughmdr.scene.separation import CLEAR, Separation, SeparationReader, Target
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import Quantity, WholeNumber
from roughmdr.schema.section import Section
from roughmdr.variables import CONTROLS, DEFAULT_STEPS, PRELOADS, TRAVEL

_START = SeparationReader(clear=True, other=f', or "{CLEAR}"')
_STOP = SeparationReader(other=', or a target such as { contact_fraction = 0.02 } or { pressure = "1 MPa" }')
_PER_AREA = ("pressure", "preload_pressure", "preload_contact_fraction")
_Separation = Annotated[Separation, SeparationReader(example='"-2 sigma"')]
_SeparationOrTarget = Annotated[
    Annotated[Target, Tag("target")] | Annotated[Separation, _STOP, Tag("distance")],
    Discriminator(lambda value: "target" if isinstance(value, dict | Target) else "distance"),
    Field(examples=['"0 sigma"']),
]
_Force = Annotated[float, Quantity("N", example='"1 mN"')]
_Pressure = Annotated[float, Quantity("Pa", example='"1 MPa"')]


class Range(Section):
    """``steps`` separations from ``start`` to ``stop``, both included; ``start`` is None for "clear"."""

    start: Annotated[Separation | None, _START] = None
    """First separation, or position of the spring; "clear": where nothing touches. Default: "clear"."""
    stop: _SeparationOrTarget
    """Where loading ends: a separation, or { contact_fraction = ... } or { pressure = ... }."""
    steps: Annotated[int, STEPS]
    """Number of steps, both ends included."""


class RemoteRange(Range):
    """``steps`` positions of the far end of the machine's spring from ``start`` to ``stop``, both included."""

    stop: _Separation
    """Where loading ends."""


class ForceRange(Section):
    """``steps`` loads from ``start`` to ``stop``, both included."""

    start: _Force = 0.0
    """First load."""
    stop: _Force
    """Last load."""
    steps: Annotated[int, STEPS]
    """Number of steps, both ends included."""


class PressureRange(ForceRange):
    """``steps`` loads over the nominal area from ``start`` to ``stop``, both included."""

    start: _Pressure = 0.0
    stop: _Pressure


_Range = TypeVar("_Range")
_Value = TypeVar("_Value")
_NEITHER = "must be a table with start, stop and steps, or a list"
_RangeOrList = Annotated[
    Annotated[_Range, Tag("range")] | Annotated[list[_Value], Field(min_length=1), Tag("list")],
    Discriminator(kind_of, custom_error_type="neither", custom_error_message=_NEITHER),
]
_RangeListOrHeld = Annotated[
    Annotated[_Range, Tag("range")]
    | Annotated[list[_Value], Field(min_length=1), Tag("list")]
    | Annotated[_Value, Tag("held")],
    Discriminator(
        lambda value: "held" if isinstance(value, float | int | str | Separation) else kind_of(value),
        custom_error_type="neither",
        custom_error_message=_NEITHER,
    ),
]


class FlatPath(Section):
    """[path]: a range or a list of separations, or of what a machine controls in place of them.

    With ``lateral`` the flat moves sideways, and one separation, force or pressure is held.

    A machine presses with a ``force`` or a ``pressure``, a dead load, or moves the far end of a spring of
    ``machine_stiffness``, ``remote``. A preload is loaded to in ``steps`` steps, by the flat itself or through that
    spring. ``unload`` appends the steps in reverse, after ``hold`` more at the last.
    """

    examples: ClassVar[Mapping[str, str]] = {"separation": '{ start = "4 sigma", stop = "0 sigma", steps = 200 }'}

    separation: _RangeListOrHeld[Range, _Separation] | None = None
    """Separations of the flat from the datum plane: a table of start, stop and steps, or a list."""
    remote: _RangeOrList[RemoteRange, _Separation] | None = None
    """Positions of the far end of the machine's spring: a table of start, stop and steps, or a list."""
    force: _RangeListOrHeld[ForceRange, _Force] | None = None
    """Dead loads in place of separations: a table of start, stop and steps, or a list."""
    pressure: _RangeListOrHeld[PressureRange, _Pressure] | None = None
    """Dead loads over the nominal area: a table of start, stop and steps, or a list."""
    lateral: Lateral | None = None
    """Lateral displacements, while a single separation, force or pressure is held."""
    machine_stiffness: Annotated[float, STIFFNESS] | None = None
    """Stiffness of the spring, with remote or a preload."""
    preload: Annotated[float, PRELOAD["preload"]] | None = None
    """Load until this force; with unload = true pull it off then."""
    preload_pressure: Annotated[float, PRELOAD["preload_pressure"]] | None = None
    """Load until this force over the nominal area."""
    preload_contact_fraction: Annotated[float, PRELOAD["preload_contact_fraction"]] | None = None
    """Load until this contact area over the nominal area."""
    steps: Annotated[int, STEPS] = DEFAULT_STEPS
    """Number of steps of the loading to a preload."""
    hold: Annotated[int, WholeNumber(0, 1_000_000)] = 0
    """Steps more at the last one, before unload."""
    unload: StrictBool = False
    """Whether the steps follow in reverse."""

    @model_validator(mode="before")
    @classmethod
    def _held(cls, table: Any) -> Any:
        if isinstance(table, dict) and table.keys() <= cls.model_fields.keys():  # else a key is misspelt
            check_single_values(table, _NEITHER)
        return table

    @model_validator(mode="after")
    def _one_control(self) -> "FlatPath":
        given = [name for name in (*CONTROLS, *PRELOADS) if getattr(self, name) is not None]
        if not given:
            raise mismatch("path.separation", "is missing")
        if len(given) > 1:
            raise mismatch(f"path.{given[1]}", f"does not go with path.{given[0]}: a path controls one of the two")
        if self.lateral is not None:
            check_held(given[0], getattr(self, given[0]))
        if self.machine_stiffness is None and given == ["remote"]:
            raise mismatch("path.machine_stiffness", "is missing")
        if self.machine_stiffness is not None and given != ["remote"] and given[0] not in PRELOADS:
            raise mismatch("path.machine_stiffness", "goes with path.remote, the far end of the spring, or a preload")
        if "steps" in self.model_fields_set and given[0] not in PRELOADS:
            raise mismatch("path.steps", f"goes with a preload only; path.{given[0]} has its own")
        return self

    @property
    def to_preload(self) -> Preload | None:
        """The quantity, with its value, that loading goes on to; None where the path is given otherwise."""
        return Preload(PRELOADS[self.key][0], getattr(self, self.key)) if self.key in PRELOADS else None

    @property
    def control(self) -> str:
        """The quantity that is controlled."""
        return self.key if self.key in CONTROLS else TRAVEL.name

    @property
    def key(self) -> str:
        """The key that the path is given by."""
        return next(name for name in (*CONTROLS, *PRELOADS) if getattr(self, name) is not None)

    @property
    def area_key(self) -> str:
        """The dotted key of what is per nominal area; empty where there is none."""
        return f"path.{self.key}" if self.key in _PER_AREA else ""

    @property
    def _steps(self) -> Range | ForceRange | list[Any]:
        steps = getattr(self, self.control)
        return steps if isinstance(steps, Range | ForceRange | list) else [steps]

    @property
    def _ends(self) -> list[Separation | Target | float | None]:
        if self.to_preload:
            return [0.0, 1.0]
        steps = self._steps
        return [*steps] if isinstance(steps, list) else [steps.start, steps.stop]

    @property
    def starts_clear(self) -> bool:
        """Whether it starts where no asperity touches, or attracts."""
        return self._ends[0] is None

    @property
    def target(self) -> Target | None:
        """The target that is reached where it stops; None where it stops at a separation."""
        stop = self._ends[-1]
        return stop if isinstance(stop, Target) else None

    @property
    def uses_sigma(self) -> bool:
        """Whether a separation is given in standard deviations of the heights."""
        return any(isinstance(end, Separation) and end.in_sigma for end in self._ends)

    def sigma_fault(self, sigma: float) -> str:
        """Return why separations cannot be given in sigma [m]; empty if they can, or are not."""
        if not self.uses_sigma or 0.0 < sigma < np.inf:
            return ""
        return f"cannot be given in sigma: the heights' standard deviation is {sigma:g} m"

    def given(self, sigma: float) -> list[float | None]:
        """Return the steps that are given, or both ends of the range, in SI; None for "clear" and a target.

        ``sigma`` [m] is the heights' standard deviation; SceneError if the path is given in sigma and there is none.
        """
        if fault := self.sigma_fault(sigma):
            raise SceneError(f"path.{self.control}: {fault}")
        return [
            end.metres(sigma) if isinstance(end, Separation) else (end if isinstance(end, float) else None)
            for end in self._ends
        ]

    def values(self, sigma: float, clear: float | None = None, reached: float | None = None) -> Floats:
        """Return the controlled quantity at each step in SI, without hold and unloading.

        sigma [m] is the heights' standard deviation.
        ``clear`` and ``reached`` [m] are the start and the stop of a range where it does not give them as separations.
        SceneError if the path is given in sigma and there is none, or if it is not finite.
        """
        if self.to_preload:
            return travel(self.steps)
        given, steps = self.given(sigma), self._steps
        if isinstance(steps, list):
            path = np.array(given, dtype=np.float64)
        else:
            pairs = zip(given, (clear, reached), strict=True)
            ends = np.array([end if found is None else found for end, found in pairs], dtype=np.float64)
            start, stop = ends.tolist()
            finite = math.isfinite(stop - start)
            path = np.linspace(start, stop, steps.steps) if finite else np.array([np.inf])
        if not np.isfinite(path).all():
            raise SceneError(f"path.{self.control}: reaches beyond the largest float")
        return path

    def whole(self, values: Floats) -> Floats:
        """Return the values of all steps, hold and unloading included."""
        held = np.full(self.hold, values[-1])
        return np.concatenate([values, held, values[::-1]] if self.unload else [values, held])
