"""Writes a result as a table for a finite-element code, or as quadrature nodes."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.errors import LimitWarning, RoughmdrError, StoreError, level_outside
from roughmdr.model_error.parts import PLASTIC
from roughmdr.report.export.formats import FORMATS, Format
from roughmdr.report.export.header import origin_lines, table_lines
from roughmdr.report.export.law import QUANTITIES, Law, Quantity, law_of
from roughmdr.report.export.part import columns_of, tangent_stiffness
from roughmdr.report.export.table import MOST_ERROR, Table, table_of
from roughmdr.report.export.text import Column, Document, text_of
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.given import given_result
from roughmdr.result.select import cell_of, select
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import with_options
from roughmdr.schema.units import DIMENSIONLESS, quantity as number_in_si
from roughmdr.schema.wording import short_repr, suggestion
from roughmdr.storage.files import replace_atomically
from roughmdr.storage.result_file import check_output
from roughmdr.variables import BRANCHES

if TYPE_CHECKING:
    import xarray as xr

_LEAST_ERROR = 1e-9
_MEMORY = {
    "loading": "contacts yield: this is the first loading, and branch 'unloading' the elastic law that follows it",
    "unloading": "contacts have yielded: this is the elastic law of faces that have borne its largest pressure",
}


@dataclass(frozen=True)
class Export:
    """Choices of an export: the format, the quantity and its error, the units, the branch and the cell."""

    to: str
    quantity: str = "pressure"
    units: str = ""
    branch: str = "loading"
    error: float = 1e-3
    distance: str | float = ""
    select: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _check("to", self.to, list(FORMATS))
        _check("quantity", self.quantity, [*QUANTITIES, "loss", "nodes"])
        _check("branch", self.branch, list(BRANCHES))
        if self.quantity == "loss" and self.branch != "loading":
            raise StoreError(f"branch is {self.branch!r}; a loss is that of a loading and the unloading behind it")
        if self.quantity == "loss" and self.error != Export.error:
            raise StoreError(f"error is {self.error!r}; a loss is a row for each loop, without lines between them")
        if not _LEAST_ERROR <= self.error <= MOST_ERROR:
            raise StoreError(f"error is {self.error!r}; it must be from {_LEAST_ERROR:g} to {MOST_ERROR:g}")
        if self.quantity not in self.format.quantities:
            able = [name for name, each in FORMATS.items() if self.quantity in each.quantities]
            said = f"{self.to} has no table of quantity {self.quantity!r}; {', '.join(able)} have"
            raise StoreError(f"{said}; {self.to} has {', '.join(self.format.quantities)}")

    @property
    def centres(self) -> float | None:
        """The distance [m] of two centres at zero overclosure, of formats over the distance; None of others."""
        if (self.distance == "") == self.format.of_distance:
            needed = "lammps needs that of two centres, or of one from a wall, at zero separation; others have none"
            raise StoreError(f"distance is {short_repr(self.distance)}; {needed}")
        try:
            return number_in_si(self.distance, "m") if self.format.of_distance else None
        except RoughmdrError as error:
            raise StoreError(f"distance is {short_repr(self.distance)}: {error}") from None

    @property
    def format(self) -> Format:
        """The format of the file."""
        return FORMATS[self.to]


@with_options(Export)
def export(result: "str | Path | xr.Dataset", out: str | Path, *, to: str, fresh: bool = False, **options: Any) -> None:
    """Write the mean law of a result, or its expected law, as a table for a finite-element code, or a function in C.

    A LimitWarning tells of parts of the law that such a table leaves out.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned, over the separation.
    out : path
        The file to write: .inp for Abaqus, CalculiX and Ansys, .i for MOOSE, .table for LAMMPS, .h, .csv, .json. One
        that was exported before is replaced.
    to : {"abaqus", "calculix", "moose", "ansys", "c", "lammps", "csv", "json"}
        The code, or the format.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``.
    **options
        ``quantity``: "pressure" (default) or "area" over the overclosure, "conductance" or "tangential" stiffness over
        the pressure, each per nominal area; "force", the whole law of a body; "loss", the energy lost by each loop of
        the path, and in each cell of a sweep of path.separation.stop; or "nodes", a few asperities whose sum is the
        expected law. ``units``: names of length, force and stress such as "mm,N,MPa"; SI unless given.
        ``branch``: "loading" (default) or "unloading". ``error``: that of lines between the points of the table, over
        the largest value and over the value itself where that is within a decade of it (1e-3). ``distance`` [m]: for
        lammps, that of two centres, or of one from a wall, at zero separation. ``select``: a dictionary such as
        ``{"adhesion.work": "50 mJ/m^2"}`` of the cell of a sweep.

    Raises
    ------
    StoreError
        Where there is no such result, quantity, unit or cell, where the steps of its path are too far apart for the
        error, where the code cannot take the table, or ``out`` cannot be written or must not be replaced.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "One patch", "material": {"effective_modulus": "1 GPa"}, "batch": {"estimator": "expected"},
    ...     "path": {"separation": {"start": "clear", "stop": "0.5 um", "steps": 100}},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... })
    >>> rm.export(result, "layer.inp", to="calculix", units="mm,N,MPa", error=5e-3)
    """
    asked = Export(to, **options)
    data, file = given_result(result)
    path = Path(out)
    check_export(path, file, asked, fresh=fresh)
    document, told = document_of(data, file, asked)
    for warning in told:
        warnings.warn(warning, LimitWarning, stacklevel=level_outside())
    write(document, path, asked)


def check_export(path: Path, file: Path | None, asked: Export, *, fresh: bool) -> None:
    """Raise StoreError unless the export can be written to ``path``; with ``fresh`` it may replace any file."""
    check_output(path, f"table for {asked.to}", asked.format.endings, [file], kind="export", fresh=fresh)


def write(document: Document, path: Path, asked: Export) -> None:
    """Write a document in the syntax of its format, whole or not at all."""
    text = text_of(document, asked.format)
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def document_of(result: ResultView, file: Path | None, asked: Export) -> tuple[Document, tuple[str, ...]]:
    """Return what is to be written of a result, which was read from ``file`` unless that is None, and warnings."""
    units, centres = UnitSystem.read(asked.units), asked.centres
    if asked.quantity == "nodes":
        from roughmdr.report.export.nodes import nodes_document

        return nodes_document(result, file, asked.select, asked.error, units), ()
    if asked.quantity == "loss":
        from roughmdr.report.export.loss import loss_document

        return loss_document(result, asked.select, units), ()
    cell, words = select(result, asked.select)
    quantity = QUANTITIES[asked.quantity]
    law = law_of(cell, quantity, asked.branch)
    form = asked.format
    table = table_of(law, quantity, asked.branch, error=asked.error, with_tension=form.with_tension, distance=centres)
    if quantity.whole:
        columns = columns_of(
            table.law, tangent_stiffness(table.law.overclosure, cell, law, table.steps), units, centres
        )
    else:
        columns = _columns(table, law, quantity, units)
    _check_fit(table, quantity, units, asked)
    header = dict(origin_lines(cell, words)) | dict(table_lines(cell, table, quantity, law, units))
    if note := form.quantities[asked.quantity]:
        header["use"] = note.format(value=columns[1].name, VALUE=columns[1].name.upper())
    if centres is not None:
        header["distance"] = f"{centres / units.length.size:.15g} {units.length.name} minus the overclosure"
    memory = {"memory": _MEMORY[asked.branch]} if cell.known(PLASTIC).size else {}
    friction = _friction(result, asked) if quantity.name == "tangential" else None
    tag = form.tags.get((units.length.size, units.force.size), "")
    return Document(quantity.name, header | memory, columns, friction, tag), (*table.warnings, *memory.values())


def _columns(table: Table, law: Law, quantity: Quantity, units: UnitSystem) -> tuple[Column, ...]:
    """Return the columns of a table per area: the argument, the value, and the others."""
    unit, length, stress, part = units.of(law.source.dimension), units.length, units.stress, table.law
    overclosure = Column("overclosure", length.name, part.overclosure / length.size)
    separation = Column("separation", length.name, (part.datum - part.overclosure) / length.size)
    pressure = Column("pressure", stress.name, part.pressure / stress.size)
    value = Column(law.source.variable, unit.name, part.value / unit.size)
    value = pressure if quantity.name == "pressure" else value
    error = Column("standard_error", unit.name, part.standard_error / unit.size)
    argument, other = (pressure, overclosure) if quantity.over_pressure else (overclosure, pressure)
    return (argument, value, separation, *([] if value is pressure else [other]), error)


def _friction(result: ResultView, asked: Export) -> float | None:
    """Return the coefficient of friction of the scene in the cell that is selected; None where it has none."""
    swept = result.swept(cell_of(result, asked.select))
    if "tangential_friction" in swept:
        return float(swept["tangential_friction"].values)
    friction = result.scene.get("tangential", {}).get("friction")
    return None if friction is None else number_in_si(friction, DIMENSIONLESS)


def _check_fit(table: Table, quantity: Quantity, units: UnitSystem, asked: Export) -> None:
    """Raise StoreError where the code does not read a table as it is."""
    most, lines = asked.format.most_lines.get(asked.quantity), table.law.overclosure.size
    if most is not None and lines > most:
        raise StoreError(
            f"error is {asked.error:g}, which takes {lines} points, and {asked.to} reads {most} at most: ask for an "
            f"error of about {asked.error * (lines / most) ** 2:.2g}"
        )
    if quantity.over_pressure:
        return
    step = float(np.diff(table.law.overclosure).min()) / units.length.size
    if step < asked.format.least_step:
        raise StoreError(
            f"units: the overclosure has steps of {step:.2g} {units.length.name}, and {asked.to} widens those below "
            f"{asked.format.least_step:g}: ask for a smaller unit of length"
        )


def _check(name: str, value: object, allowed: list[str]) -> None:
    if value not in allowed:
        raise StoreError(f"{name} is {short_repr(value)}{suggestion(str(value), allowed)}")
