"""Public functions of one asperity: its contact under a control, its pull-off and its Tabor number."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity import validity
from roughmdr.asperity.contact import Contact, Results
from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial, tabor_number
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, check_values, exactly_one
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.springs import Springs

_PULL_OFFS = {"force": "at the largest tension", "displacement": "at the point of detachment under fixed grips"}
"""The two ends of a slow retraction, by its control."""


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
    taken = _resolved(shape, effective_modulus, asked)
    contact = _contact(shape, effective_modulus, taken, method, springs)
    solve = {"indentation": contact.at_indentation, "force": contact.at_force, "contact_radius": contact.at_radius}
    with np.errstate(all="ignore"):  # what overflows is refused below
        results = {**solve[control](np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            raise OutOfRange(f"{name} at {control} = {np.atleast_1d(values)[lost][0]:g} {unit} is not representable")
    attrs = warn_limits(_warnings(shape, results["contact_radius"], contact.effective_modulus, taken))
    attrs |= {"adhesion": taken.model} if asked.model == "auto" else {}
    return _dataset({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control, attrs)


def pull_off(
    shape: Shape,
    *,
    work: float | str,
    control: Literal["force", "displacement"] = "force",
    **material: Unpack[AdhesiveMaterial],
) -> xr.Dataset:
    """Find the pull-off of one asperity: the largest tension that its contact bears.

    With ``control="displacement"`` find the point of detachment under fixed grips, which is something else: the least
    indentation at which there is a contact. The tension there is mostly less, since it has passed its largest.

    Parameters
    ----------
    shape, work, **material
        Profile, work of adhesion [J/m^2], and E*, adhesion, strength, range and error as in ``indent``.
    control : {"force", "displacement"}, optional
        Slow retraction under dead load, which ends at the pull-off force, or under fixed grips.

    Returns
    -------
    xarray.Dataset
        Scalars: force [N], indentation [m], contact_radius [m] and, with "dugdale", cohesive_radius [m]; all 0 without
        adhesion. Their long_name and the attribute ``control`` say which of the two points it is.

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301.
    .. [2] D. Maugis, J. Colloid Interface Sci. 150 (1992) 243.

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius=1e-6)
    >>> off = rm.pull_off(tip, effective_modulus="1 GPa", work="50 mJ/m^2")
    >>> f"{float(off.force):.4g}"  # -3/2 pi w R
    '-2.356e-07'
    >>> grips = rm.pull_off(tip, effective_modulus="1 GPa", work="50 mJ/m^2", control="displacement")
    >>> f"{float(grips.force / off.force):.4g}"  # 5/9
    '0.5556'
    """
    if control not in _PULL_OFFS:
        raise RoughmdrError(f"control is {control!r}; it must be 'force' or 'displacement'")
    wanted = Adhesion.from_arguments(work, material)
    effective_modulus = effective_modulus_of(pull_off, material)
    asked = _resolved(shape, effective_modulus, wanted)
    contact = Contact.of(shape, effective_modulus, asked)
    names = ["force", "indentation", "contact_radius", *(["cohesive_radius"] if asked.model == "dugdale" else [])]
    if not contact.law.adhesive:
        return _at_pull_off({name: np.zeros(()) for name in names}, control, {})
    with np.errstate(all="ignore"):
        results = contact.pull_off(control)
    radius = results["contact_radius"]
    for name in names:
        if not np.isfinite(results[name]).all() or (asked.model == "jkr" and (radius == 0.0).any()):
            given = f"effective modulus {contact.effective_modulus:g} Pa, work {asked.work:g} J/m^2, {shape}"
            raise OutOfRange(f"{name} at pull-off is not representable: {given}")
    attrs = warn_limits(_warnings(shape, radius, contact.effective_modulus, asked))
    attrs |= {"adhesion": asked.model} if wanted.model == "auto" else {}
    return _at_pull_off({name: results[name].reshape(()) for name in names}, control, attrs)


def tabor(
    shape: Shape,
    *,
    work: float | str,
    strength: float | str | None = None,
    range: float | str | None = None,  # noqa: A002 - as in a scene
    **material: Unpack[MaterialArguments],
) -> float:
    """Compute the Tabor number dl(a) strength/(pi^(2/3) work) of a contact.

    dl(a) = sqrt(2 pi a work/E*), and a is the radius at which JKR detaches under fixed grips.
    Where the number is large JKR holds; where it is small the attraction reaches far beyond the contact (DMT). For the
    paraboloid it is (R work^2/E*^2)^(1/3) strength/work.

    Parameters
    ----------
    shape, **material
        Profile and E* as in ``indent``.
    work : float or str
        Work of adhesion [J/m^2], above 0.
    strength, range : float or str, optional
        One of both: the stress of the attraction [Pa], or its range work/strength [m], above 0.

    Returns
    -------
    float
        The Tabor number [1].

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] D. Tabor, J. Colloid Interface Sci. 58 (1977) 2.

    Examples
    --------
    >>> import roughmdr as rm
    >>> round(rm.tabor(rm.Paraboloid(radius=1e-6), effective_modulus=1e9, work=0.05, strength="5 MPa"), 3)
    0.136
    """
    exactly_one("tabor", strength=strength, range=range)
    asked = Adhesion.checked("jkr", check_number("work", work, "J/m^2"), strength, range)
    return _tabor(shape, effective_modulus_of(tabor, material), asked)


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


def _resolved(shape: object, effective_modulus: float, adhesion: Adhesion) -> Adhesion:
    """Return the model itself: for "auto" JKR where its pull-off force is near enough to Dugdale's."""
    if adhesion.model != "auto" or not isinstance(shape, Shape) or adhesion.work == 0.0:
        return adhesion.resolved(0.0)
    try:
        with np.errstate(all="ignore"):  # a contact that is not representable has no finite force
            jkr, dugdale = (
                float(
                    Contact.of(shape, effective_modulus, adhesion._replace(model=model)).pull_off("force")["force"][0]
                )
                for model in adhesion.candidates
            )
    except OutOfRange:
        return adhesion.resolved(math.inf)
    known = math.isfinite(jkr) and math.isfinite(dugdale) and dugdale < 0.0
    return adhesion.resolved(abs(jkr / dugdale - 1.0) if known else math.inf)


