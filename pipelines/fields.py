"""The fields of one contact: pressure, deformed surface and stress on the axis, for every shape and with adhesion.

    python pipelines/fields.py -o results/studies

Writes fields.nc and three pictures, pressures.png, surfaces.png and axis_stresses.png.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import xarray as xr
from numpy.typing import NDArray

import roughmdr as rm
from roughmdr.shapes import Shape
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance
from roughmdr.variables import FIELDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

MODULUS, WORK, POISSON = 4e6, 0.05, 0.49  # of a soft rubber against a rigid body [Pa], [J/m^2], [1]
RADIUS, DEPTH = 10e-6, 2e-6  # of every contact; of the flat punch [m]
_TABLE = np.linspace(0.0, 3.0 * RADIUS, 16)
SHAPES: dict[str, Shape] = {
    "flat punch": rm.FlatPunch(radius=RADIUS),
    "rounded punch": rm.RoundedPunch(flat_radius=5e-6, edge_radius=18e-6),
    "truncated paraboloid": rm.TruncatedParaboloid(radius=45e-6, flat_radius=4e-6),
    "truncated cone": rm.TruncatedCone(slope=0.17, flat_radius=4e-6),
    "capped paraboloid": rm.CappedParaboloid(radius=45e-6, cap_radius=150e-6, blend_radius=4e-6),
    "power law, n = 4": rm.PowerLaw(exponent=4.0, width=RADIUS, rise=0.7e-6),
    "paraboloid": rm.Paraboloid(radius=50e-6),
    "sphere": rm.Sphere(radius=50e-6),
    "power series, n = 1 and 4": rm.PowerSeries(terms={1.0: 0.05, 4.0: 0.45e-6 / RADIUS**4}),
    "table of a wavy tip": rm.Tabulated(r=_TABLE, f=_TABLE**2 / 80e-6 + 0.1e-6 * (1.0 - np.cos(_TABLE / 1.5e-6))),
    "rounded cone": rm.RoundedCone(slope=0.15, blend_radius=3e-6),
    "cone": rm.Cone(slope=0.127),
}
ADHESION = {"without adhesion": 0.0, "JKR": WORK}
_REACH = 2.4  # of what is drawn, over the contact radius
_COLORS = {"without adhesion": "#1b6ca8", "JKR": "#c8553d"}
_BODY = "#e4e0d8"


def fields(points: int = 480) -> xr.Dataset:
    """All the numbers of this study; no radius is one at which a pressure is infinite."""
    steps = (np.arange(points // 2) + 0.5) / (points // 2)
    over = RADIUS * np.concatenate([np.sin(0.5 * np.pi * steps), 1.0 + (_REACH - 1.0) * steps**2])
    shapes = []
    for shape in SHAPES.values():
        states = []
        for work in ADHESION.values():
            given: dict[str, Any] = {"effective_modulus": MODULUS, "work": work}
            stretch = float(np.sqrt(2.0 * np.pi * RADIUS * work / MODULUS))  # by which the others are lifted too
            given |= {"indentation": DEPTH - stretch} if isinstance(shape, rm.FlatPunch) else {"contact_radius": RADIUS}
            contact = rm.indent(shape, **given)
            indentation = float(contact.indentation)
            profile = shape.f(np.minimum(over, shape.radius)) if isinstance(shape, rm.FlatPunch) else shape.f(over)
            one = rm.axis_stress(shape, z=over, poisson=POISSON, **given)
            one["pressure"] = rm.pressure(shape, r=over, **given)
            one["surface_displacement"] = rm.surface_displacement(shape, r=over, **given)
            one["body_height"] = ("r", profile - indentation, {"units": "m", "long_name": "the body above the surface"})
            for name in ("largest_shear", "largest_shear_depth"):
                if name not in one:  # a sharp tip
                    one[name] = ((), np.nan, FIELDS[name].attrs)
            one["force"] = contact.force
            states.append(one.drop_vars(("indentation", "contact_radius"), errors="ignore").drop_attrs(deep=False))
        shapes.append(xr.concat(states, "adhesion"))
    result = xr.concat(shapes, "shape").assign_coords(
        shape=("shape", list(SHAPES), {"long_name": "shape of the asperity"}),
        adhesion=("adhesion", list(ADHESION), {"long_name": "law of adhesion"}),
    )
    about = provenance("Fields of one contact", "fields.py")
    return result.assign_attrs(about, effective_modulus=MODULUS, work=WORK, poisson=POISSON, contact_radius=RADIUS)


def _panels(result: xr.Dataset, draw: Callable[["Axes", xr.Dataset, str], None], x: str, y: str) -> "Figure":
    """A panel for each shape, and in it both laws."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 9.0), layout="constrained")
    axes = figure.subplots(3, 4, sharex=True, sharey=True)
    for ax, name in zip(axes.flat, result["shape"].to_numpy(), strict=True):
        for law in result.adhesion.to_numpy():
            draw(ax, result.sel(shape=name, adhesion=law), str(law))
        ax.set_title(str(name), fontsize=11)
    for ax in axes[-1]:
        ax.set_xlabel(x)
    for ax in axes[:, 0]:
        ax.set_ylabel(y)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, frameon=False)
    return figure


