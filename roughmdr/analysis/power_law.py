"""Power laws fitted to the curves of a result, in logarithms."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.result.curves import Branch, apply, curve, result_of
from roughmdr.result.view import ResultView
from roughmdr.schema.arguments import check_values
from roughmdr.schema.wording import short_repr

if TYPE_CHECKING:
    import xarray as xr

Between = tuple[float | str, float | str]
_DIMENSIONS = {"N m-1": "N/m", "J m-2": "J/m^2"}
"""Units of results whose dimension is spelled differently."""
_COMMENT = (
    "y = coefficient (x/x0)^exponent, fitted to the logarithms of the steps at which both are above 0, and within the "
    "range asked for; no value where there are fewer than two such steps, and no error from two steps alone"
)


class _Sums(NamedTuple):
    """Sums over the points of each realisation, in logarithms, for a straight line through them: [..., realization]."""

    points: Floats
    x: Floats
    """Mean of x."""
    y: Floats
    slope: Floats
    spread: Floats
    """Sum of the squares of x - mean."""
    residual: Floats
    """Sum of the squares of the residuals."""


def fit_power_law(dataset: "xr.Dataset", y: str, x: str, branch: str, between: Between | None) -> "xr.Dataset":
    """Return the power law y(x) on a branch, for each cell of a sweep."""
    import xarray as xr

    result = result_of(dataset)
    along, abscissa = (curve(result, name, asked) for name, asked in ((y, "y is"), (x, "x is")))
    both = {"y": along.attrs.get("units", "1"), "x": abscissa.attrs.get("units", "1")}
    low, high = (0.0, np.inf) if between is None else _ends(between, both["x"])
    chosen = _chosen(result, branch)
    sums = apply(
        _sums, abscissa, along, core=[["step"]] * 2, out=[[]] * len(_Sums._fields), chosen=chosen, low=low, high=high
    )
    if "realization" not in sums[0].dims:
        sums = tuple(each.expand_dims("realization", axis=-1) for each in sums)
    names = {
        "exponent": ("1", f"exponent n of {y} = c ({x}/x0)^n"),
        "exponent_error": ("1", "standard error of the exponent"),
        "coefficient": (both["y"], f"coefficient c: {y} at x0"),
        "coefficient_error": (both["y"], "standard error of the coefficient"),
        "x0": (both["x"], f"geometric mean of {x} over the points"),
        "rms_residual": ("1", f"root mean square of the misfit in log {y}: relative"),
        "points": ("1", "number of points"),
    }
    fitted = apply(_fit, *sums, core=[["realization"]] * len(sums), out=[[]] * len(names))
    data = {
        name: array.assign_attrs(units=units, long_name=long_name)
        for (name, (units, long_name)), array in zip(names.items(), fitted, strict=True)
    }
    return xr.Dataset(data, attrs={"branch": branch, "comment": _COMMENT})


def _ends(between: Between, units: str) -> tuple[float, float]:
    """Return the range of x in SI; StoreError unless it is two numbers, the lower first."""
    ends = check_values("between", list(between), _DIMENSIONS.get(units, units))
    if ends.shape != (2,) or not ends[0] < ends[1]:
        raise StoreError(f"between is {short_repr(between)}; it must be two values of x, the lower first")
    return float(ends[0]), float(ends[1])


def _chosen(result: ResultView, branch: str) -> NDArray[np.int64]:
    """Return the steps on a branch, without those that repeat the one before."""
    wanted = Branch(result, branch).wanted
    values = result.path.reshape(-1, wanted.size)
    held = np.append(False, (np.diff(values) == 0.0).all(axis=0) & wanted[:-1])
    return np.flatnonzero(wanted & ~held)


def _sums(x: Floats, y: Floats, *, chosen: NDArray[np.int64], low: float, high: float) -> tuple[Floats, ...]:
    """Return the ``_Sums`` of the chosen steps of curves [..., step]."""
    x, y = np.broadcast_arrays(x[..., chosen], y[..., chosen])
    used = (x > 0.0) & (y > 0.0) & (x >= low) & (x <= high) & np.isfinite(x) & np.isfinite(y)
    log_x, log_y = (np.log(np.where(used, each, 1.0)) for each in (x, y))
    count = used.sum(axis=-1).astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean_x, mean_y = (each.sum(axis=-1) / count for each in (log_x, log_y))
        dx, dy = (np.where(used, each - mean[..., None], 0.0) for each, mean in ((log_x, mean_x), (log_y, mean_y)))
        spread = (dx * dx).sum(axis=-1)
        slope = np.where(spread > 0.0, (dx * dy).sum(axis=-1) / spread, np.nan)
    left = dy - slope[..., None] * dx
    return _Sums(count, mean_x, mean_y, slope, spread, (left * left).sum(axis=-1))


def _fit(*sums: Floats) -> tuple[Floats, ...]:
    """Return the power law over realisations [..., realization]; those without a slope do not count."""
    each = _Sums(*sums)
    known = np.isfinite(each.slope)
    count = np.where(known, each.points, 0.0)
    points, realizations = count.sum(axis=-1), known.sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_x0 = np.where(known, count * each.x, 0.0).sum(axis=-1) / points
        left = np.where(known, each.residual, 0.0).sum(axis=-1)
        spread = np.where(known, each.spread, 0.0).sum(axis=-1)
        at_x0 = np.exp(each.y + each.slope * (log_x0[..., None] - each.x))
        exponent, exponent_error = mean_and_error(each.slope, known)
        coefficient, coefficient_error = mean_and_error(at_x0, known)
        variance = np.where(points > 2.0, left / (points - 2.0), np.nan)
        alone = realizations == 1
        exponent_error = np.where(alone, np.sqrt(variance / spread), exponent_error)
        coefficient_error = np.where(alone, coefficient * np.sqrt(variance / points), coefficient_error)
        rms = np.sqrt(left / points)
    return exponent, exponent_error, coefficient, coefficient_error, np.exp(log_x0), rms, points
