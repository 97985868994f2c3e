"""The document that ``run``, ``plan`` and ``info`` print with --json: its keys, declared here and nowhere else.

One JSON object on standard output, whatever happens. Numbers are in SI; null stands for what is not known, does not
apply or is not finite. All keys of a table are always there. ``FORMAT`` rises when a key changes its meaning or goes;
keys may be added without that.
"""

import json
import math
from collections.abc import Iterable, Mapping
from typing import Any, TypedDict, cast

import numpy as np

from roughmdr.errors import SceneError
from roughmdr.schema.wording import gathered

FORMAT = 1


class FaultTable(TypedDict):
    """One thing that went wrong; texts are empty where they do not apply."""

    location: str  # file and line, or "--set"
    key: str  # of the scene, dotted
    value: str  # as it was given
    message: str


class PullOffTable(TypedDict):
    """The pull-off of a cell: means over the realisations that have one. A tension is below 0."""

    count: int  # realisations that have one; the others end in contact
    force: float  # the largest tension [N]
    standard_error: float  # of the force [N]; null for a single realisation
    of_mean: float  # of the mean force [N]
    separation: float  # [m]
    pressure: float  # [Pa]
    contacts: float
    contact_fraction: float


class AccuracyTable(TypedDict):
    """How a cell was computed where the run chose that."""

    reached: float  # error of the mean force over its largest value
    method: str  # "sampled", "stratified" or "expected"


class CellTable(TypedDict):
    """One cell of a sweep; the only one without a sweep. Errors are the largest of its realisations."""

    swept: dict[str, float | str]  # swept key, dots as underscores: value in SI, or name
    realizations: int
    status: dict[str, int]  # "done", "failed", "not_run": number of runs, or 1 where only statistics are kept
    remark: str  # why a run failed, or is doubtful
    pull_off: PullOffTable | None
    model_error: float
    parts: dict[str, float]  # of the model error, by their names in results
    at_given_pressure: dict[str, float]  # largest model errors of other variables there; none if contacts yield
    largest_contact_fraction: float
    effective_contacts: float  # that carry the load at closest approach
    sampling_error: float  # scatter of the force there from patch to patch
    area_sampling_error: float  # scatter of the contact area at the same force
    trusted_separation: float  # [m]
    yielding: dict[str, float]  # diagnostics of contacts above the hardness, by their names in results
    numerical_error: float
    run_time: float  # [s], of all realisations
    accuracy: AccuracyTable | None


class CoordinateTable(TypedDict):
    """Values along a swept dimension."""

    units: str  # empty for names
    values: list[float] | list[str]


class ResultTable(TypedDict):
    """A result, as ``run`` wrote it and ``info`` finds it."""

    title: str
    file: str | None
    file_size: int | None  # bytes
    sizes: dict[str, int]  # swept dimensions, in their order
    coordinates: dict[str, CoordinateTable]  # swept keys; with mode "zip" all over the dimension cell
    realizations: int  # of a cell, at most
    steps: int
    control: str  # the quantity that the path controls
    variables: list[str]
    cells: list[CellTable]
    path: list[str]  # which separations "clear" and targets came to
    lattice: list[str]  # that the asperities fill, with its pitch and patch
    map: list[str]
    trust: dict[str, str | None]  # by the names of ``_TRUST``: in words
    sample: str | None  # how far one stands for others
    advice: str | None
    reference: str | None  # other sections that tell something of a result have a key of their own
    accuracy: str | None
    failed: str | None
    warnings: list[str]
    left_out: list[str]
    run_time: float  # [s], of all realisations
    elapsed: float | None  # [s], of the command that ran it
    seed: int
    versions: dict[str, str]  # "source", "packages", and "numbers": all that decides them
    history: list[str]
    scene: str  # TOML


class ForeseenTable(TypedDict):
    """A cell as a few asperities foretell it."""

    swept: dict[str, float | str]
    start: float  # separations [m]
    closest: float
    end: float
    pressure: float  # at closest approach [Pa]
    tension: float  # the largest [Pa]
    yielding: dict[str, float]  # diagnostics of contacts above the hardness, by their names in results
    tabor_number: float
    adhesion: str
    model_error: float
    parts: dict[str, float]
    at_given_pressure: dict[str, float]
    largest_contact_fraction: float
    effective_contacts: float  # that carry the load at closest approach
    sampling_error: float  # scatter of the force there from patch to patch
    area_sampling_error: float  # scatter of the contact area at the same force
    contact_fraction_at_pull_off: float
    trusted_separation: float  # [m]


