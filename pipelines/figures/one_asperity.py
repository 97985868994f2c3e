"""One asperity under JKR adhesion: the two steps of its contact, its pull-off, and the shape that adheres best.

The two steps are Fig. 8 of M. Heß, "On the reduction method of dimensionality: the exact mapping of axisymmetric
contact problems with and without adhesion", 2012; shapes of one size follow H. Yao, H. Gao, J. Colloid Interface Sci.
298 (2006) 564.
"""

import math
from typing import Any, Literal

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar
from studies.study import named

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape

MODULUS, WORK = 4e6, 0.05  # a soft rubber against a rigid body [Pa], [J/m^2]
SLOPE, RADIUS, FLAT = 0.2, 50e-6, 10e-6  # cone [1], paraboloid [m], flat punch [m]
SHAPES: dict[str, Shape] = {
    "cone": rm.Cone(slope=SLOPE),
    "paraboloid": rm.Paraboloid(radius=RADIUS),
    "flat punch": rm.FlatPunch(radius=FLAT),
}
# Pull-off forces from the papers (Maugis for the cone, JKR, Kendall): under fixed grips, under dead load [N].
KNOWN = {
    "cone": [-factor * WORK**2 / (math.pi * MODULUS * SLOPE**3) for factor in (6.0, 54.0)],
    "paraboloid": [-factor * math.pi * WORK * RADIUS for factor in (5.0 / 6.0, 1.5)],
    "flat punch": [-math.sqrt(8.0 * math.pi * MODULUS * WORK * FLAT**3)] * 2,
}
Control = Literal["displacement", "force"]
CONTROLS: tuple[Control, ...] = ("displacement", "force")
COURSES = ("loading", "unloading", "unstable")
PRESSED = 2.0  # contact radius of the two steps, over that at first touch
INSIDE, SPRINGS = 8, 12  # springs from the middle to the edge of the contact, and to the end of the row
WIDTH = 10e-6  # width of the power laws whose exponent is varied [m]
STRETCHES = (0.3, 1.0, 3.0)  # dl(width) over their rise
SHARPEST, FLATTEST = 1.0, 100.0  # exponents
POINTS, QUICK = 121, 41
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}


def stretch(radius: Floats | float) -> Floats:
    """Return dl(a) = sqrt(2 pi a w/E*) [m], the stretch at which a spring at the edge detaches (H 44)."""
    return np.sqrt(2.0 * math.pi * WORK / MODULUS * np.asarray(radius))


def two_steps() -> xr.Dataset:
    """Return the row of springs below a cone: pressed without adhesion, lifted at fixed radius, and at its pull-off."""
    cone = SHAPES["cone"]
    touch = rm.indent(cone, **_MATERIAL, indentation=0.0)
    radius = PRESSED * float(touch.contact_radius)
    states = {
        "pressed": rm.indent(cone, effective_modulus=MODULUS, contact_radius=radius),
        "lifted": rm.indent(cone, **_MATERIAL, contact_radius=radius),
        "pull-off": rm.pull_off(cone, **_MATERIAL, control="displacement"),
    }
    radii, depths, force = (
        np.array([float(state[name]) for state in states.values()])
        for name in ("contact_radius", "indentation", "force")
    )
    numbers = np.arange(-SPRINGS, SPRINGS + 1)
    position = radii[:, None] * numbers / INSIDE  # so that one spring is at the very edge
    surface = np.where(np.abs(numbers) <= INSIDE, cone.g(np.abs(position)) - depths[:, None], 0.0)
    row = ("stage", "spring")
    return xr.Dataset(
        {
            "spring_position": (row, position, named("distance of a spring from the axis", "m")),
            "spring_end": (row, surface, named("end of a spring above the undeformed surface", "m")),
            "stage_contact_radius": ("stage", radii, named("contact radius a", "m")),
            "stage_depth": ("stage", cone.g(radii), named("MDR profile at the contact radius, g(a)", "m")),
            "stage_stretch": ("stage", stretch(radii), named("stretch at which a spring at a detaches, dl(a)", "m")),
            "stage_indentation": ("stage", depths, named("indentation", "m")),
            "stage_force": ("stage", force, named("force, compression > 0", "N")),
            "touch_radius": ((), radius / PRESSED, named("contact radius of the cone at first touch", "m")),
            "touch_depth": ((), float(stretch(radius / PRESSED)), named("stretch of the edge at first touch", "m")),
        },
        coords={
            "stage": ("stage", list(states), {"long_name": "state of the row of springs"}),
            "spring": ("spring", numbers, named("number of the spring")),
        },
    )


