"""The profile of a shape with one parameter besides width and rise, for vector code.

It reads the copy of the parameter in NUMBER: compilers do not vectorise loads from the beginning of rows. Notation of
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
