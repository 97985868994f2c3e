"""One asperity's face: indentation, force or contact radius in, the whole state of the contact out, as xarray."""

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.kernels.elementwise import apply
from roughmdr.kernels.laws import Law, choose
from roughmdr.shapes.base import Floats, Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr


class Contact(NamedTuple):
    """A law with the natural scales of one asperity."""

    law: Law
    form: float
    depth: tuple[float, float]
    radius: float
    force: float
    stiffness: float
    force_control: tuple[float, float]
    radius_under_force: float

    @classmethod
    def of(cls, shape: Shape, modulus: float, work: float) -> "Contact":
        """The contact of ``shape``; OutOfRange where an argument is, or where a float cannot hold its scales."""
        modulus = check_number("modulus", modulus, "Pa", zero=False)
        work = check_number("work", work, "J/m^2", zero=True)
        columns = shape.stretch({name: np.array([value]) for name, value in shape.parameters.items()})
        width, rise, form = (float(column[0]) for column in columns)
        law = choose(shape.name, work, columns[2])
        depth, radius, force, stiffness = law.natural(modulus, work, width, rise, form)
        force_control, radius_under_force = law.natural_force(modulus, work, width, rise, form)
        scales = {
            "indentation": depth[0],
            "contact_radius": radius,
            "force": force,
            "stiffness": stiffness,
            "pull-off force": force_control[0],
            "contact_radius under dead load": radius_under_force,
        }
        for quantity, scale in scales.items():
            if not np.finfo(float).tiny <= scale < math.inf:
                raise OutOfRange(
                    f"the natural {quantity} of {shape} with modulus {modulus:g} Pa and work {work:g} J/m^2 "
                    f"is not representable (it must lie between 2e-308 and 2e308 in SI units)"
                )
        return cls(law, form, depth, radius, force, stiffness, force_control, radius_under_force)

    def reduced(self, value: Floats, scale: tuple[float, float]) -> Floats:
        """Distance >= 0 of ``value`` to the onset of contact over ``scale``: to the fold at -scale, or to 0.

        The float that is nearest to the fold stands for the fold itself.
        """
        if not self.law.adhesive:
            return np.asarray(value / scale[0])
        distance = ((value + scale[0]) + scale[1]) / scale[0]
        return np.where(value == -scale[0], 0.0, distance).clip(min=0.0)

    def indentation(self, state: Floats) -> Floats:
        """Indentation [m] of each state."""
        distance = apply(self.law.distance, state, self.form)
        if not self.law.adhesive:
            return self.depth[0] * distance
        return self.depth[0] * (distance - 1.0) - self.depth[1]


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
    values = _control_values(control, raw)
    contact = Contact.of(shape, modulus, work)
    solve = {"indentation": _at_indentation, "force": _at_force, "contact_radius": _at_radius}[control]
    with np.errstate(all="ignore"):  # what overflows is refused below
        results = {**solve(contact, np.atleast_1d(values)), control: np.atleast_1d(values)}
        results["contact_area"] = math.pi * results["contact_radius"] * results["contact_radius"]
    for name, numbers in results.items():
        lost = ~np.isfinite(numbers) | ((name == "contact_area") & (numbers == 0.0) & (results["contact_radius"] > 0.0))
        if lost.any():
            worst = np.atleast_1d(values)[lost][0]
            raise OutOfRange(f"{name} at {control} = {worst:g} {ASPERITY[control].units} is not representable")
    return _dataset({name: numbers.reshape(values.shape) for name, numbers in results.items()}, control)


def pull_off(
    shape: Shape, *, modulus: float, work: float, control: Literal["displacement", "force"] = "displacement"
) -> "xr.Dataset":
    """Where a slow retraction lets go: under fixed grips ("displacement") or dead load ("force").

    The global minimum of delta(a), or of P(a) (H 45 ff.). modulus is E* [Pa], work [J/m^2]. Returns a Dataset of
    scalars: force [N], indentation [m], contact_radius [m]; all 0 without adhesion. Raises OutOfRange as ``indent``.
    """
    if control not in ("displacement", "force"):
        raise RoughmdrError(f"control is {control!r}; it must be 'displacement' or 'force'")
    contact = Contact.of(shape, modulus, work)
    if not contact.law.adhesive:
        return _dataset({name: np.zeros(()) for name in ("force", "indentation", "contact_radius")}, None)
    with np.errstate(all="ignore"):
        if control == "displacement":
            fold = np.array([-contact.depth[0]])
            results = {**_at_indentation(contact, fold), "indentation": fold}
        else:
            results = _at_force(contact, np.array([-contact.force_control[0]]))
    return _dataset({name: results[name].reshape(()) for name in ("force", "indentation", "contact_radius")}, None)