def pull_off_curves() -> xr.Dataset:
    """Return force against indentation of three shapes, loading, unloading and unstable, and the pull-offs."""
    points = np.linspace(0.0, 1.0, POINTS)
    depth, force = np.full((2, len(SHAPES), len(COURSES), POINTS), np.nan)
    folds = np.empty((3, len(SHAPES), len(CONTROLS)))
    for i, shape in enumerate(SHAPES.values()):
        for j, control in enumerate(CONTROLS):
            fold = rm.pull_off(shape, **_MATERIAL, control=control)
            folds[:, i, j] = fold.force, fold.indentation, fold.contact_radius
        lowest = float(folds[1, i, 0])
        # Loaded as far as the force is the opposite of the pull-off force.
        highest = float(rm.indent(shape, **_MATERIAL, force=-folds[0, i, 1]).indentation)
        depth[i, 0] = highest * points
        depth[i, 1] = lowest + (highest - lowest) * (1.0 - points) ** 2  # denser near the fold
        depth[i, 1, -1] = lowest
        for course in (0, 1):
            force[i, course] = rm.indent(shape, **_MATERIAL, indentation=depth[i, course]).force
        if not isinstance(shape, rm.FlatPunch):  # whose contact has one radius, and is stable until it is lost
            unstable = rm.indent(shape, **_MATERIAL, contact_radius=folds[2, i, 0] * (1.0 - points))
            depth[i, 2], force[i, 2] = unstable.indentation, unstable.force
    over, at = ("shape", "course", "point"), ("shape", "control")
    return xr.Dataset(
        {
            "curve_indentation": (over, depth, named("indentation", "m")),
            "curve_force": (over, force, named("force, compression > 0", "N")),
            "pull_off_force": (at, folds[0], named("force at pull-off", "N")),
            "pull_off_indentation": (at, folds[1], named("indentation at pull-off", "m")),
            "pull_off_radius": (at, folds[2], named("contact radius at pull-off", "m")),
            "known_force": (at, np.array([*KNOWN.values()]), named("pull-off force of theory", "N")),
        },
        coords={
            "shape": ("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
            "course": ("course", list(COURSES), {"long_name": "part of the curve"}),
            "control": ("control", list(CONTROLS), {"long_name": "quantity that is prescribed while pulling"}),
        },
    )


def pull_off_within_width(exponent: float, rise: float, control: Control) -> tuple[float, float]:
    """Return the pull-off force [N] of a power law that ends at its width, and the contact radius there [m].

    Where the contact of the infinite power law would be wider, that of the real one stays at the rim until the energy
    release rate there is the work of adhesion: the equilibrium whose radius is the width.
    """
    shape = rm.PowerLaw(exponent=exponent, width=WIDTH, rise=rise)
    state = rm.pull_off(shape, **_MATERIAL, control=control)
    if float(state.contact_radius) > WIDTH:
        state = rm.indent(shape, **_MATERIAL, contact_radius=WIDTH)
    return float(state.force), float(state.contact_radius)


def shape_and_pull_off(points: int = POINTS) -> xr.Dataset:
    """Return pull-off forces of power laws of one width, for three rises; the worst exponent of each.

    Under dead load P = -(2n-1)/(2n+2) sqrt(8 pi E* w a^3), (a/width)^(n-1/2) = 3 dl(width)/(2 n g(width)): the flat
    face, n -> infinity, adheres best. A blunter profile has its rise nearer to the rim: contact keeps its middle for
    longer, and its rim for less long. Tension is smallest near (a/width)^(n-1/2) = exp(-1/2), that is where
    n g(width) = 2.5 dl(width).
    """
    exponents = np.geomspace(SHARPEST, FLATTEST, points)
    rises = stretch(WIDTH) / np.array(STRETCHES)
    force, radius = np.moveaxis(np.array(
        [[[pull_off_within_width(n, rise, control) for n in exponents] for control in CONTROLS] for rise in rises]
    ), -1, 0)  # fmt: skip
    worst = np.array([[_worst(exponents, force[i, j], rise, control) for j, control in enumerate(CONTROLS)]
                      for i, rise in enumerate(rises)])  # fmt: skip
    flat = rm.pull_off(rm.FlatPunch(radius=WIDTH), **_MATERIAL, control="displacement")
    over = ("relative_stretch", "control", "exponent")
    return xr.Dataset(
        {
            "held_force": (over, force, named("force at pull-off, contact within the width", "N")),
            "held_radius": (over, radius, named("contact radius at pull-off", "m")),
            "worst_exponent": (over[:2], worst[..., 0], named("exponent with the smallest pull-off force")),
            "worst_force": (over[:2], worst[..., 1], named("force at pull-off with it", "N")),
            "flat_force": ((), float(flat.force), named("pull-off force of a flat face", "N")),
            "width": ((), WIDTH, named("radius of the asperity", "m")),
        },
        coords={
            "relative_stretch": (over[:1], list(STRETCHES), named("dl(width) over rise")),
            "rise": (over[:1], rises, named("height of the profile at its width", "m")),
            "control": ("control", list(CONTROLS), {"long_name": "quantity that is prescribed while pulling"}),
            "exponent": (over[2:], exponents, named("exponent n of f = rise (r/width)^n")),
        },
    )


def _worst(exponents: Floats, force: Floats, rise: float, control: Control) -> list[float]:
    """Return the exponent with the smallest tension and that force [N], refined about the best of the grid."""
    lowest = int(np.argmax(force))
    if lowest in (0, len(exponents) - 1):
        return [float(exponents[lowest]), float(force[lowest])]
    bounds = float(exponents[lowest - 1]), float(exponents[lowest + 1])
    found = minimize_scalar(
        lambda n: -pull_off_within_width(float(n), rise, control)[0], bounds=bounds, method="bounded"
    )
    return [float(found.x), float(-found.fun)]


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure."""
    result = xr.merge([two_steps(), pull_off_curves(), shape_and_pull_off(QUICK if quick else POINTS)])
    return result.assign_attrs(effective_modulus=MODULUS, work=WORK, slope=SLOPE, width=WIDTH, springs_inside=INSIDE)


def report(result: xr.Dataset) -> str:
    """Return the pull-off forces and the worst exponents."""
    lines = []
    for name in result["shape"].to_numpy():
        grips, dead_load = result.pull_off_force.sel(shape=name).to_numpy()
        lines.append(f"{name:<12} detaches at {dead_load:.6g} N under dead load, {grips:.6g} N under fixed grips")
    for ratio in STRETCHES:
        one = result.sel(relative_stretch=ratio, control="force")
        part = float(one.worst_force / one.flat_force)
        lines.append(f"dl(width)/rise = {ratio:<4g} worst exponent {float(one.worst_exponent):.2f}, with {part:.3f} "
                     "of the force of a flat face")  # fmt: skip
    return "\n".join(lines)
