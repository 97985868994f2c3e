"""One flat-ended punch, its contact pinned to its edge: P = 2 E* b delta, with adhesion down to -dl(b) (H 44).

The natural depth is dl(b), where it detaches (K. Kendall, J. Phys. D 4 (1971) 1186), or b without adhesion. The state
is the indentation over it.
"""

import math

from roughmdr.numerics import double_double as dd
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import njit

_KERNEL_ERROR = 1e-14


@njit
def scales(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """Depth [m], b [m], 2 E* b depth [N] and 2 E* b [N/m]; all 0 where the stretch is not representable."""
    depth = (width, 0.0)
    if work > 0.0:
        square = dd.divide(dd.multiply(dd.PI, dd.two_product(2.0 * work, width)), (effective_modulus, 0.0))
        if not 1e-280 < square[0] < 1e290:
            return (0.0, 0.0), 0.0, 0.0, 0.0
        depth = dd.sqrt(square)
    return depth, width, 2.0 * effective_modulus * width * depth[0], 2.0 * effective_modulus * width


@njit
def relative_errors(n: float) -> tuple[float, float]:
    """The error of the force: the scales and the state have a few roundings each."""
    return _KERNEL_ERROR, 0.0


@njit
def force_scales(effective_modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """The force [N] at the depth, and b [m]."""
    depth = scales(effective_modulus, work, width, rise, n)[0]
    return dd.multiply(dd.two_product(2.0 * effective_modulus, width), depth), width


@njit
def state(x: float, n: float) -> float:
    """delta over depth without adhesion."""
    return x


@njit
def state_jkr(x: float, n: float) -> float:
    """delta over depth at the distance x to the detachment."""
    return x - 1.0


@njit
def state_of_radius(radius: float, size: float, n: float) -> float:
    """NaN: the radius does not determine the state."""
    return math.nan


@njit
def reduced_control(s: float, n: float) -> float:
    """x without adhesion."""
    return s


@njit
def reduced_control_jkr(s: float, n: float) -> float:
    """x(s)."""
    return s + 1.0


@njit
def radius(s: float, n: float) -> float:
    """a/b."""
    return 1.0


@njit
def force(s: float, n: float) -> float:
    """P over 2 E* b depth."""
    return s


@njit
def stiffness(s: float, n: float) -> float:
    """k over 2 E* b."""
    return 1.0


@njit
def energy(s: float, n: float) -> float:
    """U over 2 E* b depth^2."""
    return 0.5 * s * s


@njit
def energy_jkr(s: float, n: float) -> float:
    """U, elastic and surface, over 2 E* b dl^2: pi w b^2 = E* b dl^2/2."""
    return 0.5 * s * s - 0.25


state_of_force, state_of_force_jkr = state, state_jkr
