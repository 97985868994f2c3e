"""One asperity in contact: its kernels, its natural scales, and its state under each control."""

import math
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.kernels.interface import Columns, Kernels
from roughmdr.kernels.profile.layout import CONTROL, COUNT, FOLD
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import Pair
from roughmdr.shapes import ProfileShape, Shape

Results = dict[str, Floats]

FIXED_GRIPS, DEAD_LOAD = 0.0, 1.0


class Contact(NamedTuple):
    """The kernels of one asperity, with its parameters and natural scales."""

    kernels: Kernels
    shape: Shape
    effective_modulus: float
    adhesion: Adhesion
    params: Any
    depth: tuple[float, float]  # natural indentation [m] as (hi, lo); with adhesion that of detachment is -depth
    radius: float
    force: float
    stiffness: float

    @property
    def onset(self) -> float:
        """The indentation [m] from which on the surfaces touch, or attract each other, as they approach."""
        return -self.adhesion.range

    @classmethod
    def of(cls, shape: Shape, effective_modulus: float, adhesion: Adhesion) -> "Contact":
        """Return the contact of a shape; ShapeError unless it is one, OutOfRange if a float cannot hold its scales."""
        contact = cls.rounded(shape, effective_modulus, adhesion)
        return contact._replace(depth=contact._exact(contact.depth, contact.params))

    @classmethod
    def rounded(cls, shape: Shape, effective_modulus: float, adhesion: Adhesion) -> "Contact":
        """Return the contact as ``of``, with a depth of as many digits as its kernels have: enough for a mean over
        heights, not next to the fold of a single asperity.
        """
        if not isinstance(shape, Shape):
            raise ShapeError(f"shape is {shape!r}; it must be a shape such as Paraboloid(radius=1e-6)")
        width, rise, params = shape.nondimensional()
        kernels = choose(shape.name, adhesion, np.array([params]))
        with np.errstate(all="ignore"):  # overflow is refused below
            params = prepared(kernels, shape, effective_modulus, adhesion, FIXED_GRIPS)
            if (shape.pinned or shape.limit < adhesion.range) and adhesion.cohesive and params[COUNT] == 0.0:
                reason = (
                    f"is so long that a contact of {shape} is lost in its roundings"
                    if shape.pinned
                    else f"reaches beyond the end of {shape}"
                )
                strength = f"strength is {adhesion.strength:g} Pa: its range, {adhesion.range:g} m"
                raise OutOfRange(f"{strength}, {reason}; it must be larger")
            scales = kernels.scales(effective_modulus, adhesion.work, width, rise, params)
            contact = cls(kernels, shape, effective_modulus, adhesion, params, *scales)
        depth, radius, force, stiffness = scales
        contact._check(indentation=depth[0], contact_radius=radius, force=force, stiffness=stiffness)
        return contact

    def _under_load(self) -> tuple[tuple[float, float], float, Any]:
        """Return the pull-off force [N] (without adhesion the natural force), its radius [m], and params under dead
        load.
        """
        width, rise, _ = self.shape.nondimensional()
        with np.errstate(all="ignore"):
            params = prepared(self.kernels, self.shape, self.effective_modulus, self.adhesion, DEAD_LOAD)
            force, radius = self.kernels.force_scales(self.effective_modulus, self.adhesion.work, width, rise, params)
        self._check(force=force[0], contact_radius=radius)
        return self._exact(force, params), radius, params

    def _exact(self, depth: tuple[float, float], params: Any) -> tuple[float, float]:
        """Return a natural depth or force with the digits that the fold needs."""
        if not (self.kernels.adhesive and self.kernels.iterative) or self.adhesion.cohesive:
            return depth
        return exact_depth(cast(ProfileShape, self.shape), self.effective_modulus, self.adhesion.work, params)

    def _check(self, **scales: float) -> None:
        for quantity, scale in scales.items():
            if not np.finfo(float).tiny <= scale < math.inf:
                raise OutOfRange(
                    f"the natural {quantity} is not representable (2e-308 to 2e308 in SI): "
                    f"effective modulus {self.effective_modulus:g} Pa, {self.adhesion}, {self.shape}"
                )

    def reduced(self, value: Floats, scale: tuple[float, float]) -> Floats:
        """Return (value + scale)/scale >= 0 with adhesion, 0 at the fold, and value/scale without.

        The float that is nearest to the fold stands for the fold itself.
        """
        if not self.kernels.adhesive:
            return np.asarray(value / scale[0])
        distance = ((value + scale[0]) + scale[1]) / scale[0]
        return np.where(value == -scale[0], 0.0, distance).clip(min=0.0)

    def pull_off(self, control: str) -> Results:
        """Return the state in which a slow retraction ends under "displacement" or "force"; arrays of one number."""
        if control == "displacement":
            fold = np.array([-self.depth[0]])
            return {**self.at_indentation(fold), "indentation": fold}
        return self.at_force(np.array([-self._under_load()[0][0]]))

    def at_indentation(self, delta: Floats) -> Results:
        """Return the contact as on retraction; zeros where there is none."""
        kernels = self.kernels
        detachment = -self.depth[0] if kernels.adhesive else 0.0
        in_contact = (delta >= detachment) if kernels.adhesive else (delta > 0.0)
        state = apply(kernels.state, np.where(in_contact, self.reduced(delta, self.depth), 1.0), self.params)
        one_step_above = self.reduced(np.nextafter(detachment, math.inf) * np.ones(1), self.depth)
        beside_fold = np.where(delta == detachment, apply(kernels.state, one_step_above, self.params), state)
        radius, force, _ = self.radius_force_stiffness(state)
        stiffness = self.radius_force_stiffness(beside_fold)[2]
        return self._results(in_contact, state, force=force, contact_radius=radius, stiffness=stiffness)

    def at_force(self, force: Floats) -> Results:
        """Return the contact on the branch that is stable under dead load; OutOfRange where there is none."""
        kernels = self.kernels
        scale, scale_radius, params = self._under_load()
        lowest = -scale[0] if kernels.adhesive else 0.0
        if (force < lowest).any():
            raise OutOfRange(f"force is {float(force.min())!r} N; it must be at least the pull-off force, {lowest!r} N")
        in_contact = (force >= lowest) if kernels.adhesive else (force > 0.0)
        distance = np.where(in_contact, self.reduced(force, scale), 1.0)
        state = apply(kernels.state_of_force, distance, params)
        radius, _, stiffness = self.radius_force_stiffness(state)
        if kernels.radius_of_force is not None:
            radius = scale_radius * apply(kernels.radius_of_force, distance, params)
        delta = self.indentation_of(state)
        results = self._results(in_contact, state, indentation=delta, contact_radius=radius, stiffness=stiffness)
        return {**results, "force": force}

    def at_radius(self, radius: Floats) -> Results:
        """Return the equilibrium with each radius, stable or not; zeros where it is 0."""
        kernels, shape = self.kernels, self.shape
        if (radius < 0.0).any():
            raise OutOfRange(f"contact_radius is {float(radius.min()):g} m; it must be at least 0")
        if shape.pinned:
            raise ShapeError(
                f"contact_radius does not determine the state of a flat punch: it is always {shape.limit:g} m"
            )
        on_the_flat = (radius > 0.0) & (radius < self.radius) & shape.flat
        if on_the_flat.any():
            raise ShapeError(
                f"contact_radius is {radius[on_the_flat][0]:g} m, on the flat of the {shape.name}, where contacts "
                f"are not stable; it must be 0, or at least {self.radius:g} m"
            )
        if self.adhesion.cohesive and (radius == 0.0).any():
            raise ShapeError(
                "contact_radius is 0 m, which does not determine the state: the surfaces can attract each other"
            )
        in_contact = radius > 0.0
        a = np.where(in_contact, radius, self.radius)
        if self.adhesion.cohesive:
            delta, force, stiffness = apply_all(kernels.equilibrium_at_radius, a, self.radius, self.params)
            c = apply(kernels.cohesive_at_radius, a, self.radius, self.params)
            rise = float(shape.nondimensional()[1])
            results = {"indentation": rise * delta, "force": self.force * force, "cohesive_radius": self.radius * c}
            return results | {"stiffness": self.stiffness * stiffness}
        state = apply(kernels.state_of_radius, a, self.radius, self.params)
        beside_fold = state
        if kernels.adhesive and not kernels.iterative:  # other folds are no exact floats
            above = apply(kernels.state_of_radius, np.nextafter(a, math.inf), self.radius, self.params)
            beside_fold = np.where(state == 0.0, above, state)
        force, stiffness = self.radius_force_stiffness(state)[1], self.radius_force_stiffness(beside_fold)[2]
        delta = self.indentation_of(state)
        return self._results(in_contact, state, indentation=delta, force=force, stiffness=stiffness)

    def radius_force_stiffness(self, state: Floats) -> tuple[Floats, Floats, Floats]:
        """Return contact radius [m], force [N] and stiffness [N/m] of each state."""
        kernels, params = self.kernels, self.params
        with np.errstate(divide="ignore"):  # at a fold the stiffness is without bound; compiled kernels do not warn
            parts = apply_all(kernels.radius_force_stiffness, state, params)
        return self.radius * parts[0], self.force * parts[1], self.stiffness * parts[2]

    def at_states(self, in_contact: NDArray[np.bool_], state: Floats) -> Results:
        """Return all quantities of the equilibrium at each state; zeros out of contact."""
        radius, force, stiffness = self.radius_force_stiffness(state)
        delta = self.indentation_of(state)
        if self.kernels.adhesive:  # a rounding below detachment there would be no contact
            delta = np.maximum(delta, -self.depth[0])
        return self._results(
            in_contact, state, indentation=delta, force=force, contact_radius=radius, stiffness=stiffness
        )

    def _results(self, in_contact: NDArray[np.bool_], state: Floats, **results: Floats) -> Results:
        """Return results, with the cohesive radius [m] where adhesion has a range; zeros out of contact."""
        if self.kernels.cohesive:
            results["cohesive_radius"] = self.radius * apply(self.kernels.cohesive_radius, state, self.params)
        return {name: np.where(in_contact, numbers, 0.0) for name, numbers in results.items()}

    def indentation_of(self, state: Floats) -> Floats:
        """Return the indentation [m] of each state."""
        distance = apply(self.kernels.reduced_control, state, self.params)
        return self.depth[0] * (distance - 1.0) - self.depth[1] if self.kernels.adhesive else self.depth[0] * distance


