"""The scene: its sections, and what must agree between them; its cells and files."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import PrivateAttr, model_validator

from roughmdr.ensemble import Source
from roughmdr.errors import Fault, OutOfRange, SceneError
from roughmdr.interaction.settings import reason_against_adhesion
from roughmdr.scene.asked import Asked, path_to
from roughmdr.scene.content import Sections
from roughmdr.scene.lateral import displacements
from roughmdr.scene.path import FlatPath
from roughmdr.scene.sections import Accuracy
from roughmdr.scene.separation import CLEAR, end_in_words
from roughmdr.scene.sweep import Axis
from roughmdr.schema.faults import mismatch
from roughmdr.schema.units import format_quantity, millipascals
from roughmdr.schema.wording import html_listing, listing, printable, short_repr
from roughmdr.stages import STAGES
from roughmdr.variables import CONTROLS, DEFAULT_VARIABLES, OUTPUT_VARIABLES, PRELOADS

_SOFTEST = 1.0
"""Effective modulus [Pa] below which no solid is known: the softest gels have some 10 Pa."""


class Scene(Sections):
    """A whole scene. ``roughmdr.scene.read`` makes one from a file or a dictionary."""

    _table: dict[str, Any] = PrivateAttr(default_factory=dict)
    _file: Path | None = PrivateAttr(default=None)
    _cells: "tuple[Scene, ...]" = PrivateAttr(default=())
    _locate: Callable[[Fault], Fault] | None = PrivateAttr(default=None)

    @classmethod
    def of(
        cls,
        table: dict[str, Any],
        file: Path | None,
        validated: dict[str, Any] | None = None,
        cells: "tuple[Scene, ...]" = (),
    ) -> "Scene":
        """Validate a table, read from ``file`` unless that is None; pydantic's ValidationError if it is no scene.

        ``validated`` are sections that need no validation any more, ``cells`` the scenes that its sweep makes of it.
        """
        scene = cls.model_validate(table | (validated or {}))
        scene._table, scene._file, scene._cells = table, file, cells
        return scene

    def __repr__(self) -> str:
        return listing(self._lines())

    def _repr_html_(self) -> str:
        return html_listing(self._lines())

    def _lines(self) -> Iterator[tuple[str, str]]:
        """Yield the scene in a few lines."""
        yield "scene", printable(self.title)
        yield "asperities", asperities_in_words(self.asperities)
        yield "material", f"effective modulus {format_quantity(self.effective_modulus, 'Pa')}"
        work = format_quantity(self.work, "J/m^2")
        yield "adhesion", "none" if self.adhesion is None else f"{self.adhesion.model}, work {work}"
        if self.interaction is not None:
            yield "interaction", self.interaction.model
        yield "path", path_in_words(self.path)
        for axis in self.sweep.axes:
            yield "sweep", f"{axis.key} {axis_in_words(axis)}"
        cells, realizations = len(self.cells), self.batch.realizations
        of_cells = f"{cells} cells x " if cells > 1 else ""
        yield "runs", f"{of_cells}{realizations} realisation{'s' * (realizations > 1)}, seed {self.seed}"

    def located(self, error: SceneError, cell: str = "") -> SceneError:
        """Return an error that was found after validation with the places of its faults, and the swept values."""
        where = f" (where {cell})" if cell else ""
        faults = [fault._replace(message=f"{fault.message}{where}") for fault in error.faults]
        return SceneError.of([self._locate(fault) if self._locate else fault for fault in faults]) if faults else error

    @property
    def cells(self) -> "tuple[Scene, ...]":
        """Scenes of the sweep's cells, the last swept key fastest; the scene itself if it has no sweep."""
        return self._cells or (self,)

    @model_validator(mode="before")
    @classmethod
    def _usual_variables(cls, table: Any) -> Any:
        output = table.get("output", {})
        if not isinstance(output, dict) or "variables" in output:
            return table
        usual = next(filter(None, (stage.usual_variables(table) for stage in reversed(STAGES))), None)
        return table if usual is None else {**table, "output": {**output, "variables": usual}}

    @model_validator(mode="before")
    @classmethod
    def _for_what_is_asked(cls, table: Any) -> Any:
        """Add a path to the place where a quantity is asked for, and the variables that it takes."""
        accuracy = table.get("accuracy")
        of = accuracy.get("of") if isinstance(accuracy, dict) else None
        if not isinstance(of, dict):
            return table
        output = table.get("output", {})
        names = output.get("variables", [*DEFAULT_VARIABLES]) if isinstance(output, dict) else None
        if isinstance(names, list):
            asked = [name for name in (*of, "force", "stiffness") if name in OUTPUT_VARIABLES]
            table = {**table, "output": {**output, "variables": [*names, *asked]}}
        return table if "path" in table else {**table, "path": path_to(of)}

    @model_validator(mode="after")
    def _sections_agree(self) -> "Scene":
        if self.counter is not None and self.material.effective_modulus is not None:
            raise mismatch("counter", "does not go with material.effective_modulus, which holds both bodies already")
        try:
            _ = self.effective_modulus
        except OutOfRange as error:
            raise mismatch("material.modulus", str(error)) from None
        asperities, estimator, realizations = self.asperities, self.batch.estimator, self.batch.realizations
        if not asperities.is_random and realizations > 1:
            message = f"must be 1 with source {asperities.source!r}: nothing in it is random"
            raise mismatch("batch.realizations", message)
        coupling = self.interaction
        if coupling is not None and (reason := reason_against_adhesion(coupling, self.adhesion_model)):
            raise mismatch("interaction", reason)
        self._check_stages()
        if self.material.hardness is not None and self.unlike:
            raise mismatch("material.hardness", f"tells where elastic contacts under a flat yield, not {self.unlike}")
        if estimator != "sampled" and (reason := self.reason_against(estimator)):
            raise mismatch("batch.estimator", f"cannot be {estimator!r}: {reason}")
        if self.accuracy is not None:
            self._check_accuracy(self.accuracy)
        if self.path.area_key and asperities.is_random and asperities.nominal_area is None:
            raise mismatch(self.path.area_key, "needs a nominal area: asperities.patch")
        if estimator == "expected" and realizations > 1:
            raise mismatch("batch.realizations", "must be 1 with estimator 'expected': there is only one expected law")
        if not asperities.is_random:
            return self
        if fault := self.path.sigma_fault(asperities.sigma):
            raise mismatch(f"path.{self.path.control}", fault)
        exponent = asperities.min_exponent
        if self.work > 0.0 and not exponent > 0.5:
            key = "exponent" if asperities.shared_profile is None else "terms"
            raise mismatch(f"asperities.{key}", f"{exponent:g} is too low; with adhesion it must be above 0.5")
        return self

    def _check_stages(self) -> None:
        given = [(stage, getattr(self, stage.key)) for stage in reversed(STAGES)]
        if len(alone := [key for stage, section in given if (key := stage.alone(self, section))]) > 1:
            raise mismatch(alone[0], f"does not go with {alone[1]}: each is of the elastic law under a flat")
        for stage, section in given:
            if section is None:
                stage.check_without(self)
            else:
                section.check(self)

    def _check_accuracy(self, accuracy: Accuracy) -> None:
        if accuracy.of is not None:
            self._check_asked(accuracy.of)
        elif not self.asperities.is_random:
            raise mismatch("accuracy", f"does not go with source {self.asperities.source!r}: nothing in it is random")
        if "estimator" in self.batch.model_fields_set:
            raise mismatch("batch.estimator", "is chosen by accuracy.method if there is an [accuracy]")
        if self.batch.realizations > accuracy.max_realizations:
            message = f"must be at most accuracy.max_realizations, {accuracy.max_realizations}"
            raise mismatch("batch.realizations", message)
        if accuracy.method != "auto" and (reason := self.reason_against(accuracy.method)):
            raise mismatch("accuracy.method", f"cannot be {accuracy.method!r}: {reason}")

    def _check_asked(self, of: Asked) -> None:
        path = self.path
        if self.unlike:
            raise mismatch("accuracy.of", f"asks for the elastic law under a flat, not {self.unlike}")
        leads = path.control == of.given and path.lateral is None
        sigma = self.asperities.sigma if path.uses_sigma or of.in_sigma else 0.0
        given = [value for value in path.given(sigma) if value is not None]
        if reason := of.reason_against(given, sigma) if leads and given else f"must control the {of.given}":
            raise mismatch("path", f"{reason}, where accuracy.of asks for its quantity; or leave it out")

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings of quantities that are possible but hardly meant: pressures in millipascals, solids like air."""
        told = tuple(f"{key} = {short_repr(value)}: {doubt}" for key, value, doubt in _millipascals(self._table))
        if not told and self.effective_modulus < _SOFTEST:
            soft = format_quantity(self.effective_modulus, "Pa")
            told = (f"effective modulus {soft}: no solid is so soft, gels have some 10 Pa; is its unit right?",)
        return told

    @property
    def without_grid(self) -> "Scene":
        """The scene with steps marked that interaction.beyond would have computed on a grid, which takes long."""
        if self.interaction is None or self.interaction.beyond == "flag":
            return self
        return self.model_copy(update={"interaction": self.interaction.model_copy(update={"beyond": "flag"})})

    @property
    def file(self) -> Path | None:
        """File that the scene was read from, None if from none."""
        return self._file

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Files that a run of the scene reads, its own included."""
        own = () if self._file is None else (self._file,)
        return (*own, *{file for cell in self.cells for file in cell.asperities.inputs})

    @property
    def toml(self) -> str:
        """The scene as it was given, in TOML."""
        return tomli_w.dumps(_without_none(self._table))


