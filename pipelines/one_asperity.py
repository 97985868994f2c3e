"""One asperity under JKR adhesion: the two steps of its contact, how it lets go, and which shape holds best.

    python pipelines/one_asperity.py -o results/studies

Writes one_asperity.nc and three pictures, two_steps.png (Fig. 8 of M. Heß, "On the reduction method of dimensionality:
the exact mapping of axisymmetric contact problems with and without adhesion", 2012), pull_off_curves.png and
shape_and_pull_off.png (after H. Yao, H. Gao, J. Colloid Interface Sci. 298 (2006) 564).
"""

import math
from pathlib import Path
from typing import Literal

import click
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from one_asperity_pictures import PICTURES

import roughmdr as rm
from roughmdr.shapes import Shape
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance

Floats = NDArray[np.float64]

MODULUS, WORK = 4e6, 0.05  # of a soft rubber against a rigid body [Pa], [J/m^2]
SLOPE, RADIUS, FLAT = 0.2, 50e-6, 10e-6  # of the cone [1], the paraboloid [m], the flat punch [m]
SHAPES: dict[str, Shape] = {
    "cone": rm.Cone(slope=SLOPE),
    "paraboloid": rm.Paraboloid(radius=RADIUS),
    "flat punch": rm.FlatPunch(radius=FLAT),
}
# Pull-off forces as their papers have them (Maugis for the cone, JKR, Kendall): under fixed grips, under dead load [N].
KNOWN = {
    "cone": [-factor * WORK**2 / (math.pi * MODULUS * SLOPE**3) for factor in (6.0, 54.0)],
    "paraboloid": [-factor * math.pi * WORK * RADIUS for factor in (5.0 / 6.0, 1.5)],
    "flat punch": [-math.sqrt(8.0 * math.pi * MODULUS * WORK * FLAT**3)] * 2,
}
CONTROLS: tuple[Literal["displacement", "force"], ...] = ("displacement", "force")
COURSES = ("loading", "unloading", "unstable")
PRESSED = 2.0  # the contact radius of the two steps, over the one at first touch
INSIDE, SPRINGS = 8, 12  # springs from the middle to the edge of the contact, and to the end of the row
WIDTH = 10e-6  # of the power laws whose exponent is varied [m]
STRETCHES = (0.3, 1.0, 3.0)  # dl(width) over their rise
SHARPEST, FLATTEST = 1.0, 100.0  # exponents
POINTS = 121


def stretch(radius: Floats | float) -> Floats:
    """dl(a) = sqrt(2 pi a w/E*) [m]: how far a spring at the edge stretches before it lets go (H 44)."""
    return np.sqrt(2.0 * math.pi * WORK / MODULUS * np.asarray(radius))


def two_steps() -> xr.Dataset:
    """The spring row below a cone: pressed without adhesion, lifted at fixed contact radius, and at its pull-off."""
    cone = SHAPES["cone"]
    touch = rm.indent(cone, effective_modulus=MODULUS, work=WORK, indentation=0.0)
    radius = PRESSED * float(touch.contact_radius)
    states = {
        "pressed": rm.indent(cone, effective_modulus=MODULUS, contact_radius=radius),
        "lifted": rm.indent(cone, effective_modulus=MODULUS, work=WORK, contact_radius=radius),
        "pull-off": rm.pull_off(cone, effective_modulus=MODULUS, work=WORK),
    }
    radii = np.array([float(state.contact_radius) for state in states.values()])
    depths = np.array([float(state.indentation) for state in states.values()])
    numbers = np.arange(-SPRINGS, SPRINGS + 1)
    position = radii[:, None] * numbers / INSIDE  # so that one spring hangs at the very edge
    follows = np.abs(numbers) <= INSIDE
    surface = np.where(follows, cone.g(np.abs(position)) - depths[:, None], 0.0)

    def scalar(value: float, name: str) -> tuple[tuple[()], float, dict[str, str]]:
        return (), value, {"units": "m", "long_name": name}

    def staged(values: Floats, units: str, name: str) -> tuple[tuple[str, ...], Floats, dict[str, str]]:
        return ("stage", "spring")[: values.ndim], values, {"units": units, "long_name": name}

    force = np.array([float(state.force) for state in states.values()])
    return xr.Dataset(
        {
            "spring_position": staged(position, "m", "distance of a spring from the axis"),
            "spring_end": staged(surface, "m", "end of a spring above the undeformed surface"),
            "stage_contact_radius": staged(radii, "m", "contact radius a"),
            "stage_depth": staged(cone.g(radii), "m", "MDR profile at the contact radius, g(a)"),
            "stage_stretch": staged(stretch(radii), "m", "stretch at which a spring at a lets go, dl(a)"),
            "stage_indentation": staged(depths, "m", "indentation"),
            "stage_force": staged(force, "N", "force, compression > 0"),
            "touch_radius": scalar(float(touch.contact_radius), "contact radius of the cone at first touch"),
            "touch_depth": scalar(float(stretch(touch.contact_radius)), "stretch of the edge at first touch"),
        },
        coords={
            "stage": ("stage", list(states), {"long_name": "state of the spring row"}),
            "spring": ("spring", numbers, {"units": "1", "long_name": "number of the spring"}),
        },
    )


