"""Contacts above the hardness of the softer body: their shares, and up to where the elastic law holds."""

import math
from contextlib import suppress

import numpy as np

from roughmdr.aggregate.each_contact import contacts_at
from roughmdr.aggregate.problem import Problem
from roughmdr.errors import OutOfRange
from roughmdr.model_error.parts import YIELDED_SHARE

_HALVINGS = 9  # steps of the search for that share: its separation is right to 1/512 of the approach, 1 % of a sigma
_ROUND = ("paraboloid", "sphere")  # shapes whose radius is that of their tip


def yielding(problem: Problem, hardness: float, closest: float) -> dict[str, float]:
    """Return the diagnostics of contacts above a hardness [Pa] under a flat that approaches to ``closest`` [m].

    The elastic law has no end where they bear at most ``YIELDED_SHARE`` of the load; its pressure is 0 where they bear
    more from first touch on, NaN where there is no nominal area. OutOfRange as ``contacts_at``.
    """
    ensemble = problem.ensemble
    elastic, force = float(ensemble.height.max(initial=-math.inf)), 0.0
    contacts, load, _ = _shares(problem, hardness, closest) if closest < elastic else (0.0, 0.0, 0.0)
    radius = float(np.mean(ensemble.parameters["radius"])) if ensemble.shape in _ROUND else math.nan
    index = problem.effective_modulus / hardness * math.sqrt(ensemble.spread / radius)
    found = {"yielded_contact_fraction": contacts, "yielded_load_fraction": load, "plasticity_index": index}
    if load <= YIELDED_SHARE:
        return found
    for _ in range(_HALVINGS):
        middle, load, borne = 0.5 * (closest + elastic), math.nan, math.nan
        with suppress(OutOfRange):  # coupled contacts without an equilibrium
            _, load, borne = _shares(problem, hardness, middle)
        if load <= YIELDED_SHARE:
            elastic, force = middle, borne
        else:
            closest = middle
    pressure = max(force, 0.0) / (ensemble.nominal_area or math.nan)
    return {**found, "elastic_separation": elastic, "elastic_pressure": pressure}


def _shares(problem: Problem, hardness: float, separation: float) -> tuple[float, float, float]:
    """Return the share of the contacts with a mean pressure above the hardness [Pa], that of the load of pushing ones
    which they bear, and the force of all [N], at a separation [m].
    """
    found = contacts_at(problem, np.array([separation]), 0)
    touching = found.radius > 0.0
    force, radius = found.force[touching], found.radius[touching]
    above = force / radius / radius > math.pi * problem.ensemble.area_share * hardness
    pushing = float(force.sum(where=force > 0.0))
    load = float(force[above].sum()) / pushing if pushing > 0.0 else 0.0
    return float(above.mean()) if above.size else 0.0, load, float(found.force.sum())
