"""The row of springs: how it loads and unloads one asperity, and how it converges.

The row is drawn as in Fig. 8 of M. Heß, "On the reduction method of dimensionality: the exact mapping of axisymmetric
contact problems with and without adhesion", 2012. Errors are those at given indentations against the closed forms.
"""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from studies.study import Axes, Figure, Study, blank, named, without_limits

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.asperity import coils
from roughmdr.shapes import Shape
from roughmdr.springs import Springs

MODULUS, WORK = 4e6, 0.05  # a soft rubber against a rigid body [Pa], [J/m^2]
RADIUS = 50e-6  # radius of the asperity whose row is drawn [m]
DRAWN = 20  # springs on each side of it
_TABLE = np.linspace(0.0, 40e-6, 21)
SHAPES: dict[str, Shape] = {
    "flat punch": rm.FlatPunch(radius=7.3e-6),
    "cone": rm.Cone(slope=0.17),
    "paraboloid": rm.Paraboloid(radius=RADIUS),
    "sphere": rm.Sphere(radius=RADIUS),
    "power law, n = 0.7": rm.PowerLaw(exponent=0.7, width=1e-6, rise=0.6e-6),
    "power series": rm.PowerSeries({1.2: 0.5, 2.0: 3e3, 6.0: 1e22}),
    "truncated cone": rm.TruncatedCone(slope=0.17, flat_radius=6.1e-6),
    "truncated paraboloid": rm.TruncatedParaboloid(radius=RADIUS, flat_radius=6.1e-6),
    "rounded cone": rm.RoundedCone(slope=0.17, blend_radius=8.3e-6),
    "capped paraboloid": rm.CappedParaboloid(radius=RADIUS, cap_radius=2.7 * RADIUS, blend_radius=6.1e-6),
    "rounded punch": rm.RoundedPunch(flat_radius=6.1e-6, edge_radius=RADIUS),
    "tabulated": rm.Tabulated(_TABLE, 0.07 * _TABLE + _TABLE**2 / 90e-6),
}
ADHESION = {"none": 0.0, "jkr": WORK}
COUNTS = 100 * 2 ** np.arange(9)
QUICK = COUNTS[:4]
DEPTHS = np.geomspace(0.31, 23.0, 16)  # above the fold, over its depth
EXACT = 1e-12  # errors below are roundings
COMPRESSED, STRETCHED = "#1b6ca8", "#c8553d"  # colours of springs and of courses
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}
_STAGES = {
    "pressed": "A  loading: springs attach up to a stretch u of Δℓ(x)",
    "pulled": "B  back at first touch: all are stretched",
    "last contact": "C  the last contact under fixed grips",
}


def row_of_springs(points: int = 2401) -> xr.Dataset:
    """Return a paraboloid on a coarse row, loading and unloading, beside the exact force; the row at three points."""
    tip = rm.Paraboloid(radius=RADIUS)
    depth_of_fold = -float(rm.pull_off(tip, **_MATERIAL, control="displacement").indentation)
    loading = depth_of_fold * np.linspace(-1.45, 2.2, points)
    path = np.append(loading, loading[-2::-1])
    contact = Springs.of(tip, MODULUS, WORK, DRAWN)
    state = contact.follow(path)
    radius, force = state["contact_radius"], state["force"]
    row, _, _ = next(contact.fitted(path.max(keepdims=True), loaded=False))
    exact = rm.indent(tip, **_MATERIAL, indentation=path).force.to_numpy()
    exact[:points][loading < 0.0] = 0.0  # not yet in contact
    stages = {
        "pressed": points - 1,
        "pulled": points + int(np.flatnonzero(path[points:] >= 0.0)[-1]),
        "last contact": int(np.flatnonzero(radius)[-1]),
    }
    at = list(stages.values())
    side = row.spacing * (np.arange(DRAWN + 1) + 0.5)
    position, depth = np.append(-side[::-1], side), np.append(row.g[::-1], row.g)
    ends = np.where(np.abs(position) < radius[at][:, None], depth - path[at][:, None], 0.0)
    return xr.Dataset(
        {
            "path_indentation": ("point", path, named("indentation", "m")),
            "path_force": ("point", force, named("force of the row of springs", "N")),
            "path_force_exact": ("point", exact, named("force, exact", "N")),
            "spring_end": (("stage", "spring"), ends, named("end of a spring above the undeformed surface", "m")),
            "stage_indentation": ("stage", path[at], named("indentation", "m")),
            "stage_contact_radius": ("stage", radius[at], named("contact radius", "m")),
            "stage_force": ("stage", force[at], named("force of the row of springs", "N")),
        },
        coords={
            "spring_position": ("spring", position, named("distance of a spring from the axis", "m")),
            "stage": ("stage", list(stages), {"long_name": "state of the row of springs"}),
        },
    )


