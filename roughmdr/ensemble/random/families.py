"""Families of distributions in standard form: any continuous one of scipy.stats, a few of them without importing it.

scipy.stats takes longer to import than a small scene to compute. The families that most scenes use are one line each on
scipy.special; they give the same bits as scipy.stats, which a test holds them to.
"""

import math
import threading
import warnings
from collections.abc import Callable
from functools import cache, lru_cache, partial, wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats

_P = ParamSpec("_P")
_T = TypeVar("_T")
_RAISED = (ArithmeticError, RuntimeError, ValueError)
_TAILS = np.array([1e-3, 1e-6, 1e-10])  # shares of a family beyond quantiles that its moments must leave room for
_ROOM = 2.0  # times what they leave: quantiles may be rounded
_ALONE = threading.Lock()  # the filters of warnings are those of all threads


class Family(NamedTuple):
    """A family with location 0 and scale 1; ``own`` are its shape parameters."""

    shapes: tuple[str, ...]
    defined: Callable[..., bool]
    """(*own) -> whether there is such a distribution."""
    moments: Callable[..., tuple[float, float]]
    """(*own) -> mean and variance, inf or NaN where there is none."""
    lower: Callable[..., Floats]
    """(u, *own) -> the values below which the fractions u lie."""
    upper: Callable[..., Floats]
    """(u, *own) -> the values above which the fractions u lie."""
    below: Callable[..., Floats]
    """(x, *own) -> the fractions below the values x."""
    above: Callable[..., Floats]
    """(x, *own) -> the fractions above the values x."""
    density: Callable[..., Floats]
    """(x, *own) -> the density at x."""


def _normal(uniform: Floats) -> Floats:
    from scipy.special import ndtri

    return np.asarray(ndtri(uniform))


def _below_normal(x: Floats) -> Floats:
    from scipy.special import ndtr

    return np.asarray(ndtr(x))


def _normal_density(x: Floats) -> Floats:
    return np.asarray(np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi))


def _log(x: Floats) -> Floats:
    """The logarithm, -inf where there is none."""
    return np.log(np.maximum(x, 0.0))


def _log_normal_density(x: Floats, s: float) -> Floats:
    inside = np.where(x > 0.0, x, 1.0)
    return np.where(x > 0.0, _normal_density(np.log(inside) / s) / (s * inside), 0.0)


def _log_normal_moments(s: float) -> tuple[float, float]:
    with np.errstate(over="ignore"):
        spread = np.exp(s * s)
        return float(np.sqrt(spread)), float(spread * (spread - 1.0))


_LEAN = {
    "norm": Family(
        (),
        lambda: True,
        lambda: (0.0, 1.0),
        _normal,
        lambda u: -_normal(u),
        _below_normal,
        lambda x: _below_normal(-x),
        _normal_density,
    ),
    "lognorm": Family(
        ("s",),
        lambda s: s > 0.0,
        _log_normal_moments,
        lambda u, s: np.exp(s * _normal(u)),
        lambda u, s: np.exp(s * -_normal(u)),
        lambda x, s: _below_normal(_log(x) / s),
        lambda x, s: _below_normal(-_log(x) / s),
        _log_normal_density,
    ),
    "uniform": Family(
        (),
        lambda: True,
        lambda: (0.5, 1.0 / 12.0),
        lambda u: u,
        lambda u: 1.0 - u,
        lambda x: np.clip(x, 0.0, 1.0),
        lambda x: np.clip(1.0 - x, 0.0, 1.0),
        lambda x: np.where((x >= 0.0) & (x <= 1.0), 1.0, 0.0),
    ),
}


@cache
def find_family(name: str) -> Family | None:
    """The family with a scipy.stats name; None where there is none."""
    if name in _LEAN:
        return _LEAN[name]
    import scipy.stats

    family = getattr(scipy.stats, name, None)
    return _from_scipy(family) if isinstance(family, scipy.stats.rv_continuous) else None


def _from_scipy(family: Any) -> Family:
    return Family(
        () if family.shapes is None else tuple(family.shapes.split(", ")),
        _quiet(lambda *own: bool(family._argcheck(*own))),
        lru_cache(maxsize=256)(_quiet(partial(_moments, family))),
        *(_quiet(_one_by_one(function)) for function in (family.ppf, family.isf, family.cdf, family.sf, family.pdf)),
    )


def _one_by_one(function: Callable[..., Floats]) -> Callable[..., Floats]:
    """A function of scipy's that is NaN where it would raise, as some do far out."""

    def call(x: ArrayLike, *own: float) -> Floats:
        try:
            return np.asarray(function(x, *own))
        except _RAISED:
            if np.ndim(x) == 0:
                return np.asarray(np.nan)
            return np.array([call(one, *own) for one in np.ravel(x)]).reshape(np.shape(x))

    return call


def _moments(family: Any, *own: float) -> tuple[float, float]:
    """Mean and variance; NaN for what scipy says where there is none, as of invweibull with c below 1 or 2.

    What lies beyond a quantile bears its share of the mean and of the variance (the inequalities of Markov and
    Chebyshev): moments without room for it are none.
    """
    mean, variance = (float(moment) for moment in family.stats(*own, moments="mv"))
    least, most = family.support(*own)
    try:
        low, high = family.ppf(_TAILS, *own), family.isf(_TAILS, *own)
    except _RAISED:  # its inverse leads nowhere
        return mean, variance
    too_high = _TAILS * (high - least) > _ROOM * (mean - least)
    too_low = _TAILS * (most - low) > _ROOM * (most - mean)
    if not least <= mean <= most or too_high.any() or too_low.any():
        return math.nan, math.nan
    far = np.sqrt(_TAILS) * np.maximum(high - mean, mean - low)
    return mean, variance if variance >= 0.0 and not (far > _ROOM * math.sqrt(variance)).any() else math.nan


def _quiet(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The same without scipy's warnings: what comes of it is looked at."""

    @wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with _ALONE, warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return function(*args, **kwargs)

    return call


def known_families() -> list[str]:
    """The names of all families."""
    import scipy.stats

    return [name for name in dir(scipy.stats) if isinstance(getattr(scipy.stats, name), scipy.stats.rv_continuous)]
