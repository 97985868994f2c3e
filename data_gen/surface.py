"""Make a synthetic rough surface: a periodic self-affine height map, as netCDF with height(x, y) in m.

    python data_gen/surface.py results/surface.nc --points 256 --size "100 um" --rms "0.5 um" --short-wave "6 um"

The spectrum is C(q) ~ q^(-2 (1 + H)) between the long- and the short-wave cut-off; phases and amplitudes are random.
The map is scaled to have the r.m.s. height, or with --slope the r.m.s. slope, exactly.
"""

import shlex
import sys
from pathlib import Path

import click
import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import DIMENSIONLESS, quantity
from roughmdr.spectrum import SelfAffine
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf
from roughmdr.storage.result_file import provenance

sys.path.insert(0, str(Path(__file__).parents[1] / "pipelines"))
from oracles.gaussian_maps import gaussian_map, rms_slope


@click.command(help=(__doc__ or "").split("\n")[0])
@click.argument("output", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--points", type=click.IntRange(8, 8192), default=256, show_default=True, help="Grid points a side.")
@click.option("--size", default="100 um", show_default=True, help="Side of the map.")
@click.option("--rms", help="Root-mean-square height.  [default: 0.5 um, without --slope]")
@click.option("--slope", help="Root-mean-square slope, instead of --rms.")
@click.option("--hurst", type=click.FloatRange(0.0, 1.0), default=0.8, show_default=True)
@click.option("--long-wave", default="50 um", show_default=True, help="Longest wavelength.")
@click.option("--short-wave", default="6 um", show_default=True, help="Shortest wavelength.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
def main(
    output: Path,
    points: int,
    size: str,
    rms: str | None,
    slope: str | None,
    hurst: float,
    long_wave: str,
    short_wave: str,
    seed: int,
) -> None:
    """Write a synthetic height map."""
    import xarray as xr

    if rms is not None and slope is not None:
        raise click.UsageError("takes --rms or --slope, not both")
    try:
        side = quantity(size, "m")
        waves = {"hurst": hurst, "long_wave": quantity(long_wave, "m"), "short_wave": quantity(short_wave, "m")}
        if slope is None:
            wanted = SelfAffine.of(**waves, rms_height=quantity(rms or "0.5 um", "m"))
        else:
            wanted = SelfAffine.of(**waves, rms_slope=quantity(slope, DIMENSIONLESS))
        height = gaussian_map(wanted, points, side, seed)
        height *= wanted.rms_height / np.std(height) if slope is None else wanted.rms_slope / rms_slope(height, side)
        at = ((np.arange(points) + 0.5) * side / points, {"units": "m", "long_name": "position"})
        title = f"Synthetic self-affine surface, Hurst exponent {hurst:g}, seed {seed}"
        dataset = xr.Dataset(
            {"height": (("x", "y"), height, {"units": "m", "long_name": "surface height"})},
            coords={"x": ("x", *at), "y": ("y", *at)},
            attrs={**provenance(title, f"surface.py {shlex.join(sys.argv[1:])}"), "periodic": 1},
        )
        output.parent.mkdir(parents=True, exist_ok=True)
        write_netcdf(Labelled.of(dataset), output)
    except RoughmdrError as error:
        raise click.UsageError(str(error)) from None
    click.echo(f"{output}: {points} x {points} points")


if __name__ == "__main__":
    main()