def _millipascals(table: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, str, str]]:
    """Yield key, value and doubt of each quantity of a table that is given in millipascals."""
    for key, entry in table.items():
        if isinstance(entry, dict):
            yield from _millipascals(entry, f"{prefix}{key}.")
        for value in entry if isinstance(entry, list) else [entry]:
            if doubt := millipascals(value):
                yield f"{prefix}{key}", value, doubt


def _without_none(table: dict[str, Any]) -> dict[str, Any]:
    return {
        key: _without_none(value) if isinstance(value, dict) else value
        for key, value in table.items()
        if value is not None
    }


def asperities_in_words(section: Source) -> str:
    """Return how many there are, their shape and source, or the files that they are read from."""
    if section.is_random:
        lattice = f", {section.lattice_in_words}" if section.lattice_in_words else ""
        return f"{section.expected_count:.10g} of shape {section.shape_name}, source {section.source}{lattice}"
    return f"source {section.source}: {', '.join(printable(str(file)) for file in section.inputs)}"


def path_in_words(path: FlatPath) -> str:
    """Return the ends of a path, and its steps."""
    given = getattr(path, path.key)
    if path.lateral is not None:
        held = f"{path.key} {end_in_words(given, CONTROLS[path.key])}"
        steps = f"lateral in {displacements(path.lateral).size} steps at {held}"
    elif isinstance(given, list):
        steps = f"{path.key} in {len(given)} steps"
    elif path.to_preload:
        steps = f"{path.key} {format_quantity(given, PRELOADS[path.key][1])} in {path.steps} steps"
    else:
        start = CLEAR if path.starts_clear else end_in_words(given.start, CONTROLS[path.key])
        steps = f"{path.key} from {start} to {end_in_words(given.stop, CONTROLS[path.key])} in {given.steps} steps"
    return f"{steps}{f', held for {path.hold}' if path.hold else ''}{', and back' if path.unload else ''}"


def axis_in_words(axis: Axis) -> str:
    """Return the range of the values of a swept key, or its names."""
    if axis.values.dtype.kind == "U":
        return ", ".join(map(str, axis.values))
    low, high = float(axis.values.min()), float(axis.values.max())
    return f"{format_quantity(low, axis.unit, to=high)} ({axis.values.size} values)"