def draw_pressures(result: xr.Dataset) -> "Figure":
    """Pressure over the radius; where it is infinite the line leaves the panel."""

    def draw(ax: "Axes", one: xr.Dataset, law: str) -> None:
        ax.axhline(0.0, color="0.7", lw=0.7, zorder=0)
        r = one.r.to_numpy() / RADIUS
        p = np.where(r < 1.0, one.pressure.to_numpy(), np.nan) / MODULUS
        ax.plot(np.concatenate([-r[::-1], r]), np.concatenate([p[::-1], p]), color=_COLORS[law], lw=1.6, label=law)
        ax.set(xlim=(-1.2, 1.2), ylim=(-0.12, 0.28))

    return _panels(result, draw, "r / a", "p / E*")


def draw_surfaces(result: xr.Dataset) -> "Figure":
    """The body and the surface that it deforms, both in micrometres; the surface rises where it is pulled."""

    def draw(ax: "Axes", one: xr.Dataset, law: str) -> None:
        r, body = 1e6 * one.r.to_numpy(), 1e6 * one.body_height.to_numpy()
        u = 1e6 * one.surface_displacement.to_numpy()
        around = np.concatenate([-r[::-1], r])
        if law == "JKR":
            solid = np.where(r <= 1e6 * RADIUS, body, 9.0) if one["shape"] == "flat punch" else body
            ax.fill_between(around, np.concatenate([solid[::-1], solid]), 9.0, color=_BODY, lw=0, zorder=0)
            ax.axhline(0.0, color="0.7", lw=0.7, zorder=-1)
        ax.plot(around, -np.concatenate([u[::-1], u]), color=_COLORS[law], lw=1.6, label=law)
        ax.set(xlim=(-24.0, 24.0), ylim=(-3.0, 2.4))

    return _panels(result, draw, "r [µm]", "height of the surface [µm]")


def draw_axis_stresses(result: xr.Dataset) -> "Figure":
    """Stresses on the axis over the depth, downwards; the largest shear marked."""

    def draw(ax: "Axes", one: xr.Dataset, law: str) -> None:
        z = one.z.to_numpy() / RADIUS
        for name, style in (("sigma_zz", "-"), ("sigma_rr", "--"), ("shear", ":")):
            label = {"sigma_zz": "σzz", "sigma_rr": "σrr", "shear": "|σzz − σrr|/2"}[name]
            ax.plot(one[name] / MODULUS, z, color=_COLORS[law], ls=style, lw=1.5, label=f"{label}, {law}")
        ax.plot(one.largest_shear / MODULUS, one.largest_shear_depth / RADIUS, "o", color=_COLORS[law], ms=5)
        ax.axvline(0.0, color="0.7", lw=0.7, zorder=0)
        ax.set(xlim=(-0.3, 0.15), ylim=(_REACH, 0.0))

    return _panels(result, draw, "stress / E*, tension > 0", "depth z / a")


PICTURES: dict[str, Callable[[xr.Dataset], "Figure"]] = {
    "pressures.png": draw_pressures,
    "surfaces.png": draw_surfaces,
    "axis_stresses.png": draw_axis_stresses,
}


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
def main(output: Path) -> None:
    """Compute, print, write fields.nc and three pictures."""
    output.mkdir(parents=True, exist_ok=True)
    result = fields()
    write_netcdf(Labelled.of(result), output / "fields.nc")
    for name, draw in PICTURES.items():
        with replace_atomically(output / name) as temporary:
            draw(result).savefig(temporary, dpi=160, format="png")
    for shape in result["shape"].to_numpy():
        one = result.sel(shape=shape, adhesion="without adhesion")
        text = "without bound towards the tip"
        if one.largest_shear.notnull():
            text = (
                f"{float(one.largest_shear):.5g} Pa, {float(one.largest_shear_depth) / RADIUS:.3f} a below the surface"
            )
        click.echo(f"{shape:<26} largest shear on the axis {text}")


if __name__ == "__main__":
    main()
