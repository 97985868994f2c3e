"""Public function of one asperity: its contact under a control."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.asperity.dataset import dataset_of
from roughmdr.asperity.tabor import resolved, warnings_of
from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_values, exactly_one
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.springs import Springs


def indent(
    shape: Shape | Callable[[Floats], Floats],
    *,
    indentation: ArrayLike | None = None,
    force: ArrayLike | None = None,
    contact_radius: ArrayLike | None = None,
    work: float | str = 0.0,
    method: Literal["exact", "springs"] = "exact",
    springs: int | None = None,
    **material: Unpack[AdhesiveMaterial],
) -> xr.Dataset:
    """Compute the contact of one asperity with an elastic half-space under one control.

    Parameters
    ----------
    shape : Shape or callable
        The profile; with method="springs" also a function f(r) [m] of an array of radii [m].
    indentation, force, contact_radius : array_like, shape () or (n,), optional
        Exactly one of them, in SI or as strings with a unit such as "2 nm". indentation [m]: the contact as on
        retraction; below its detachment force and contact radius are 0. force [N]: the branch that is stable under dead
        load. contact_radius [m]: the equilibrium with that radius, stable or not.
    work : float or str, optional
        Work of adhesion [J/m^2]; 0 for none.
    method, springs : {"exact", "springs"} and int, optional
        "springs" solves a row of so many springs (``roughmdr.springs``) in place of the exact contact.
    **material
        E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with counter_poisson).
        adhesion="dugdale" needs strength [Pa], with which the surfaces attract each other, or the range [m] of that,
        work/strength. "jkr", the default, then warns where the Tabor number is small. "auto" takes JKR where its
        pull-off force differs from Dugdale's by at most ``error`` (default 0.01) of it, else Dugdale.

    Returns
    -------
    xarray.Dataset
        Over the control, in the order given, without dimension for a number: force [N], indentation [m], contact_radius
        [m], contact_area [m2], stiffness [N/m] and, with "dugdale", cohesive_radius [m], up to which the surfaces
        attract each other. At the fold, where k is infinite, the stiffness is that of the next larger indentation. The
        attribute ``adhesion`` is the model that "auto" took.

    Raises
    ------
    OutOfRange
        Where an argument is out of its range (a force below the pull-off force, or below 0 without adhesion; a contact
        radius below 0), or a float cannot hold the answer.
    ShapeError, RoughmdrError
        Where the shape is none, or contact_radius does not determine the state; RoughmdrError unless exactly one
        control is given, and E* in exactly one way.

    References
    ----------
    .. [1] V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction (2015).
    .. [2] D. Maugis, J. Colloid Interface Sci. 150 (1992) 243, here for any shape.

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius="1 um")
    >>> contact = rm.indent(tip, modulus="70 GPa", poisson=0.3, indentation=["1 nm", "2 nm"])
    >>> [f"{force:.4g}" for force in contact.force.values]
    ['3.243e-06', '9.174e-06']
    """
    model = material.get("adhesion", "jkr")
    if method == "springs" and model != "jkr":
        raise RoughmdrError(f"adhesion is {model!r}; with method='springs' it must be 'jkr'")
    asked = Adhesion.from_arguments(work, material)
    control, raw = exactly_one("indent", indentation=indentation, force=force, contact_radius=contact_radius)
    unit = ASPERITY[control].units
    values = check_values(control, raw, unit)
    effective_modulus = effective_modulus_of(indent, material)
    taken = resolved(shape, effective_modulus, asked)
    contact = _contact(shape, effective_modulus, taken, method, springs)
    solve = {"indentation": contact.at_indentation, "force": contact.at_force, "contact_radius": contact.at_radius}
    with np.errstate(all="ignore"):  # what overflows is refused below
        results = {**solve[control](np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            raise OutOfRange(f"{name} at {control} = {np.atleast_1d(values)[lost][0]:g} {unit} is not representable")
    attrs = warn_limits(warnings_of(shape, results["contact_radius"], contact.effective_modulus, taken))
    attrs |= {"adhesion": taken.model} if asked.model == "auto" else {}
    return dataset_of({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control, attrs)


def _contact(
    shape: Shape | Callable[[Floats], Floats],
    effective_modulus: float,
    adhesion: Adhesion,
    method: str,
    springs: int | None,
) -> Contact | Springs:
    """Return the exact contact, or a row of springs."""
    if method not in ("exact", "springs"):
        raise RoughmdrError(f"method is {method!r}; it must be 'exact' or 'springs'")
    if method == "springs":
        from roughmdr.springs import Springs

        return Springs.of(shape, effective_modulus, adhesion.work, springs)
    if springs is not None:
        raise RoughmdrError(f"springs is {springs!r}; it goes with method='springs' only")
    if not isinstance(shape, Shape) and callable(shape):
        raise ShapeError(f"shape is {shape!r}; a function f(r) goes with method='springs' only")
    return Contact.of(shape, effective_modulus, adhesion)
