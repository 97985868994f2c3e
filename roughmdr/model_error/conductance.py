"""The error of the conductance at given separation, against boundary elements (``pipelines/study.py conductance``)."""

import math

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble, Origin
from roughmdr.model_error.interaction import OF_ORIGIN
from roughmdr.model_error.parts import Assumptions, ModelError
from roughmdr.numerics.arguments import Floats

_INDEPENDENT: dict[Origin, float] = {"asperities": 2.2, "summits": 3.5, "hills": 10.0}
"""Error of the conductance without interaction, over the root of the contact fraction."""
_NEAR, _OVERLAP = 0.1, 0.2
"""Error of contacts coupled in pairs, over the contact fraction, and over the share of the force of overlapping ones.
"""
_FIRST_ORDER, _THIRD = 2.0, 1.5
"""Error that the first order adds, over this power of the contact fraction: (a/D)^3."""
_HILLS, _SUMMITS = 0.1, 2.5
"""Error of the hills of an isotropic map, two r.m.s. errors of their stiffness (``pipelines/study.py hills``); error of
summits, over the root of the contact fraction."""


def coupled_conductance_error(contact_fraction: Floats, overlap: Floats, ensemble: Ensemble, order: int) -> Floats:
    """Return about the largest relative error of the conductance [1] of contacts that are coupled in pairs.

    ``contact_fraction`` is the summed contact area over the nominal area, ``overlap`` the share of the force of
    contacts that overlap; shape (n,) each.
    """
    if ensemble.origin == "hills":  # hills are parts of one surface, and their contacts overlap
        error = np.where(contact_fraction > 0.0, _HILLS * math.sqrt(ensemble.anisotropy), 0.0)
    else:
        error = _NEAR * contact_fraction + _OVERLAP * overlap
    if ensemble.origin == "summits":
        error = error + _SUMMITS * np.sqrt(contact_fraction)
    if order == 1:
        error = error + _FIRST_ORDER * contact_fraction**_THIRD
    return np.minimum(error, 1.0)


def sticking_error(conductance_error: float, ratio: float, coupled: Floats, share: Floats) -> float:
    """Return the error of the stiffness of contacts that stick, if it is the normal one times G*/E*, the ``ratio``.

    It is NaN where that of the conductance is. The directions of neighbours add at most 1 - G*/E* of the change by
    neighbours: ``coupled``, the share by which they lower the conductance radius. On a patch that repeats, the counter
    pressure hides that change; for random positions it is then about the change of a conductance by neighbours, over
    the root of the number of contacts (30 patches of 10, 40 and 160 discs each, 0.2 and 2 % contact: 0.5 to 0.8 of it
    at most). ``share`` is the contact fraction over that number; shape (n,) each.
    """
    by_chance = _INDEPENDENT["asperities"] * np.sqrt(share)
    directions = float(np.max(np.maximum(np.abs(coupled), by_chance), initial=0.0))
    return min(conductance_error + abs(1.0 - ratio) * directions, 1.0)


def conductance_error(assumptions: Assumptions, model_error: ModelError, contact_fraction: Floats | None) -> float:
    """Return the largest error along a path, with the parts that are not by interaction; NaN without a nominal area."""
    if contact_fraction is None:
        return math.nan
    if not (contact_fraction > 0.0).any():  # NaN at steps without an equilibrium
        return 0.0
    interaction, known = assumptions.conductance_error, assumptions.neighbours_error
    if interaction is None:
        over_root = _INDEPENDENT[assumptions.origin]
        interaction = over_root * np.sqrt(contact_fraction)
        if known is not None:
            interaction = known * (over_root / OF_ORIGIN[assumptions.origin].estimate)
    largest = float(np.nanmax(interaction, initial=0.0))
    others = math.fsum(part for name, part in model_error.parts.items() if name != "interaction_error")
    return min(largest + others, 1.0)
