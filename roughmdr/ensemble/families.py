"""Families of distributions in standard form: any continuous one of scipy.stats, a few of them without importing it.

scipy.stats takes longer to import than a small scene to compute. The families that most scenes use are one line each on
scipy.special; they give the same bits as scipy.stats, which a test holds them to.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from roughmdr.arguments import Floats


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


def _normal(uniform: Floats) -> Floats:
    from scipy.special import ndtri

    return np.asarray(ndtri(uniform))


def _log_normal_moments(s: float) -> tuple[float, float]:
    with np.errstate(over="ignore"):
        spread = np.exp(s * s)
        return float(np.sqrt(spread)), float(spread * (spread - 1.0))


_LEAN = {
    "norm": Family((), lambda: True, lambda: (0.0, 1.0), _normal, lambda u: -_normal(u)),
    "lognorm": Family(
        ("s",),
        lambda s: s > 0.0,
        _log_normal_moments,
        lambda u, s: np.exp(s * _normal(u)),
        lambda u, s: np.exp(s * -_normal(u)),
    ),
    "uniform": Family((), lambda: True, lambda: (0.5, 1.0 / 12.0), lambda u: u, lambda u: 1.0 - u),
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
        lambda *own: bool(family._argcheck(*own)),
        lambda *own: tuple(float(moment) for moment in family.stats(*own, moments="mv")),
        lambda u, *own: np.asarray(family.ppf(u, *own)),
        lambda u, *own: np.asarray(family.isf(u, *own)),
    )


def known_families() -> list[str]:
    """The names of all families."""
    import scipy.stats

    return [name for name in dir(scipy.stats) if isinstance(getattr(scipy.stats, name), scipy.stats.rv_continuous)]
