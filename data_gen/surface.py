"""Make a synthetic rough surface: a periodic self-affine height map, as netCDF with height(x, y) in m.

    python data_gen/surface.py results/surface.nc --points 256 --size "100 um" --rms "0.5 um" --short-wave "6 um"

The spectrum is C(q) ~ q^(-2 (1 + H)) between the long- and the short-wave cut-off; phases and amplitudes are random.
"""

import shlex
import sys
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.labelled import Labelled
from roughmdr.store import provenance, write
from roughmdr.units import quantity


def self_affine(
    points: int, size: float, rms: float, hurst: float, long_wave: float, short_wave: float, seed: int
) -> NDArray[np.float64]:
    """Heights [m] on a periodic square grid of points x points over ``size`` [m], with r.m.s. height ``rms`` [m].

    OutOfRange where the grid cannot hold the waves: 2 spacings <= short_wave < long_wave <= size.
    """
    if not 2.0 * size / points <= short_wave < long_wave <= size:
        raise OutOfRange(
            f"short_wave {short_wave:g} m and long_wave {long_wave:g} m must lie between two spacings, "
            f"{2.0 * size / points:g} m, and the size, {size:g} m"
        )
    along = 2.0 * np.pi * np.fft.fftfreq(points, size / points)
    q = np.hypot(along[:, None], along[None, :])
    inside = (q >= 2.0 * np.pi / long_wave * (1 - 1e-9)) & (q <= 2.0 * np.pi / short_wave * (1 + 1e-9))
    amplitude = np.where(inside, q, np.inf) ** (-1.0 - hurst)
    noise = np.random.Generator(np.random.Philox(seed)).standard_normal((points, points))
    height = np.fft.ifft2(np.fft.fft2(noise) * amplitude).real
    return height * (rms / np.std(height))


def _length(text: str) -> float:
    return quantity(text, "m")


@click.command(help=(__doc__ or "").split("\n")[0])
@click.argument("output", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--points", type=click.IntRange(8, 8192), default=256, show_default=True, help="Grid points a side.")
@click.option("--size", default="100 um", show_default=True, help="Side of the map.")
@click.option("--rms", default="0.5 um", show_default=True, help="Root-mean-square height.")
@click.option("--hurst", type=click.FloatRange(0.0, 1.0), default=0.8, show_default=True)
@click.option("--long-wave", default="50 um", show_default=True, help="Longest wavelength.")
@click.option("--short-wave", default="6 um", show_default=True, help="Shortest wavelength.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
def main(
    output: Path, points: int, size: str, rms: str, hurst: float, long_wave: str, short_wave: str, seed: int
) -> None:
    """Write a synthetic height map."""
    import xarray as xr

    try:
        side = _length(size)
        height = self_affine(points, side, _length(rms), hurst, _length(long_wave), _length(short_wave), seed)
        at = ((np.arange(points) + 0.5) * side / points, {"units": "m", "long_name": "position"})
        dataset = xr.Dataset(
            {"height": (("x", "y"), height, {"units": "m", "long_name": "surface height"})},
            coords={"x": ("x", *at), "y": ("y", *at)},
            attrs=provenance(
                f"Synthetic self-affine surface, Hurst exponent {hurst:g}, seed {seed}",
                f"surface.py {shlex.join(sys.argv[1:])}",
            ),
        )
        output.parent.mkdir(parents=True, exist_ok=True)
        write(Labelled.of(dataset), output)
    except RoughmdrError as error:
        raise click.UsageError(str(error)) from None
    click.echo(f"{output}: {points} x {points} points")


if __name__ == "__main__":
    main()
