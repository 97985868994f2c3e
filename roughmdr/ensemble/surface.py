"""source = "surface": the summits of a measured height map, as paraboloids."""

from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator

from roughmdr.arguments import Floats
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.file import check_is_file
from roughmdr.ensemble.source import Source
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.units import unit_factor

if TYPE_CHECKING:
    import xarray as xr

_ROUNDING = 64 * np.finfo(float).eps  # of the largest height: what removing a quadratic may leave of nothing
_UNEVEN = 1e-3  # a spacing that varies by more than this part is no regular grid


class SurfaceAsperities(Source):
    """[asperities] with source = "surface": ``file`` is a netCDF map, height(x, y)."""

    drawn: ClassVar[bool] = False

    source: Literal["surface"]
    file: Annotated[str, AfterValidator(check_is_file)]
    shape: Literal["paraboloid"] = "paraboloid"

    @cached_property
    def summits(self) -> Ensemble:
        """The asperities of the map; SceneError where it cannot be read or has none."""
        height, dx, dy = read_map(Path(self.file))
        noise = _ROUNDING * float(np.max(np.abs(height)))
        try:
            return find_summits(remove_quadratic(height), dx, dy, noise)
        except SceneError as error:
            raise SceneError(f"{self.file}: {error}") from None

    @property
    def shape_name(self) -> str:
        """The shape of the asperities."""
        return self.shape

    @property
    def expected_count(self) -> float:
        """How many summits there are."""
        return float(self.summits.height.size)

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that the asperities are read from."""
        return (Path(self.file),)

    @property
    def sigma(self) -> float:
        """Standard deviation of the summit heights [m]."""
        return float(np.std(self.summits.height))

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of the map: always the same ones."""
        return replace(self.summits, attrs={**self.summits.attrs, "seed": seed})


def read_map(path: Path) -> tuple[Floats, float, float]:
    """Heights [m] over x and y, and both spacings [m], from a netCDF file with height(x, y); SceneError if not so."""
    import xarray as xr

    try:
        with xr.open_dataset(path) as dataset:
            dataset.load()
    except Exception as error:
        raise SceneError(f"{path}: not a netCDF file that can be read ({type(error).__name__})") from error
    if "height" not in dataset or dataset["height"].ndim != 2:
        raise SceneError(
            f"{path}: it must hold a variable height over two dimensions; it has {list(dataset.data_vars)}"
        )
    height = dataset["height"].transpose("x", "y") if set(dataset["height"].dims) == {"x", "y"} else dataset["height"]
    if height.dtype.kind not in "iuf":
        raise SceneError(f"{path}: heights are of type {height.dtype}; they must be numbers")
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
    if dataset[dim].dtype.kind not in "iuf":
        raise SceneError(f"{path}: the coordinate {dim} is of type {dataset[dim].dtype}; it must be numbers")
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


def find_summits(height: Floats, dx: float, dy: float, noise: float = 0.0) -> Ensemble:
    """The points above all eight neighbours by more than ``noise``, each with a paraboloid that fits them.

    The fit is by least squares. Its top is the summit; the radius is 1/sqrt(k1 k2), from the geometric mean of the
    principal curvatures: that of the sphere which an elliptic contact is best replaced by (J. A. Greenwood, Wear 261
    (2006) 191). A point whose paraboloid is a saddle is no summit; the attribute ``saddles`` counts them. Heights,
    spacings and noise are [m]; SceneError where no summit is found.
    """
    nx, ny = height.shape
    inner = height[1:-1, 1:-1]

    def neighbours(i: int, j: int) -> Floats:
        return height[1 + i : nx - 1 + i, 1 + j : ny - 1 + j]

    around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    rows, columns = np.nonzero(np.logical_and.reduce([inner > neighbours(i, j) + noise for i, j in around]))
    drop = {(i, j): neighbours(i, j)[rows, columns] - inner[rows, columns] for i, j in around}

    def moment(m: int, n: int) -> Floats:
        total: Floats = np.sum([i**m * j**n * drop[i, j] for i, j in around], axis=0)
        return total

    # The normal equations of drop = p i + q j + (A i^2 + 2 B i j + C j^2)/2 over the eight neighbours (i, j).
    p, q = moment(1, 0) / 6.0, moment(0, 1) / 6.0
    A = 0.6 * moment(2, 0) - 0.4 * moment(0, 2)
    C = 0.6 * moment(0, 2) - 0.4 * moment(2, 0)
    B = moment(1, 1) / 4.0

    with np.errstate(over="ignore", under="ignore", invalid="ignore"):  # what no float can hold is no dome
        determinant = A * C - B * B
    domed = (determinant > 0.0) & (A < 0.0)
    if not domed.any():
        raise SceneError("the map has no summit: no point stands above its eight neighbours on a dome")
    p, q, A, B, C, determinant = (values[domed] for values in (p, q, A, B, C, determinant))
    i_top, j_top = (B * q - C * p) / determinant, (B * p - A * q) / determinant
    # A top beyond the neighbours is an extrapolation: there the point itself is the better summit.
    trusted = np.maximum(np.abs(i_top), np.abs(j_top)) <= 1.0
    i_top, j_top = np.where(trusted, i_top, 0.0), np.where(trusted, j_top, 0.0)
    rows, columns = rows[domed], columns[domed]
    return Ensemble.sorted(
        "paraboloid",
        inner[rows, columns] + 0.5 * (p * i_top + q * j_top),
        {"radius": dx * dy / np.sqrt(determinant)},
        nx * dx * ny * dy,
        {"x": (rows + 1.5 + i_top) * dx, "y": (columns + 1.5 + j_top) * dy},
        {
            "patch_x": nx * dx,
            "patch_y": ny * dy,
            "points_per_summit": height.size / rows.size,
            "saddles": int((~domed).sum()),
        },
    )
