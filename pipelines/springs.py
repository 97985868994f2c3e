"""The row of springs: how one asperity is pressed and let go by it, and what its error costs.

    python pipelines/springs.py -o results/studies

Writes springs.nc, springs_row.png (after Fig. 8 of M. Heß, "On the reduction method of dimensionality: the exact
mapping of axisymmetric contact problems with and without adhesion", 2012) and springs_error.png. Errors are those at
given indentations against the closed forms; run times are those of ``rm.indent``, per contact.
"""

import time
import warnings
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from springs_pictures import PICTURES

import roughmdr as rm
from roughmdr.shapes import Shape
from roughmdr.springs import Springs
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance

Floats = NDArray[np.float64]

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


def row_of_springs(points: int = 2401) -> xr.Dataset:
    """A paraboloid on a coarse row along a path in and out, its exact law, and the row at three of its points."""
    tip = rm.Paraboloid(radius=RADIUS)
    off = rm.pull_off(tip, effective_modulus=MODULUS, work=WORK)
    way_in = -float(off.indentation) * np.linspace(-1.45, 2.2, points)
    path = np.append(way_in, way_in[-2::-1])
    contact = Springs.of(tip, MODULUS, WORK, DRAWN)
    state = contact.follow(path)
    row, _, _ = next(contact.rows.fitted(path.max(keepdims=True), loaded=False))
    exact = rm.indent(tip, effective_modulus=MODULUS, work=WORK, indentation=path).force.to_numpy()
    exact[:points][way_in < 0.0] = 0.0  # not yet touched
    held = np.flatnonzero(state["contact_radius"])
    stages = {
        "pressed": points - 1,
        "pulled": points + int(np.flatnonzero(path[points:] >= 0.0)[-1]),
        "last contact": int(held[-1]),
    }
    at = list(stages.values())
    side = row.spacing * (np.arange(DRAWN + 1) + 0.5)
    position, depth = np.append(-side[::-1], side), np.append(row.g[::-1], row.g)
    inside = np.abs(position) < state["contact_radius"][at][:, None]
    ends = np.where(inside, depth - path[at][:, None], 0.0)

    def metres(dims: str, values: Floats, name: str) -> tuple[tuple[str, ...], Floats, dict[str, str]]:
        return tuple(dims.split()), values, {"units": "m", "long_name": name}

    return xr.Dataset(
        {
            "path_indentation": metres("point", path, "indentation"),
            "path_force": ("point", state["force"], {"units": "N", "long_name": "force of the row of springs"}),
            "path_force_exact": ("point", exact, {"units": "N", "long_name": "force, exact"}),
            "spring_depth": metres("spring", depth, "MDR profile at a spring, g(x)"),
            "spring_end": metres("stage spring", ends, "end of a spring above the undeformed surface"),
            "stage_indentation": metres("stage", path[at], "indentation"),
            "stage_contact_radius": metres("stage", state["contact_radius"][at], "contact radius"),
            "stage_force": ("stage", state["force"][at], {"units": "N", "long_name": "force of the row of springs"}),
        },
        coords={
            "spring_position": metres("spring", position, "distance of a spring from the axis"),
            "stage": ("stage", list(stages), {"long_name": "state of the row of springs"}),
        },
    )


class Point(NamedTuple):
    """What a number of springs makes of some contacts."""

    force_error: float
    radius_error: float
    seconds: float


def measured(shape: Shape, work: float, counts: NDArray[np.int64], repeats: int) -> tuple[list[Point], float]:
    """The errors and the time per contact for each number of springs, and that of the closed forms."""
    off = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK)
    depth = -float(off.indentation) * (DEPTHS - (1.0 if work else 0.0))
    exact = rm.indent(shape, effective_modulus=MODULUS, work=work, indentation=depth)
    scale = np.abs(exact.force) - float(rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control="force").force)
    points = []
    for count in counts:
        row, seconds = _timed(shape, work, depth, repeats, int(count))
        force = float(np.sqrt((((row.force - exact.force) / scale) ** 2).mean()))
        radius = float(np.sqrt(((row.contact_radius / exact.contact_radius - 1.0) ** 2).mean()))
        points.append(Point(force, radius, seconds))
    return points, _timed(shape, work, depth, repeats, None)[1]


