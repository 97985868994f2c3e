"""One indenter in a square periodic patch of zero mean displacement, by boundary integrals with a free edge; E* is 1.

Its images load the surface through the part of the Green's function that is smooth at the contact (``two_contacts``).
"""

import math

import numpy as np
from scipy.special import erf, erfc

from roughmdr.numerics.arguments import Floats
from twins.mapped_disc import Complexes
from twins.two_contacts import DEGREE, Contact, Indenter, press

_CELLS = 3  # images and waves on either side: the sums of Ewald have 14 digits at the contact
_SPLIT = math.sqrt(math.pi)


def image_green(z: Complexes) -> Floats:
    """Return the displacement [1/(E* side)] by a point force and its images, less 1/(π r); of zero mean.

    Positions are in sides of the patch (P. P. Ewald, Ann. Phys. 369 (1921) 253).
    """
    r = np.abs(z)
    result = np.asarray(-2.0 - np.divide(erf(_SPLIT * r), r, out=np.full(r.shape, 2.0), where=r > 1e-8))
    for m in range(-_CELLS, _CELLS + 1):
        for n in range(-_CELLS, _CELLS + 1):
            if m or n:
                away, q = np.abs(z + complex(m, n)), 2.0 * math.pi * math.hypot(m, n)
                wave = np.cos(2.0 * math.pi * (m * z.real + n * z.imag))
                result += erfc(_SPLIT * away) / away + 2.0 * math.pi * math.erfc(0.5 * q / _SPLIT) / q * wave
    return np.asarray(result / math.pi)


def periodic(indenter: Indenter, side: float, degree: int = DEGREE) -> Contact:
    """Return the contact in a patch of ``side``; the approach counts from the mean plane of the deformed surface."""
    return press(indenter, images=lambda z, source: image_green((z[:, None] - source) / side) / side, degree=degree)
