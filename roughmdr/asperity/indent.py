"""Public function of one asperity: its contact under a control."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.approach import at_indentation as approach_at_indentation
from roughmdr.asperity.contact import Contact, Results
from roughmdr.asperity.dataset import dataset_of
from roughmdr.asperity.on_machine import OnMachine, approach_at_force, check_machine_stiffness
from roughmdr.asperity.tabor import resolved, warnings_of
from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_values, exactly_one
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.springs import Springs


class IndentArguments(AdhesiveMaterial, total=False):
    """The elastic constants, how the surfaces attract each other, the machine, and the method."""

    machine_stiffness: float | str | None
    method: Literal["exact", "springs"]
    springs: int | None


@named_keywords
def indent(
    shape: Shape | Callable[[Floats], Floats],
    *,
    indentation: ArrayLike | None = None,
    force: ArrayLike | None = None,
    contact_radius: ArrayLike | None = None,
    remote: ArrayLike | None = None,
    approach: bool = False,
    work: float | str = 0.0,
    **given: Unpack[IndentArguments],
) -> xr.Dataset:
    """Compute the contact of one asperity with an elastic half-space under one control.

    Parameters
    ----------
    shape : Shape or callable
        The profile; with method="springs" also a function f(r) [m] of an array of radii [m].
    indentation, force, contact_radius, remote : array_like, shape () or (n,), optional
        Exactly one of them, in SI or as strings with a unit such as "2 nm". indentation [m]: the contact as on
        retraction; below its detachment force and contact radius are 0. force [N]: the branch that is stable under dead
        load. contact_radius [m]: the equilibrium with that radius, stable or not. remote [m]: a spring in series, such
        as a cantilever, holds the tip, and its far end has been moved by so much towards the surface past the point at
        which the slack spring just brings the tip to first touch. So the force is machine_stiffness (remote -
        indentation); the contact is as on retraction, and beyond its detachment the tip hangs free, at indentation =
        remote.
    approach : bool, optional
        Whether indentation, force and remote are for a slow approach from afar in place of a retraction. Without
        adhesion both are the same. JKR has no contact before first touch; Dugdale attracts from indentation = -range
        on. On a spring, or under a dead load of at least 0, the tip jumps to the first stable contact that it finds.
    work : float or str, optional
        Work of adhesion [J/m^2]; 0 for none.
    **given
        The machine: machine_stiffness [N/m], which goes with remote.
        The material: E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with
        counter_poisson). adhesion="dugdale" needs strength [Pa], with which the surfaces attract each other, or the
        range [m] of that, work/strength. "jkr", the default, then warns where the Tabor number is small. "auto" takes
        JKR where its pull-off force differs from Dugdale's by at most ``error`` (default 0.01) of it, else Dugdale.
        The method: method="springs" solves a row of so many springs (``roughmdr.springs``), an int, in place of the
        exact contact; as on retraction, under the other three controls.

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
        Where an argument is out of its range (a force below the pull-off force, or below 0 without adhesion or on
        approach; a contact radius below 0), or a float cannot hold the answer.
    ShapeError, RoughmdrError
        Where the shape is none, or contact_radius does not determine the state; RoughmdrError unless exactly one
        control is given, E* in exactly one way, and machine_stiffness with remote alone.

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
    >>> cantilever = {"effective_modulus": "1 GPa", "work": "50 mJ/m^2", "machine_stiffness": "40 N/m"}
    >>> held = rm.indent(tip, remote=["-2 nm", "0 nm"], **cantilever)
    >>> [f"{force:.4g}" for force in held.force.values]
    ['-1.302e-07', '-7.555e-08']
    >>> [f"{force:.4g}" for force in rm.indent(tip, remote=["-2 nm", "0 nm"], approach=True, **cantilever).force.values]
    ['0', '-7.555e-08']
    """
    method, springs, spring = (
        given.pop("method", "exact"),
        given.pop("springs", None),
        given.pop("machine_stiffness", None),
    )
    model = given.get("adhesion", "jkr")
    if method == "springs" and model != "jkr":
        raise RoughmdrError(f"adhesion is {model!r}; with method='springs' it must be 'jkr'")
    asked = Adhesion.from_arguments(work, given)
    controls = {"indentation": indentation, "force": force, "contact_radius": contact_radius, "remote": remote}
    control, raw = exactly_one("indent", **controls)
    unit = ASPERITY[control].units
    values = check_values(control, raw, unit)
    stiffness = check_machine_stiffness(spring, wanted=control == "remote")
    _check_combination(control, method, approach)
    effective_modulus = effective_modulus_of(indent, given)
    taken = resolved(shape, effective_modulus, asked)
    contact = _contact(shape, effective_modulus, taken, method, springs)
    solve = _solver(contact, control, stiffness, approach)
    with np.errstate(all="ignore"):  # overflow is refused below
        results = {**solve(np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            raise OutOfRange(f"{name} at {control} = {np.atleast_1d(values)[lost][0]:g} {unit} is not representable")
    attrs = warn_limits(warnings_of(shape, results["contact_radius"], contact.effective_modulus, taken))
    attrs |= {"adhesion": taken.model} if asked.model == "auto" else {}
    return dataset_of({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control, attrs)


def _check_combination(control: str, method: str, approach: bool) -> None:
    """Raise RoughmdrError where a control does not go with the method, or with an approach."""
    if not isinstance(approach, bool | np.bool_):
        raise RoughmdrError(f"approach is {approach!r}; it must be True or False")
    if approach and control == "contact_radius":
        raise RoughmdrError("approach is True; with contact_radius, which is of any equilibrium, it must be False")
    if method == "springs" and (approach or control == "remote"):
        given = "approach is True" if approach else "remote is given"
        raise RoughmdrError(f"{given}; with method='springs' a contact is as on retraction, without a machine")


def _solver(
    contact: Contact | Springs, control: str, machine_stiffness: float, approach: bool
) -> Callable[[Floats], Results]:
    """Return the function that computes the results at values of the control."""
    if isinstance(contact, Contact):
        if control == "remote":
            held = OnMachine.on_spring(contact, machine_stiffness)
            return held.on_approach if approach else held.on_retraction
        if approach and contact.kernels.adhesive:
            return partial(approach_at_indentation if control == "indentation" else approach_at_force, contact)
    at = {"indentation": contact.at_indentation, "force": contact.at_force, "contact_radius": contact.at_radius}
    return at[control]


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
