"""Our law beside another solution: laws along paths, numbers of all cases, errors, and how often a stated one holds."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from studies.study import Axes, Figure, blank, named, without_limits

Variable = tuple[tuple[str, ...], Floats, dict[str, str]]  # dimensions, values and attributes
FACTOR = 3.0  # largest ratio of the stated and the true error, either way, at which the stated one is near
PAIRS: dict[int, Any] = {order: {"model": "pairwise", "order": order} for order in (1, 2)}
"""Interactions in pairs, by their order."""
INTERACTIONS: dict[str, Any] = {
    "independent": None, "mean field": "mean_field", **{f"order {order}": pairs for order, pairs in PAIRS.items()}
}  # fmt: skip


def law_of(ensemble: xr.Dataset, **asked: Any) -> xr.Dataset:
    """Return the law by roughmdr, without warnings; RoughmdrError where it has none."""
    with without_limits():
        return rm.load_separation(ensemble, **asked)


def law_or_nan(ensemble: xr.Dataset, separation: Floats, *variables: str, **asked: Any) -> list[Floats]:
    """Return variables of the law at separations; NaN where it has none."""
    try:
        law = law_of(ensemble, separation=separation, variables=variables, **asked)
    except rm.RoughmdrError:
        return [np.full(separation.size, np.nan)] * len(variables)
    return [law[name].to_numpy() for name in variables]


def in_cases(words: Mapping[str, tuple[str, str]], cases: Sequence[Any], *dims: str) -> dict[str, Variable]:
    """Return variables by their words and units, of numbers or arrays of each case; NaN beyond the end of arrays.

    A case has them by their names, or in the order of the words.
    """
    found = [case if isinstance(case, Mapping) else dict(zip(words, case, strict=True)) for case in cases]
    return {name: (dims, _padded([case[name] for case in found]), named(*words[name])) for name in words}


def of_rows(words: Mapping[str, tuple[str, str]], rows: Sequence[Mapping[str, Any]], *dims: str) -> xr.Dataset:
    """Return the numbers of all cases by their words and units, and whatever else a row holds as labels of its case."""
    labels = [name for name in rows[0] if name not in words]
    return xr.Dataset(in_cases(words, rows, *dims), {name: (dims[0], [row[name] for row in rows]) for name in labels})


def _padded(rows: list[Any]) -> Floats:
    arrays = [np.asarray(row, dtype=float) for row in rows]
    found = np.full((len(arrays), *np.max([each.shape for each in arrays], axis=0).astype(int)), np.nan)
    for number, each in enumerate(arrays):
        place: tuple[Any, ...] = (number, *(slice(size) for size in each.shape))
        found[place] = each
    return found


def cases_of(result: xr.Dataset, **labels: Any) -> xr.Dataset:
    """Return the cases of a result with these labels."""
    chosen = np.all([result[name].to_numpy() == label for name, label in labels.items()], axis=0)
    (dim,) = result[next(iter(labels))].dims
    return result.isel({dim: np.flatnonzero(chosen)})


def groups_of(result: xr.Dataset, *names: str) -> Iterator[tuple[tuple[Any, ...], xr.Dataset]]:
    """Yield the labels under these names that occur together, in their order, with the cases that have them."""
    for labels in dict.fromkeys(zip(*(result[name].values.tolist() for name in names), strict=True)):
        yield labels, cases_of(result, **dict(zip(names, labels, strict=True)))


def rms(values: xr.DataArray | Floats) -> float:
    """Return the root mean square of what is known."""
    known = np.asarray(values)[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else np.nan


def each_of(result: xr.Dataset, dim: str = "case") -> list[xr.Dataset]:
    """Return the cases of a result one by one."""
    return [result.isel({dim: number}) for number in range(result.sizes[dim])]


def percent(value: float, digits: int = 1) -> str:
    """Return a share in per cent; a dash where it is unknown."""
    return f"{100.0 * value:.{digits}f} %" if np.isfinite(value) else "-"


def median_and_largest(errors: xr.DataArray | Floats) -> str:
    """Return the median magnitude and, in brackets, the largest of the errors that are known."""
    known = np.abs(np.asarray(errors)[np.isfinite(errors)])
    return f"{100.0 * np.median(known):.2g} % ({100.0 * known.max():.2g})" if known.size else ""


HELD = ["errors", "below the estimate", f"within a factor of {FACTOR:g}"]  # heads of the cells


def bounds(error: Floats, stated: Floats, unknown: Floats | float = 0.0) -> tuple[Any, Any]:
    """Return which errors a stated one bounds, and which are within FACTOR of it, but for what is unknown of both."""
    near = (stated <= FACTOR * np.maximum(error, unknown)) & (error <= FACTOR * np.maximum(stated, unknown))
    return error <= np.maximum(stated, unknown), near


def held(error: Floats, stated: Floats, unknown: Floats | float = 0.0) -> list[str]:
    """Return how often a stated error holds, as the cells under ``HELD``."""
    return [str(error.size), *(percent(float(np.mean(each)), 0) for each in bounds(error, stated, unknown))]


def panels(width: float, height: float, count: int) -> tuple[Figure, list[Axes]]:
    """Return a figure of panels in a row, on a grid."""
    figure = blank(width, height)
    row = list(np.atleast_1d(figure.subplots(1, count)))
    for panel in row:
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure, row
