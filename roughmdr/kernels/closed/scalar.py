"""Parameters of contacts in closed form: one number per asperity, passed to the kernels unchanged."""

from functools import partial

from roughmdr.kernels.interface import Columns, Material, kernel
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


@njit
def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return the parameters of the asperities from start to stop."""
    return columns.params[start:stop]


@partial(njit, inline=True)
def params_of(params: Floats, i: int) -> float:
    """Return the parameter of one asperity."""
    return float(params[i])


@njit
def heterogeneous(params: Floats) -> bool:
    """Return whether the parameters differ."""
    differing = 0
    for i in range(params.size):
        differing += params[i] != params[0]
    return differing > 0


def radius_force_stiffness(t: float, n: float) -> tuple[float, float, float]:
    """Return a, P and k, each over its natural scale."""
    return kernel.radius(t, n), kernel.force(t, n), kernel.stiffness(t, n)
