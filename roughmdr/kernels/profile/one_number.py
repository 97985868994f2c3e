"""The profile of a shape that one number tells apart, besides width and rise, for vector code.

Compilers make none of loads from where the rows of all asperities begin, and the number stands there. Notation of
``layout``.
"""

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import NUMBER
from roughmdr.numerics.arguments import Floats


def mdr_profile(t: float, params: Floats) -> tuple[float, float, float, float]:
    """a, da/dt, g and dg/dt."""
    return kernel.mdr_profile(t, (params[NUMBER],))


def reduced_load(t: float, params: Floats) -> float:
    """∫_0^a x g'(x) dx."""
    return kernel.reduced_load(t, (params[NUMBER],))
