"""Shapes drawn at random over all that a user may ask for."""

from collections.abc import Callable

import numpy as np

import roughmdr as rm
from roughmdr.shapes import Shape

Rng = np.random.Generator


def power_of_ten(rng: Rng, low: float, high: float) -> float:
    """Return a number whose decimal logarithm is uniform between two."""
    return float(10.0 ** rng.uniform(low, high))


def _length(rng: Rng) -> float:
    return power_of_ten(rng, -10.0, 0.0)


def _slope(rng: Rng) -> float:
    return power_of_ten(rng, -4.0, 2.0)


def _exponent(rng: Rng) -> float:
    """Return an exponent; half of them are near 1/2, where contacts are most sensitive."""
    return 0.5 + power_of_ten(rng, -2.0, 0.0 if rng.random() < 0.5 else 2.0)


def _series(rng: Rng) -> Shape:
    """Return a series whose terms are equal within some decades of one width."""
    width, count = np.float64(power_of_ten(rng, -8.0, -1.0)), int(rng.integers(1, 6))
    exponents = sorted({round(_exponent(rng), 6) if rng.random() < 0.7 else _exponent(rng) for _ in range(count)})
    rise = width * _slope(rng)
    return rm.PowerSeries({n: float(rise * power_of_ten(rng, -3.0, 3.0) / width**n) for n in exponents})


def _table(rng: Rng) -> Shape:
    """Return a table of powers, some with a flat tip, a wear flat or unevenly spaced points."""
    r = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-1.5, 0.0, int(rng.integers(3, 12))))])
    f = (r / r[-1]) ** rng.uniform(1.0, 6.0) + (rng.random() < 0.3) * rng.random() * r / r[-1]
    if rng.random() < 0.2:
        f[: int(rng.integers(2, r.size))] = 0.0
    length = _length(rng)
    return rm.Tabulated(r * length / r[-1], f * length * power_of_ten(rng, -4.0, 0.0))


def _mdr_table(rng: Rng) -> Shape:
    """Return an MDR table of rises of any size at radii near to each other or far apart."""
    count = int(rng.integers(1, 20))
    a, g = (np.cumsum(10.0 ** rng.uniform(-2.0, 0.0, count)) for _ in range(2))
    return rm.MdrTable(a * _length(rng), g * _length(rng))


def _capped(rng: Rng) -> Shape:
    radius = _length(rng)
    return rm.CappedParaboloid(radius, radius * power_of_ten(rng, 0.0, 4.0), _length(rng))


DRAW: dict[str, Callable[[Rng], Shape]] = {
    "paraboloid": lambda rng: rm.Paraboloid(_length(rng)),
    "cone": lambda rng: rm.Cone(_slope(rng)),
    "power_law": lambda rng: rm.PowerLaw(_exponent(rng), width=_length(rng), rise=_length(rng)),
    "flat_punch": lambda rng: rm.FlatPunch(_length(rng)),
    "sphere": lambda rng: rm.Sphere(_length(rng)),
    "truncated_cone": lambda rng: rm.TruncatedCone(_slope(rng), _length(rng)),
    "truncated_paraboloid": lambda rng: rm.TruncatedParaboloid(_length(rng), _length(rng)),
    "rounded_cone": lambda rng: rm.RoundedCone(_slope(rng), _length(rng)),
    "capped_paraboloid": _capped,
    "rounded_punch": lambda rng: rm.RoundedPunch(_length(rng), _length(rng)),
    "power_series": _series,
    "tabulated": _table,
    "mdr_table": _mdr_table,
}
