"""How far from an ensemble a rigid flat touches and attracts no asperity."""

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


def _last_detachment(z: Floats, columns: Columns, material: Material, least_depth: float) -> float:
    """Return where [m] the last contact has detached under fixed grips; NaN where a depth is not representable."""
    last = -math.inf
    for start in range(0, z.size, BLOCK):
        stop = min(start + BLOCK, z.size)
        params = law.prepare(material, columns, start, stop, 0.0)
        for i in range(start, stop):
            own = law.params_of(params, i - start)
            (depth, _), _, _, _ = law.scales(
                material.effective_modulus, material.work, columns.width[i], columns.rise[i], own
            )
            if not 0.0 < depth < math.inf:
                return math.nan
            last = max(last, z[i] + (1.0 + _MARGIN) * max(depth, least_depth))
    return last


@cache
def _compiled(kernels: Kernels) -> Callable[..., float]:
    return specialise(_last_detachment, kernels)


def clear_separation(ensemble: Ensemble, effective_modulus: float, adhesion: Adhesion) -> float:
    """Return a separation [m] just above that at which any asperity is in contact, or attracts; E* [Pa].

    There a flat that rises has left all of them. NaN where the contact of an asperity is not representable.
    """
    highest = float(ensemble.height.max())
    if adhesion.work == 0.0:
        return highest
    columns, last = ensemble.nondimensional(), highest
    for model in adhesion.candidates:
        one = adhesion._replace(model=model)
        kernels = choose(ensemble.shape, one, columns.params)
        material = Material(effective_modulus, one.work, one.strength)
        with np.errstate(all="ignore"):
            found = _compiled(kernels)(ensemble.height, columns, material, one.range)
        last = max(last, found) if found < math.inf else math.nan
    return math.nextafter(last, math.inf)