def _tabor(shape: Shape, effective_modulus: float, adhesion: Adhesion) -> float:
    contact = Contact.of(shape, effective_modulus, Adhesion(adhesion.work))
    radius = float(contact.pull_off("displacement")["contact_radius"][0])
    return tabor_number(radius, effective_modulus, adhesion.work, adhesion.strength)


def _warnings(shape: object, radius: Floats, effective_modulus: float, adhesion: Adhesion) -> list[str]:
    """Return warnings of contact radii [m] of a shape, or a range of its adhesion, for which the theory is doubtful."""
    if not isinstance(shape, Shape):
        return []
    limits = validity.ValidityLimits.of(radius, shape.df(radius), np.array(shape.end))
    if adhesion.model == "jkr" and adhesion.tabor_known:
        limits = limits._replace(tabor=_tabor(shape, effective_modulus, adhesion))
    return limits.warnings


def _at_pull_off(results: Results, control: str, attrs: dict[str, str]) -> xr.Dataset:
    """Return scalars as a dataset that says which point they are of."""
    dataset = _dataset(results, None, {"control": control, **attrs})
    for array in dataset.values():
        array.attrs["long_name"] += f", {_PULL_OFFS[control]}"
    return dataset


def _dataset(results: Results, control: str | None, attrs: dict[str, str]) -> xr.Dataset:
    import xarray as xr

    arrays = {name: ((control,) if n.ndim else (), n, ASPERITY[name].attrs) for name, n in results.items()}
    coords = {} if control is None else {control: arrays.pop(control)}
    return xr.Dataset(arrays, coords=coords, attrs=attrs)
