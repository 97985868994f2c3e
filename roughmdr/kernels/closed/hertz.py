"""One power-law asperity without adhesion: delta = g(a), P = 2 E* [a g(a) - G(a)], k = 2 E* a (H 10, 16, 25).

Reduced: x = delta/depth with depth = kappa rise, and the state t = a/width, so that x = t^n.
"""

import math

from roughmdr.numerics.double_double import ROUNDING, Pair, two_product
from roughmdr.numerics.jit import njit
from roughmdr.shapes.kappa import kappa

_KERNEL_ERROR = 1e-13  # relative error of the force, as tested
_STEEP = 20.0  # (1e-15)^20 is still a normal float


@njit
def _scales(effective_modulus: float, width: float, depth: float) -> tuple[Pair, float, float, float]:
    """Depth [m], radius [m], force [N] and stiffness [N/m] as natural scales."""
    return (depth, 0.0), width, 2.0 * effective_modulus * width * depth, 2.0 * effective_modulus * width


@njit
def scales_paraboloid(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """The natural scales with kappa(2) = 2."""
    return _scales(effective_modulus, width, 2.0 * rise)


@njit
def scales_cone(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """The natural scales with kappa(1) = pi/2."""
    return _scales(effective_modulus, width, 0.5 * math.pi * rise)


@njit
def scales_power(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """The natural scales with any kappa(n).

    Where f = c r^n is so steep that t^n of a common radius is no normal float, the width is replaced by about the
    geometric mean of itself and of the radius at which f(r) = r.
    """
    k = 0.0
    if n > _STEEP:
        k = math.floor(0.5 * math.log2(width / rise) / (n - 1.0))
    power, rest = two_product(k, n)
    whole = math.floor(power)
    lifted = math.ldexp(rise * math.pow(2.0, (power - whole) + rest), int(whole))
    return _scales(effective_modulus, math.ldexp(width, int(k)), kappa(n) * lifted)


@njit
def state_paraboloid(x: float, n: float) -> float:
    """t at the reduced indentation x >= 0, n = 2."""
    return math.sqrt(x)


@njit
def state_cone(x: float, n: float) -> float:
    """t at the reduced indentation x >= 0, n = 1."""
    return x


@njit
def state_power(x: float, n: float) -> float:
    """t at the reduced indentation x >= 0. The second line removes the rounding of 1/n."""
    t = math.pow(x, 1.0 / n)
    back = math.pow(t, n)
    return t + t * (x / back - 1.0) / n if 0.0 < back < math.inf else t


@njit
def state_of_radius(radius: float, size: float, n: float) -> float:
    """t at a contact radius, ``size`` the natural one."""
    return radius / size


@njit
def reduced_control(t: float, n: float) -> float:
    """x(t)."""
    return math.pow(t, n)


@njit
def radius(t: float, n: float) -> float:
    """a/width."""
    return t


@njit
def force_paraboloid(t: float, n: float) -> float:
    """P over 2 E* width depth, n = 2."""
    return 2.0 / 3.0 * (t * t * t)


@njit
def force_cone(t: float, n: float) -> float:
    """P over 2 E* width depth, n = 1."""
    return 0.5 * (t * t)


@njit
def force_power(t: float, n: float) -> float:
    """P over 2 E* width depth."""
    return n / (n + 1.0) * (t * math.pow(t, n))


@njit
def stiffness(t: float, n: float) -> float:
    """k over 2 E* width."""
    return t


@njit
def energy_paraboloid(t: float, n: float) -> float:
    """U = ∫ P d(delta) over 2 E* width depth^2, n = 2."""
    square = t * t
    return 4.0 / 15.0 * (square * square * t)


@njit
def energy_cone(t: float, n: float) -> float:
    """U = ∫ P d(delta) over 2 E* width depth^2, n = 1."""
    return t * t * t / 6.0


@njit
def energy_power(t: float, n: float) -> float:
    """U = ∫ P d(delta) over 2 E* width depth^2."""
    x = math.pow(t, n)
    return n * n / ((n + 1.0) * (2.0 * n + 1.0)) * (t * x * x)


@njit
def relative_errors(n: float) -> tuple[float, float]:
    """The error of the force: a rounding of t changes t^(n + 1) by n + 1 roundings."""
    return _KERNEL_ERROR + 4.0 * ROUNDING * n, 0.0


@njit
def force_scales(effective_modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """The force [N] at t = 1, and the radius [m] there."""
    _, size, force, _ = scales_power(effective_modulus, work, width, rise, n)
    return (force * (n / (n + 1.0)), 0.0), size


@njit
def radius_of_force(x: float, n: float) -> float:
    """t at x >= 0, the force over that at t = 1: x = t^(n + 1)."""
    return state_power(x, n + 1.0)


@njit
def state_of_force(x: float, n: float) -> float:
    """t at x >= 0, the force over that at t = 1: x = t^(n + 1)."""
    return state_power(x, n + 1.0)
