"""Adhesive contacts that feel each other, along a path of the flat: the totals at each separation, and the jumps."""

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.front import Front
from roughmdr.interaction.settings import Interaction
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.underway import each_step
from roughmdr.shapes import SHAPES

_ABOVE = 1e-9  # height above first touch, over the side of the patch, at which a path begins at the latest


def solve_path(
    ensemble: Ensemble,
    separation: Floats,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
    names: set[str],
    at: int | None = None,
    reach: float = 0.0,
) -> Adhering:
    """Return adhesive contacts at separations [m] of a flat that comes from infinity; w [J/m2].

    Stiffness, energy and crowding are computed where ``names`` asks for them; each contact is told where the flat is
    closest, or at step number ``at``; ``reach`` as ``Account``. Errors as ``interaction.solve``.
    """
    front, rises = Front(ensemble, effective_modulus, work, interaction), np.diff(separation, prepend=np.inf) > 0.0
    account = Account(front, names, rises=bool(rises.any()), at=at, reach=reach)
    state = front.parted(max(float(separation[0]) / front.length, front.top + _ABOVE))
    try:
        for h, up in each_step(list(zip(separation.tolist(), rises.tolist(), strict=True))):
            state, pieces = front.go(state, h / front.length)
            for piece in pieces:
                account.pass_over(piece)
            account.stand(state, h, rises=up)
    except NoEquilibriumError:
        account.lose_rest(separation.size)
    return account.result()


def prepare(shape: str) -> None:
    """Compile all that adhesive contacts of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    place = np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble.alike(example, np.zeros(3), {"x": place, "y": place}, 10.0)
    solve_path(ensemble, np.zeros(1), 1.0, 1e-6, Interaction(model="pairwise"), set())
