"""What the kernels need to know of a profile: its MDR profile along the contact radius, in units of width and rise.

The functions are plain Python on ``elementary``, so that they can be compiled, or run with any number of digits.
``t`` is the parameter that the shape chooses to count its contact radius by, growing with it: where a contact radius
needs more digits than a float has (a corner, the equator of a sphere) it is not the radius itself. ``params`` holds the
numbers, beside width and rise, that tell profiles of one shape apart.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

Params = Sequence[float]


def never_softens(params: Params) -> int:
    """No dip."""
    return 0


def _no_softening_interval(index: int, params: Params) -> tuple[float, float]:
    """Never called."""
    return 0.0, 0.0


def _smooth(low: float, high: float, params: Params) -> bool:
    """No kink anywhere."""
    return False


def no_breakpoints(params: Params) -> int:
    """No edge."""
    return 0


def _no_breakpoint(index: int, params: Params) -> tuple[float, float]:
    """Never called."""
    return 0.0, 0.0


def one_breakpoint(params: Params) -> int:
    """One edge."""
    return 1


def breakpoint_at_one(index: int, params: Params) -> tuple[float, float]:
    """At one width, from which on the profile is smooth in sqrt(x^2 - 1)."""
    return 1.0, 1.0


def _few(params: Params) -> float:
    """Those of a dozen operations, and of the powers of t up to the third."""
    return 16.0


def _nothing(params: Any) -> None:
    """Nothing more to find out."""


class Profile(NamedTuple):
    """A profile in units of its width (radii) and its rise (depths), over the contact radius a; g and G as in H 17."""

    mdr_profile: Callable[..., tuple[Any, Any, Any, Any]]
    """(t, form) -> a, da/dt, g, dg/dt."""
    reduced_load: Callable[..., Any]
    """(t, form) -> ∫_0^a x g'(x) dx = a g - G, without their difference."""
    mdr_integral: Callable[..., Any]
    """(t, form) -> G."""
    t_of_radius: Callable[[float, float, Params], float]
    """(contact radius, width, form) -> t."""
    f_and_slope: Callable[..., tuple[Any, Any]]
    """(r, form) -> f, df/dr."""
    softening_count: Callable[[Params], int] = never_softens
    """form -> how often sqrt(a) g'(a) falls on its way from 0 to infinity: each time two stable branches may part."""
    softening_interval: Callable[[int, Params], tuple[float, float]] = _no_softening_interval
    """(number, form) -> the t from which and to which it falls."""
    kink: Callable[[float, float, Params], bool] = _smooth
    """(low, high, form) -> whether g' is not smooth from low to high."""
    elastic_integral: Callable[..., Any] | None = None
    """(t, form) -> 2 ∫ g' ∫ x g' dx dx to a; None where that is left to quadrature."""
    corner: bool = False
    """Whether g' jumps up to infinity where it begins to fall."""
    flat: bool = False
    """Whether the profile is flat to one width, so that g and t begin there."""
    end: float = math.inf
    """The radius where the profile ends."""
    breakpoint_count: Callable[[Params], int] = no_breakpoints
    """form -> at how many radii g is not smooth."""
    breakpoint: Callable[[int, Params], tuple[float, float]] = _no_breakpoint
    """(number, form) -> such a radius, and the one y for which g is smooth in sqrt(x^2 - y^2) from there on."""
    t_of_q: Callable[[float, Params], float] | None = None
    """(q, form) -> t where q = sqrt(x^2 - y^2) beyond the edge y, where that has more digits than x itself."""
    roundings: Callable[[Params], float] = _few
    """form -> by how many roundings, of what they are, g and a g - G may be off, that of t among them."""
    term_sizes: Callable[[float, Params], tuple[float, float]] | None = None
    """(t, form) -> how large the terms are that g and push are the sums of; None where none of them cancel."""
    precompute: Callable[[Any], None] = _nothing
    """Fills in what else the functions need to know, in the second place of a form that is one number."""


def swung(radius: float, width: float) -> float:
    """q = sqrt(a^2 - b^2)/b for a contact radius a >= b = ``width``."""
    return float(((radius - width) / width) ** 0.5 * ((radius + width) / width) ** 0.5)
