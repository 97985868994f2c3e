"""The files that random scenes read: an ensemble of each shape, and maps."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.shapes import SHAPES

FILE_SIZE = 1e-6  # of the heights [m]


class Inputs(NamedTuple):
    """Files that scenes read, and the shapes for which adhesion of finite range is drawn."""

    ensembles: dict[str, str]
    """The file of each shape."""
    maps: tuple[str, ...]
    cohesive: tuple[str, ...]

    @classmethod
    def written(cls, folder: Path, cohesive: tuple[str, ...]) -> "Inputs":
        """Write small ensembles of all shapes and two small maps."""
        ensembles = {}
        for name, shape in SHAPES.items():
            given: dict[str, Any] = {
                key: 1e2 * FILE_SIZE if shape.units[key] == "m" else 2.5 for key in shape.parameter_sets[-1]
            }
            if name == "power_series":
                given = {"terms": {"2": 1e4, "4": 1e13}}
            if name == "tabulated":
                given = {"r": [0.0, 1e-5, 3e-5, 6e-5], "f": [0.0, 5e-7, 5e-6, 3e-5]}
            height = {"distribution": "normal", "std": FILE_SIZE}
            section = {"source": "random", "shape": name, "count": 5, "patch": 1e-3, "height": height, **given}
            ensembles[name] = str(folder / f"{name}.nc")
            rm.generate(section, seed=1).to_netcdf(ensembles[name])
        noise = np.random.default_rng(1).standard_normal((48, 48))
        waves = np.fft.fftfreq(48)
        smooth = np.fft.ifft2(np.fft.fft2(noise) * np.exp(-((waves[:, None] ** 2 + waves**2) / 0.1**2))).real
        x = np.arange(48) * 1e-6
        rough = xr.Dataset({"height": (("x", "y"), smooth * (FILE_SIZE / smooth.std()))}, coords={"x": x, "y": x})
        maps = (folder / "periodic.nc", folder / "open.nc")
        rough.assign_attrs(periodic=1).to_netcdf(maps[0])
        rough.where(rough.height < 2.5 * FILE_SIZE).to_netcdf(maps[1])
        return cls(ensembles, tuple(map(str, maps)), cohesive)
