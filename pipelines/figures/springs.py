"""The row of springs: how it loads and unloads one asperity, and its error against its run time.

The row is drawn as in Fig. 8 of M. Heß, "On the reduction method of dimensionality: the exact mapping of axisymmetric
contact problems with and without adhesion", 2012. Errors are those at given indentations against the closed forms; run
times are those of ``rm.indent``, per contact.
"""

import time
import warnings
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from studies.study import named

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.springs import Springs

MODULUS, WORK = 4e6, 0.05  # of a soft rubber against a rigid body [Pa], [J/m^2]
RADIUS = 50e-6  # of the asperity whose row is drawn [m]
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
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}


def row_of_springs(points: int = 2401) -> xr.Dataset:
    """Return a paraboloid on a coarse row, loading and unloading, beside the exact force; the row at three points."""
    tip = rm.Paraboloid(radius=RADIUS)
    loading = -float(rm.pull_off(tip, **_MATERIAL).indentation) * np.linspace(-1.45, 2.2, points)
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
            "spring_depth": ("spring", depth, named("MDR profile at a spring, g(x)", "m")),
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


def errors_of(shape: Shape, work: float, counts: NDArray[np.int64], repeats: int) -> tuple[Floats, float]:
    """Return the errors of force and radius and the time per contact [s] of each count, and that of closed forms."""
    off = rm.pull_off(shape, **_MATERIAL)
    depth = -float(off.indentation) * (DEPTHS - (1.0 if work else 0.0))
    exact, seconds = _timed(shape, work, depth, repeats)
    scale = np.abs(exact.force) - float(rm.pull_off(shape, **_MATERIAL, control="force").force)
    points = []
    for count in counts:
        row, time_of_row = _timed(shape, work, depth, repeats, method="springs", springs=int(count))
        relative = (row.force - exact.force) / scale, row.contact_radius / exact.contact_radius - 1.0
        points.append([*(float(np.sqrt((error**2).mean())) for error in relative), time_of_row])
    return np.array(points), seconds


def _timed(shape: Shape, work: float, depth: Floats, repeats: int, **method: Any) -> tuple[xr.Dataset, float]:
    """Return the contacts, by closed forms or by springs, and the shortest time for one [s]."""
    seconds = []
    for _ in range(repeats):
        started = time.perf_counter()
        found = rm.indent(shape, effective_modulus=MODULUS, work=work, indentation=depth, **method)
        seconds.append((time.perf_counter() - started) / depth.size)
    return found, min(seconds)


def order(counts: NDArray[np.int64], errors: Floats) -> float:
    """Return p of errors ~ N^-p, by least squares in logarithms; NaN where they are roundings."""
    if (errors < EXACT).any():
        return float("nan")
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


def errors(counts: NDArray[np.int64], repeats: int) -> xr.Dataset:
    """Return errors, orders and run times of all shapes, with and without adhesion."""
    found = [[errors_of(shape, work, counts, repeats) for work in ADHESION.values()] for shape in SHAPES.values()]
    points = np.array([[points for points, _ in one] for one in found])
    exact = np.array([[seconds for _, seconds in one] for one in found])
    orders = np.array([[[order(counts, errors) for errors in one.T[:2]] for one in both] for both in points])
    over = ("shape", "adhesion", "springs")
    return xr.Dataset(
        {
            "force_error": (over, points[..., 0], named("relative error of the force, root mean square")),
            "radius_error": (over, points[..., 1], named("relative error of the contact radius, root mean square")),
            "force_order": (over[:2], orders[..., 0], named("order of the force in the number of springs")),
            "radius_order": (over[:2], orders[..., 1], named("order of the contact radius in the number of springs")),
            "time": (over, points[..., 2], named("run time per contact", "s")),
            "time_exact": (over[:2], exact, named("run time per contact of the closed forms", "s")),
        },
        coords={
            "shape": ("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
            "adhesion": ("adhesion", list(ADHESION), {"long_name": "model of adhesion"}),
            "springs": ("springs", counts, named("number of springs")),
        },
    )


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure; ``quick`` on short rows."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # both sides of each comparison suppose small slopes
        result = xr.merge([row_of_springs(), errors(QUICK, 1) if quick else errors(COUNTS, 2)])
    return result.assign_attrs(**_MATERIAL, radius=RADIUS)


def report(result: xr.Dataset) -> str:
    """Return the orders, and the errors and run times of the longest row."""
    lines, last = [], result.isel(springs=-1)
    for name in result["shape"].to_numpy():
        for model in result.adhesion.to_numpy():
            one = last.sel(shape=name, adhesion=model)
            lines.append(
                f"{name:<21} {model:<5} force: order {float(one.force_order):.2f}, error {float(one.force_error):.1e}; "
                f"radius: order {float(one.radius_order):.2f}; {int(one.springs)} springs "
                f"{1e3 * float(one.time):.3g} ms, closed forms {1e3 * float(one.time_exact):.3g} ms"
            )
    return "\n".join(lines)
