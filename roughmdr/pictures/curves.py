"""The curves of a result that a picture shows: each variable in each cell, over one loading or unloading."""

import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PLASTIC
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.result.model_errors import error_of_mean
from roughmdr.result.view import Leg, ResultView, step_blocks
from roughmdr.schema.wording import suggestion
from roughmdr.variables import CURVE_VARIABLES, LAW_VARIABLES, OVER_AREA, TIME

_PER_AREA = {
    **{total: (OVER_AREA[total], CURVE_VARIABLES[OVER_AREA[total]].units) for total in ("force", "contact_area")},
    "contact_count": ("contacts per area", "m-2"),
    "stiffness": ("stiffness per area", "Pa m-1"),
    "contact_radius_sum": ("contact radii per area", "m-1"),
    "conductance_radius": ("conductance radius per area", "m-1"),
    "thermal_conductance": ("thermal conductance per area", "W m-2 K-1"),
    "electrical_conductance": ("electrical conductance per area", "S m-2"),
    "energy": ("energy per area", "J m-2"),
    "dissipated_energy": ("dissipated energy per area", "J m-2"),
    "machine_dissipated_energy": ("energy that the machine dissipates per area", "J m-2"),
    "tangential_force": ("tangential force per area", "Pa"),
    "tangential_stiffness": ("tangential stiffness per area", "Pa m-1"),
    "friction_energy": ("energy lost by slip per area", "J m-2"),
}
_LONG_NAMES = {"remote": "position of the far end of the spring", "lateral": "lateral displacement"}
_FEW, _ROBUST = 30, 9  # with fewer realisations the median is also taken over up to so many steps
_BAND = (0.16, 0.84)


class Quantity(NamedTuple):
    """A variable as it is drawn: its name on the axis, its unit, and what it is divided by in each cell."""

    variable: str
    name: str
    unit: str
    area: Floats  # nominal, or 1

    @classmethod
    def of(cls, result: ResultView, variable: str, *, per_area: bool = False) -> "Quantity":
        """Return a variable of a result, per nominal area where that is asked for and it is a sum over asperities."""
        name, unit = _LONG_NAMES.get(variable, variable.replace("_", " ")), LAW_VARIABLES[variable].units
        if not per_area or variable not in _PER_AREA:
            return cls(variable, name, unit, np.ones(tuple(result.sweep.values())))
        if "nominal_area" not in result.variables:
            raise StoreError("the result has no nominal_area to divide by: its asperities have none, or it is older")
        return cls(variable, *_PER_AREA[variable], result.variables["nominal_area"].values)

    def scaled(self, values: Floats) -> Floats:
        """Return numbers of the variable, over the swept keys and more, as they are drawn."""
        return np.asarray(values / np.expand_dims(self.area, tuple(range(self.area.ndim, values.ndim))))

    def in_cell(self, values: Floats, cell: tuple[int, ...]) -> Floats:
        """Return numbers of the variable in one cell as they are drawn."""
        return np.asarray(values / self.area[cell])


class Runs(NamedTuple):
    """Curves of the realisations of a cell that were computed, of which no more are copied than are asked for."""

    values: Floats  # [realization, step]; of all
    computed: Ints  # numbers of the realisations
    area: float

    def some(self, which: Ints | slice, steps: slice = slice(None)) -> Floats:
        """Return some of them, by their place among those computed, as they are drawn."""
        found = self.values[self.computed[which], steps]
        found /= self.area
        return found

    def quantiles(self, shares: list[float]) -> Floats:
        """Return quantiles over the realisations: [share, step]."""
        blocks = step_blocks(self.computed.size, self.values.shape[1])
        return np.concatenate([quantiles(self.some(slice(None), block), shares, axis=0) for block in blocks], axis=1)


class Curve(NamedTuple):
    """A quantity in one cell of a result, over one loading or unloading."""

    cell: int
    branch: str
    x: Floats
    middle: Floats  # mean over the realisations; of a stiffness where contacts detach the median
    low: Floats  # two standard errors below it, or the lower edge of the band of a median; NaN if there is none
    high: Floats
    model_error: Floats  # in its unit; NaN where it is not known
    runs: Runs  # none if only statistics were kept, and of a median
    runs_x: Runs


