"""The error of the force of asperities that are coupled in pairs, to first or second order in their distance."""

import math

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble, Origin
from roughmdr.numerics.arguments import Floats

_SEPARATED, _POWER = 0.18, 2.5
"""Error of contacts that are far from overlapping, (a/D)^5: factor, and power of the contact fraction."""
_FIRST, _THIRD, _FULLER = 0.65, 1.5, 3.0
"""Error of separated contacts to first order, (a/D)^3: factor, power of the contact fraction, and growth with it."""
_CROWDED = 5.0
"""Growth with the contact fraction of the error by contacts near to each other (``interaction/totals.py``); to first
order that error cancels a part of the error by terms left out."""
_TYPICAL_CROWDING = 0.15
"""Crowding over the share of the force of overlapping contacts, where their distances are not known."""
_LIGHT_SUMMITS, _SUMMITS = 0.1, 0.7
"""Error of summits at light contact, and what is added over the root of the contact fraction: flanks of a continuous
surface are no paraboloids (``pipelines/study.py at_pressure``)."""

_HILLS = 0.06
"""Error of the hills of an isotropic map, from 0.3 to 20 % contact (``pipelines/study.py hills``); it grows as the root
of the ratio of the slopes across and along the waves."""

_HELD = 0.13
"""Error of the force of adhesive hills in contact, over their pull-off forces: that of one paraboloid at Tabor number 2
(``pipelines/study.py versus_adhesive_bem``; ``pipelines/study.py adhesive_hills`` compares it with maps)."""

WARNED_SHARE, WARNED_FRACTION = 0.1, 0.1
MARKED_SHARE, MARKED_FRACTION = 0.25, 0.15
"""Shares of the force of overlapping contacts, and contact fractions, from which there is a warning or a mark."""
HILLS_MARKED_FRACTION = 0.3
"""Contact fraction of hills from which there is a mark: nothing was measured beyond. Their contacts may overlap."""


def coupling_error(
    contact_fraction: Floats, crowding: Floats, ensemble: Ensemble | None = None, order: int = 2
) -> Floats:
    """Return about the largest relative error of the force [1], as measured (``pipelines/study.py versus_bem``).

    ``contact_fraction`` is the summed contact area over the nominal area, ``crowding`` about the error by contacts near
    to each other at low contact fractions; shape (n,) each. ``ensemble`` are the asperities, on a plane where it is
    left out.
    """
    if ensemble is not None and ensemble.origin == "hills":
        return np.where(contact_fraction > 0.0, min(_HILLS * math.sqrt(ensemble.anisotropy), 1.0), 0.0)
    if order == 1:
        error = np.maximum(_FIRST * contact_fraction**_THIRD * (1.0 + _FULLER * contact_fraction), crowding)
    else:
        separated = _SEPARATED * contact_fraction**_POWER
        error = np.maximum(separated, crowding * (1.0 + _CROWDED * contact_fraction))
    origin = "asperities" if ensemble is None else ensemble.origin
    return np.minimum(error + summits_error(contact_fraction, origin), 1.0)


def adhesive_hills_error(doubted: Floats, held: Floats, largest: float) -> Floats:
    """Return the part of JKR in the error of hills at each step, over the largest force [1]; 1 where that is 0.

    ``doubted`` is the sum of the pull-off forces of hills out of contact in JKR that attraction with a range may have
    pulled into contact, and of hills whose contacts overlap and may merge; ``held`` is that of all other contacts,
    shape (n,) each; ``largest`` is the largest force [N].
    """
    off = doubted + _HELD * held
    return np.where(off < largest, off / (largest or 1.0), (off > 0.0).astype(float))


def foreseen_error(contact_fraction: float, overlap: float) -> float:
    """Return ``coupling_error`` where only the share of the force of overlapping contacts is known."""
    return float(coupling_error(np.array(contact_fraction), np.array(_TYPICAL_CROWDING * overlap)))


def summits_error(contact_fraction: Floats, origin: Origin) -> Floats:
    """Return the part of it that asperities cause by standing for the summits of a surface [1]."""
    if origin != "summits":
        return np.zeros_like(contact_fraction)
    return np.where(contact_fraction > 0.0, _LIGHT_SUMMITS + _SUMMITS * np.sqrt(contact_fraction), 0.0)


def coupling_warnings(
    contact_fraction: float, overlap: float, marked: float, *, on_grid: bool = False, area: str = "the nominal area"
) -> list[str]:
    """Return the warnings of the largest contact fraction, of which ``area``, and overlap of a path; ``on_grid``: by
    boundary elements.
    """
    if on_grid:
        failed = f"up to {marked:.0f} steps of a realisation have no value: boundary elements did not converge"
        return [failed] if marked > 0 else []
    lines = []
    if contact_fraction > WARNED_FRACTION or overlap > WARNED_SHARE:
        carried = f", and those that overlap carry {overlap:.2g} of the force" if overlap > 0.0 else ""
        lines.append(
            f"contacts cover up to {contact_fraction:.2g} of {area}{carried} at closest approach: where they "
            f"are so near, their coupling is approximate (warned of above {WARNED_FRACTION:g} of the area and "
            f"{WARNED_SHARE:g} of the force)"
        )
    if marked > 0:
        causes = [
            "without an equilibrium, so that they have no value",
            "not at rest to the error asked for",
            f"with more than {MARKED_SHARE:g} of the force in overlapping contacts",
        ]
        if contact_fraction > MARKED_FRACTION:
            area = f"{MARKED_FRACTION:g} of the area in contact (of hills {HILLS_MARKED_FRACTION:g})"
            causes.insert(0, f"with more than {area}")
        lines.append(f"up to {marked:.0f} steps of a realisation are marked: {', or '.join(causes)}")
    return lines
