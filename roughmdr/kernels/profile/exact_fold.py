"""The pull-off of one asperity, at the fold where it detaches, beyond the digits of a float.

At the distance X to the fold, an error of the fold is magnified by 1/sqrt(X) in radius, force and stiffness.
"""

from roughmdr.kernels.profile.layout import CONTROL, FOLD
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import Pair
from roughmdr.shapes import ProfileShape


def exact_depth(shape: ProfileShape, effective_modulus: float, work: float, params: Floats) -> Pair:
    """Minus the indentation [m] (fixed grips) or minus the force [N] (dead load) at detachment, as two floats.

    These are dl(a) - g(a) and 2 E* [a dl(a) - (a g - G)] at the lowest foot of the row (H 40-41, 44).

    The quantity is stationary there, so that the rounding of t does not matter.
    """
    from mpmath import mp

    a, g, push = shape.precisely(float(params[FOLD]))
    with mp.workdps(40):
        stretch = mp.sqrt(2 * mp.pi * a * mp.mpf(work) / mp.mpf(effective_modulus))
        depth = stretch - g if params[CONTROL] == 0.0 else 2 * mp.mpf(effective_modulus) * (a * stretch - push)
        return float(depth), float(depth - mp.mpf(float(depth)))
