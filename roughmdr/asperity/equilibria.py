"""Every equilibrium of one asperity at a given indentation, stable or not."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, release_stretch
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP
from roughmdr.numerics.arguments import Floats, check_values
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

_NAMES = ("contact_radius", "force", "contact_area", "stiffness")
_LEAST = 1e-150  # of the radius of the first fold, where the search for a small contact begins


def equilibria(shape: Shape, *, effective_modulus: float, work: float, indentation: float) -> "xr.Dataset":
    """All contact radii in equilibrium at an indentation [m] (H 40-41, 44), from the smallest to the largest.

    effective_modulus is E* [Pa], work the work of adhesion [J/m^2]. The result is a Dataset over ``equilibrium``:
    contact_radius [m], force [N], contact_area [m2], stiffness [N/m], ``stable_displacement`` and ``stable_force``,
    whether it is stable under fixed grips and under dead load; its size is 0 where there is no contact. ``indent``
    gives the largest of those that are stable under fixed grips. Raises OutOfRange and ShapeError as ``indent``.
    """
    import xarray as xr

    delta = check_values("indentation", indentation)
    if delta.ndim != 0:
        raise OutOfRange(f"indentation has {delta.ndim} dimensions; equilibria takes one number")
    contact = Contact.of(shape, effective_modulus, Adhesion.checked("jkr", work, None))
    with np.errstate(all="ignore"):  # what overflows is refused below
        found = [*_stable(contact, float(delta)), *_unstable(contact, float(delta))]
    columns = np.array(sorted(found), dtype=np.float64).reshape(-1, 3).T
    a, force, stiffness = columns
    results = dict(zip(_NAMES, (a, force, math.pi * a * a, stiffness), strict=True))
    for name, values in results.items():
        if not np.isfinite(values).all():
            raise OutOfRange(f"{name} at indentation = {float(delta):g} m is not representable")
    # k/(2 E* a) is at most 1 where fixed grips hold the contact, and at least 3 where they do not.
    held = stiffness <= 4.0 * effective_modulus * a
    data = {name: ("equilibrium", values, ASPERITY[name].attrs) for name, values in results.items()}
    return xr.Dataset(
        {
            **data,
            "stable_displacement": ("equilibrium", held, {"long_name": "stable under fixed grips"}),
            "stable_force": ("equilibrium", held & (stiffness > 0.0), {"long_name": "stable under dead load"}),
        },
        coords={"indentation": ((), delta, ASPERITY["indentation"].attrs)},
    )


def _stable(contact: Contact, delta: float) -> Iterator[tuple[float, float, float]]:
    """Contact radius, force and stiffness on each stable branch that reaches delta."""
    law = contact.law
    onset = -contact.depth[0] if law.adhesive else 0.0
    if delta < onset or (delta == 0.0 and not law.adhesive):
        return
    if law.branched and delta > onset:
        x = float(contact.reduced(np.array([delta]), contact.depth)[0])
        for number in range(1, int(contact.params[COUNT]) + 1):
            # A way that begins on a branch ends there just where the branch reaches so far.
            if law.branch(x, float(number), True, contact.params) == number:
                state = law.state_on_branch(x, float(number), contact.params)
                yield (
                    contact.radius * law.radius(state, contact.params),
                    contact.force * law.force(state, contact.params),
                    contact.stiffness * law.stiffness(state, contact.params),
                )
    else:
        results = contact.at_indentation(np.array([delta]))
        yield float(results["contact_radius"][0]), float(results["force"][0]), float(results["stiffness"][0])


def _unstable(contact: Contact, delta: float) -> Iterator[tuple[float, float, float]]:
    """The same on the way from each fold to the branch before it, where delta falls as a grows."""
    from scipy.optimize import brentq

    if not contact.law.adhesive:
        return
    shape, effective_modulus = contact.shape, contact.effective_modulus
    edge = contact.radius if shape.flat else 0.0

    def stretch(a: float) -> float:
        return release_stretch(a, effective_modulus, contact.adhesion.work)

    def excess(log_a: float, most: float) -> float:
        a = min(math.exp(log_a), most)
        g = 0.0 if a <= edge else float(shape.g(a))
        return g - stretch(a) - delta

    for low, high in _falls(contact):
        ends = math.log(low), math.log(high)
        if not (excess(ends[0], high) > 0.0 > excess(ends[1], high)):
            continue
        a = math.exp(float(brentq(excess, *ends, (high,), xtol=1e-15, rtol=1e-15)))
        if a < edge:
            yield a, -2.0 * effective_modulus * a * stretch(a), 6.0 * effective_modulus * a
        else:
            results = contact.at_radius(np.array([a]))
            yield a, float(results["force"][0]), float(results["stiffness"][0])


def _falls(contact: Contact) -> Iterator[tuple[float, float]]:
    """Contact radii between which the indentation falls."""
    if contact.law.iterative:
        params = contact.params
        radii: Floats = np.array(
            [
                contact.radius * contact.law.radius(params[place + j], params)
                for j in range(int(params[COUNT]))
                for place in (FOOT, TOP)[: 1 + (j < params[COUNT] - 1)]
            ]
        )
    else:
        radii = contact.pull_off("displacement")["contact_radius"]
    turns = [radii[0] * _LEAST, *radii.tolist()]
    yield from list(pairwise(turns))[::2]
