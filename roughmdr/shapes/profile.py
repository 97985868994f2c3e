"""The functions that the kernels need of a profile, in units of its width (radii) and its rise (depths).

They are plain Python on ``vector_math``, so that they can be compiled, or run with any number of digits. ``t`` is the
parameter by which the shape counts its contact radius a, and grows with it: a/width itself, unless a contact radius
needs more digits than a float has (at a corner, at the equator of a sphere). ``params`` holds the numbers, besides
width and rise, that tell profiles of one shape apart.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

Params = Sequence[float]


def zero(params: Params) -> int:
    """Return 0, as a count of breakpoints or of softening intervals."""
    return 0


def one(params: Params) -> int:
    """Return 1, as a count of breakpoints or of softening intervals."""
    return 1


def _no_interval(index: int, params: Params) -> tuple[float, float]:
    """Stand for the softening intervals where there are none; never called."""
    return 0.0, 0.0


def _breakpoint_at_one(index: int, params: Params) -> tuple[float, float]:
    """Return a breakpoint at one width, from which on g is smooth in sqrt(x^2 - 1)."""
    return 1.0, 1.0


def _no_kink(low: float, high: float, params: Params) -> bool:
    """Return False: g' is smooth everywhere."""
    return False


def kink_at_one(low: float, high: float, params: Params) -> bool:
    """Return whether t = 1, where g' has a kink, lies between low and high."""
    return low < 1.0 < high


def _radius_over_width(radius: float, width: float, params: Params) -> float:
    """Return t where it is the contact radius itself."""
    return radius / width


def q_of_radius(radius: float, width: float, params: Params) -> float:
    """Return q = sqrt(a^2 - b^2)/b for a contact radius a >= b = ``width``."""
    return float(((radius - width) / width) ** 0.5 * ((radius + width) / width) ** 0.5)


def t_is_q(q: float, params: Params) -> float:
    """Return t where it is q = sqrt(a^2 - 1)."""
    return q


def _default_roundings(params: Params) -> float:
    """Return the roundings of a dozen operations, and of the powers of t up to the third."""
    return 16.0


def _nothing_to_precompute(params: Any) -> None:
    """Leave ``params`` as it is."""


class Profile(NamedTuple):
    """The functions of a profile; g and G as in ``shapes.base``."""

    mdr_profile: Callable[..., tuple[Any, Any, Any, Any]]  # (t, params) -> a, da/dt, g, dg/dt
    reduced_load: Callable[..., Any]  # (t, params) -> ∫_0^a x g'(x) dx = a g - G, without that difference
    f_and_slope: Callable[..., tuple[Any, Any]]  # (r, params) -> f, df/dr
    t_of_radius: Callable[[float, float, Params], float] = _radius_over_width  # (contact radius, width, params) -> t
    softening_count: Callable[[Params], int] = zero
    """params -> number of intervals in which sqrt(a) g'(a) falls: each can part two stable branches."""
    softening_interval: Callable[[int, Params], tuple[float, float]] = _no_interval
    """(index, params) -> t at the beginning and at the end of such an interval."""
    kink: Callable[[float, float, Params], bool] = _no_kink
    """(low, high, params) -> whether g' is not smooth for t from low to high."""
    mdr_integral: Callable[..., Any] | None = None
    """(t, params) -> G; needed where a g - reduced_load cancels, as g rises from 0 at the edge of a flat or next to
    it."""
    elastic_integral: Callable[..., Any] | None = None
    """(t, params) -> 2 ∫ g' ∫ x g' dx dx to a; None where that is left to quadrature."""
    zone_integrals: Callable[..., tuple[Any, Any]] | None = None
    """(t, a, m, theta, params) -> I and K of ``shapes.zone_integrals``; None where they are left to quadrature."""
    corner: bool = False  # whether g' jumps to infinity, at the edge of a flat or of a blunter tip
    flat: bool = False  # whether the profile is flat to one width, where g and t begin
    end: float = math.inf  # the radius where the profile ends
    breakpoint_count: Callable[[Params], int] = zero  # params -> number of radii at which g is not smooth
    breakpoint: Callable[[int, Params], tuple[float, float]] = _breakpoint_at_one
    """(index, params) -> such a radius, and the y for which g is smooth in sqrt(x^2 - y^2) from there on."""
    t_of_q: Callable[[float, Params], float] | None = None
    """(q, params) -> t at q = sqrt(x^2 - y^2) beyond the breakpoint y, where q has more digits than x."""
    roundings: Callable[[Params], float] = _default_roundings
    """params -> bound of the relative errors of g and reduced_load, that of t included, in units of 2^-53."""
    term_sizes: Callable[[float, Params], tuple[float, float]] | None = None
    """(t, params) -> sizes of the terms that g and reduced_load are sums of; None where the terms do not cancel."""
    precompute: Callable[[Any], None] = _nothing_to_precompute
    """Fills in what else the functions need; the params of a shape that has one have a spare second element for it."""
