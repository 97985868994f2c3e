"""The error of independent asperities by groups, and how far an estimate by the contact fraction alone holds."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from roughmdr.numerics.arguments import Floats

FEW_CONTACTS = 4.0
"""Up to so many, contacts of the patch and of its periodic images are a lattice, wherever they are placed."""
GROUPS = ("few contacts", "random", "separated", "square", "map")
FACTOR = 3.0
"""Within which the estimate is to be."""
_MIN_POINTS = 2.5  # of the grid a contact radius; below, boundary elements are off by a per cent and more
_CELLS = {"hexagonal": "separated", "hard_core 0.5": "separated", "hard_core 0.7": "separated"}


class Estimate(NamedTuple):
    """The relative error of the force at given separation, 0 to 1."""

    estimate: Floats
    low: Floats
    high: Floats


def interaction_error(contact_fraction: ArrayLike) -> Estimate:
    """Return how much too low the force of independent asperities is, by their summed contact fraction f.

    A square lattice of equal contacts of any shape has 1.40 sqrt(f) to first order: each feels its periodic images,
    -3.90 P/(pi E* L), with its stiffness 2 E* a. Asperities at random places have half of it and more. At f from 0.3
    to 0.5 boundary elements are in full contact, and the error is 1.
    """
    fraction = np.asarray(contact_fraction, dtype=np.float64)
    root = np.sqrt(fraction)
    parts = (1.4 * root + fraction, 0.5 * root, 1.6 * root + 2.0 * fraction)
    return Estimate(*(np.minimum(part, 1.0) for part in parts))


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


def groups(result: xr.Dataset) -> NDArray[np.str_]:
    """Return the group of each case and step."""
    placed = np.array([_CELLS.get(name, name) for name in result["placement"].to_numpy().tolist()])
    whole = np.broadcast_to(placed[:, None], result["force"].shape)
    few = (result["contact_count"].to_numpy() <= FEW_CONTACTS) & (whole != "map")
    return np.where(few, "few contacts", whole)


class Judged(NamedTuple):
    """A group of errors against the estimate."""

    number: int
    coefficient: tuple[float, float, float]
    """Median, 5 % and 95 % of e/sqrt(f)."""
    bounded: float
    """Share of errors that the estimate bounds,"""
    below_high: float
    """that the high one bounds,"""
    within: float
    """and that are within FACTOR of the estimate."""


def judge(fraction: Floats, error: Floats) -> Judged:
    """Judge errors that are known, at their contact fractions."""
    found = interaction_error(fraction)
    middle, low, high = np.quantile(error / np.sqrt(fraction), [0.5, 0.05, 0.95]).tolist()
    within = (found.estimate <= FACTOR * error) & (error <= FACTOR * found.estimate)
    return Judged(
        error.size,
        (middle, low, high),
        float(np.mean(error <= found.estimate)),
        float(np.mean(error <= found.high)),
        float(np.mean(within)),
    )
