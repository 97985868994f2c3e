"""One asperity's face: indentation, force or contact radius in, the whole state of the contact out, as xarray."""

import math
import warnings
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from roughmdr import limits
from roughmdr.arguments import Floats, check_values
from roughmdr.contact import Contact
from roughmdr.errors import LimitWarning, OutOfRange, RoughmdrError
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr


def indent(
    shape: Shape,
    *,
    modulus: float,
    work: float = 0.0,
    indentation: ArrayLike | None = None,
    force: ArrayLike | None = None,
    contact_radius: ArrayLike | None = None,
    adhesion: Literal["jkr"] = "jkr",
) -> "xr.Dataset":
    """The contact of one asperity with an elastic half-space, exact (H 16, 25 without adhesion; H 40-41, 44 with JKR).

    Exactly one control is given, as a number or a one-dimensional array:

    indentation : [m]
        The contact as on retraction; out of contact (beyond pull-off) force and contact radius are 0.
    force : [N]
        The branch that is stable under dead load. OutOfRange below the pull-off force (without adhesion: below 0).
    contact_radius : [m]
        The equilibrium with that radius, stable or not. OutOfRange below 0.

    modulus is E* [Pa], work the work of adhesion [J/m^2]; 0 means none. The result is a Dataset over the control
    (same order; a number gives a 0-d Dataset): force [N], indentation [m], contact_radius [m], contact_area [m2],
    stiffness [N/m]. At the fold the stiffness is its finite value one rounding step above.

    Raises OutOfRange where an argument is out of its range or a float cannot hold the answer.
    """
    if adhesion != "jkr":
        raise RoughmdrError(f"adhesion is {adhesion!r}; it must be 'jkr'")
    controls = {"indentation": indentation, "force": force, "contact_radius": contact_radius}
    given = {name: value for name, value in controls.items() if value is not None}
    if len(given) != 1:
        names = " and ".join(given) or "none"
        raise RoughmdrError(f"got {names}; indent takes exactly one of indentation, force, contact_radius")
    ((control, raw),) = given.items()
    values = check_values(control, raw)
    contact = Contact.of(shape, modulus, work)
    solve = {"indentation": contact.at_indentation, "force": contact.at_force, "contact_radius": contact.at_radius}
    with np.errstate(all="ignore"):  # what overflows is refused below
        results = {**solve[control](np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            worst = np.atleast_1d(values)[lost][0]
            raise OutOfRange(f"{name} at {control} = {worst:g} {ASPERITY[control].units} is not representable")
    extremes = limits.Extremes.of(results["contact_radius"], shape.df(results["contact_radius"]), np.array(shape.end))
    return _dataset({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control, extremes)


def pull_off(
    shape: Shape, *, modulus: float, work: float, control: Literal["displacement", "force"] = "displacement"
) -> "xr.Dataset":
    """Where a slow retraction lets go: under fixed grips ("displacement") or dead load ("force").

    The global minimum of delta(a), or of P(a). modulus is E* [Pa], work [J/m^2]. Returns a Dataset of
    scalars: force [N], indentation [m], contact_radius [m]; all 0 without adhesion. Raises OutOfRange as ``indent``.
    """
    if control not in ("displacement", "force"):
        raise RoughmdrError(f"control is {control!r}; it must be 'displacement' or 'force'")
    contact = Contact.of(shape, modulus, work)
    if not contact.law.adhesive:
        none = {name: np.zeros(()) for name in ("force", "indentation", "contact_radius")}
        return _dataset(none, None, limits.Extremes())
    with np.errstate(all="ignore"):
        results = contact.pull_off(control)
    radius = results["contact_radius"]
    for name, numbers in results.items():
        if not np.isfinite(numbers).all() or (radius == 0.0).any():
            raise OutOfRange(
                f"{name} at pull-off is not representable: modulus {modulus:g} Pa, work {work:g} J/m^2, {shape}"
            )
    extremes = limits.Extremes.of(radius, shape.df(radius), np.array(shape.end))
    names = ("force", "indentation", "contact_radius")
    return _dataset({name: results[name].reshape(()) for name in names}, None, extremes)


def _dataset(results: dict[str, Floats], control: str | None, extremes: limits.Extremes) -> "xr.Dataset":
    """The results over the control, with what is doubtful about them; each doubt is a LimitWarning too."""
    import xarray as xr

    for text in extremes.warnings:
        warnings.warn(text, LimitWarning, stacklevel=3)

    def dims(numbers: Floats) -> tuple[str, ...]:
        return (control,) if control is not None and numbers.ndim else ()

    return xr.Dataset(
        {name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name != control},
        coords={name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name == control},
        attrs={"warnings": "\n".join(extremes.warnings)} if extremes.warnings else {},
    )
