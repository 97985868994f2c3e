"""The mean law of one cell of a result per nominal area, along one loading or unloading."""

from typing import NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.result.view import Leg, ResultView
from roughmdr.stages import stages_in
from roughmdr.variables import SEPARATION


class Source(NamedTuple):
    """A variable of a result from which a quantity of a table is made."""

    variable: str
    dimension: str
    """SI unit of the variable, as ``UnitSystem.of`` takes it."""
    per_area: bool
    """Whether the variable is a total, to be divided by the nominal area."""


class Quantity(NamedTuple):
    """A quantity that tables hold."""

    name: str
    sources: tuple[Source, ...]
    over_pressure: bool = False
    """Whether tables have it over the pressure, else over the overclosure."""
    whole: bool = False
    """Whether it is the whole law of a body at given separations, else the part per area that a load can follow."""


_PRESSURE = Quantity("pressure", (Source("pressure", "Pa", False), Source("force", "Pa", True)))
_CONDUCTANCES = Source("thermal_conductance", "W/m2/K", True), Source("electrical_conductance", "S/m2", True)
QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        _PRESSURE,
        Quantity("conductance", _CONDUCTANCES, over_pressure=True),
        Quantity("area", (Source("contact_fraction", "1", False), Source("contact_area", "1", True))),
        Quantity("tangential", (Source("tangential_stiffness", "Pa/m", True),), over_pressure=True),
        Quantity("force", (Source("force", "N", False),), whole=True),
    )
}
"""Quantities of tables by their names."""


class Law(NamedTuple):
    """A quantity along one leg of a path, from the farthest separation to the closest; steps without motion once."""

    source: Source
    separation: Floats
    """[m]: [step], falling."""
    pressure: Floats
    """[Pa], of a whole law the force [N]: [step]."""
    value: Floats
    """In the dimension of its source, in SI: [step]."""
    standard_error: Floats
    """Standard error of ``value`` over the realisations, NaN of one: [step]."""
    steps: Ints
    """Steps of the path: [step]."""
    realizations: int
    """Number of which it is the mean; 0 of an expected law."""
    scene: str
    """The scene of the result, in TOML."""


def law_of(cell: ResultView, quantity: Quantity, branch: str) -> Law:
    """Return the mean law of a result of one cell along its loading or unloading that comes closest.

    StoreError where the result has more cells, no such branch, another coordinate than the separation, or lacks a
    variable.
    """
    if len(cell.cells) > 1:
        listed = ", ".join(f"{name} ({size})" for name, size in cell.sweep.items())
        raise StoreError(f"the result has {len(cell.cells)} cells, over {listed}: select one of each")
    if cell.control != SEPARATION.name:
        needed = "a table needs the mean law over the separation; run the scene with path.separation"
        raise StoreError(f"the path of the result is over {cell.control}: {needed}")
    separation = cell.coordinates[SEPARATION.name].values.reshape(-1)
    steps = _steps(cell.legs, separation, branch)
    value, error, source = _mean(cell, quantity, steps)
    pressure = value if quantity.whole else _mean(cell, _PRESSURE, steps)[0]
    runs = 0 if cell.estimator == "expected" else cell.realizations
    return Law(source, separation[steps], pressure, value, error, steps, runs, cell.attrs["scene"])


def _steps(legs: list[Leg], separation: Floats, branch: str) -> Ints:
    """Return the steps of the loading or unloading that comes closest, from far to near."""
    fitting = [leg.steps for leg in legs if leg.branch == branch]
    if not fitting:
        raise StoreError(f"branch is {branch!r}, and the path of the result has none")
    leg = min(fitting, key=lambda steps: float(separation[steps].min()))
    ordered = leg if branch == "loading" else leg[::-1]
    moves: Ints = ordered[np.append(np.diff(separation[ordered]) != 0.0, True)]
    if not (np.diff(separation[moves]) < 0.0).all():
        raise StoreError(f"the separations of the {branch} do not fall from far to near, as its branch says")
    return moves


def _mean(cell: ResultView, quantity: Quantity, steps: Ints) -> tuple[Floats, Floats, Source]:
    """Return the mean of a quantity at steps, its standard error, and what it is made from."""
    source = next((source for source in quantity.sources if cell.holds(source.variable)), None)
    if source is None:
        names = " or ".join(repr(source.variable) for source in quantity.sources)
        raise StoreError(f"quantity {quantity.name!r} needs the variable {names}: add it to [output] variables")
    area = 1.0
    if source.per_area:
        if "nominal_area" not in cell.variables:
            under = "".join(f" under [{stage.key}]" for stage in stages_in(cell.scene) if not stage.flat)
            raise StoreError(
                f"quantity {quantity.name!r} is per nominal area, and the result has none{under}: 'force' is not"
            )
        area = float(cell.variables["nominal_area"].values.item())
        if not 0.0 < area < np.inf:
            raise StoreError(f"nominal_area is {area:g} m2; per area there is nothing")
    mean, error = (numbers.reshape(-1)[steps] / area for numbers in cell.mean(source.variable))
    if not np.isfinite(mean).all():
        raise StoreError(f"{source.variable} is not known at all steps: no run of this cell was computed")
    return mean, error, source
