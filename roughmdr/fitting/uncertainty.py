"""The uncertainty of fitted parameters: covariance, intervals, and the shift that the error of the law may cause."""

from typing import NamedTuple

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.fitting.edges import Edges, certain_edges, farthest
from roughmdr.fitting.model import Model
from roughmdr.fitting.search import Found
from roughmdr.fitting.slopes import yielded
from roughmdr.numerics.arguments import Floats

_LEVEL = 0.95
_TOGETHER = 0.99  # probability of the parameters, all together, of which the edges between jumps allow some
_LEAST_SLOPE = 1e-6  # least slope over the largest: parameters that change the law by less are not known at all
_LEAST_FREEDOM = 1e-6  # least degrees of freedom of a step: with none, the fit follows it whatever the noise
_NEIGHBOURS = 2  # steps to each side whose residuals estimate the noise of a step
_LEAST_NOISE = 1e-6  # least variance of the noise over the largest, where degrees of freedom are counted
_UNKNOWN = 10.0  # standard error of x along a combination that is not known at all, however small the noise


class Uncertainty(NamedTuple):
    """The uncertainty of the free parameters x of a fit."""

    influence: Floats
    """Shift of each x by a standard deviation of each step, [parameter, step]; last, along what no step determines."""
    by_even_noise: Floats
    """Such shifts by equal noise at all steps: they show which parameters the curve can tell apart at all."""
    slopes: Floats
    """Derivative of the law with respect to each x, [step, parameter]."""
    reach: Floats
    """Distances in x to the lower and the upper end of the 95 % interval, [2, parameter]."""
    shift: Floats | None
    """Largest shift of each x by the error of the law; None where that error is not known."""

    @property
    def covariance(self) -> Floats:
        """The covariance of x."""
        return np.asarray(self.influence @ self.influence.T)

    @property
    def standard_error(self) -> Floats:
        """The standard error of each x."""
        return self.deviation_of(np.eye(self.influence.shape[0]))

    @property
    def correlation(self) -> Floats:
        """The correlation of x; 0 with a parameter whose error is 0."""
        return correlation_of(self.influence)

    def deviation_of(self, combination: Floats) -> Floats:
        """Return the standard error of a combination of x, or of each of several."""
        return np.asarray(np.linalg.norm(combination @ self.influence, axis=-1))


def correlation_of(influence: Floats) -> Floats:
    """Return the correlation of parameters by the influence of each step on them."""
    error = np.linalg.norm(influence, axis=1, keepdims=True)
    scaled = influence / np.where(error > 0.0, error, 1.0)
    correlation = np.clip(scaled @ scaled.T, -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    return np.asarray(correlation)


def uncertainty(model: Model, found: Found) -> Uncertainty:
    """Return the uncertainty at the parameters of least squares.

    With a standard deviation of each load it follows from these, by the normal distribution. Without, the variance of
    each step is that of the residuals near it, for noise that is constant, proportional or otherwise uneven, with
    Student's t and the degrees of freedom of the deciding steps. Intervals end where a jump would miss a measured
    load: see ``edges``.
    """
    from scipy.stats import norm, t

    slopes = found.slopes
    lengths = np.linalg.norm(slopes, axis=0)
    if not lengths.max() > 0.0:
        keys = ", ".join(parameter.key for parameter in model.parameters)
        negative = bool(model.curve.load.sum() < 0.0)
        sign = f"; {model.curve.quantity} is mostly negative, and compression is positive" * negative
        raise OutOfRange(f"free: {keys}: changes nothing along the measured path, where the scene has no contact{sign}")
    lengths = np.maximum(lengths, _LEAST_SLOPE * lengths.max())
    left, sizes, right = np.linalg.svd(slopes / lengths, full_matrices=False)
    _check_enough(model, slopes / lengths)
    inverse = right.T @ (left / np.maximum(sizes, _LEAST_SLOPE * sizes[0])).T / lengths[:, None]
    probability = 0.5 * (1.0 + _LEVEL)
    if model.curve.error is None:
        influence, freedom = by_residuals(inverse, left, found.deviations)
        quantile = np.asarray(t.ppf(probability, freedom))
    else:
        influence, quantile = inverse, np.full(found.x.size, norm.ppf(probability))
    unknown = right[sizes < _LEAST_SLOPE * sizes[0]] / lengths
    unknown *= _UNKNOWN / np.abs(unknown).max(axis=1, keepdims=True)
    influence = np.hstack([influence, unknown.T])
    reach = _reach(influence, np.asarray(quantile), certain_edges(model, found))
    return Uncertainty(influence, inverse, slopes, reach, _shift(model, found, inverse))


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


def by_residuals(inverse: Floats, left: Floats, residuals: Floats) -> tuple[Floats, Floats]:
    """Return the shift of each parameter by the noise of each step, from residuals near it, with degrees of freedom.

    ``inverse`` [parameter, step] is the shift by a deviation; ``left`` [step, parameter] are orthonormal vectors
    that span the slopes. Each variance is a weighted sum of squared residuals. Its degrees of freedom are those of the
    chi-square distribution that scatters as much, (tr M)^2/tr M^2 with M = w (1 - H) w, after Bell and McCaffrey
    (2002); w^2 is the share of each residual in the sum.
    """
    leverage = np.square(left).sum(axis=1)
    rest = _summed_nearby(np.maximum(1.0 - leverage, _LEAST_FREEDOM))
    variance = _summed_nearby(np.square(residuals)) / rest
    shares = _summed_nearby(np.square(inverse) / rest)
    shares *= np.maximum(variance, _LEAST_NOISE * variance.max()) if variance.any() else 1.0
    shares /= shares.max(axis=1, keepdims=True)
    overlap = np.einsum("ks,sa,sb->kab", shares, left, left)
    trace = shares @ (1.0 - leverage)
    trace_of_square = np.square(shares) @ (1.0 - 2.0 * leverage) + np.square(overlap).sum(axis=(1, 2))
    return inverse * np.sqrt(variance), np.maximum(np.square(trace) / trace_of_square, 1.0)


def _summed_nearby(steps: Floats) -> Floats:
    """Return the sum over each step and its neighbours, along the last axis."""
    from scipy.ndimage import convolve1d

    return np.asarray(convolve1d(steps, np.ones(2 * _NEIGHBOURS + 1), mode="constant"))


def _shift(model: Model, found: Found, inverse: Floats) -> Floats | None:
    law = model.law(found.x)
    curve = law.model_error.curve
    if not np.isfinite(curve).all():
        return None
    error = curve * law.variables[model.curve.quantity]  # at given separation
    return np.abs(inverse @ (yielded(model, found.x, error) / model.curve.weight))
