"""One power-law asperity without adhesion, whose state is x: for sums over asperities, as vector code.

Reduced as in ``hertz``: a/width = x^(1/n) and P over 2 E* width depth = n/(n + 1) a x (H 10, 16, 25).
"""

from functools import partial

from roughmdr.numerics.jit import compiled, njit
from roughmdr.numerics.vector_math import root

_root = compiled(root, small=True)
_vector = partial(njit, small=True)


@_vector
def state(x: float, n: float) -> float:
    """x >= 0 itself."""
    return x


@_vector
def radius_force_stiffness(x: float, n: float) -> tuple[float, float, float]:
    """a over width, P over 2 E* width depth, and k over 2 E* width."""
    a = _root(x, n)
    return a, n / (n + 1.0) * (a * x), a


@njit
def energy(x: float, n: float) -> float:
    """U over 2 E* width depth^2."""
    return float(n * n / ((n + 1.0) * (2.0 * n + 1.0)) * (_root(x, n) * x * x))
