"""Public functions of the fields of one contact: pressure and displacement on the surface, stress on the axis below."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.fields.half_space import HalfSpace
from roughmdr.asperity.fields.integrals import DEEP, DISPLACEMENT, PRESSURE, STEEP
from roughmdr.errors import OutOfRange, RoughmdrError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import POISSON, effective_modulus_of
from roughmdr.shapes import Shape
from roughmdr.shapes.base import check_radii
from roughmdr.variables import FIELDS

if TYPE_CHECKING:
    import xarray as xr


@named_keywords
def pressure(
    shape: Shape,
    *,
    r: ArrayLike,
    contact_radius: float | str | None = None,
    indentation: float | str | None = None,
    work: float | str = 0.0,
    **material: Unpack[AdhesiveMaterial],
) -> xr.DataArray:
    """Compute the normal pressure on the surface, compression positive; 0 outside the contact.

    p = (E*/pi) ∫_r^a g'(x)/sqrt(x^2 - r^2) dx - E* dl(a)/(pi sqrt(a^2 - r^2)), for a flat punch
    (E*/pi) delta/sqrt(b^2 - r^2). With adhesion="dugdale", in place of the term of dl,
    -(2/pi) strength atan(sqrt((c^2 - a^2)/(a^2 - r^2))), and p = -strength from a to the cohesive radius c.

    Parameters
    ----------
    shape, **material
        The profile, and E*, adhesion, strength, range and error as in ``indent``.
    r : array_like, shape () or (n,)
        Distances from the axis [m], at least 0.
    contact_radius, indentation : float or str, optional
        One of them [m]: the equilibrium with that radius, or the contact as on retraction; p is 0 out of contact.
    work : float or str, optional
        Work of adhesion [J/m^2]; 0 for none.

    Returns
    -------
    xarray.DataArray
        p [Pa] over r.

    Raises
    ------
    OutOfRange
        Where an argument is out of its range, or p is infinite: at the edge of the contact with JKR and of a flat punch
        that is pressed, at a corner within the contact, and at the tip where the profile is sharp, f'(0+) > 0.
    ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction (2015).

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius="1 um")
    >>> p = rm.pressure(tip, r=["0 nm", "20 nm", "60 nm"], contact_radius="50 nm", effective_modulus="1 GPa")
    >>> [f"{value:.4g}" for value in p.values]
    ['3.183e+07', '2.917e+07', '0']
    >>> attraction = {"work": "50 mJ/m^2", "adhesion": "dugdale", "strength": "100 MPa"}
    >>> p = rm.pressure(tip, r=["0 nm", "52 nm"], contact_radius="50 nm", effective_modulus="1 GPa", **attraction)
    >>> [f"{value:.4g}" for value in p.values]
    ['8.488e+06', '-1e+08']
    """
    asked = Adhesion.from_arguments(work, material)
    modulus = effective_modulus_of(pressure, material)
    state = HalfSpace.of(shape, modulus, asked, contact_radius=contact_radius, indentation=indentation)
    values = check_radii("r", check_values("r", r, "m"))
    at = np.atleast_1d(values)
    state.refuse_singular("r", at)
    p, inside = np.zeros_like(at), at < state.radius
    with np.errstate(all="ignore"):
        p[inside] = modulus / math.pi * state.total(PRESSURE, at[inside])
    if state.zone is not None:
        p[~inside & (at < state.reach)] = -state.zone.strength
    return _array("pressure", p, values, warn_limits(state.warnings))


@named_keywords
def surface_displacement(
    shape: Shape,
    *,
    r: ArrayLike,
    contact_radius: float | str | None = None,
    indentation: float | str | None = None,
    work: float | str = 0.0,
    **material: Unpack[AdhesiveMaterial],
) -> xr.DataArray:
    """Compute the normal displacement of the surface, positive into the half-space.

    Inside the contact u = delta - f(r), outside (2/pi) ∫_0^a (delta - g(x))/sqrt(r^2 - x^2) dx, far away P/(pi E* r).
    With adhesion="dugdale" outside less (4/pi) (strength/E*) ∫_a^min(r,c) sqrt((c^2 - x^2)/(r^2 - x^2)) dx.

    Parameters
    ----------
    shape, r, contact_radius, indentation, work, **material
        As ``pressure``.

    Returns
    -------
    xarray.DataArray
        u [m] over r; finite everywhere.

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``pressure``, but for its infinities.

    References
    ----------
    .. [1] V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction (2015).

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius="1 um")
    >>> u = rm.surface_displacement(tip, r=["0 nm", "1 um"], indentation="2 nm", effective_modulus="1 GPa")
    >>> [f"{value:.4g}" for value in u.values]
    ['2e-09', '3.797e-11']
    """
    asked = Adhesion.from_arguments(work, material)
    modulus = effective_modulus_of(surface_displacement, material)
    state = HalfSpace.of(shape, modulus, asked, contact_radius=contact_radius, indentation=indentation)
    values = check_radii("r", check_values("r", r, "m"))
    at = np.atleast_1d(values)
    u = np.zeros_like(at)
    if state.reach > 0.0:
        inside = (at <= state.radius) & (state.radius > 0.0)
        with np.errstate(all="ignore"):
            u[inside] = state.indentation - shape.f(at[inside])
            u[~inside] = 2.0 / math.pi * state.total(DISPLACEMENT, at[~inside])
    return _array("surface_displacement", u, values, warn_limits(state.warnings))


@named_keywords
def axis_stress(
    shape: Shape,
    *,
    z: ArrayLike,
    contact_radius: float | str | None = None,
    indentation: float | str | None = None,
    work: float | str = 0.0,
    **material: Unpack[AdhesiveMaterial],
) -> xr.Dataset:
    """Compute the stress on the axis below the contact, tension positive.

    The contact is a superposition of flat punches of radius x under dg.

    Parameters
    ----------
    shape, contact_radius, indentation, work
        As ``pressure``.
    z : array_like, shape () or (n,)
        Depths [m], at least 0; 0 is refused where the pressure is infinite at r = 0.
    **material
        poisson [1] of the half-space in any case; with it effective_modulus [Pa], or modulus [Pa] as in ``indent``.
        Of adhesion "jkr" only.

    Returns
    -------
    xarray.Dataset
        Over z: sigma_zz, sigma_rr and shear = ``|sigma_zz - sigma_rr|/2`` [Pa]. Without dimension: largest_shear
        [Pa] of all depths, and largest_shear_depth [m] (0 on the surface), left out where the profile is sharp,
        f'(0+) > 0: there the shear grows without bound towards the tip, as (1/2 - poisson) ln(1/z) for a cone.

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``pressure``; RoughmdrError also without poisson.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), section 3.4.

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius="1 um")
    >>> stress = rm.axis_stress(tip, z="24 nm", contact_radius="50 nm", modulus="1 GPa", poisson=0.3)
    >>> f"{float(stress.largest_shear_depth):.3g}"  # 0.48 of the contact radius
    '2.4e-08'
    """
    asked = Adhesion.from_arguments(work, material)
    if asked.model != "jkr":
        raise RoughmdrError(f"adhesion is {asked.model!r}; axis_stress takes adhesion='jkr' only")
    if material.get("poisson") is None:
        raise RoughmdrError("axis_stress needs the poisson of the half-space, with effective_modulus as with modulus")
    poisson = POISSON.argument("poisson", material["poisson"])
    if material.get("effective_modulus") is not None and material.get("modulus") is None:
        del material["poisson"]
    modulus = effective_modulus_of(axis_stress, material)
    state = HalfSpace.of(shape, modulus, asked, contact_radius=contact_radius, indentation=indentation)
    values = check_radii("z", check_values("z", z, "m"))
    at = np.atleast_1d(values)
    state.refuse_singular("z", at, only=0.0)
    stress, weights = modulus / math.pi, (0.5 - poisson, 3.5 - poisson)
    with np.errstate(all="ignore"):
        steep, deep = state.below(STEEP, at), state.below(DEEP, at)
        results = {
            "sigma_zz": -stress * (steep + 3.0 * deep),
            "sigma_rr": -stress * ((0.5 + poisson) * steep + (poisson - 0.5) * deep),
            "shear": 0.5 * stress * np.abs(weights[0] * steep + weights[1] * deep),
        }
        results = {name: numbers.reshape(values.shape) for name, numbers in results.items()}
        if not state.sharp:
            depth, shear = state.largest_shear(*weights)
            results |= {"largest_shear": np.array(0.5 * stress * shear), "largest_shear_depth": np.array(depth)}
    return _dataset(results, "z", values, warn_limits(state.warnings))


def _dataset(results: dict[str, Floats], name: str, at: Floats, attrs: dict[str, str]) -> xr.Dataset:
    """Return ``results`` over the coordinate ``name``, or without dimension; OutOfRange where they are not finite."""
    import xarray as xr

    for variable, numbers in results.items():
        lost = np.atleast_1d(~np.isfinite(numbers))
        if lost.any():
            where = f" at {name} = {np.atleast_1d(at)[lost][0]:g} m" if numbers.shape == at.shape else ""
            raise OutOfRange(f"{variable}{where} is not representable")
    dims = (name,) if at.ndim else ()
    return xr.Dataset(
        {key: (dims if numbers.ndim else (), numbers, FIELDS[key].attrs) for key, numbers in results.items()},
        coords={name: (dims, at, FIELDS[name].attrs)},
        attrs=attrs,
    )


def _array(variable: str, values: Floats, at: Floats, attrs: dict[str, str]) -> xr.DataArray:
    return _dataset({variable: values.reshape(at.shape)}, "r", at, {})[variable].assign_attrs(attrs)
