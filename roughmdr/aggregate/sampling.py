"""Sampling errors of force and area: how far those of other patches of a surface differ, from the contacts of one."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.law import effective_number
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.placed import sides_of
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import SAMPLE

_BLOCKS = 4
"""Number of blocks along a side: fewer tell their scatter less surely, more are smaller than the longest waves."""
_HALVES = 2 * _BLOCKS
_NEXT = np.arange(1, _HALVES + 1) % _HALVES  # half block after each along a side; the patch goes on beyond its edges
_WAVES = np.arange(-12.0, 13.0)
"""Waves along a side that are taken to make up the forces of blocks; shorter ones are 8 % of these."""


def sample_of(ensemble: Ensemble, force: Floats, radius: Floats, factor: float = 1.0) -> dict[str, Any]:
    """Return the effective number of contacts and the sampling errors of force and area, ``SAMPLE`` by their names [1].

    ``force`` [N] and ``radius`` [m] are those of all asperities; ``factor`` is the scatter of their sum over that which
    its parts tell. Parts are 4 x 4 blocks of the patch where positions are known: long waves and clusters count. Else,
    and under a curved body, by whose profile blocks differ, they are the contacts: as many as chance has it (N. R.
    Campbell, Proc. Camb. Phil. Soc. 15 (1909) 117), or some of N asperities. At the same force the area differs, to
    first order, by the sum of what parts have above their shares by force (W. G. Cochran, Sampling Techniques, Wiley
    1977, chapter 6), of which n contacts tell the variance too small by 1 - 1/n. NaN where no contact bears a force, or
    one asperity is all there is; for the area also where one contact pulls, or bears all.
    """
    number, count, sides = effective_number(force), force.size, sides_of(ensemble)
    fixed = ensemble.origin == "asperities" and (not ensemble.goes_on or "patch_x" in ensemble.attrs)  # or a lattice
    found = dict(zip(SAMPLE, (number, math.nan, math.nan), strict=True))
    if math.isnan(number) or (fixed and count == 1):
        return found
    bearing = slice(count - int(np.argmax(force[::-1] != 0.0)))  # none after these bears a force
    load = force[bearing] / np.abs(force[bearing]).sum()
    own, weight = load, 1.0
    if tells := number > 1.0 and load.min() >= 0.0:
        area = radius[bearing] * radius[bearing]
        own = area / area.sum() - load
    if ensemble.positions.keys() >= {"x", "y"} and sides is not None and ensemble.axis is None:
        x, y = (ensemble.positions[name][bearing] * (_HALVES / side) for name, side in zip("xy", sides, strict=True))
        at = _HALVES * (np.floor(x).astype(np.int64) % _HALVES) + np.floor(y).astype(np.int64) % _HALVES
        load, own, fixed, count = _blocks(at, load), _blocks(at, own), True, _HALVES**2
        weight = 0.25 * _BLOCKS**2 / (_BLOCKS**2 - 1)
    variance = float(load @ load) - (float(load.sum()) ** 2 / count if fixed else 0.0)
    found["sampling_error"] = factor * math.sqrt(weight * max(variance, 0.0))
    if tells:
        found["area_sampling_error"] = math.sqrt(number / (number - 1.0) * weight * float(own @ own))
    return found


def _blocks(at: NDArray[np.int64], values: Floats) -> Floats:
    """Return the sums of values at half blocks over the blocks of four grids, each shifted by half a block."""
    halves = np.bincount(at, values, _HALVES**2).reshape(_HALVES, _HALVES)
    halves = halves + halves[_NEXT]
    return np.ravel(halves + halves[:, _NEXT])


def evening(ensemble: Ensemble, radius: Floats) -> float:
    """Return how much less blocks scatter because contacts of these radii [m] are coupled on a patch that repeats [1].

    A force that varies with the wave number k is lower by 1 + 4 sum of a/(A k): contacts have the stiffness 2 E* a, the
    half-space the compliance 2/(E* k) (K. L. Johnson, Contact Mechanics, Cambridge 1985, section 13.2). All waves count
    as equally strong. The force of the patch, k = 0, is not lower: separations are from the deformed mean plane.
    """
    x, y = sides_of(ensemble) or (1.0, 1.0)
    strength = np.outer(np.sinc(_WAVES / _BLOCKS) ** 2, np.sinc(_WAVES / _BLOCKS) ** 2)
    number = 2.0 * math.pi * np.hypot(_WAVES[:, None] / x, _WAVES / y)
    strength, number = strength[number > 0.0], number[number > 0.0]
    lowered = strength / (1.0 + 4.0 * float(radius.sum()) / x / y / number) ** 2
    return math.sqrt(float(strength.sum() / lowered.sum()))
