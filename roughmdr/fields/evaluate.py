"""The fields of one contact: pressure and displacement on the surface of the half-space, stress on the axis below."""

import math
import warnings
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import LimitWarning, OutOfRange
from roughmdr.fields.half_space import HalfSpace, one_number
from roughmdr.fields.quadrature import DEEP, DISPLACEMENT, PRESSURE, STEEP
from roughmdr.numerics.arguments import Floats, check_values
from roughmdr.shapes import Shape
from roughmdr.shapes.base import check_radii
from roughmdr.variables import FIELDS

if TYPE_CHECKING:
    import xarray as xr


def pressure(
    shape: Shape,
    *,
    r: ArrayLike,
    contact_radius: float | None = None,
    indentation: float | None = None,
    effective_modulus: float,
    work: float = 0.0,
) -> "xr.DataArray":
    """The normal pressure p(r) [Pa] on the surface, compression > 0 (H 42); 0 outside the contact.

    r [m] is a number or a one-dimensional array, from 0 on. The state is told by one number: ``contact_radius`` [m],
    the equilibrium with that radius (ShapeError for a flat punch), or ``indentation`` [m], the contact as on
    retraction, where out of contact p is 0. effective_modulus is E* [Pa], work the work of adhesion [J/m^2].

    p = (E*/pi) ∫_r^a g'(x)/sqrt(x^2 - r^2) dx - E* dl(a)/(pi sqrt(a^2 - r^2)), for a flat punch
    (E*/pi) delta/sqrt(b^2 - r^2). OutOfRange where p is infinite: at the edge of the contact with adhesion and of a
    flat punch, at a corner within the contact, and at the tip where the profile is sharp, f'(0+) > 0.
    """
    state = HalfSpace.of(shape, effective_modulus, work, contact_radius, indentation)
    values = check_radii("r", check_values("r", r))
    at = np.atleast_1d(values)
    state.refuse_singular("r", at)
    found = np.zeros_like(at)
    inside = at < state.radius
    with np.errstate(all="ignore"):
        found[inside] = state.effective_modulus / math.pi * state.total(PRESSURE, at[inside])
    return _array("pressure", found, values, _attributed(state))


def surface_displacement(
    shape: Shape,
    *,
    r: ArrayLike,
    contact_radius: float | None = None,
    indentation: float | None = None,
    effective_modulus: float,
    work: float = 0.0,
) -> "xr.DataArray":
    """The normal displacement u(r) [m] of the surface, positive into the half-space.

    Arguments and errors as ``pressure``, but for its infinities: u is finite everywhere. Inside the contact
    u = delta - f(r), outside (2/pi) ∫_0^a (delta - g(x))/sqrt(r^2 - x^2) dx, far away P/(pi E* r).
    """
    state = HalfSpace.of(shape, effective_modulus, work, contact_radius, indentation)
    values = check_radii("r", check_values("r", r))
    at = np.atleast_1d(values)
    found = np.zeros_like(at)
    if state.radius > 0.0:
        inside = at <= state.radius
        with np.errstate(all="ignore"):
            found[inside] = state.indentation - shape.f(at[inside])
            found[~inside] = 2.0 / math.pi * state.total(DISPLACEMENT, at[~inside])
    return _array("surface_displacement", found, values, _attributed(state))


def axis_stress(
    shape: Shape,
    *,
    z: ArrayLike,
    contact_radius: float | None = None,
    indentation: float | None = None,
    effective_modulus: float,
    work: float = 0.0,
    poisson: float,
) -> "xr.Dataset":
    """The stress on the axis at depths z [m], from 0 on, tension > 0: sigma_zz, sigma_rr and the shear [Pa].

    The shear is |sigma_zz - sigma_rr|/2. ``largest_shear`` [Pa] is the largest of all depths, and
    ``largest_shear_depth`` [m] its place (0 on the surface); both are left out where the profile is sharp, f'(0+) > 0,
    since there the shear grows without bound towards the tip (as (1/2 - poisson) ln(1/z) for a cone).

    poisson, above -1 and at most 1/2, is that of the half-space. Other arguments and errors as ``pressure``; z = 0 is
    refused where the pressure is infinite at r = 0. From flat punches of radius x under dg (K. L. Johnson, Contact
    Mechanics, 1985, section 3.4).
    """
    state = HalfSpace.of(shape, effective_modulus, work, contact_radius, indentation)
    if not -1.0 < one_number("poisson", poisson) <= 0.5:
        raise OutOfRange(f"poisson is {poisson:g}; it must be above -1 and at most 0.5")
    values = check_radii("z", check_values("z", z))
    at = np.atleast_1d(values)
    state.refuse_singular("z", at, only=0.0)
    stress = state.effective_modulus / math.pi
    mixed = 0.5 - poisson, 3.5 - poisson
    with np.errstate(all="ignore"):
        steep, deep = state.below(STEEP, at), state.below(DEEP, at)
        results = {
            "sigma_zz": -stress * (steep + 3.0 * deep),
            "sigma_rr": -stress * ((0.5 + poisson) * steep + (poisson - 0.5) * deep),
            "shear": 0.5 * stress * np.abs(mixed[0] * steep + mixed[1] * deep),
        }
        results = {name: numbers.reshape(values.shape) for name, numbers in results.items()}
        if not state.sharp:
            depth, shear = state.largest_shear(*mixed)
            results |= {"largest_shear": np.array(0.5 * stress * shear), "largest_shear_depth": np.array(depth)}
    return _dataset(results, "z", values, _attributed(state))


def _attributed(state: HalfSpace) -> dict[str, str]:
    """The attributes that say what is doubtful; each doubt is a LimitWarning too."""
    for text in state.warnings:
        warnings.warn(text, LimitWarning, stacklevel=3)
    return {"warnings": "\n".join(state.warnings)} if state.warnings else {}


def _dataset(results: dict[str, Floats], name: str, at: Floats, attrs: dict[str, str]) -> "xr.Dataset":
    """``results`` over the coordinate ``name``, numbers without dimension; OutOfRange where they are not finite."""
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


def _array(variable: str, found: Floats, at: Floats, attrs: dict[str, str]) -> "xr.DataArray":
    return _dataset({variable: found.reshape(at.shape)}, "r", at, {})[variable].assign_attrs(attrs)
