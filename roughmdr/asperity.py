"""One asperity's face: indentation, force or contact radius in, the whole state of the contact out, as xarray."""

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.arguments import Floats, check_number, check_values
from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError
from roughmdr.kernels.elementwise import apply
from roughmdr.kernels.laws import Law, choose
from roughmdr.shapes.base import Shape
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr


class Contact(NamedTuple):
    """A law with the natural scales of one asperity."""

    law: Law
    arguments: tuple[float, float, float, float, float]
    """modulus, work, width, rise, form."""
    depth: tuple[float, float]
    radius: float
    force: float
    stiffness: float

    @classmethod
    def of(cls, shape: Shape, modulus: float, work: float) -> "Contact":
        """The contact of ``shape``; OutOfRange where an argument is, or where a float cannot hold its scales."""
        if not isinstance(shape, Shape):
            raise ShapeError(f"shape is {shape!r}; it must be a shape such as Paraboloid(radius=1e-6)")
        modulus = check_number("modulus", modulus, "Pa")
        work = check_number("work", work, "J/m^2", zero=True)
        width, rise, form = shape.stretched()
        law = choose(shape.name, work, np.array([form]))
        contact = cls(law, (modulus, work, width, rise, form), *law.natural(modulus, work, width, rise, form))
        contact._check(
            indentation=contact.depth[0],
            contact_radius=contact.radius,
            force=contact.force,
            stiffness=contact.stiffness,
        )
        return contact

    @property
    def form(self) -> float:
        """The third number of ``Shape.stretch``."""
        return self.arguments[-1]

    def under_load(self) -> tuple[tuple[float, float], float]:
        """The force [N] that force control is reduced by, and its radius [m]."""
        force, radius = self.law.natural_force(*self.arguments)
        self._check(force=force[0], contact_radius=radius)
        return force, radius

    def _check(self, **scales: float) -> None:
        for quantity, scale in scales.items():
            if not np.finfo(float).tiny <= scale < math.inf:
                modulus, work, width, rise, form = self.arguments
                raise OutOfRange(
                    f"the natural {quantity} is not representable (2e-308 to 2e308 in SI): modulus {modulus:g} Pa, "
                    f"work {work:g} J/m^2, asperity of width {width:g} m, rise {rise:g} m, exponent {form:g}"
                )

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
    values = check_values(control, raw)
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

    The global minimum of delta(a), or of P(a). modulus is E* [Pa], work [J/m^2]. Returns a Dataset of
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
            results = _at_force(contact, np.array([-contact.under_load()[0][0]]))
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
    scale, radius_there = contact.under_load()
    lowest = -scale[0] if law.adhesive else 0.0
    if (force < lowest).any():
        worst = float(force.min())
        raise OutOfRange(f"force is {worst!r} N; the contact holds no more than the pull-off force, {lowest!r} N")
    radius = radius_there * apply(law.radius_of_force, contact.reduced(force, scale), contact.form)
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


def _dataset(results: dict[str, Floats], control: str | None) -> "xr.Dataset":
    import xarray as xr

    def dims(numbers: Floats) -> tuple[str, ...]:
        return (control,) if control is not None and numbers.ndim else ()

    return xr.Dataset(
        {name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name != control},
        coords={name: (dims(n), n, ASPERITY[name].attrs) for name, n in results.items() if name == control},
    )