class PlanTable(TypedDict):
    """A plan: what a run would do."""

    implausible: list[str]  # what of sizes, units and pressures cannot be meant
    title: str
    sizes: dict[str, int]
    coordinates: dict[str, CoordinateTable]
    realizations: int  # of a cell, in the first round
    steps: int
    control: str
    variables: list[str]
    keep: str
    runs: int
    tasks: int
    workers: int
    time: dict[str, float]  # "total", "longest" (with the finest grids of a reference), "start_up" [s]
    memory: dict[str, float]  # "total", "resident", "finest" (grids of a reference), "available" [bytes]
    file_size: float  # bytes
    accuracy: dict[str, Any] | None  # "relative" or "of", "max_realizations", "method"
    choice: list[str]  # how a quantity is computed that is asked for, and what other methods would give
    cells: list[ForeseenTable]  # those that were tried
    path: list[str]
    lattice: list[str]  # that the asperities fill, with its pitch and patch
    map: list[str]
    trust: dict[str, str | None]
    sample: str | None  # how far one stands for others
    advice: str | None
    warnings: list[str]
    failures: list[str]  # which of the cells that were tried cannot be computed, and why
    left_out: list[str]


class PartCellTable(TypedDict):
    """A cell of a batch that is not over."""

    swept: dict[str, float | str]
    done: int  # realisations that are kept
    failed: int
    total: int | None  # null with [accuracy]


class LawTable(TypedDict):
    """The mean law so far of a cell, at a few steps of its path."""

    swept: dict[str, float | str]
    variable: str
    runs: int
    control: str  # name of the values, such as separation
    values: list[float]  # SI
    mean: list[float]  # SI, likewise the error
    standard_error: list[float]  # null where it is not known


class PartsTable(TypedDict):
    """A folder OUT.nc.parts: what a batch has done that is at work, or was interrupted."""

    title: str | None
    folder: str
    output: str
    part: str | None  # such as 7/100; null where all of the batch is computed here
    done: int  # runs that are kept
    total: int | None  # null where it is not known, as with [accuracy]
    failed: int  # runs, which are repeated
    remark: str | None  # why the first of them failed
    cells: list[PartCellTable]  # none where other versions began the batch
    law: LawTable | None  # null without runs, or where other versions began the batch
    began: str | None  # ISO 8601, UTC
    last: str | None  # when something was kept last
    holder: dict[str, int | str] | None  # "process", "host", "since" of the run at work; null for none
    holder_known: bool  # false where it is on another machine
    continued_by: str  # command
    versions: str | None
    scene: str | None  # TOML


class Document(TypedDict):
    """The whole document. Where ``exit_status`` is not 0, ``faults`` says why."""

    format: int
    command: str
    exit_status: int
    faults: list[FaultTable]
    warnings: list[str]  # of the command; those of a result or a plan are in it
    result: ResultTable | None
    plan: PlanTable | None
    parts: PartsTable | None


def document(
    command: str,
    exit_status: int = 0,
    *,
    faults: Iterable[FaultTable] = (),
    warnings: Iterable[str] = (),
    **told: ResultTable | PlanTable | PartsTable | None,
) -> Document:
    """Return a document about what was ``told``: result, plan or parts, or none of them."""
    made = {"format": FORMAT, "command": command, "exit_status": exit_status}
    made |= {"faults": list(faults), "warnings": list(warnings), "result": None, "plan": None, "parts": None}
    return cast("Document", made | told)


def fault(message: str) -> FaultTable:
    """Return a fault of no key."""
    return FaultTable(location="", key="", value="", message=message)


def faults_of(error: BaseException, message: str = "") -> list[FaultTable]:
    """Return the faults of an error: those of a scene one by one, else its message, or the one given."""
    listed = error.faults if isinstance(error, SceneError) else ()
    tables = [
        FaultTable(location=each.location, key=each.key, value=each.value, message=each.message) for each in listed
    ]
    return tables or [fault(message or str(error))]


def to_json(made: Document) -> str:
    """Return the text of a document: of plain letters only, which no terminal acts on."""
    return json.dumps(_plain(made), allow_nan=False, indent=2)


def _plain(value: Any) -> Any:
    """Convert NumPy's numbers to Python's, and what is not finite to None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def paragraphs(lines: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return lines with names by their names, spaces as underscores; one without a name continues the one before."""
    told = gathered(lines)
    return {
        name.replace(" ", "_"): "; ".join([first, *(each.lstrip("; ") for each in more)])
        for name, (first, *more) in told.items()
    }


_TRUST = ("contact", "model_error", "trust", "hardness", "yielding")


def trust_table(lines: Iterable[tuple[str, str]]) -> dict[str, str | None]:
    """Return the lines of ``trust_lines`` by their names; None for those that are not told."""
    told = paragraphs(lines)
    return {name: told.get(name) for name in _TRUST}
