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
    form: Floats,
    start: int,
    stop: int,
    control: float,
) -> Floats:
    """The forms of the asperities from start to stop."""
    return form[start:stop]


@njit
def own(forms: Floats, i: int) -> float:
    """The form of one asperity."""
    return float(forms[i])


@njit
def mixed(forms: Floats) -> bool:
    """Whether the forms differ."""
    return bool(np.any(forms != forms[0]))
