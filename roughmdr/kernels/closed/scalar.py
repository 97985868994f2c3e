"""Laws whose form is one number, or none: the kernels take it as it is."""

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


@njit
def prepare(
    effective_modulus: float,
    work: float,
    strength: float,
    width: Floats,
    rise: Floats,
    params: Floats,
    start: int,
    stop: int,
    control: float,
) -> Floats:
    """The forms of the asperities from start to stop."""
    return params[start:stop]


@njit
def own(params: Floats, i: int) -> float:
    """The form of one asperity."""
    return float(params[i])


@njit
def mixed(params: Floats) -> bool:
    """Whether the forms differ."""
    return bool(np.any(params != params[0]))
