"""Partial slip of a rough contact under a lateral displacement, from its normal law (Cattaneo, Mindlin, Jaeger).

A contact that is pressed and then moved sideways by u sticks in an inner disc and slips around it, where the shear is
mu times the pressure. That shear is mu times the difference of two normal contacts: the present one, and that whose
contact is the stick disc, which is pressed in less by c u with c = G*/(mu E*). So for all independent contacts
together, of any shape, with their normal force F(h), the sum a of their radii and their energy U(h) at separation h:

    tangential force        T = mu [F(h) - F(h + c u)]
    its slope               dT/du = 2 G* a(h + c u)
    energy lost by slip     D = mu {u [F(h) + F(h + c u)] - (2/c) [U(h) - U(h + c u)]}

on the first loading; ``loading.masing`` has all other paths. D is the work of T less the elastic energy that it
leaves, which in the springs of the method of dimensionality reduction, E* dx and G* dx, is
(mu/c) [U(h) - U(h + c u) - c u F(h + c u)].

1/G* = (2 - nu1)/(4 G1) + (2 - nu2)/(4 G2). Left out are the normal displacement that shear makes where Dundurs' beta is
not 0, and slip across the pull where nu is not 0.

Sources: C. Cattaneo, Rend. Accad. Naz. Lincei 27 (1938) 342; R. D. Mindlin, J. Appl. Mech. 16 (1949) 259; J. Jäger,
Arch. Appl. Mech. 65 (1995) 478, for any shape; V. L. Popov, M. Hess, Method of Dimensionality Reduction (2015), ch. 5.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.errors import OutOfRange
from roughmdr.loading.masing import Masing
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats

Law = Callable[[Floats, list[str]], LoadSeparation]
"""The normal law of contacts without adhesion: rising separations [m] and the variables asked for -> the law there."""

_NEEDED = {
    "tangential_force": ("force",),
    "tangential_stiffness": ("contact_radius_sum",),
    "friction_energy": ("force", "energy"),
}
_MAX_RATIO = 1e-6 / float(np.finfo(float).eps)  # largest ratio of numbers to their difference: six digits of it remain


def normal_variables(names: Iterable[str]) -> list[str]:
    """Return the normal variables that these are computed from; a normal variable stands for itself."""
    return list(dict.fromkeys(each for name in names for each in _NEEDED.get(name, (name,))))


class SlipConstants(NamedTuple):
    """The constants of a contact under tangential load."""

    effective_modulus: float
    """E* [Pa]."""
    stiffness_ratio: float
    """G*/E* [1]."""
    friction: float
    """The coefficient mu [1]; NaN where none is given."""

    @property
    def reach(self) -> float:
        """The approach of the normal contacts over the lateral displacement that unloads as much: c [1]."""
        return self.stiffness_ratio / self.friction

    def stiffness(self, radius: Floats) -> Floats:
        """Return the tangential stiffness [N/m] of contacts that stick, from their conductance radius [m]: 2 G* a."""
        return 2.0 * self.stiffness_ratio * self.effective_modulus * radius


def partial_slip(
    law: Law, separation: float, memory: Masing, tangential: SlipConstants, names: list[str]
) -> LoadSeparation:
    """Return the law along a lateral path at a constant separation [m], with the separation as a variable.

    The tangential force is right to roundings of mu F, the energy to those of mu F u. OutOfRange where these leave few
    digits of the largest tangential force, or where a variable is not representable.
    """
    amplitude, number = np.unique(np.append(0.0, memory.amplitude), return_inverse=True)
    with np.errstate(over="ignore"):  # refused below
        reduced = separation + tangential.reach * amplitude
    if not np.isfinite(reduced).all():
        raise OutOfRange(f"lateral displacements over a friction of {tangential.friction:g} are not representable")
    asked = normal_variables(name for name in names if name != "separation")
    normal = law(reduced, asked)
    first, steps = FirstCurve(normal.variables, reduced, tangential), number[1:]
    if "tangential_force" in names and amplitude[-1] > 0.0:
        first.check_digits()
    with np.errstate(all="ignore"):  # refused below
        slipped = {
            "tangential_force": lambda: memory.force(first.tangential_force[steps]),
            "tangential_stiffness": lambda: first.tangential_stiffness[steps],
            "friction_energy": lambda: memory.loss(first.friction_energy[steps]),
        }
        held = {"separation": separation, **{name: float(normal.variables[name][0]) for name in asked}}
        found = {name: slipped[name]() if name in slipped else np.full(steps.size, held[name]) for name in names}
    if lost := [name for name, values in found.items() if not np.isfinite(values).all()]:
        raise OutOfRange(f"{lost[0]} is not representable with a friction of {tangential.friction:g}")
    return normal._replace(variables=found, pull_off=PullOff())


class FirstCurve(NamedTuple):
    """The first loading of contacts at rest, at lateral displacements that rise from 0."""

    normal: dict[str, Floats]
    """The normal law at each of ``separation``."""
    separation: Floats
    """The constant separation [m], and those at which the normal contacts are the stick discs."""
    tangential: SlipConstants

    @property
    def tangential_force(self) -> Floats:
        """T [N]."""
        force = self.normal["force"]
        return np.asarray(self.tangential.friction * (force[0] - force))

    @property
    def tangential_stiffness(self) -> Floats:
        """dT/du [N/m]."""
        return self.tangential.stiffness(self.normal["contact_radius_sum"])

    @property
    def friction_energy(self) -> Floats:
        """D [J]: 2 mu/c times the excess of the chord of F over F itself, of which U is the integral."""
        force, energy, way = self.normal["force"], self.normal["energy"], self.separation - self.separation[0]
        excess = 0.5 * way * (force[0] + force) - (energy[0] - energy)
        return np.asarray(2.0 * (self.tangential.friction / self.tangential.reach) * excess)

    def check_digits(self) -> None:
        """Raise OutOfRange where rounding leaves few digits of the largest tangential force."""
        (force, reduced), (place, last) = (each[[0, -1]].tolist() for each in (self.normal["force"], self.separation))
        if force == 0.0 or reduced == 0.0:  # full slip
            return
        way, slipped = last - place, force - reduced
        if slipped <= 0.0 or max(abs(last) / way, force / slipped) > _MAX_RATIO:
            raise OutOfRange(
                f"friction {self.tangential.friction:g} is so large, or the displacement so small, that rounding "
                "leaves less than six digits of the tangential force: the contacts stick, with the "
                "tangential_stiffness of a normal path"
            )
