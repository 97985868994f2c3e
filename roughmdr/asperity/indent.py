"""One asperity's face: indentation, force or contact radius in, the whole state of the contact out, as xarray."""

import math
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity import validity
from roughmdr.asperity.contact import Contact
from roughmdr.errors import LimitWarning, OutOfRange, RoughmdrError, ShapeError
from roughmdr.kernels.adhesion import Adhesion, Model, tabor_number
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.shapes import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.springs import Springs


def indent(
    shape: Shape | Callable[[Floats], Floats],
    *,
    effective_modulus: float,
    work: float = 0.0,
    indentation: ArrayLike | None = None,
    force: ArrayLike | None = None,
    contact_radius: ArrayLike | None = None,
    adhesion: Model = "jkr",
    strength: float | None = None,
    method: Literal["exact", "springs"] = "exact",
    springs: int | None = None,
) -> "xr.Dataset":
    """The contact of one asperity with an elastic half-space, exact (H 16, 25 without adhesion; H 40-41, 44 with JKR).

    adhesion "dugdale" has a range: the surfaces attract each other with the stress ``strength`` [Pa] up to a gap of
    work/strength (D. Maugis, J. Colloid Interface Sci. 150 (1992) 243, here for any shape).

    Exactly one control is given, as a number or a one-dimensional array:

    indentation : [m]
        The contact as on retraction; beyond pull-off force and contact radius are 0.
    force : [N]
        The branch that is stable under dead load. OutOfRange below the pull-off force (without adhesion: below 0).
    contact_radius : [m]
        The equilibrium with that radius, stable or not. OutOfRange below 0; with "dugdale" ShapeError for 0.

    effective_modulus is E* [Pa], work the work of adhesion [J/m^2]; 0 means none. The result is a Dataset over the
    control (same order; a number gives a 0-d Dataset): force [N], indentation [m], contact_radius [m], contact_area
    [m2], stiffness [N/m], and with "dugdale" cohesive_radius [m], up to which the surfaces attract each other. At the
    fold the stiffness is its finite value one rounding step above. With "jkr" a ``strength`` makes for a warning where
    the Tabor number is small.

    With method="springs" a row of ``springs`` springs takes the place of the closed forms (``roughmdr.springs``); the
    shape may then be a function f(r) [m] of an array of radii [m] too.

    Raises OutOfRange where an argument is out of its range or a float cannot hold the answer.
    """
    if method == "springs" and adhesion != "jkr":
        raise RoughmdrError(f"adhesion is {adhesion!r}; with method='springs' it must be 'jkr'")
    controls = {"indentation": indentation, "force": force, "contact_radius": contact_radius}
    given = {name: value for name, value in controls.items() if value is not None}
    if len(given) != 1:
        names = " and ".join(given) or "none"
        raise RoughmdrError(f"got {names}; indent takes exactly one of indentation, force, contact_radius")
    ((control, raw),) = given.items()
    values = check_values(control, raw)
    contact = _contact(shape, effective_modulus, Adhesion.checked(adhesion, work, strength), method, springs)
    solve = {"indentation": contact.at_indentation, "force": contact.at_force, "contact_radius": contact.at_radius}
    with np.errstate(all="ignore"):  # what overflows is refused below
        results = {**solve[control](np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            worst = np.atleast_1d(values)[lost][0]
            raise OutOfRange(f"{name} at {control} = {worst:g} {ASPERITY[control].units} is not representable")
    extremes = validity.ValidityLimits()
    if isinstance(shape, Shape):
        radius = results["contact_radius"]
        extremes = validity.ValidityLimits.of(radius, shape.df(radius), np.array(shape.end))
    doubts = [*extremes.warnings, *_short_range(shape, effective_modulus, work, adhesion, strength)]
    return _dataset({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control, doubts)


def _contact(
    shape: Shape | Callable[[Floats], Floats],
    effective_modulus: float,
    adhesion: Adhesion,
    method: str,
    springs: int | None,
) -> "Contact | Springs":
    """The contact by its closed forms, or as a row of springs."""
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


def pull_off(
    shape: Shape,
    *,
    effective_modulus: float,
    work: float,
    control: Literal["displacement", "force"] = "displacement",
    adhesion: Model = "jkr",
    strength: float | None = None,
) -> "xr.Dataset":
    """Where a slow retraction lets go: under fixed grips ("displacement") or dead load ("force").

    The global minimum of delta(a), or of P(a). effective_modulus is E* [Pa], work [J/m^2]. Returns a Dataset of
    scalars: force [N], indentation [m], contact_radius [m], with "dugdale" cohesive_radius [m]; all 0 without adhesion.
    Raises OutOfRange as ``indent``.
    """
    if control not in ("displacement", "force"):
        raise RoughmdrError(f"control is {control!r}; it must be 'displacement' or 'force'")
    contact = Contact.of(shape, effective_modulus, Adhesion.checked(adhesion, work, strength))
    names = ["force", "indentation", "contact_radius", *(["cohesive_radius"] if adhesion == "dugdale" else [])]
    if not contact.law.adhesive:
        return _dataset({name: np.zeros(()) for name in names}, None, [])
    with np.errstate(all="ignore"):
        results = contact.pull_off(control)
    radius = results["contact_radius"]
    for name in names:
        if not np.isfinite(results[name]).all() or (adhesion == "jkr" and (radius == 0.0).any()):
            raise OutOfRange(
                f"{name} at pull-off is not representable: "
                f"effective modulus {effective_modulus:g} Pa, work {work:g} J/m^2, {shape}"
            )
    extremes = validity.ValidityLimits.of(radius, shape.df(radius), np.array(shape.end))
    doubts = [*extremes.warnings, *_short_range(shape, effective_modulus, work, adhesion, strength)]
    return _dataset({name: results[name].reshape(()) for name in names}, None, doubts)


def _short_range(
    shape: object, effective_modulus: float, work: float, adhesion: str, strength: float | None
) -> list[str]:
    """What to say of JKR where a strength is given with it."""
    if adhesion != "jkr" or strength is None or work == 0.0 or not isinstance(shape, Shape):
        return []
    return validity.short_range(tabor(shape, effective_modulus=effective_modulus, work=work, strength=strength))


def _dataset(results: dict[str, Floats], control: str | None, doubts: list[str]) -> "xr.Dataset":
    """The results over the control, with what is doubtful about them; each doubt is a LimitWarning too."""
    import xarray as xr

    for text in doubts:
        warnings.warn(text, LimitWarning, stacklevel=3)

    def dims(numbers: Floats) -> tuple[str, ...]:
        return (control,) if control is not None and numbers.ndim else ()

    return xr.Dataset(
        {name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name != control},
        coords={name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name == control},
        attrs={"warnings": "\n".join(doubts)} if doubts else {},
    )


def tabor(shape: Shape, *, effective_modulus: float, work: float, strength: float) -> float:
    """The Tabor number [1] of an asperity: dl(a) strength/(pi^(2/3) work) with a where JKR lets go under fixed grips.

    Large: JKR; small: the attraction reaches far beyond the contact (DMT). For the paraboloid it is
    (R work^2/E*^2)^(1/3) strength/work (D. Tabor, J. Colloid Interface Sci. 58 (1977) 2). effective_modulus is E* [Pa],
    work [J/m^2], strength [Pa], all > 0. Raises OutOfRange as ``indent``.
    """
    strength, work = check_number("strength", strength, "Pa"), check_number("work", work, "J/m^2")
    contact = Contact.of(shape, effective_modulus, Adhesion(work))
    radius = float(contact.pull_off("displacement")["contact_radius"][0])
    return tabor_number(radius, contact.effective_modulus, work, strength)
