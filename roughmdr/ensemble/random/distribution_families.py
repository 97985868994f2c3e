"""Declare the families of distributions that a scene can name.

Every continuous distribution of scipy.stats is a family already, by its name there. ``FAST_FAMILIES`` holds those that
most scenes use, on scipy.special, since scipy.stats takes longer to import than a small scene to compute; they give the
same bits as scipy's. A family that scipy lacks is one more entry there. A second name for a family is an entry of
``ALIASES``; it has the parameters, loc and scale of that family.
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
_SCIPY_ERRORS = (ArithmeticError, RuntimeError, ValueError)
_TAIL_FRACTIONS = np.array([1e-3, 1e-6, 1e-10])  # beyond the quantiles that moments are checked against
_TAIL_MARGIN = 2.0  # factor by which a bound may be violated: quantiles may be rounded
_WARNING_FILTERS = threading.Lock()  # the filters are those of all threads

ALIASES = {"normal": "norm", "lognormal": "lognorm", "exponential": "expon", "weibull": "weibull_min"}
"""Names of a scene -> names of families."""


class Family(NamedTuple):
    """A family with location 0 and scale 1, as functions of its own parameters, ``args`` (scipy: shape parameters)."""

    parameters: tuple[str, ...]  # the names of its own parameters
    is_defined: Callable[..., bool]  # (*args) -> whether there is such a distribution
    moments: Callable[..., tuple[float, float]]  # (*args) -> mean and variance, inf or NaN where there is none
    ppf: Callable[..., Floats]  # (u, *args) -> the values below which the fractions u lie
    isf: Callable[..., Floats]  # (u, *args) -> the values above which the fractions u lie
    cdf: Callable[..., Floats]  # (x, *args) -> the fractions below the values x
    sf: Callable[..., Floats]  # (x, *args) -> the fractions above the values x
    pdf: Callable[..., Floats]  # (x, *args) -> the density at x


def ndtri(fraction: Floats) -> Floats:
    """Return the normal scores below which the fractions lie."""
    from scipy import special

    return np.asarray(special.ndtri(fraction))


def ndtr(score: Floats) -> Floats:
    """Return the fractions below normal scores."""
    from scipy import special

    return np.asarray(special.ndtr(score))


def _normal_pdf(x: Floats) -> Floats:
    return np.asarray(np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi))


def _log(x: Floats) -> Floats:
    """Return the logarithm, -inf at and below 0."""
    return np.log(np.maximum(x, 0.0))


def _lognormal_pdf(x: Floats, s: float) -> Floats:
    positive = np.where(x > 0.0, x, 1.0)
    return np.where(x > 0.0, _normal_pdf(np.log(positive) / s) / (s * positive), 0.0)


def _lognormal_moments(s: float) -> tuple[float, float]:
    with np.errstate(over="ignore"):
        square = np.exp(s * s)
        return float(np.sqrt(square)), float(square * (square - 1.0))


FAST_FAMILIES = {
    "norm": Family(
        parameters=(),
        is_defined=lambda: True,
        moments=lambda: (0.0, 1.0),
        ppf=ndtri,
        isf=lambda u: -ndtri(u),
        cdf=ndtr,
        sf=lambda x: ndtr(-x),
        pdf=_normal_pdf,
    ),
    "lognorm": Family(
        parameters=("s",),
        is_defined=lambda s: s > 0.0,
        moments=_lognormal_moments,
        ppf=lambda u, s: np.exp(s * ndtri(u)),
        isf=lambda u, s: np.exp(s * -ndtri(u)),
        cdf=lambda x, s: ndtr(_log(x) / s),
        sf=lambda x, s: ndtr(-_log(x) / s),
        pdf=_lognormal_pdf,
    ),
    "uniform": Family(
        parameters=(),
        is_defined=lambda: True,
        moments=lambda: (0.5, 1.0 / 12.0),
        ppf=lambda u: u,
        isf=lambda u: 1.0 - u,
        cdf=lambda x: np.clip(x, 0.0, 1.0),
        sf=lambda x: np.clip(1.0 - x, 0.0, 1.0),
        pdf=lambda x: np.where((x >= 0.0) & (x <= 1.0), 1.0, 0.0),
    ),
}


@cache
def find_family(name: str) -> Family | None:
    """Return the family of that name; None where there is none."""
    if name in FAST_FAMILIES:
        return FAST_FAMILIES[name]
    import scipy.stats

    family = getattr(scipy.stats, name, None)
    if not isinstance(family, scipy.stats.rv_continuous):
        return None
    functions = (family.ppf, family.isf, family.cdf, family.sf, family.pdf)
    return Family(
        () if family.shapes is None else tuple(family.shapes.split(", ")),
        _quiet(lambda *args: bool(family._argcheck(*args))),
        lru_cache(maxsize=256)(_quiet(partial(_checked_moments, family))),
        *(_quiet(_nan_for_errors(function)) for function in functions),
    )


@cache
def known_families() -> list[str]:
    """Return the names of all families."""
    import scipy.stats

    names = [name for name in dir(scipy.stats) if isinstance(getattr(scipy.stats, name), scipy.stats.rv_continuous)]
    return sorted({*FAST_FAMILIES, *names})


def _nan_for_errors(function: Callable[..., Floats]) -> Callable[..., Floats]:
    """Wrap a function of scipy's so that it is NaN where it would raise, as some do far out."""

    def call(x: ArrayLike, *args: float) -> Floats:
        try:
            return np.asarray(function(x, *args))
        except _SCIPY_ERRORS:
            if np.ndim(x) == 0:
                return np.asarray(np.nan)
            return np.array([call(one, *args) for one in np.ravel(x)]).reshape(np.shape(x))

    return call


def _checked_moments(family: Any, *args: float) -> tuple[float, float]:
    """Return mean and variance; NaN where scipy returns numbers but there is none, as for invweibull with c below 1.

    The values beyond a quantile bound the mean and the variance from below (the inequalities of Markov and Chebyshev):
    moments that violate these bounds are wrong.
    """
    mean, variance = (float(moment) for moment in family.stats(*args, moments="mv"))
    begin, end = family.support(*args)
    try:
        low, high = family.ppf(_TAIL_FRACTIONS, *args), family.isf(_TAIL_FRACTIONS, *args)
    except _SCIPY_ERRORS:  # the inverse does not converge
        return mean, variance
    too_high = _TAIL_FRACTIONS * (high - begin) > _TAIL_MARGIN * (mean - begin)
    too_low = _TAIL_FRACTIONS * (end - low) > _TAIL_MARGIN * (end - mean)
    if not begin <= mean <= end or too_high.any() or too_low.any():
        return math.nan, math.nan
    spread = np.sqrt(_TAIL_FRACTIONS) * np.maximum(high - mean, mean - low)
    return mean, variance if variance >= 0.0 and not (spread > _TAIL_MARGIN * math.sqrt(variance)).any() else math.nan


def _quiet(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """Wrap a function so that it does not warn: its results are checked."""

    @wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with _WARNING_FILTERS, warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            return function(*args, **kwargs)

    return call
