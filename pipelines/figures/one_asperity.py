"""One asperity under JKR adhesion: how it is pressed, lifted and detached, and the shape that adheres best.

Shapes of one size follow H. Yao, H. Gao, J. Colloid Interface Sci. 298 (2006) 564.
"""

import math
from typing import Any, Literal

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar
from studies.study import Figure, Study, blank, named

import roughmdr as rm
from figures.springs import COMPRESSED, STRETCHED
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
WIDTH = 10e-6  # width of the power laws whose exponent is varied [m]
STRETCHES = (0.3, 1.0, 3.0)  # dl(width) over their rise
SHARPEST, FLATTEST = 1.0, 100.0  # exponents
POINTS, QUICK = 121, 41
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}


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
    rises = math.sqrt(2.0 * math.pi * WORK / MODULUS * WIDTH) / np.array(STRETCHES)
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
    result = xr.merge([pull_off_curves(), shape_and_pull_off(QUICK if quick else POINTS)])
    return result.assign_attrs(effective_modulus=MODULUS, work=WORK, slope=SLOPE, width=WIDTH)


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


_KNOWN = {  # under fixed grips and under dead load
    "cone": (r"$-\frac{6\,w^2}{\pi E^* S^3}$", r"$-\frac{54\,w^2}{\pi E^* S^3}$  (Maugis)"),
    "paraboloid": (r"$-\frac{5}{6}\,\pi w R$", r"$-\frac{3}{2}\,\pi w R$  (JKR)"),
    "flat punch": ("", r"$-\sqrt{8\pi E^* w b^3}$  (Kendall)"),
}


def draw_pull_off_curves(result: xr.Dataset) -> Figure:
    """Draw for each shape the force over its pull-off force under dead load, against depth over that at pull-off."""
    figure = blank(13, 4.8)
    for ax, name in zip(figure.subplots(1, 3, sharey=True), result["shape"].to_numpy(), strict=True):
        shape = result.sel(shape=name)
        grips, dead_load = (shape.sel(control=control) for control in ("displacement", "force"))
        force, depth = -float(dead_load.pull_off_force), -float(grips.pull_off_indentation)
        x, y = shape.curve_indentation / depth, shape.curve_force / force
        last, touch = float(grips.pull_off_force) / force, float(y.sel(course="loading")[0])
        widest = float(x.sel(course="loading").max())
        low = -1.0 - 0.16 * (widest + 1.0)
        for line in (ax.axhline, ax.axvline):
            line(0.0, color="0.7", lw=0.7, zorder=0)
        ax.plot([low, 0.0], [0.0, 0.0], color=COMPRESSED, lw=4, alpha=0.45)
        for course, style, label in (
            ("loading", {"color": COMPRESSED, "lw": 4, "alpha": 0.45}, "loading, with its jump at first touch"),
            ("unloading", {"color": STRETCHED, "lw": 1.8}, "unloading, fixed grips"),
            ("unstable", {"color": "k", "lw": 1.2, "ls": "--"}, "unstable"),
        ):
            if np.isfinite(x.sel(course=course)).all():
                ax.plot(x.sel(course=course), y.sel(course=course), label=label, **style)
        for at, start, end, colour in ((0.0, 0.0, touch, COMPRESSED), (-1.0, last, 0.0, STRETCHED)):
            if abs(start - end) > 1e-9:
                jump = {"arrowstyle": "-|>", "color": colour, "lw": 1.4, "ls": ":", "shrinkA": 0, "shrinkB": 0}
                ax.annotate("", (at, end), (at, start), arrowprops=jump)
        ax.plot(-1.0, last, "o", color=STRETCHED, ms=7, label="pull-off under fixed grips")
        at = float(dead_load.pull_off_indentation) / depth
        ax.plot(at, -1.0, "o", mec="k", mfc="none", mew=1.5, ms=11, label="pull-off under dead load")
        for text, known in zip(_KNOWN[str(name)], shape.known_force.to_numpy() / force, strict=True):
            if text:
                ax.axhline(known, color="0.4", lw=0.8, ls=":", zorder=0)
                ax.text(widest, known - 0.02, text, ha="right", va="top", fontsize=11)
        ax.set(xlim=(low, widest), ylim=(-1.3, 1.0), title=name, xlabel="δ / |δ at pull-off under fixed grips|")
    figure.axes[0].set_ylabel("P / |P at pull-off under dead load|")
    figure.axes[1].legend(frameon=False, fontsize=9, loc="upper left")
    return figure


def draw_shape_and_pull_off(result: xr.Dataset) -> Figure:
    """Draw the pull-off force over that of a flat face of the same width, against the exponent, with the worst ones."""
    figure = blank(7.6, 5.0)
    ax = figure.subplots()
    for color, ratio in zip((COMPRESSED, STRETCHED, "#3b7a57"), result.relative_stretch.to_numpy(), strict=True):
        for control, style in (("force", "-"), ("displacement", "--")):
            one = result.sel(relative_stretch=ratio, control=control)
            force = one.held_force / result.flat_force
            label = f"Δℓ(width)/rise = {ratio:g}" if control == "force" else None
            ax.plot(one.exponent, force, color=color, ls=style, lw=1.8, label=label)
            worst = one.worst_force / result.flat_force
            ax.plot(one.worst_exponent, worst, "v", color=color, ms=8, clip_on=False, zorder=3)
            at_rim = one.held_radius.to_numpy() == result.attrs["width"]
            ax.plot(one.exponent[at_rim], force[at_rim], color=color, lw=5, alpha=0.35)
    ax.axhline(1.0, color="0.3", lw=1.0)
    sharpest, flattest = float(result.exponent.min()), float(result.exponent.max())
    ax.text(flattest, 1.01, "flat face, n → ∞ (Kendall): best for every rise ▸", ha="right", va="bottom", fontsize=9)
    for style, label in (("k-", "dead load"), ("k--", "fixed grips"), ("kv", "worst exponent")):
        ax.plot([], [], style, label=label)
    ax.plot([], [], "k-", lw=5, alpha=0.35, label="contact as wide as the asperity")
    ax.set(xscale="log", xlim=(sharpest, flattest), ylim=(0.0, 1.08))
    ax.set_xticks([1, 2, 3, 5, 10, 20, 50, 100], ["1\ncone", "2\nparaboloid", "3", "5", "10", "20", "50", "100"])
    ax.set(xlabel="exponent n of f = rise (r/width)ⁿ", ylabel="pull-off force / that of a flat face of that width")
    ax.legend(frameon=False, fontsize=9, loc="lower right")
    return figure


STUDY = Study(
    "one_asperity", "One asperity under JKR adhesion", measure,
    {"pull_off_curves": draw_pull_off_curves, "shape_and_pull_off": draw_shape_and_pull_off}, report,
    f"{QUICK} of {POINTS} shapes",
)  # fmt: skip
