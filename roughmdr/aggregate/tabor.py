"""The least Tabor number of an ensemble, and the error of JKR there."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.detachment import Detachments, detachments
from roughmdr.kernels.adhesion import Adhesion, tabor_number
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.model_error.at_force import range_error
from roughmdr.shapes import SHAPES

SHIFT, _AT_A_CORNER = 5.0, 2.0
"""The error of JKR's force for many asperities, over the largest force, is at most (5 |delta_c|/std + 2 at a corner)
over the Tabor number, std that of the heights: under Dugdale's adhesion contacts are made sooner by w/sigma0. Measured
with paraboloids of normal heights, |delta_c|/std from 0.1 to 10, Tabor numbers from 1 to 100, the flat down to 2, 0 and
-1 std (``pipelines/study.py adhesion_range``): there at most 4.3.
Rounded punches need no more, however sharp their edges are: contacts detach at nearly the force of JKR."""

_JUMP, _JUMP_POWER = 1.6, -4.0 / 7.0
"""Distance before touch from which attraction with a range pulls a contact on, over the stretch at which it detaches:
factor and power of the Tabor number. The power is that of van der Waals forces (J.-J. Wu, J. Adhes. 86 (2010) 1071).
The factor bounds what boundary elements find, 0.8 at a Tabor number of 2 and 0.5 at 6
(``pipelines/study.py versus_adhesive_bem``)."""

_PER_FOLD = 4.0  # pull-off force of a paraboloid over E* a |delta| at its detachment under fixed grips

ASSUMED_RANGE = 0.4e-9
"""Range of the adhesion [m] where it is not given: of van der Waals forces between solids, on the long side, which is
the safe one.
"""


class JkrValidity(NamedTuple):
    """The limits of JKR for an ensemble."""

    tabor: float = math.inf
    """The least Tabor number [1]; inf where the strength of the adhesion is not given."""
    jkr_error: float = 0.0
    """Estimated error of the force by JKR, over the largest force; with ``ASSUMED_RANGE`` where no range is given."""
    contact_error: float = 0.0
    """Estimated error of JKR's force of one contact [N] while it lasts; jumps on before touch are left out."""

    @property
    def reach(self) -> float:
        """Largest distance before touch from which contacts may jump on, over the stretch at which they detach.

        At most 1, which it also is where the range is not given.
        """
        return min(_JUMP * self.tabor**_JUMP_POWER, 1.0) if 0.0 < self.tabor < math.inf else 1.0


def jkr_validity(
    shape: str,
    spread: float,
    columns: Columns,
    effective_modulus: float,
    adhesion: Adhesion,
    detached: Callable[[], Detachments] | None = None,
) -> JkrValidity:
    """Return the limits of JKR; the Tabor number is 0 where a contact is not representable in JKR.

    ``spread`` is the standard deviation of the heights [m]; ``detached`` returns where the contacts detach under JKR,
    if that is known already.
    """
    if not adhesion.tabor_known:
        assumed = adhesion._replace(strength=adhesion.work / ASSUMED_RANGE)
        if not assumed.tabor_known or not columns.width.size:
            return JkrValidity()
        usual = Columns(*(np.quantile(column, 0.5, axis=0, method="lower")[None] for column in columns))
        return jkr_validity(shape, spread, usual, effective_modulus, assumed)._replace(tabor=math.inf)
    if detached is None:
        jkr = Adhesion(adhesion.work)
        kernels = choose(shape, jkr, columns.params)
        depths, radii = detachments(kernels, columns, effective_modulus, jkr)
    else:
        depths, radii = detached()
    radius, depth = float(radii.min(initial=math.inf)), float(depths.max(initial=0.0))
    if not 0.0 < radius < math.inf:
        return JkrValidity(0.0, math.inf, math.inf)
    tabor = tabor_number(radius, effective_modulus, adhesion.work, adhesion.strength)
    pull_off = _PER_FOLD * effective_modulus * radius * depth
    if tabor == 0.0:  # below any float: DMT
        return JkrValidity(tabor, math.inf, float(range_error(tabor)) * pull_off)
    sharp = SHAPES[shape].flat and SHAPES[shape].corner
    at_corner = _AT_A_CORNER if sharp else 0.0
    shift = SHIFT * depth / spread if spread > 0.0 else math.inf
    relative = min(at_corner / tabor + float(range_error(tabor)), float(range_error(0.0)))
    return JkrValidity(tabor, (shift + at_corner) / tabor, relative * pull_off)
