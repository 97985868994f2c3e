"""Every equilibrium of one asperity at a given indentation, stable or not."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Unpack

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, release_stretch
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP
from roughmdr.schema.arguments import check_scalar
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

_SMALLEST = 1e-150  # of the radius of the first fold: where the search for a small contact begins


def equilibria(
    shape: Shape, *, work: float | str, indentation: float | str, **material: Unpack[MaterialArguments]
) -> xr.Dataset:
    """Find all contact radii in equilibrium at an indentation, from the smallest to the largest.

    ``indent`` gives the largest of those that are stable under fixed grips.

    Parameters
    ----------
    shape, **material
        The profile, and E* as in ``indent``.
    work, indentation : float or str
        Work of adhesion [J/m^2], with JKR, 0 for none; approach past first touch [m].

    Returns
    -------
    xarray.Dataset
        Over ``equilibrium``, of size 0 where there is no contact: contact_radius [m], force [N], contact_area [m2],
        stiffness [N/m]; stable_displacement and stable_force, whether it is stable under fixed grips and under dead
        load.

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
    """
    import xarray as xr

    delta = check_scalar("indentation", indentation, "m")
    effective_modulus = effective_modulus_of(equilibria, material)
    contact = Contact.of(shape, effective_modulus, Adhesion.checked("jkr", work, None))
    with np.errstate(all="ignore"):  # what overflows is refused below
        states = sorted([*_stable(contact, delta), *_unstable(contact, delta)])
    a, force, stiffness = np.array(states, dtype=np.float64).reshape(-1, 3).T
    results = {"contact_radius": a, "force": force, "contact_area": math.pi * a * a, "stiffness": stiffness}
    for name, values in results.items():
        if not np.isfinite(values).all():
            raise OutOfRange(f"{name} at indentation = {delta:g} m is not representable")
    # k/(2 E* a) = (r - 3)/(r - 1) with r = 2 a g'/dl: below 1 where stable under fixed grips (r > 1), above 3
    # elsewhere.
    stable = stiffness <= 4.0 * effective_modulus * a
    stable_force = stable & (stiffness > 0.0)
    data = {name: ("equilibrium", values, ASPERITY[name].attrs) for name, values in results.items()} | {
        "stable_displacement": ("equilibrium", stable, {"long_name": "stable under fixed grips"}),
        "stable_force": ("equilibrium", stable_force, {"long_name": "stable under dead load"}),
    }
    return xr.Dataset(data, coords={"indentation": ((), delta, ASPERITY["indentation"].attrs)})


def _stable(contact: Contact, delta: float) -> Iterator[tuple[float, float, float]]:
    """Yield contact radius, force and stiffness on each branch that is stable under fixed grips at delta."""
    law = contact.law
    onset = -contact.depth[0] if law.adhesive else 0.0
    if delta < onset or (delta == 0.0 and not law.adhesive):
        return
    if law.branched and delta > onset:
        x = float(contact.reduced(np.array([delta]), contact.depth)[0])
        for number in range(1, int(contact.params[COUNT]) + 1):
            # The branch extends to delta if a contact that is put on it stays on it.
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
    """Yield contact radius, force and stiffness between two branches, where delta falls as a grows."""
    from scipy.optimize import brentq

    if not contact.law.adhesive:
        return
    shape, effective_modulus = contact.shape, contact.effective_modulus
    edge = contact.radius if shape.flat else 0.0

    def stretch(a: float) -> float:
        return release_stretch(a, effective_modulus, contact.adhesion.work)

    def excess(log_a: float, maximum: float) -> float:
        a = min(math.exp(log_a), maximum)
        g = 0.0 if a <= edge else float(shape.g(a))
        return g - stretch(a) - delta

    for low, high in _falling_ranges(contact):
        ends = math.log(low), math.log(high)
        if not (excess(ends[0], high) > 0.0 > excess(ends[1], high)):
            continue
        a = math.exp(float(brentq(excess, *ends, (high,), xtol=1e-15, rtol=1e-15)))
        if a < edge:
            yield a, -2.0 * effective_modulus * a * stretch(a), 6.0 * effective_modulus * a
        else:
            results = contact.at_radius(np.array([a]))
            yield a, float(results["force"][0]), float(results["stiffness"][0])


def _falling_ranges(contact: Contact) -> Iterator[tuple[float, float]]:
    """Yield pairs of contact radii between which the indentation falls."""
    if contact.law.iterative:
        params = contact.params
        count = int(params[COUNT])
        turns = [params[column + j] for j in range(count) for column in (FOOT, TOP)[: 1 + (j < count - 1)]]
        radii = [float(contact.radius * contact.law.radius(turn, params)) for turn in turns]
    else:
        radii = contact.pull_off("displacement")["contact_radius"].tolist()
    yield from list(pairwise([radii[0] * _SMALLEST, *radii]))[::2]
