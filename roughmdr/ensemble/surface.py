"""source = "surface": the summits of a measured height map, as paraboloids."""

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.fields import Section
from roughmdr.shapes.base import Floats
from roughmdr.units import unit_factor

if TYPE_CHECKING:
    import xarray as xr

_UNEVEN = 1e-3  # a spacing that varies by more than this part is no regular grid


class SurfaceAsperities(Section):
    """[asperities] with source = "surface": ``file`` is a netCDF map, height(x, y)."""

    source: Literal["surface"]
    file: str
    shape: Literal["paraboloid"] = "paraboloid"

    @cached_property
    def summits(self) -> Ensemble:
        """The asperities of the map; SceneError where it cannot be read or has none."""
        height, dx, dy = read_map(Path(self.file))
        return find_summits(remove_quadratic(height), dx, dy)

    @property
    def sigma(self) -> float:
        """Standard deviation of the summit heights [m]."""
        return float(np.std(self.summits.height))

    def ensemble(self, seed: int, realization: int) -> Ensemble:
        """The asperities of the map: always the same ones."""
        return self.summits


def read_map(path: Path) -> tuple[Floats, float, float]:
    """Heights [m] over x and y, and the two spacings [m], from a netCDF file with height(x, y); SceneError if not so."""
    import xarray as xr

    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    try:
        with xr.open_dataset(path) as dataset:
            dataset.load()
    except Exception as error:
        raise SceneError(f"{path}: not a netCDF file that can be read ({type(error).__name__})") from error
    if "height" not in dataset or dataset["height"].ndim != 2:
        raise SceneError(f"{path}: it must hold a variable height over two dimensions; it has {list(dataset.data_vars)}")
    height = dataset["height"].transpose("x", "y") if set(dataset["height"].dims) == {"x", "y"} else dataset["height"]
    if min(height.shape) < 3:
        raise SceneError(f"{path}: the map has {height.shape[0]} x {height.shape[1]} points; it needs at least 3 x 3")
    values = np.asarray(height.to_numpy(), dtype=np.float64) * _factor(path, "height", height)
    if not np.isfinite(values).all():
        undefined = int((~np.isfinite(values)).sum())
        raise SceneError(f"{path}: {undefined} of {values.size} heights are undefined; fill or cut them first")
    dx, dy = (_spacing(path, dataset, str(dim)) for dim in height.dims)
    return values, dx, dy


def _factor(path: Path, name: str, variable: "xr.DataArray") -> float:
    try:
        return float(unit_factor(str(variable.attrs.get("units", "")), "m"))
    except RoughmdrError as error:
        raise SceneError(f"{path}: units of {name}: {error}") from None


def _spacing(path: Path, dataset: "xr.Dataset", dim: str) -> float:
    if dim not in dataset.coords:
        raise SceneError(f"{path}: the coordinate {dim} is missing; it says where the points lie")
    points = np.asarray(dataset[dim].to_numpy(), dtype=np.float64) * _factor(path, dim, dataset[dim])
    steps = np.diff(points)
    mean = float(np.mean(steps))
    if not np.isfinite(mean) or mean == 0.0 or np.ptp(steps) > _UNEVEN * abs(mean):
        raise SceneError(f"{path}: the coordinate {dim} is not evenly spaced")
    return abs(mean)


def remove_quadratic(height: Floats) -> Floats:
    """The map less its least-squares quadratic in x and y: no tilt, no curvature of the whole, mean 0."""
    u = np.linspace(-1.0, 1.0, height.shape[0])[:, None]
    v = np.linspace(-1.0, 1.0, height.shape[1])[None, :]
    one = np.ones_like(height)
    terms = np.stack([term.ravel() for term in (one, u * one, v * one, u * u * one, u * v, v * v * one)], axis=1)
    coefficients = np.linalg.lstsq(terms, height.ravel(), rcond=None)[0]
    return np.asarray(height - (terms @ coefficients).reshape(height.shape))


def find_summits(height: Floats, dx: float, dy: float) -> Ensemble:
    """The points above all their eight neighbours; through each nine a least-squares paraboloid, whose top is the summit.

    The radius is 1/sqrt(k1 k2), from the geometric mean of the principal curvatures: the radius of the sphere that
    an elliptic contact is best replaced by (J. A. Greenwood, Wear 261 (2006) 191). SceneError where no summit is found.
    """
    inner = height[1:-1, 1:-1]
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    nx, ny = height.shape
    around = [height[1 + i : nx - 1 + i, 1 + j : ny - 1 + j] for i, j in shifts]
    rows, columns = np.nonzero(np.logical_and.reduce([inner > neighbour for neighbour in around]))
    nine = np.stack([[height[rows + 1 + i, columns + 1 + j] for j in (-1, 0, 1)] for i in (-1, 0, 1)])
    along_x, along_y = nine.sum(axis=1), nine.sum(axis=0)
    slope_x, slope_y = (along_x[2] - along_x[0]) / (6.0 * dx), (along_y[2] - along_y[0]) / (6.0 * dy)
    xx = (along_x[0] - 2.0 * along_x[1] + along_x[2]) / (3.0 * dx * dx)
    yy = (along_y[0] - 2.0 * along_y[1] + along_y[2]) / (3.0 * dy * dy)
    xy = (nine[2, 2] - nine[2, 0] - nine[0, 2] + nine[0, 0]) / (4.0 * dx * dy)
    level = nine.mean(axis=(0, 1)) - (xx * dx * dx + yy * dy * dy) / 3.0

    determinant = xx * yy - xy * xy
    domed = (determinant > 0.0) & (xx < 0.0)
    safe = np.where(domed, determinant, 1.0)
    offset_x, offset_y = (xy * slope_y - yy * slope_x) / safe, (xy * slope_x - xx * slope_y) / safe
    # A top outside the nine points is an extrapolation: such a point is kept as no summit.
    kept = domed & (np.abs(offset_x) <= dx) & (np.abs(offset_y) <= dy)
    if not kept.any():
        raise SceneError("the map has no summit: no point stands above its eight neighbours with a domed fit")
    top = level + 0.5 * (slope_x * offset_x + slope_y * offset_y)
    patch_x, patch_y = nx * dx, ny * dy
    return Ensemble.sorted(
        "paraboloid",
        top[kept],
        {"radius": 1.0 / np.sqrt(determinant[kept])},
        patch_x * patch_y,
        {"x": ((rows + 1) * dx + offset_x)[kept], "y": ((columns + 1) * dy + offset_y)[kept]},
        {"patch_x": patch_x, "patch_y": patch_y, "points_per_summit": height.size / int(kept.sum())},
    )