def pull_off_curves() -> xr.Dataset:
    """Force against indentation of three shapes, in, out, and where no control holds the contact; and the pull-offs."""
    points = np.linspace(0.0, 1.0, POINTS)
    depth, force = np.full((2, len(SHAPES), len(COURSES), POINTS), np.nan)
    folds = np.empty((3, len(SHAPES), len(CONTROLS)))
    for i, shape in enumerate(SHAPES.values()):
        for j, control in enumerate(CONTROLS):
            fold = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control=control)
            folds[:, i, j] = fold.force, fold.indentation, fold.contact_radius
        lowest = float(folds[1, i, 0])
        # As far in as pushes back with what it holds.
        highest = float(rm.indent(shape, effective_modulus=MODULUS, work=WORK, force=-folds[0, i, 1]).indentation)
        depth[i, 0] = highest * points
        depth[i, 1] = lowest + (highest - lowest) * (1.0 - points) ** 2  # closer together near the fold
        depth[i, 1, -1] = lowest
        for course in (0, 1):
            force[i, course] = rm.indent(
                shape, effective_modulus=MODULUS, work=WORK, indentation=depth[i, course]
            ).force
        if not isinstance(shape, rm.FlatPunch):  # its contact has one radius, and is stable until it is none
            back = rm.indent(
                shape, effective_modulus=MODULUS, work=WORK, contact_radius=folds[2, i, 0] * (1.0 - points)
            )
            depth[i, 2], force[i, 2] = back.indentation, back.force
    over, at = ("shape", "course", "point"), ("shape", "control")
    return xr.Dataset(
        {
            "curve_indentation": (over, depth, {"units": "m", "long_name": "indentation"}),
            "curve_force": (over, force, {"units": "N", "long_name": "force, compression > 0"}),
            "pull_off_force": (at, folds[0], {"units": "N", "long_name": "force at pull-off"}),
            "pull_off_indentation": (at, folds[1], {"units": "m", "long_name": "indentation at pull-off"}),
            "pull_off_radius": (at, folds[2], {"units": "m", "long_name": "contact radius at pull-off"}),
            "known_force": (at, np.array([*KNOWN.values()]), {"units": "N", "long_name": "pull-off force of theory"}),
        },
        coords={
            "shape": ("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
            "course": ("course", list(COURSES), {"long_name": "part of the curve"}),
            "control": ("control", list(CONTROLS), {"long_name": "what is held while pulling"}),
        },
    )


def holds(exponent: float, rise: float, control: Literal["displacement", "force"]) -> tuple[float, float]:
    """Pull-off force [N] and contact radius there [m] of a power law that ends at its width.

    Where the contact of the endless power law would be wider still, that of the real one stays at the rim until the
    energy release rate there is the work of adhesion: the equilibrium whose radius is the width.
    """
    shape = rm.PowerLaw(exponent=exponent, width=WIDTH, rise=rise)
    state = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control=control)
    if float(state.contact_radius) > WIDTH:
        state = rm.indent(shape, effective_modulus=MODULUS, work=WORK, contact_radius=WIDTH)
    return float(state.force), float(state.contact_radius)


