"""The pull-off of a batch: the largest tension of each unloading, its statistics, and that of the mean law."""

import math
from collections.abc import Sequence

import numpy as np

from roughmdr.batch.collect import CollectedResults
from roughmdr.batch.moments import COUNT, MAXIMUM, MEAN, MINIMUM, SPREAD, mean_and_error
from roughmdr.batch.plan import Plan
from roughmdr.batch.rounds import CellMethod
from roughmdr.loading.pull_off import unloadings
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import DONE, OVER_AREA, PULL_OFF, PULL_OFF_NUMBERS, STATISTICS

_FORCE, _PRESSURE = "pull_off_force", "pull_off_pressure"
_TOTALS = (_FORCE, "pull_off_contact_area")


def pull_off_numbers(
    plan: Plan, methods: Sequence[CellMethod], collected: CollectedResults, force: int | None
) -> dict[str, Array]:
    """Return the variables of ``PULL_OFF``, of a batch with an unloading; ``force`` is its index among the variables.

    Under a dead load, where it has none, the mean law has no pull-off either.

    The mean law has no pull-off, and NaN, where half of the realisations or more end in contact.
    """
    swept, sizes = tuple(plan.sizes), tuple(plan.sizes.values())
    found, done = collected.pull_offs, collected.diagnostics["status"] == DONE
    if plan.keeps_statistics:
        mean_force, dims = None if force is None else collected.values["mean"][:, force], swept
        mean_lowest, count = found[:, MEAN, 0], found[:, COUNT, 0]
        all_done = np.array([float(each.realizations) for each in methods])
        numbers = {
            f"{name}_{statistic}": values
            for number, name in enumerate(PULL_OFF_NUMBERS)
            for statistic, values in _statistics(found[..., number]).items()
        }
    else:
        mean_force = None if force is None else mean_and_error(collected.values["curves"][:, :, force], done)[0]
        dims, all_done = (*swept, "realization"), done.sum(axis=1).astype(float)
        mean_lowest, _ = mean_and_error(found[..., 0], np.isfinite(found[..., 0]))
        count = np.isfinite(found[..., 0]).sum(axis=1).astype(float)
        numbers = {name: found[..., number] for number, name in enumerate(PULL_OFF_NUMBERS)}
    area = np.array([cell.scene.nominal_area or math.nan for cell in plan.cells])
    if np.isfinite(area).any():
        numbers |= {
            name.replace(total, OVER_AREA[total]): (values.T / area).T
            for total in _TOTALS
            for name, values in numbers.items()
            if name.startswith(total)
        }

    def array(name: str, own: tuple[str, ...], values: Floats) -> Array:
        shape = (*sizes, *values.shape[1:])
        return Array(own, values.reshape(shape), _attributes(name))

    data = {name: array(name, dims, values) for name, values in numbers.items()}
    data["pull_off_count"] = array("pull_off_count", swept, np.where(np.isnan(count), 0.0, count))
    of_mean = np.full(len(plan.cells), math.nan)
    if mean_force is not None:
        for cell, curve in enumerate(mean_force):
            if 2.0 * count[cell] > all_done[cell]:
                of_mean[cell] = lowest_of_mean(plan.cells[cell].values, curve)
    # The mean law is nowhere lower than the mean of the lowest forces; a parabola through few steps may be.
    of_mean = np.where(count == all_done, np.maximum(of_mean, mean_lowest), of_mean)
    for cell, method in enumerate(methods):
        if method.estimator == "expected":
            of_mean[cell] = found[cell, MEAN if plan.keeps_statistics else 0, 0]
    data[f"{_FORCE}_of_mean"] = array(f"{_FORCE}_of_mean", swept, of_mean)
    if np.isfinite(area).any():
        data[f"{_PRESSURE}_of_mean"] = array(f"{_PRESSURE}_of_mean", swept, of_mean / area)
    return data


def lowest_of_mean(separation: Floats, force: Floats) -> float:
    """Return the largest tension [N] of a curve while the flat rises; 0 without tension, NaN for a curve of NaN.

    It is the lowest point of a parabola through the lowest step and its neighbours.
    """
    lowest = 0.0
    for rise in unloadings(separation, force):
        h, values = rise.separation, rise.force
        if np.isnan(values).any():
            return math.nan
        at = int(np.argmin(values))
        least = float(values[at])
        if 0 < at < values.size - 1:
            left, right = h[at] - h[at - 1], h[at + 1] - h[at]
            before, after = (values[at] - values[at - 1]) / left, (values[at + 1] - values[at]) / right
            bend = (after - before) / (left + right)
            slope = before + bend * left
            least -= float(0.25 * slope * slope / bend) if bend > 0.0 else 0.0
        lowest = min(lowest, least)
    return lowest


def _statistics(table: Floats) -> dict[str, Floats]:
    """Return mean, standard error and so on from a table of ``KnownMoments``: [cell, row]."""
    count = table[:, COUNT]
    error = np.where(count > 1.0, table[:, SPREAD] / np.sqrt(np.maximum(count - 1.0, 1.0)), math.nan)
    return {"mean": table[:, MEAN], "sem": error, "min": table[:, MINIMUM], "max": table[:, MAXIMUM]}


def _attributes(name: str) -> dict[str, str]:
    if name in PULL_OFF:
        return PULL_OFF[name].attrs
    base, _, statistic = name.rpartition("_")
    attrs = PULL_OFF[base].attrs
    return attrs | {"long_name": f"{STATISTICS[statistic]} of the {attrs['long_name']}"}
