"""Every equilibrium of one asperity at a given indentation, stable or not.

Those that are not stable under fixed grips lie between two branches, where delta falls as a grows, and before the first
one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, Unpack

import numpy as np

from roughmdr.asperity.approach import branches_of
from roughmdr.asperity.contact import Contact, Results
from roughmdr.asperity.tabor import resolved
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial, release_stretch
from roughmdr.kernels.profile.layout import COUNT, DEPTH, RANGE, STRENGTH
from roughmdr.schema.arguments import check_scalar
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

_SMALLEST = 1e-150  # smallest contact radius that is sought, over that of the first fold
_ITERATIONS = 2000
_RTOL = 4.0 * float(np.finfo(np.float64).eps)


@named_keywords
def equilibria(
    shape: Shape, *, work: float | str, indentation: float | str, **material: Unpack[AdhesiveMaterial]
) -> xr.Dataset:
    """Find all equilibria at an indentation, from the smallest contact radius to the largest.

    ``indent`` gives the largest of those that are stable under fixed grips.

    Parameters
    ----------
    shape, **material
        The profile, and E*, adhesion, strength, range and error as in ``indent``.
    work, indentation : float or str
        Work of adhesion [J/m^2], 0 for none; approach past first touch [m].

    Returns
    -------
    xarray.Dataset
        Over ``equilibrium``, of size 0 where there is none: contact_radius [m], force [N], contact_area [m2], stiffness
        [N/m]; stable_displacement and stable_force, whether it is stable under fixed grips and under dead load. With
        "dugdale" also cohesive_radius [m]; the contact radius is 0 where the surfaces attract each other without
        touching.

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] D. Maugis, Contact, Adhesion and Rupture of Elastic Solids (2000).

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius="1 um")
    >>> states = rm.equilibria(tip, effective_modulus="1 GPa", work="50 mJ/m^2", indentation="-1 nm")
    >>> states.stable_displacement.values.tolist()
    [False, True]
    >>> attraction = {"work": "50 mJ/m^2", "adhesion": "dugdale", "strength": "100 MPa"}
    >>> states = rm.equilibria(tip, effective_modulus="1 GPa", indentation="-1 nm", **attraction)
    >>> [f"{radius:.3g}" for radius in states.contact_radius.values]
    ['0', '5.48e-08']
    """
    import xarray as xr

    delta = check_scalar("indentation", indentation, "m")
    asked = Adhesion.from_arguments(work, material)
    effective_modulus = effective_modulus_of(equilibria, material)
    taken = resolved(shape, effective_modulus, asked)
    contact = Contact.of(shape, effective_modulus, taken)
    with np.errstate(all="ignore"):  # overflow is refused below
        states = sorted([*_stable(contact, delta), *unstable(contact, delta)])
    a, c, force, stiffness, stable = np.array(states, dtype=np.float64).reshape(-1, 5).T
    results = {"contact_radius": a, "force": force, "contact_area": math.pi * a * a, "stiffness": stiffness}
    results |= {"cohesive_radius": c} if taken.model == "dugdale" else {}
    for name, values in results.items():
        if not np.isfinite(values).all():
            raise OutOfRange(f"{name} at indentation = {delta:g} m is not representable")
    attrs = {"adhesion": taken.model} if asked.model == "auto" else {}
    data = {name: ("equilibrium", values, ASPERITY[name].attrs) for name, values in results.items()} | {
        "stable_displacement": ("equilibrium", stable > 0.0, {"long_name": "stable under fixed grips"}),
        "stable_force": ("equilibrium", (stable > 0.0) & (stiffness > 0.0), {"long_name": "stable under dead load"}),
    }
    return xr.Dataset(data, coords={"indentation": ((), delta, ASPERITY["indentation"].attrs)}, attrs=attrs)


def _stable(contact: Contact, delta: float) -> Iterator[Equilibrium]:
    """Yield the equilibrium on each branch that is stable under fixed grips at delta."""
    kernels = contact.kernels
    onset = -contact.depth[0] if kernels.adhesive else 0.0
    if delta < onset or (delta == 0.0 and not kernels.adhesive):
        return
    if kernels.cohesive and onset == contact.onset == delta:  # where attraction begins, without a jump
        return
    if not (kernels.branched and delta > onset):
        yield Equilibrium.from_results(contact.at_indentation(np.array([delta])), stable=True)
        return
    x = float(contact.reduced(np.array([delta]), contact.depth)[0])
    for number in range(1, int(contact.params[COUNT]) + 1):
        # The branch extends to delta if a contact that is put on it stays on it.
        if kernels.branch(x, float(number), True, contact.params) == number:
            state = kernels.state_on_branch(x, float(number), contact.params)
            yield Equilibrium.from_results(contact.at_states(np.array([True]), np.array([state])), stable=True)


class Equilibrium(NamedTuple):
    """An equilibrium; equilibria are ordered by contact and cohesive radius."""

    contact_radius: float
    cohesive_radius: float
    force: float
    stiffness: float
    stable: bool
    """Whether it is stable under fixed grips."""

    @classmethod
    def from_results(cls, results: Results, *, stable: bool) -> Equilibrium:
        """Return the equilibrium of results of size one."""
        cohesive_radius = float(results["cohesive_radius"][0]) if "cohesive_radius" in results else 0.0
        radius, force, stiffness = (float(results[name][0]) for name in ("contact_radius", "force", "stiffness"))
        return cls(radius, cohesive_radius, force, stiffness, stable)


def unstable(contact: Contact, delta: float) -> Iterator[Equilibrium]:
    """Yield the equilibria at delta [m] that are not stable under fixed grips."""
    if not contact.adhesion.cohesive:
        if contact.kernels.adhesive:
            yield from _unstable_jkr(contact, delta)
    elif contact.shape.pinned:
        yield from _unstable_dugdale_punch(contact, delta)
    else:
        yield from _unstable_dugdale(contact, delta)


def _unstable_jkr(contact: Contact, delta: float) -> Iterator[Equilibrium]:
    from scipy.optimize import brentq

    shape, effective_modulus = contact.shape, contact.effective_modulus
    edge = contact.radius if shape.flat else 0.0

    def stretch(a: float) -> float:
        return release_stretch(a, effective_modulus, contact.adhesion.work)

    def excess(log_a: float, maximum: float) -> float:
        a = min(math.exp(log_a), maximum)
        g = 0.0 if a <= edge else float(shape.g(a))
        return g - stretch(a) - delta

    for low, high in _falling_radii(contact):
        ends = math.log(low), math.log(high)
        if not (excess(ends[0], high) > 0.0 > excess(ends[1], high)):
            continue
        a = math.exp(float(brentq(excess, *ends, (high,), xtol=1e-15, rtol=1e-15)))
        if a < edge:
            yield Equilibrium(a, 0.0, -2.0 * effective_modulus * a * stretch(a), 6.0 * effective_modulus * a, False)
        else:
            results = contact.at_radius(np.array([a]))
            yield Equilibrium.from_results({**results, "contact_radius": np.array([a])}, stable=False)


def _falling_radii(contact: Contact) -> Iterator[tuple[float, float]]:
    """Yield pairs of contact radii [m] of JKR between which the indentation falls."""
    if contact.kernels.iterative:
        turns = [turn for branch in branches_of(contact) for turn in branch if turn < math.inf]
        radii = [float(contact.radius * contact.kernels.radius(turn, contact.params)) for turn in turns]
    else:
        radii = contact.pull_off("displacement")["contact_radius"].tolist()
    yield from list(pairwise([radii[0] * _SMALLEST, *radii]))[::2]


def _unstable_dugdale(contact: Contact, delta: float) -> Iterator[Equilibrium]:
    """Yield those of a shape with a profile, whose state parametrises all equilibria from 0 on."""
    from scipy.optimize import brentq

    def excess(state: float) -> float:
        return float(contact.indentation_of(np.array([state]))[0]) - delta

    turns = [0.0, *(turn for branch in branches_of(contact) for turn in branch if turn < math.inf)]
    for low, high in list(pairwise(turns))[::2]:
        if low < high and excess(low) > 0.0 > excess(high):
            state = float(brentq(excess, low, high, xtol=1e-300, rtol=_RTOL, maxiter=_ITERATIONS))
            yield Equilibrium.from_results(contact.at_states(np.array([True]), np.array([state])), stable=False)


def _unstable_dugdale_punch(contact: Contact, delta: float) -> Iterator[Equilibrium]:
    """Yield the equilibrium of a flat punch whose cohesive zone ends within its edge.

    There g = 0 and K = 0 (``kernels.dugdale.equilibrium``): with a = c cos(theta), delta = -beta c sin(theta) and
    beta c (theta sin(theta) - 1 + cos(theta)) = pi/2 w/sigma0; without contact delta = -2/pi beta c - w/sigma0.
    """
    from scipy.optimize import brentq

    beta, gap_limit = (float(contact.params[place]) for place in (STRENGTH, RANGE))
    width, wanted = contact.radius, delta / contact.radius
    if not -contact.params[DEPTH] < wanted < -gap_limit:
        return
    theta, c = 0.5 * math.pi, 0.5 * math.pi * (-wanted - gap_limit) / beta
    if (1.0 - 2.0 / math.pi) * beta * c > gap_limit:

        def excess(angle: float) -> float:
            sine = math.sin(angle)
            lifted = angle * sine - sine * sine / (1.0 + math.cos(angle))
            return 0.5 * math.pi * gap_limit * sine + wanted * lifted

        theta = float(brentq(excess, 1e-300, 0.5 * math.pi, xtol=1e-300, rtol=_RTOL, maxiter=_ITERATIONS))
        c = -wanted / (beta * math.sin(theta))
    a = c * math.cos(theta) if theta < 0.5 * math.pi else 0.0
    m = c * math.sin(theta)
    short = m * m / (c + a)  # c - a
    push = -0.5 * beta * (a * m + c * c * theta)
    stiffness = a + theta * theta * c * c / short
    unit = 2.0 * contact.effective_modulus * width
    yield Equilibrium(a * width, c * width, unit * width * push, unit * stiffness, False)