def _timed(shape: Shape, work: float, depth: Floats, repeats: int, count: int | None) -> tuple[xr.Dataset, float]:
    """The contacts by so many springs, or by the closed forms, and the shortest time for one [s]."""
    seconds = []
    for _ in range(repeats):
        started = time.perf_counter()
        if count is None:
            found = rm.indent(shape, effective_modulus=MODULUS, work=work, indentation=depth)
        else:
            found = rm.indent(
                shape, effective_modulus=MODULUS, work=work, indentation=depth, method="springs", springs=count
            )
        seconds.append((time.perf_counter() - started) / depth.size)
    return found, min(seconds)


def order(counts: NDArray[np.int64], errors: Floats) -> float:
    """The p of errors ~ N^-p, by least squares in logarithms; NaN where they are roundings."""
    if (errors < EXACT).any():
        return float("nan")
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


def errors(counts: NDArray[np.int64], repeats: int) -> xr.Dataset:
    """Errors, orders and run times of all shapes, with and without adhesion."""
    found = [[measured(shape, work, counts, repeats) for work in ADHESION.values()] for shape in SHAPES.values()]
    points = np.array([[points for points, _ in one] for one in found])
    over = ("shape", "adhesion", "springs")
    orders = np.array([[[order(counts, errors) for errors in one.T[:2]] for one in both] for both in points])

    def named(name: str, units: str = "1") -> dict[str, str]:
        return {"units": units, "long_name": name}

    return xr.Dataset(
        {
            "force_error": (over, points[..., 0], named("relative error of the force, root mean square")),
            "radius_error": (over, points[..., 1], named("relative error of the contact radius, root mean square")),
            "force_order": (over[:2], orders[..., 0], named("order of the force in the number of springs")),
            "radius_order": (over[:2], orders[..., 1], named("order of the contact radius in the number of springs")),
            "time": (over, points[..., 2], named("run time per contact", "s")),
            "time_exact": (
                over[:2],
                np.array([[seconds for _, seconds in one] for one in found]),
                named("run time per contact of the closed forms", "s"),
            ),
        },
        coords={
            "shape": ("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
            "adhesion": ("adhesion", list(ADHESION), {"long_name": "model of adhesion"}),
            "springs": ("springs", counts, named("number of springs")),
        },
    )


def study(quick: bool) -> xr.Dataset:
    """All the numbers of this study; ``quick`` on short rows."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # both sides of each comparison suppose small slopes
        result = xr.merge([row_of_springs(), errors(QUICK, 1) if quick else errors(COUNTS, 2)])
    return result.assign_attrs(
        provenance("One asperity as a row of springs", "springs.py"),
        effective_modulus=MODULUS,
        work=WORK,
        radius=RADIUS,
    )


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Short rows: seconds, and rough figures.")
def main(output: Path, quick: bool) -> None:
    """Compute, print, write springs.nc and two pictures."""
    output.mkdir(parents=True, exist_ok=True)
    result = study(quick)
    write_netcdf(Labelled.of(result), output / "springs.nc")
    for name, draw in PICTURES.items():
        with replace_atomically(output / name) as temporary:
            draw(result).savefig(temporary, dpi=160, format="png")
    last = result.isel(springs=-1)
    for name in SHAPES:
        for model in ADHESION:
            one = last.sel(shape=name, adhesion=model)
            click.echo(
                f"{name:<21} {model:<5} force: order {float(one.force_order):.2f}, error {float(one.force_error):.1e}; "
                f"radius: order {float(one.radius_order):.2f}; {int(one.springs)} springs "
                f"{1e3 * float(one.time):.3g} ms, closed forms {1e3 * float(one.time_exact):.3g} ms"
            )


if __name__ == "__main__":
    main()
