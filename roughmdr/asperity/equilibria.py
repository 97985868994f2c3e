"""Every equilibrium of one asperity at a given indentation, stable or not."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Unpack

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.asperity.tabor import resolved
from roughmdr.asperity.unstable import Equilibrium, unstable
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.kernels.profile.layout import COUNT
from roughmdr.schema.arguments import check_scalar
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr


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
