"""The search for the parameters of least squares: from the start of the scene, and if need be from others."""

import time
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from roughmdr.fitting.correlation import POOR, is_systematic
from roughmdr.fitting.jumps import least_squares_between, with_measured_jumps
from roughmdr.fitting.model import Model
from roughmdr.fitting.slopes import slopes_of
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array

_UNTIL: dict[str, Any] = {"ftol": 1e-10, "xtol": 1e-7, "gtol": 1e-12, "max_nfev": 60}
_STARTS, _TRIED = 16, 3  # other starts per parameter, and number of them that are followed


class Found(NamedTuple):
    """The parameters of least squares."""

    x: Floats
    deviations: Floats
    slopes: Floats
    """Derivatives of the deviations: [step, parameter]."""
    converged: bool
    points: int
    """Number of measured points; deviations behind them are from priors and other curves."""

    @property
    def residuals(self) -> Floats:
        """The deviations from the measured points alone."""
        return self.deviations[: self.points]


class Fitted(NamedTuple):
    """A model with its parameters of least squares, and how it compares with others."""

    model: Model
    found: Found
    compared: Mapping[str, Array] = {}
    """Arrays over ``model``, in the order of ``model_name``; none where nothing is compared."""
    doubts: tuple[str, ...] = ()
    """Which models the data do not tell from it, in words."""


def fitted(model: Model) -> Fitted:
    """Return a model with its parameters of least squares; RoughmdrError where no start has a law.

    Priors count once the noise is known: where it is not stated, after a search without them.
    """
    if not model.parameters:
        return Fitted(model, _follow(model, model.begin))
    started, found = time.perf_counter(), _from_all_starts(model)
    if model.noise == 0.0 and any(parameter.prior for parameter in model.parameters):
        model.assume_noise_of(found.deviations, found.slopes)
        found = _from_all_starts(model)
    model.seconds += time.perf_counter() - started
    return Fitted(model, found)


def _from_all_starts(model: Model) -> Found:
    """Return the parameters of least squares, from the start of the scene and if need be from others.

    Where the deviations from the start of the scene are systematic or large, other starts around it are tried. On a
    machine, whose law takes longer, they are tried at the separations that follow from the measured force.
    """
    if model.curve.control == "separation":
        found = _search(model)
    else:
        with model.held(load=model.curve.load):
            near = _search(model)
        found = _follow(model, near.x)
    if model.jumps and found.deviations.any() and found.slopes.any():
        x = least_squares_between(model, found.x)
        found = found._replace(x=x, deviations=model.point(x).deviations, slopes=slopes_of(model, x))
    model.curve = model.curve._replace(level=model.baseline(found.x))
    return found


def _search(model: Model) -> Found:
    start = model.begin
    first = with_measured_jumps(model, start) if model.jumps and model.borne is None else start
    found = [_follow(model, first)] if np.isfinite(model.point(first).cost) else []
    if not found or is_systematic(found[0].residuals) or model.curve.relative_rms(found[0].deviations) > POOR:
        starts = np.concatenate([_other_starts(model), start[None]]) if first.any() else _other_starts(model)
        costs = [model.point(x).cost for x in starts]
        best = [starts[i] for i in np.argsort(costs)[:_TRIED] if np.isfinite(costs[i])]
        if not best and not found:
            raise model.last_error
        found += [_follow(model, x) for x in best]
    return min(found, key=lambda each: float(each.deviations @ each.deviations))


def _follow(model: Model, start: Floats) -> Found:
    """Return where least squares lead to from a start; RoughmdrError where that has no law."""
    from scipy.optimize import least_squares

    def deviations(x: Floats) -> Floats:
        return model.point(x).deviations

    points, first = model.curve.load.size, deviations(start)
    if not np.isfinite(first).all():
        raise model.last_error
    if not start.size:
        return Found(start, first, np.empty((points, 0)), True, points)
    begin, slopes = np.clip(start, *model.bounds), partial(slopes_of, model)
    result: Any = least_squares(deviations, begin, slopes, model.bounds, **_UNTIL)
    return Found(result.x, result.fun, result.jac, result.status > 0, points)


def _other_starts(model: Model) -> Floats:
    """Return starts spread evenly, [start, parameter]."""
    from scipy.stats.qmc import Halton

    count = len(model.parameters)
    low, high = np.transpose([parameter.nearby for parameter in model.parameters])
    spread = Halton(count, scramble=False).random(_STARTS * count + 1)[1:]
    return np.asarray(low + (high - low) * spread)
