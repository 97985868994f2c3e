"""The separations of a map at which 0.3 to 20 % of it are in contact."""

import numpy as np

from roughmdr.numerics.arguments import Floats
from studies.hills.maps import MapCase
from studies.hills.press import by_elements

POINTS = 8
"""Of the map and of the boundary elements that all is held against, a shortest wave."""
FRACTIONS = np.geomspace(0.003, 0.2, 9)
_POINTS = 4  # a shortest wave, of the elements that look for the separations
_SEARCHED = 12  # separations, between which those of the fractions are found


def separations(case: MapCase) -> Floats:
    """Return separations [m] of the contact fractions, by coarse boundary elements."""
    height = case.height(_POINTS)
    tried = np.linspace(0.98 * float(height.max()), 0.2 * float(height.std()), _SEARCHED)
    found = by_elements(height, tried, stiffness=False)
    known = found.contact_fraction > 0.0
    return np.asarray(np.interp(np.log(FRACTIONS), np.log(found.contact_fraction[known]), tried[known]))