def drawn_against(result: ResultView, asked: str | None) -> str:
    """Return the variable that curves are drawn against; StoreError for one that the result lacks."""
    if asked is None:
        return result.abscissa
    timed = [TIME.name] if TIME.name in result.coordinates else []
    available = [*dict.fromkeys([result.control, *timed, *result.curves])]
    if asked not in available:
        raise StoreError(f"x is {asked!r}, which is not in the result{suggestion(asked, available)}")
    return asked


def curves_of(result: ResultView, quantity: Quantity, x: Quantity) -> Iterator[Curve]:
    """Yield the curves of a quantity over another, cell by cell."""
    done, name = result.done, quantity.variable
    runs = _runs(result, name)
    mean, error = _mean(result, name)
    xs = _runs(result, x.variable)
    x_mean = _mean(result, x.variable)[0]
    known = result.holds("model_error_curve")
    model_error = error_of_mean(result, name) if known else np.full_like(mean, np.nan)
    mean, error, model_error, x_mean = *map(quantity.scaled, (mean, error, model_error)), x.scaled(x_mean)
    sticky, yielding = result.adheres, name == "stiffness" and PLASTIC in result.variables
    for number, cell in enumerate(np.ndindex(mean.shape[:-1])):
        computed = np.flatnonzero(done[cell])[: runs.shape[-2]]
        areas = [float(each.area[cell]) for each in (quantity, x)]
        for branch, along in _legs(result):
            rises = yielding and branch == "unloading" and result.branches[along[0]] != branch
            # At a turn that is not repeated the stiffness is that of yielding.
            steps = slice(along[int(rises)], along[-1] + 1)
            some, some_x = (
                Runs(each[cell][:, steps], computed, area) for each, area in zip((runs, xs), areas, strict=True)
            )
            middle, off = mean[cell][steps], 2.0 * error[cell][steps]
            low, high = middle - off, middle + off
            if name == "stiffness" and sticky and branch == "unloading":  # the variance of the stiffness is infinite
                middle, low, high = _medians(middle, some)
                some = some._replace(computed=computed[:0])
            yield Curve(
                number, branch, x_mean[cell][steps], middle, low, high,
                model_error[cell][steps], some, some_x,
            )  # fmt: skip


def _legs(result: ResultView) -> list[Leg]:
    """Return the steps of each loading and unloading, from the turning point on, which a path need not repeat.

    Where it does, some time may have passed.
    """
    control = result.path
    if TIME.name in result.coordinates:
        control = np.stack([control, result.over_steps(TIME.name)])
    return [
        leg
        if (first := leg.steps[0]) == 0 or (control[..., first] == control[..., first - 1]).all()
        else leg._replace(steps=np.append(first - 1, leg.steps))
        for leg in result.legs
    ]


def _medians(mean: Floats, runs: Runs) -> tuple[Floats, Floats, Floats]:
    """Return the median of the realisations with a band of two thirds of them; few are joined over some steps."""
    shares = [_BAND[0], 0.5, _BAND[1]]
    if runs.computed.size >= _FEW:
        low, middle, high = runs.quantiles(shares)
        return middle, low, high
    values, width = runs.some(slice(None)) if runs.computed.size else mean[None], min(_ROBUST, 1 + 2 * (mean.size // 8))
    padded = np.pad(values, ((0, 0), (width // 2, width // 2)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, width, axis=1)
    low, middle, high = quantiles(windows, shares, axis=(0, 2))
    return middle, low, high


def quantiles(values: Floats, shares: list[float], axis: int | tuple[int, ...]) -> Floats:
    """Return quantiles of the numbers that there are; NaN where there are none."""
    if np.isfinite(values).all() and values.size:
        return np.asarray(np.quantile(values, shares, axis=axis))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanquantile(values, shares, axis=axis))


def _runs(result: ResultView, name: str) -> Floats:
    """Return a variable of all realisations, [..., realization, step]; none where their statistics were kept."""
    cells, steps = tuple(result.sweep.values()), result.sizes["step"]
    if "realization" not in result.sizes:
        return np.empty((*cells, 0, steps))
    if name in result.variables:
        return result.variables[name].values
    return np.broadcast_to(result.over_steps(name)[..., None, :], (*cells, result.sizes["realization"], steps))


def _mean(result: ResultView, name: str) -> tuple[Floats, Floats]:
    """Return the mean of a variable and its standard error; a coordinate has none."""
    if name not in result.variables and f"{name}_mean" not in result.variables:
        values = result.over_steps(name)
        return values, np.full_like(values, np.nan)
    return result.mean(name)