def shape_and_pull_off(points: int = POINTS) -> xr.Dataset:
    """Pull-off force against exponent for power laws of one width, with three rises; the worst exponent of each.

    Under dead load P = -(2n-1)/(2n+2) sqrt(8 pi E* w a^3), (a/width)^(n-1/2) = 3 dl(width)/(2 n g(width)): the flat
    face, n -> infinity, holds most. A blunter profile has its rise nearer to the rim: contact keeps its middle longer,
    and its rim less long. Tension is least near (a/width)^(n-1/2) = exp(-1/2), that is n g(width) = 2.5 dl(width).
    """
    exponents = np.geomspace(SHARPEST, FLATTEST, points)
    rises = stretch(WIDTH) / np.array(STRETCHES)
    found = np.array([[[holds(n, rise, control) for n in exponents] for control in CONTROLS] for rise in rises])
    force, radius = np.moveaxis(found, -1, 0)
    worst = np.empty((len(rises), len(CONTROLS), 2))
    for i, rise in enumerate(rises):
        for j, control in enumerate(CONTROLS):
            worst[i, j] = _worst(exponents, force[i, j], rise, control)
    flat = rm.pull_off(rm.FlatPunch(radius=WIDTH), effective_modulus=MODULUS, work=WORK)
    over = ("relative_stretch", "control", "exponent")
    return xr.Dataset(
        {
            "held_force": (over, force, {"units": "N", "long_name": "force at pull-off, contact within the width"}),
            "held_radius": (over, radius, {"units": "m", "long_name": "contact radius at pull-off"}),
            "worst_exponent": (over[:2], worst[..., 0], {"units": "1", "long_name": "exponent that holds least"}),
            "worst_force": (over[:2], worst[..., 1], {"units": "N", "long_name": "force at pull-off with it"}),
            "flat_force": ((), float(flat.force), {"units": "N", "long_name": "pull-off force of a flat face"}),
            "width": ((), WIDTH, {"units": "m", "long_name": "radius of the asperity"}),
        },
        coords={
            "relative_stretch": (over[:1], list(STRETCHES), {"units": "1", "long_name": "dl(width) over rise"}),
            "rise": (over[:1], rises, {"units": "m", "long_name": "height of the profile at its width"}),
            "control": ("control", list(CONTROLS), {"long_name": "what is held while pulling"}),
            "exponent": (over[2:], exponents, {"units": "1", "long_name": "exponent n of f = rise (r/width)^n"}),
        },
    )


def _worst(exponents: Floats, force: Floats, rise: float, control: Literal["displacement", "force"]) -> list[float]:
    """The exponent of the least tension and that force [N], refined between the neighbours of the lowest point."""
    from scipy.optimize import minimize_scalar

    lowest = int(np.argmax(force))
    if lowest in (0, len(exponents) - 1):
        return [float(exponents[lowest]), float(force[lowest])]
    found = minimize_scalar(
        lambda n: -holds(float(n), rise, control)[0],
        bounds=(float(exponents[lowest - 1]), float(exponents[lowest + 1])),
        method="bounded",
    )
    return [float(found.x), float(-found.fun)]


def one_asperity(points: int = POINTS) -> xr.Dataset:
    """All the numbers of this study."""
    result = xr.merge([two_steps(), pull_off_curves(), shape_and_pull_off(points)])
    return result.assign_attrs(
        provenance("One asperity under JKR adhesion", "one_asperity.py"),
        effective_modulus=MODULUS,
        work=WORK,
        slope=SLOPE,
        width=WIDTH,
        springs_inside=INSIDE,
    )


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
def main(output: Path) -> None:
    """Compute, print, write one_asperity.nc and three pictures."""
    output.mkdir(parents=True, exist_ok=True)
    result = one_asperity()
    write_netcdf(Labelled.of(result), output / "one_asperity.nc")
    for name, draw in PICTURES.items():
        with replace_atomically(output / name) as temporary:
            draw(result).savefig(temporary, dpi=160, format="png")
    for name in result["shape"].to_numpy():
        grips, dead = result.pull_off_force.sel(shape=name).to_numpy()
        click.echo(f"{name:<12} lets go at {dead:.6g} N under dead load, {grips:.6g} N under fixed grips")
    for ratio in STRETCHES:
        one = result.sel(relative_stretch=ratio, control="force")
        click.echo(
            f"dl(width)/rise = {ratio:<4g} worst exponent {float(one.worst_exponent):.2f}, which holds "
            f"{float(one.worst_force / one.flat_force):.3f} of a flat face"
        )


if __name__ == "__main__":
    main()
