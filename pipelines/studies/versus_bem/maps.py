"""Gaussian self-affine maps, and their summits as the ensemble of independent asperities."""

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from oracles.gaussian_maps import gaussian_map

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from studies.versus_bem.ensembles import SIZE

_SLOPE = 1e-3  # r.m.s., small: nothing depends on it


class MapCase(NamedTuple):
    """A map of a self-affine spectrum; its waves as shares of the side."""

    hurst: float
    long_wave: float
    short_wave: float
    points: int
    """A side of the grid."""
    seed: int

    @property
    def labels(self) -> tuple[str, str, float]:
        """Placement, shape, and the ratio of the wavelengths."""
        return "map", f"hurst {self.hurst:g}", self.long_wave / self.short_wave

    def build(self) -> tuple[xr.Dataset, Floats, Floats]:
        """Return the summits, and the map on its grid and on every second point of it, which still holds its waves."""
        waves = {"long_wave": self.long_wave * SIZE, "short_wave": self.short_wave * SIZE}
        spectrum = SelfAffine.of(hurst=self.hurst, rms_slope=_SLOPE, **waves)
        height = gaussian_map(spectrum, self.points, SIZE, self.seed)
        with tempfile.TemporaryDirectory() as folder:
            write_map(height, SIZE, Path(folder) / "map.nc")
            summits = rm.generate({"source": "surface", "file": str(Path(folder) / "map.nc")}, seed=0)
        return summits, height, height[::2, ::2]


def write_map(height: Floats, size: float, file: Path) -> None:
    """Write a periodic map of heights [m] over ``size`` [m] as netCDF."""
    along = np.arange(height.shape[0]) * size / height.shape[0]
    stored = xr.Dataset(
        {"height": (("x", "y"), height, {"units": "m"})},
        {axis: (axis, along, {"units": "m"}) for axis in "xy"},
        {"periodic": 1},
    )
    write_netcdf(Labelled.of(stored), file)
