"""The machine that moves the flat: a spring in series, its soft limit a dead load, its stiff limit fixed grips.

The spring of stiffness k_m carries the force F = k_m (h - X), X the position of its far end. So the flat at h asks for
X = h - F/k_m, and under a dead load for the load F itself. Both are the one number

    demand = weight h - compliance F,

with weight 1 and compliance 1/k_m of a spring, 0 and 1 of a dead load: it grows while the machine withdraws. On a
monotone leg the flat stands at the first separation, in the sense of the leg, at which the demand has passed that of
the machine.
"""

from typing import NamedTuple, TypeVar

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.loading.path import LoadingPath, labelled_branches, rises_anywhere
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Quantity, WholeNumber
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES, CURVE_VARIABLES, REMOTE, SEPARATION, TRAVEL

Number = TypeVar("Number", float, Floats)
STIFFNESS = Quantity("N/m", above=0.0, example='"1 kN/m"')
PRELOAD = {
    "preload": Quantity("N", above=0.0, example='"1 mN"'),
    "preload_pressure": Quantity("Pa", above=0.0, example='"1 MPa"'),
    "preload_contact_fraction": Quantity("1", above=0.0, at_most=1.0, example="0.02"),
}
STEPS = WholeNumber(2, 10_000_000, example="200")


class Machine(NamedTuple):
    """Weight and compliance of a machine: its demand is weight h - compliance F."""

    weight: float
    """1 with a spring or fixed grips, 0 under dead load."""
    compliance: float
    """1/k_m [m/N] of a spring, 0 of fixed grips, 1 under dead load."""

    @property
    def is_dead_load(self) -> bool:
        """Whether the machine keeps the force, whatever the separation."""
        return self.weight == 0.0

    def demand(self, separation: Floats, force: Floats) -> Floats:
        """Return the position of the far end [m], or minus the load [N], at which the flat is in equilibrium."""
        return self.weight * separation - self.compliance * force

    def slope(self, stiffness: Number) -> Number:
        """Return d(demand)/dh; ``stiffness`` is that of the contacts [N/m]."""
        return self.weight + self.compliance * stiffness

    def energy(self, separation: Number, demand: Number) -> Number:
        """Return the energy of the machine [J]: k_m (h - X)^2/2 of the spring, L h of the dead load."""
        if self.is_dead_load:
            return -demand * separation
        off = separation - demand
        return 0.5 * off * off / self.compliance


DEAD_LOAD, FIXED_GRIPS = Machine(0.0, 1.0), Machine(1.0, 0.0)


def spring(stiffness: float) -> Machine:
    """Return the machine with a spring [N/m] in series."""
    return Machine(1.0, 1.0 / stiffness)


class Preload(NamedTuple):
    """The quantity and its value at which loading ends."""

    quantity: str
    """One of "force", "pressure" and "contact_fraction"."""
    value: float
    """In SI."""