def _at_indentation(contact: Contact, delta: Floats) -> dict[str, Floats]:
    law = contact.law
    onset = -contact.depth[0] if law.adhesive else 0.0
    touching = (delta >= onset) if law.adhesive else (delta > 0.0)
    distance = np.where(touching, contact.reduced(delta, contact.depth), 1.0)
    state = apply(law.state, distance, contact.form)
    one_step_above = contact.reduced(np.nextafter(onset, math.inf) * np.ones(1), contact.depth)
    off_the_fold = np.where(delta == onset, apply(law.state, one_step_above, contact.form), state)
    stiffness = apply(law.stiffness, off_the_fold, contact.form)
    results = {
        "force": contact.force * apply(law.force, state, contact.form),
        "contact_radius": contact.radius * apply(law.radius, state, contact.form),
        "stiffness": contact.stiffness * stiffness,
    }
    return {name: np.where(touching, numbers, 0.0) for name, numbers in results.items()}


def _at_force(contact: Contact, force: Floats) -> dict[str, Floats]:
    law = contact.law
    lowest = -contact.force_control[0] if law.adhesive else 0.0
    if (force < lowest).any():
        worst = float(force.min())
        raise OutOfRange(f"force is {worst!r} N; the contact holds no more than the pull-off force, {lowest!r} N")
    distance = contact.reduced(force, contact.force_control)
    radius = contact.radius_under_force * apply(law.radius_of_force, distance, contact.form)
    return {**_at_radius(contact, radius), "contact_radius": radius, "force": force}


def _at_radius(contact: Contact, radius: Floats) -> dict[str, Floats]:
    law = contact.law
    if (radius < 0.0).any():
        raise OutOfRange(f"contact_radius is {float(radius.min()):g} m; it must be at least 0")
    touching = radius > 0.0
    ratio = np.where(touching, radius / contact.radius, 1.0)
    state = apply(law.state_of_radius, ratio, contact.form)
    at_fold = law.adhesive & (state == 0.0)
    off_the_fold = apply(law.state_of_radius, np.where(at_fold, np.nextafter(1.0, 2.0), ratio), contact.form)
    results = {
        "indentation": contact.indentation(state),
        "force": contact.force * apply(law.force, state, contact.form),
        "stiffness": contact.stiffness * apply(law.stiffness, off_the_fold, contact.form),
    }
    return {name: np.where(touching, numbers, 0.0) for name, numbers in results.items()}


def _control_values(name: str, raw: ArrayLike) -> Floats:
    try:
        values = np.asarray(raw, dtype=np.float64)
    except (TypeError, ValueError):
        raise OutOfRange(f"{name} is {raw!r}; it must be a number or a one-dimensional array") from None
    if values.ndim > 1:
        raise OutOfRange(f"{name} has {values.ndim} dimensions; it must be a number or a one-dimensional array")
    if not np.isfinite(values).all():
        worst = np.atleast_1d(values)[~np.isfinite(np.atleast_1d(values))][0]
        raise OutOfRange(f"{name} is {worst}; it must be finite")
    return values


def check_number(name: str, value: float, unit: str, *, zero: bool) -> float:
    """``value`` as a float; OutOfRange unless it is finite and above 0 (or 0, where that is allowed)."""
    allowed = f"a finite number {'of at least' if zero else 'above'} 0 {unit}"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise OutOfRange(f"{name} is {value!r}; it must be {allowed}") from None
    if not (math.isfinite(number) and (number > 0.0 or (zero and number == 0.0))):
        raise OutOfRange(f"{name} is {number:g} {unit}; it must be {allowed}")
    return number


def _dataset(results: dict[str, Floats], control: str | None) -> "xr.Dataset":
    import xarray as xr

    def dims(numbers: Floats) -> tuple[str, ...]:
        return (control,) if control is not None and numbers.ndim else ()

    return xr.Dataset(
        {name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name != control},
        coords={name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name == control},
    )