def errors_of(shape: Shape, work: float, counts: NDArray[np.int64]) -> Floats:
    """Return the errors of force and radius for each number of springs."""
    off = rm.pull_off(shape, **_MATERIAL, control="displacement")
    depth = -float(off.indentation) * (DEPTHS - (1.0 if work else 0.0))
    given: Any = {"effective_modulus": MODULUS, "work": work, "indentation": depth}
    exact = rm.indent(shape, **given)
    scale = np.abs(exact.force) - float(rm.pull_off(shape, **_MATERIAL, control="force").force)
    errors = []
    for count in counts:
        row = rm.indent(shape, **given, method="springs", springs=int(count))
        relative = (row.force - exact.force) / scale, row.contact_radius / exact.contact_radius - 1.0
        errors.append([float(np.sqrt((error**2).mean())) for error in relative])
    return np.array(errors)


def order(counts: NDArray[np.int64], errors: Floats) -> float:
    """Return p of errors ~ N^-p, by least squares in logarithms; NaN where they are roundings."""
    if (errors < EXACT).any():
        return float("nan")
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


def errors(counts: NDArray[np.int64]) -> xr.Dataset:
    """Return errors and orders of all shapes, with and without adhesion."""
    found = np.array([[errors_of(shape, work, counts) for work in ADHESION.values()] for shape in SHAPES.values()])
    orders = np.apply_along_axis(lambda one: order(counts, one), 2, found)
    over = ("shape", "adhesion", "springs")
    return xr.Dataset(
        {
            "force_error": (over, found[..., 0], named("relative error of the force, root mean square")),
            "radius_error": (over, found[..., 1], named("relative error of the contact radius, root mean square")),
            "force_order": (over[:2], orders[..., 0], named("order of the force in the number of springs")),
            "radius_order": (over[:2], orders[..., 1], named("order of the contact radius in the number of springs")),
        },
        coords={
            "shape": ("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
            "adhesion": ("adhesion", list(ADHESION), {"long_name": "model of adhesion"}),
            "springs": ("springs", counts, named("number of springs")),
        },
    )


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure; ``quick`` on short rows."""
    with without_limits():  # both sides of each comparison suppose small slopes
        result = xr.merge([row_of_springs(), errors(QUICK if quick else COUNTS)])
    return result.assign_attrs(**_MATERIAL, radius=RADIUS)


def report(result: xr.Dataset) -> str:
    """Return the orders, and the error of the longest row."""
    lines, last = [], result.isel(springs=-1)
    for name in result["shape"].to_numpy():
        for model in result.adhesion.to_numpy():
            one = last.sel(shape=name, adhesion=model)
            error = f"error {float(one.force_error):.1e} with {int(one.springs)} springs"
            of_force, of_radius = f"order {float(one.force_order):.2f}", f"order {float(one.radius_order):.2f}"
            lines.append(f"{name:<21} {model:<5} force: {of_force}, {error}; radius: {of_radius}")
    return "\n".join(lines)


def draw_row(result: xr.Dataset) -> Figure:
    """Draw the row at three points of its path, and the path over the exact one; lengths in micrometres."""
    figure = blank(15, 7.6)
    grid = figure.add_gridspec(1, 2, width_ratios=[1.25, 1.0])
    rows, path = figure.add_subfigure(grid[0]), figure.add_subfigure(grid[1])
    axes = rows.subplots(3, 1, sharex=True)
    for ax, (name, title) in zip(axes, _STAGES.items(), strict=True):
        stage = result.sel(stage=name)
        _draw_stage(ax, stage, result.attrs["radius"])
        delta, a, force = (1e6 * float(stage[f"stage_{one}"]) for one in ("indentation", "contact_radius", "force"))
        ax.set_title(title, fontsize=10.5, loc="left")
        ax.set_title(f"δ = {delta:+.3f} µm,  a = {a:.2f} µm,  P = {force:.2f} µN", fontsize=9, loc="right")
    axes[-1].set_xlabel("x [µm]")
    rows.supylabel("height above the undeformed surface [µm]", fontsize=10)
    _draw_path(path.subplots(), result)
    return figure


def _draw_stage(ax: Axes, stage: xr.Dataset, radius: float) -> None:
    """Draw the MDR profile of the tip, the springs and the stretch of the outermost one in contact."""
    from matplotlib.collections import LineCollection

    positions, ends = (1e6 * stage[name].to_numpy() for name in ("spring_position", "spring_end"))
    bottom, top, half = -0.95, 0.8, 1.02 * float(positions[-1])
    x = np.linspace(-half, half, 401)
    g = 1e6 * rm.Paraboloid(radius=radius).g(1e-6 * np.abs(x))
    profile = g - 1e6 * float(stage.stage_indentation)
    ax.fill_between(x, profile, top, where=list(profile <= top), color="#e4e0d8", lw=0)
    ax.plot(x, profile, color="#4a4a4a", lw=1.4)
    ax.axhline(0.0, color="0.45", lw=0.9, ls=(0, (6, 4)), zorder=0)
    contact = np.abs(positions) < 1e6 * float(stage.stage_contact_radius)
    colors = list(np.where(contact, np.where(ends > 0.0, STRETCHED, COMPRESSED), "#9a9a9a"))
    width = 0.2 * float(positions[1] - positions[0])
    ax.add_collection(LineCollection(coils(positions, ends, bottom, width), colors=colors, linewidths=0.9))
    ax.scatter(positions, ends, s=9, c=colors, zorder=3)
    ax.axhline(bottom, color="#4a4a4a", lw=2.5)
    outer = np.flatnonzero(contact)[-1]
    x_outer, u = float(positions[outer]), float(ends[outer])
    ax.annotate(
        "", (x_outer, u), (x_outer, 0.0), arrowprops={"arrowstyle": "<->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    )
    ax.text(x_outer + 0.25, 0.5 * u, "u", ha="center", va="center", fontsize=12)
    ax.set(xlim=(-half, half), ylim=(bottom - 0.02, top))


def _draw_path(ax: Axes, result: xr.Dataset) -> None:
    """Draw force against indentation, loading and unloading."""
    depth = 1e6 * result.path_indentation.to_numpy()
    turning, springs = int(np.argmax(depth)), result.sizes["spring"] // 2 - 1
    for part, color, label in (
        (slice(0, turning + 1), COMPRESSED, "loading"), (slice(turning, None), STRETCHED, "unloading")
    ):  # fmt: skip
        exact, row = (1e6 * result[name][part] for name in ("path_force_exact", "path_force"))
        ax.plot(depth[part], exact, color=color, lw=5.0, alpha=0.25, label=f"{label}, exact")
        ax.plot(depth[part], row, color=color, lw=1.1, label=f"{label}, {springs} springs a side")
    for name, title in _STAGES.items():
        stage = result.sel(stage=name)
        at = 1e6 * float(stage.stage_indentation), 1e6 * float(stage.stage_force)
        ax.plot(*at, "ko", ms=5, zorder=4)
        ax.annotate(title[0], at, (7, -12), textcoords="offset points", fontsize=12, weight="bold")
    for line in (ax.axhline, ax.axvline):
        line(0.0, color="0.7", lw=0.7, zorder=0)
    ax.set(xlabel="indentation δ [µm]", ylabel="force P [µN]")
    ax.set_title("Every tooth is a pair of springs that attaches or detaches", fontsize=10.5)
    ax.legend(frameon=False, fontsize=9.5, loc="upper left")


STUDY = Study(
    "springs", "One asperity as a row of springs", measure, {"springs_row": draw_row}, report,
    f"rows of up to {max(QUICK)} of {max(COUNTS)} springs",
)  # fmt: skip
