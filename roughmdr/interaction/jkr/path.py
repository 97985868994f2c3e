"""Adhesive contacts that feel each other, along a path of the flat: the totals at each separation, and the jumps."""

from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import State
from roughmdr.interaction.jkr.front import Front
from roughmdr.interaction.jkr.jumps import Avalanche
from roughmdr.interaction.settings import Interaction
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.underway import each_step
from roughmdr.shapes import SHAPES

_ABOVE = 1e-9  # height above first touch, over the side of the patch, at which a path begins at the latest
_KEPT = 40  # number of states on the way down that are kept: those of two intervals of a search


class Begun(NamedTuple):
    """A state that the flat came down to, with what its avalanches had dissipated [J]."""

    separation: float
    """[m]"""
    state: State
    dissipated: float
    avalanches: tuple[Avalanche, ...]


class Descent:
    """A flat that comes from infinity, time after time, to adhesive contacts of an ensemble; w [J/m2].

    Each way begins where another has come down to, so that a search along the way takes little more than one.
    """

    def __init__(self, ensemble: Ensemble, effective_modulus: float, work: float, interaction: Interaction) -> None:
        self._front, self._begun = Front(ensemble, effective_modulus, work, interaction), list[Begun]()

    def along(self, separation: Floats, names: set[str], at: int | None = None, reach: float = 0.0) -> Adhering:
        """Return adhesive contacts at separations [m].

        Stiffness, energy and crowding are computed where ``names`` asks for them; each contact is told where the flat
        is closest, or at step number ``at``; ``reach`` as ``Account``. Errors as ``interaction.solve``.
        """
        front, rises = self._front, np.diff(separation, prepend=np.inf) > 0.0
        account, risen = Account(front, names, rises=bool(rises.any()), at=at, reach=reach), False
        if above := [each for each in self._begun if each.separation >= separation[0]]:
            begun = min(above, key=lambda each: each.separation)
            state = begun.state
            account.begin(begun.dissipated, begun.avalanches)
        else:
            state = front.parted(max(float(separation[0]) / front.length, front.top + _ABOVE))
        try:
            for h, up in each_step(list(zip(separation.tolist(), rises.tolist(), strict=True))):
                state, pieces = front.go(state, h / front.length)
                for piece in pieces:
                    account.pass_over(piece)
                account.stand(state, h, rises=up)
                risen |= up
                if not risen:
                    bare = state._replace(factors=None)  # which are large
                    self._begun = [*self._begun[1 - _KEPT :], Begun(h, bare, account.dissipated, account.avalanches)]
        except NoEquilibriumError:
            account.lose_rest(separation.size)
        return account.result()


def prepare(shape: str) -> None:
    """Compile all that adhesive contacts of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    place = np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble.alike(example, np.zeros(3), {"x": place, "y": place}, 10.0)
    Descent(ensemble, 1.0, 1e-6, Interaction(model="pairwise")).along(np.zeros(1), set())
