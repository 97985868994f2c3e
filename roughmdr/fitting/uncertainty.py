"""The uncertainty of fitted parameters: covariance, intervals, and the shift that the error of the law may cause."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadSeparation
from roughmdr.errors import OutOfRange
from roughmdr.fitting.correlation import (
    POOR,
    Correlation,
    by_independent_noise,
    correlated,
    correlation_of_noise,
    summed_nearby,
)
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.model import Model
from roughmdr.fitting.profile import Edges, certain_edges, farthest, profiled
from roughmdr.fitting.search import Found
from roughmdr.fitting.slopes import yielded
from roughmdr.numerics.arguments import Floats

_LEVEL = 0.95
_TOGETHER = 0.99  # probability of the parameters, all together, of which the edges between jumps allow some
_LEAST_SLOPE = 1e-6  # least slope over the largest: parameters that change the law by less are not known at all
_LEAST_FREEDOM = 1e-6  # least degrees of freedom of a step: with none, the fit follows it whatever the noise
_NEIGHBOURS = 2  # steps to each side whose residuals estimate the noise of a step
_WIDER = 10  # inverse share of the curve to each side that does so where noise is correlated
_CHANGE = 1e-3  # change of the correlation in differences, over its distance from 1
_LEAST_NOISE = 1e-6  # least variance of the noise over the largest, where degrees of freedom are counted
_ROUNDING = 1e-9  # relative difference within which two reaches are the same
_UNKNOWN = 10.0  # standard error of x along a combination that is not known at all, however small the noise
# Ratio of variances, from priors over from points, beyond which the quantile is that of the normal distribution.
_MOST_KNOWN = 1e3
_TINY = np.finfo(float).tiny  # least variance that is divided by


class Uncertainty(NamedTuple):
    """The uncertainty of the free parameters x of a fit."""

    influence: Floats
    """Shift of each x by a standard deviation of each step, [parameter, step]; last, along what no step determines."""
    by_even_noise: Floats
    """Such shifts by equal noise at all steps: they show which parameters the curve can tell apart at all."""
    noise: Correlation
    """Correlation of the noise of neighbouring steps."""
    reach: Floats
    """Distances in x to the lower and the upper end of the 95 % interval, [2, parameter]."""
    by_profile: NDArray[np.bool_]
    """Which parameters have an end of their interval by the profile of the sum of squares."""
    shift: Floats | None
    """Largest shift of each x by the error of the law; None where that error is not known."""
    error_of_law: Floats | None
    """Error of the law [step], weighted as the deviations, likewise."""

    @property
    def covariance(self) -> Floats:
        """The covariance of x."""
        return np.asarray(self.influence @ self.influence.T)

    def deviation_of(self, combination: Floats) -> float:
        """Return the standard error of a combination of x."""
        return float(np.linalg.norm(combination @ self.influence, axis=-1))


def correlation_of(influence: Floats) -> Floats:
    """Return the correlation of parameters by the influence of each step on them; 0 with one whose error is 0."""
    error = np.linalg.norm(influence, axis=1, keepdims=True)
    scaled = influence / np.where(error > 0.0, error, 1.0)
    correlation = np.clip(scaled @ scaled.T, -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    return np.asarray(correlation)


def uncertainty(model: Model, found: Found, law: LoadSeparation) -> Uncertainty:
    """Return the uncertainty at the parameters of least squares, where the law is ``law``.

    With a standard deviation of each load it follows from these, by the normal distribution. Without, the variance of
    each step is that of the residuals near it, for noise that is constant, proportional or otherwise uneven, with
    Student's t and the degrees of freedom of the deciding steps. Noise may be correlated: see ``correlation``.
    Intervals end where a jump would miss a measured load, or where the sum of squares is too large, if it is no
    parabola: see ``profile``.
    """
    slopes = found.slopes
    lengths = np.linalg.norm(slopes, axis=0)
    if not lengths.max() > 0.0:
        for parameter, x in zip(model.parameters, found.x.tolist(), strict=True):
            if bound := parameter.bound_met(x):
                raise OutOfRange(f"free: {bound}")
        keys = ", ".join(parameter.key for parameter in model.parameters)
        negative = bool((model.curve.load - model.curve.level).sum() < 0.0)
        sign = f"; {model.curve.quantity} is mostly negative, and compression is positive" * negative
        raise OutOfRange(f"free: {keys}: changes nothing along the measured path, where the scene has no contact{sign}")
    lengths = np.maximum(lengths, _LEAST_SLOPE * lengths.max())
    left, sizes, right = np.linalg.svd(slopes / lengths, full_matrices=False)
    points = found.points
    _check_enough(model, slopes[:points] / lengths)
    inverse = right.T @ (left / np.maximum(sizes, _LEAST_SLOPE * sizes[0])).T / lengths[:, None]
    noise = noise_correlation(model.curve, left[:points], found.residuals)
    residuals = found.residuals if model.curve.error is None else None
    from_priors = model.noise * inverse[:, points:] @ model.spread
    influence, quantile = by_noise(inverse[:, :points], left[:points], residuals, noise, from_priors)
    unknown = right[sizes < _LEAST_SLOPE * sizes[0]] / lengths
    unknown *= _UNKNOWN / np.abs(unknown).max(axis=1, keepdims=True)
    influence = np.hstack([influence, unknown.T])
    edges = certain_edges(model, found)
    reach = _reach(influence, quantile, edges)
    stays = reach < (1.0 - _ROUNDING) * quantile * np.linalg.norm(influence, axis=1)
    ends = profiled(model, found, inverse, np.where(stays | (not edges.certain), -reach, reach))
    at_given = law.model_error.curve * law.variables[model.curve.quantity]  # separation
    error = yielded(model, found.x, at_given) / model.curve.weight if np.isfinite(law.model_error.curve).all() else None
    shift = None if error is None else np.abs(inverse[:, :points] @ error)
    return Uncertainty(influence, inverse, noise, ends, (ends != reach).any(axis=0), shift, error)


def apart_from_the_rest(
    model: Model, found: Found, noise: Correlation, rows: NDArray[np.integer]
) -> tuple[Floats, Floats]:
    """Return how far deviations from priors or other curves are from what all the rest tells, and the covariance of
    that; by the linearised law.
    """
    points, lengths = found.points, np.linalg.norm(found.slopes, axis=0)
    slopes = found.slopes / np.where(lengths > 0.0, lengths, 1.0)
    rest, own, kept = (np.delete(slopes, rows, axis=0), slopes[rows], np.delete(model.spread, rows - points, axis=0))
    covariance = np.linalg.inv(rest.T @ rest + _LEAST_SLOPE**2 * np.eye(lengths.size))
    inverse, left = covariance @ rest.T, np.linalg.svd(slopes[:points], full_matrices=False)[0]
    shift = -inverse @ np.delete(found.deviations, rows)
    residuals = found.residuals + slopes[:points] @ shift if model.curve.error is None else None
    of_priors = np.hstack([inverse[:, points:] @ kept, _LEAST_SLOPE * covariance])  # and where nothing is known
    influence, _ = by_noise(inverse[:, :points], left, residuals, noise, model.noise * of_priors)
    spread = np.hstack([own @ influence, model.noise * model.spread[rows - points]])
    return found.deviations[rows] + own @ shift, spread @ spread.T


def noise_correlation(curve: MeasuredCurve, left: Floats, deviations: Floats) -> Correlation:
    """Return the correlation of the noise, which large deviations are not."""
    return Correlation() if curve.relative_rms(deviations) > POOR else correlation_of_noise(left, deviations)


def by_noise(
    inverse: Floats, left: Floats, residuals: Floats | None, noise: Correlation, from_priors: Floats
) -> tuple[Floats, Floats]:
    """Return the shift of each parameter by independent noise, that of the steps and then that of the priors, and the
    quantile of its error, from residuals or, where the errors are known, none.

    The degrees of freedom allow for the error of the correlation, which goes with that of the variance.
    """
    from scipy.stats import norm, t

    def at(rho: float) -> tuple[Floats, Floats]:
        if residuals is None:
            influence, freedom = by_independent_noise(inverse, rho), np.full(len(inverse), np.inf)
        else:
            influence, freedom = by_residuals(inverse, left, residuals, rho)
        of_steps, of_priors = (np.square(each).sum(axis=1) for each in (influence, from_priors))
        freedom = freedom * np.square(1.0 + np.minimum(of_priors / np.maximum(of_steps, _TINY), _MOST_KNOWN))
        return np.hstack([influence, from_priors]), freedom

    (influence, freedom), probability = at(noise.rho), 0.5 * (1.0 + _LEVEL)
    if noise.rho:
        change = _CHANGE * (1.0 - noise.rho)
        sizes = np.linalg.norm([influence, at(noise.rho + change)[0]], axis=2)
        growth = 2.0 * np.abs(np.diff(np.log(sizes), axis=0)[0]) / change
        freedom = np.maximum(2.0 / np.square(np.sqrt(2.0 / freedom) + growth * noise.error), 1.0)
    return influence, np.where(np.isinf(freedom), norm.ppf(probability), t.ppf(probability, freedom))


def _reach(influence: Floats, quantile: Floats, edges: Edges) -> Floats:
    """Return the extent of intervals to both sides: a quantile of standard errors, limited by the edges.

    The limit is sought among all parameters within the joint confidence region of probability ``_TOGETHER``.
    """
    from scipy.stats import chi2, norm

    left, sizes, _ = np.linalg.svd(influence, full_matrices=False)
    axes = left * sizes
    reach = np.tile(quantile * np.linalg.norm(axes, axis=1), (2, 1))
    if edges.ends.size:
        wider = float(np.sqrt(chi2.ppf(_TOGETHER, quantile.size))) / norm.ppf(0.5 * (1.0 + _LEVEL))
        allowed = Edges(edges.sides @ axes, edges.ends)
        for (side, i), width in np.ndenumerate(reach):
            radius = max(wider, 1.0) * float(quantile[i])
            most = farthest((-1.0, 1.0)[side] * axes[i], radius, allowed)
            reach[side, i] = min(width, most)
    return reach


def _check_enough(model: Model, slopes: Floats) -> None:
    """Raise OutOfRange where the steps that depend on the parameters are no more than these, which then fit any noise,
    unless the errors of the load are given.
    """
    deciding = int(np.sum(np.linalg.norm(slopes, axis=1) > _LEAST_SLOPE))
    if model.curve.error is None and deciding <= slopes.shape[1]:
        keys = ", ".join(parameter.key for parameter in model.parameters)
        them = "them" if slopes.shape[1] > 1 else "it"
        raise OutOfRange(
            f"free: {keys}: only {deciding} of {len(slopes)} points depend on {them}, "
            f"too few to tell the noise; measure more points in contact, free less, or give "
            f"{model.curve.quantity}_error"
        )


def by_residuals(inverse: Floats, left: Floats, residuals: Floats, rho: float = 0.0) -> tuple[Floats, Floats]:
    """Return the shift of each parameter by the noise of each step, from residuals near it, with degrees of freedom.

    ``inverse`` [parameter, step] is the shift by a deviation; ``left`` [step, parameter] are orthonormal vectors
    that span the slopes; ``rho`` is the correlation of the noise of neighbours. Each variance is a weighted sum of
    squared residuals, whose covariance is C = (1 - H) R (1 - H) = R + P Q' by that of the noise. Its degrees of freedom
    are those of the chi-square distribution that scatters as much, (tr M)^2/tr M^2 with M = w C w, after Bell and
    McCaffrey (2002); w^2 is the share of each residual in the sum.
    """
    each_side = max(_NEIGHBOURS, residuals.size // _WIDER) if rho else _NEIGHBOURS
    smooth = correlated(left, rho)
    ahead = np.hstack([left, 0.5 * left @ (left.T @ smooth) - smooth])
    back = np.roll(ahead, left.shape[1], axis=1)
    diagonal = 1.0 + np.sum(ahead * back, axis=1)
    rest = summed_nearby(np.maximum(diagonal, _LEAST_FREEDOM), each_side)
    variance = summed_nearby(np.square(residuals), each_side) / rest
    shares = summed_nearby(np.square(inverse) / rest, each_side)
    shares *= np.maximum(variance, _LEAST_NOISE * variance.max()) if variance.any() else 1.0
    shares /= shares.max(axis=1, keepdims=True)
    trace = shares @ diagonal
    trace_of_square = [
        w[:, 0] @ correlated(w, rho * rho)[:, 0]
        + 2.0 * np.sum(w * ahead * correlated(w * back, rho))
        + np.sum((ahead.T @ (w * ahead)) * (back.T @ (w * back)))
        for w in shares[:, :, None]
    ]
    freedom = np.maximum(np.square(trace) / np.array(trace_of_square), 1.0)
    return by_independent_noise(inverse * np.sqrt(variance), rho), freedom
