"""The error of independent asperities by groups, and how far an estimate by the contact fraction alone holds."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from roughmdr.model_error.interaction import ASPERITIES, SUMMITS, interaction_error
from roughmdr.numerics.arguments import Floats

FEW_CONTACTS = 4.0
"""Up to so many, contacts of the patch and of its periodic images are a lattice, wherever they are placed."""
GROUPS = ("few contacts", "random", "separated", "square", "nayak", "map", "crowd")
FACTOR = 3.0
"""Within which the estimate is to be."""
_MIN_POINTS = 2.5  # of the grid a contact radius; below, boundary elements are off by a per cent and more
_CELLS = {
    **dict.fromkeys(("hexagonal", "hard_core 0.5", "hard_core 0.7"), "separated"),
    **dict.fromkeys(("crowd 0.5", "crowd 0.7"), "crowd"),
}


def estimates(contact_fraction: Floats, group: NDArray[np.str_]) -> Floats:
    """Return the estimate of the error: of the summits of a map, and of other asperities."""
    of_asperities, of_summits = (interaction_error(contact_fraction, kind) for kind in (ASPERITIES, SUMMITS))
    return np.where(group == "map", of_summits, of_asperities)


def resolved(result: xr.Dataset) -> NDArray[np.bool_]:
    """Whether the grid resolves the contacts, and boundary elements converged, at each case and step."""
    return np.asarray((result["radius_points"] >= _MIN_POINTS) & result["force_bem"].notnull())


def errors(result: xr.Dataset) -> Floats:
    """Return the relative error of the force [case, step], 1 in full contact; NaN where it is not known."""
    error = 1.0 - result["force"] / result["force_bem"]
    return np.asarray(error.where(resolved(result)))


def grid_errors(result: xr.Dataset) -> Floats:
    """Return how far forces on half as many points are off; NaN where the error is not known, or in full contact."""
    with np.errstate(invalid="ignore"):
        off = np.abs(1.0 - result["force_coarse"].to_numpy() / result["force_bem"].to_numpy())
    return np.where(resolved(result), off, np.nan)


def without_grid(fine: Any, coarse: Any) -> Any:
    """Return the limit of forces on a grid and on one of half as many points a side, by an error of order 2."""
    return fine + (fine - coarse) / 3.0


def signed_errors(result: xr.Dataset, name: str) -> Floats:
    """Return the relative error of a force [case, step], by its name; NaN where it is not known, or in full contact."""
    known = resolved(result) & np.isfinite(result["force_bem"].to_numpy())
    with np.errstate(invalid="ignore"):
        return np.where(known, result[name].to_numpy() / result["force_bem"].to_numpy() - 1.0, np.nan)


def groups(result: xr.Dataset) -> NDArray[np.str_]:
    """Return the group of each case and step."""
    placed = np.array([_CELLS.get(name, name) for name in result["placement"].to_numpy().tolist()])
    whole = np.broadcast_to(placed[:, None], result["force"].shape)
    few = (result["contact_count"].to_numpy() <= FEW_CONTACTS) & (whole != "map") & (whole != "crowd")
    return np.where(few, "few contacts", whole)


class Judged(NamedTuple):
    """A group of errors against the estimate."""

    number: int
    bounded: float
    """Share of errors that the estimate bounds,"""
    within: float
    """and that are within FACTOR of it."""


def judge(error: Floats, estimate: Floats) -> Judged:
    """Judge errors that are known."""
    within = (estimate <= FACTOR * error) & (error <= FACTOR * estimate)
    return Judged(error.size, float(np.mean(error <= estimate)), float(np.mean(within)))