def prepared(kernels: Kernels, shape: Shape, effective_modulus: float, adhesion: Adhesion, control: float) -> Any:
    """Return the params of one contact under a control."""
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional())
    material = kernels.material(effective_modulus, adhesion)
    return kernels.params_of(kernels.prepare(material, Columns(width, rise, params), 0, 1, control, math.inf), 0)


def exact_depth(shape: ProfileShape, effective_modulus: float, work: float, params: Floats) -> Pair:
    """Return minus the indentation [m] (fixed grips) or minus the force [N] (dead load) at detachment, as two floats.

    These are dl(a) - g(a) and 2 E* [a dl(a) - (a g - G)] at the lowest foot of the row (H 40-41, 44).

    The quantity is stationary there, so that the rounding of t does not matter. At the distance X to the fold, an error
    of the fold is magnified by 1/sqrt(X) in radius, force and stiffness.
    """
    from mpmath import mp

    a, g, push = shape.precisely(float(params[FOLD]))
    with mp.workdps(40):
        stretch = mp.sqrt(2 * mp.pi * a * mp.mpf(work) / mp.mpf(effective_modulus))
        depth = stretch - g if params[CONTROL] == 0.0 else 2 * mp.mpf(effective_modulus) * (a * stretch - push)
        return float(depth), float(depth - mp.mpf(float(depth)))
