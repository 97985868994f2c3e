"""Noise that is correlated from step to step, as filters make it: a first-order autoregression, R = rho^|k - l|."""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

POOR = 0.05
"""R.m.s. deviation over the largest load from which other starts are tried too, and deviations are no noise."""
_LIMIT = 3.3  # standard deviations of the sum of products of neighbours, which chance exceeds once in a thousand curves
_CHANCE = 2.0  # standard deviations of the correlation of neighbours, which noise exceeds once in 44 curves
_MOST = 0.9999  # largest correlation that is sought
_FEWEST = 1.5  # least effective number of steps: what is correlated over more of the curve is a misfit
_LAGS, _USUAL = 20, 0.999  # number of lags at which correlations are summed, and probability of a smaller sum
_PEAKED = 4.5  # largest kurtosis of noise, 3 for the normal distribution
_WIDE, _NEAR = 4, 6  # inverse shares of a curve to each side of a step by which residuals are scaled
_LEAST = 1e-6  # least variance of the noise of a step over the mean


class Correlation(NamedTuple):
    """The correlation of the noise of neighbouring steps; 0 where none is significant, or where the law misfits."""

    rho: float = 0.0
    error: float = 0.0
    """Standard error."""

    def effective(self, steps: int) -> float:
        """Return the number of independent steps that would tell a mean as well, n (1 - rho)/(1 + rho)."""
        return steps * (1.0 - self.rho) / (1.0 + self.rho)


def is_systematic(deviations: Floats) -> bool:
    """Return whether neighbours deviate to the same side more often than those of noise do, even or uneven.

    Products of neighbours have mean 0 if all are independent, however large each may be.
    """
    products = deviations[1:] * deviations[:-1]
    size = float(np.sqrt(np.sum(np.square(products))))
    return bool(products.sum() > _LIMIT * size)


def correlation_of_noise(left: Floats, residuals: Floats) -> Correlation:
    """Return the correlation of the noise by restricted maximum likelihood, less its bias -2 rho/n (Kendall 1954).

    ``left`` [step, parameter] are orthonormal vectors that span the slopes of the law. Whether it is significant is
    told by products of scaled neighbours, which have mean 0 for any noise, less what the fit takes of them. A misfit
    is correlated over most of the curve, or what remains without the correlation is no noise either: it is still
    correlated, or a few steps have most.
    """
    if not residuals.any():
        return Correlation()
    even = residuals / (scale := _scale(residuals, _WIDE))
    squares, products = np.square(even), even[1:] * even[:-1]
    taken = 0.5 * np.sum(left[1:] * left[:-1], axis=1) @ (squares[1:] + squares[:-1])
    if not products.sum() + taken > _CHANCE * float(np.linalg.norm(products)):
        return Correlation()
    from scipy.optimize import minimize_scalar

    columns = np.column_stack([left / scale[:, None], even])

    def unlikelihood(rho: float) -> float:
        white, triangle = _whitened(columns, rho)
        determinants = (white.size - 1) * np.log1p(-rho * rho) + 2.0 * np.log(np.abs(np.diag(triangle))).sum()
        return float((white.size - left.shape[1]) * np.log(white @ white) + determinants)

    rho = float(minimize_scalar(unlikelihood, bounds=(0.0, _MOST), method="bounded").x)
    unbiased = min(rho * (1.0 + 2.0 / residuals.size), _MOST)
    found = Correlation(unbiased, float(np.sqrt((1.0 - rho * rho) / residuals.size)))
    long = Correlation(rho).effective(residuals.size) < _FEWEST
    return found if not long and _is_noise(_whitened(columns, rho)[0]) else Correlation()


def _whitened(columns: Floats, rho: float) -> tuple[Floats, Floats]:
    """Return the last column without correlation and without what the others explain, and the triangle of these."""
    white = columns.copy()
    white[1:] = (columns[1:] - rho * columns[:-1]) / np.sqrt(1.0 - rho * rho)
    q, triangle = np.linalg.qr(white[:, :-1])
    return white[:, -1] - q @ (q.T @ white[:, -1]), triangle


def _is_noise(white: Floats) -> bool:
    """Return whether residuals without correlation are noise: neither correlated (Ljung and Box 1978, with products for
    uneven noise) nor concentrated.
    """
    from scipy.stats import chi2

    even = white / _scale(white, _NEAR)
    lags = range(1, min(_LAGS, white.size // 4) + 1)
    products = [even[k:] * even[:-k] for k in lags]
    sums = [float(each.sum() / (np.linalg.norm(each) or 1.0)) for each in products]
    remains = float(np.sum(np.square(sums))) > chi2.ppf(_USUAL, max(len(lags) - 1, 1))
    return not remains and float(np.mean(even**4)) < _PEAKED


def _scale(residuals: Floats, share: int) -> Floats:
    """Return the root mean square of the residuals near each step."""
    squares, each_side = np.square(residuals), residuals.size // share
    mean = summed_nearby(squares, each_side) / summed_nearby(np.ones(residuals.size), each_side)
    return np.asarray(np.sqrt(np.maximum(mean, _LEAST * squares.mean())))


def summed_nearby(steps: Floats, each_side: int) -> Floats:
    """Return the sum over each step and its neighbours, along the last axis."""
    from scipy.ndimage import convolve1d

    return np.asarray(convolve1d(steps, np.ones(2 * each_side + 1), mode="constant"))


def correlated(columns: Floats, rho: float) -> Floats:
    """Return R times columns [step, column]."""
    back = _decaying(columns, rho)
    return np.asarray(back + _decaying(columns[::-1], rho)[::-1] - columns)


def by_independent_noise(influence: Floats, rho: float) -> Floats:
    """Return an influence [parameter, step] of correlated noise as one of independent noise: times L, R = L L'."""
    back = _decaying(influence.T[::-1], rho)[::-1].T
    return np.hstack([back[:, :1], np.sqrt(1.0 - rho * rho) * back[:, 1:]])


def _decaying(columns: Floats, rho: float) -> Floats:
    """Return the sums over each step and those before, by rho less for each step."""
    from scipy.signal import lfilter

    return np.asarray(lfilter([1.0], [1.0, -rho], columns, axis=0)) if rho else columns