class MachinePath(NamedTuple):
    """The path of a machine, step by step."""

    control: str
    """The controlled quantity: any of ``STEP_COORDINATES`` but "separation"."""
    values: Floats
    """Its value at each step: the load [N] or pressure [Pa], the position of the far end of the spring [m], or the
    travel [1].
    """
    demand: Floats
    """The demand of the machine at each step: minus the load [N], or that position [m]; minus the travel, as long as
    its ends are not known.
    """
    machine: Machine
    adhesive: bool
    """Whether contacts have a memory."""
    preload: Preload | None = None
    """The preload that a travel leads to, until its position is found; then None."""

    @classmethod
    def along(
        cls, control: str, values: Floats, *, machine_stiffness: float = 0.0, area: float = 1.0, adhesive: bool
    ) -> "MachinePath":
        """Return the path of these values; the stiffness [N/m] is for "remote", the nominal area [m2] for "pressure".

        OutOfRange where a load is not representable.
        """
        if control == "remote":
            return cls(control, values, values, spring(machine_stiffness), adhesive)
        with np.errstate(over="ignore"):  # refused below
            load = values * area if control == "pressure" else values
        if not np.isfinite(load).all():
            raise OutOfRange(f"a pressure of {np.abs(values).max():g} Pa is not representable on {area:g} m2")
        return cls(control, values, -load, DEAD_LOAD, adhesive)

    @classmethod
    def to_preload(
        cls, travel: Floats, preload: Preload, *, machine_stiffness: float | None, adhesive: bool
    ) -> "MachinePath":
        """Return the path to a preload with these travels, through a spring [N/m] or, where that is None, none."""
        machine = FIXED_GRIPS if machine_stiffness is None else spring(machine_stiffness)
        return cls(TRAVEL.name, travel, -travel, machine, adhesive, preload)

    @property
    def watched(self) -> str:
        """The variable whose error [accuracy] controls: the force; under a dead load the separation."""
        return SEPARATION.name if self.machine.is_dead_load else "force"

    @property
    def rigid(self) -> bool:
        """Whether the flat is displacement-controlled by a rigid machine (fixed grips)."""
        return self.machine == FIXED_GRIPS

    @property
    def unloads(self) -> bool:
        """Whether the machine withdraws anywhere."""
        return rises_anywhere(self.demand)

    @property
    def solutions(self) -> int:
        """The number of steps, at each of which contacts are solved once its separation is found."""
        return int(self.values.size)

    def over(self, usual: LoadingPath) -> LoadingPath:
        """Return the path of the flat, given its path over ``usual`` asperities."""
        return usual

    def between(self, clear: float, turn: float) -> "MachinePath":
        """Return the path whose travel goes from ``clear`` [m] to ``turn`` [m] exactly."""
        demand = np.where(self.values == 1.0, turn, clear + self.values * (turn - clear))
        return self._replace(demand=demand, preload=None)

    def variables(self, names: list[str]) -> list[str]:
        """Return the variables of a law that is asked for ``names``: with those that every path of a machine has."""
        own = [SEPARATION.name]
        own += [REMOTE.name] if self.control == TRAVEL.name and self.machine != FIXED_GRIPS else []
        own += ["force"] if self.control in (REMOTE.name, TRAVEL.name) else []
        return [*own, *(name for name in names if name not in (*own, self.control))]

    def coordinates(self) -> dict[str, Array]:
        """Return the controlled quantity and the branch of each step, labelled."""
        return {self.control: Array(("step",), self.values, attributes_of(self.control)), "branch": self.branch()}

    def branch(self) -> Array:
        """Return the branch of each step, labelled."""
        return labelled_branches(self.demand)


def travel(steps: int) -> Floats:
    """Return the travels of loading to a preload, from 0 to 1."""
    return np.linspace(0.0, 1.0, steps)


def attributes_of(control: str) -> dict[str, str]:
    """Return the attributes of the coordinate that a path controls."""
    return (COORDINATES.get(control) or CURVE_VARIABLES[control]).attrs


class Jump(NamedTuple):
    """A jump of the flat, at one demand of the machine."""

    step: int
    """The step that comes after it."""
    demand: float
    before: float
    """The separation [m] that it begins from."""
    after: float
    """The separation [m] that it ends at; inf where a dead load pulls the flat off."""


class Leg(NamedTuple):
    """Steps of a path in which the machine moves one way."""

    first: int
    """The step at which it begins."""
    demand: Floats
    """The demand of the machine at each step of the leg."""
    rises: bool
    """Whether the demand grows: the flat is pulled."""


def legs_of(demand: Floats) -> list[Leg]:
    """Return the legs of a path that comes from a flat far away; repeated demands belong to the leg before them."""
    legs, first, rises = list[Leg](), 0, False
    for step in range(1, demand.size):
        if demand[step] != demand[step - 1] and (demand[step] > demand[step - 1]) != rises:
            legs.append(Leg(first, demand[first:step], rises))
            first, rises = step, not rises
    return [*legs, Leg(first, demand[first:], rises)]
