"""Where the contacts of an ensemble detach under fixed grips, and from where on the flat touches and attracts none."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Kernels, Material, law
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import specialise
from roughmdr.numerics.summation import BLOCK

_MARGIN = 1e-9  # of the depth of detachment, at which a contact still holds


def _fill_depths(columns: Columns, material: Material, depths: Floats) -> None:
    """Fill in how far below first touch [m] each contact detaches."""
    for start in range(0, depths.size, BLOCK):
        stop = min(start + BLOCK, depths.size)
        params = law.prepare(material, columns, start, stop, 0.0)
        for i in range(start, stop):
            own = law.params_of(params, i - start)
            (depth, _), _, _, _ = law.scales(
                material.effective_modulus, material.work, columns.width[i], columns.rise[i], own
            )
            depths[i] = depth


@cache
def _compiled(kernels: Kernels) -> Callable[[Columns, Material, Floats], None]:
    return specialise(_fill_depths, kernels)


def detachment_depths(kernels: Kernels, columns: Columns, effective_modulus: float, adhesion: Adhesion) -> Floats:
    """Return how far below first touch [m] each adhesive contact detaches; E* [Pa]."""
    depths = np.empty(columns.width.size)
    _compiled(kernels)(columns, Material(effective_modulus, adhesion.work, adhesion.strength), depths)
    return depths


def clear_separation(ensemble: Ensemble, effective_modulus: float, adhesion: Adhesion) -> float:
    """Return a separation [m] just above that at which any asperity is in contact, or attracts; E* [Pa].

    There a flat that rises has left all of them. NaN where the contact of an asperity is not representable.
    """
    height = ensemble.height
    highest = float(height.max())
    if adhesion.work == 0.0:
        return highest
    columns, last = ensemble.nondimensional(), highest
    for model in adhesion.candidates:
        one = adhesion._replace(model=model)
        with np.errstate(all="ignore"):  # what no float can hold is NaN
            depths = detachment_depths(choose(ensemble.shape, one, columns.params), columns, effective_modulus, one)
            if not ((depths > 0.0) & (depths < math.inf)).all():
                return math.nan
            found = float(np.max(height + (1.0 + _MARGIN) * np.maximum(depths, one.range)))
        last = max(last, found) if found < math.inf else math.nan
    return math.nextafter(last, math.inf)
