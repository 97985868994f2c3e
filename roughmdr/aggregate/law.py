"""The load-separation law of one ensemble along one path, made from the totals over its asperities."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import totals
from roughmdr.asperity.validity import ValidityLimits
from roughmdr.errors import OutOfRange
from roughmdr.loading.pull_off import PullOff
from roughmdr.model_error.conductance import conductance_error
from roughmdr.model_error.parts import Assumptions, ModelError
from roughmdr.model_error.refusal import Givens, check_contact_fraction
from roughmdr.numerics.arguments import Floats

PER_AREA = {"pressure", "contact_fraction", "model_error_curve"}
"""Variables that need a nominal area."""


class LoadSeparation(NamedTuple):
    """The law of one ensemble along one path."""

    variables: dict[str, Floats]
    """Values over the steps by name, in SI."""
    numerical_error: float
    """Bound on the error of the force along the path, over the largest magnitude of the force."""
    model_error: ModelError
    """The error that the assumptions of the model cause."""
    extremes: ValidityLimits
    """The extremes of all contacts."""
    visits: int
    """How often an asperity was visited."""
    tabor: float
    """The least Tabor number of the asperities [1]; inf where the strength of the attraction is not known."""
    model: str
    """The adhesion model that was used."""
    warnings: tuple[str, ...] = ()
    """Warnings that concern the ensemble itself."""
    yielding: Callable[[], dict[str, float]] = dict
    """Return the diagnostics of contacts above the hardness; none where that is not given."""
    pull_off: PullOff = PullOff()
    """The largest tension of the unloadings."""
    overlap_count: float = math.nan
    """Number of contacts that overlap a neighbour's, at closest approach; NaN without pairwise interaction."""
    marked_steps: float = math.nan
    """Number of steps without an equilibrium, not at rest to the error asked for, or with too much overlap or contact;
    NaN without pairwise interaction.
    """
    grid_points: float = math.nan
    """Points of the boundary-element grid that gave the law; 0 if coupled in pairs, NaN if independent."""
    reference_points: float = math.nan
    """Points of the boundary-element grid of the reference beside the law; NaN without [reference]."""
    conductance_error: float = math.nan
    """The largest relative error of the conductance that the assumptions of the model cause; NaN where not asked for.
    """
    tangential_error: float = math.nan
    """The largest relative error of the stiffness of contacts that stick; NaN where not asked for."""
    avalanche_count: float = math.nan
    """Number of separations at which contacts were made or lost; NaN without pairwise interaction and adhesion."""
    avalanche_size_max: float = math.nan
    """Largest number of contacts that changed at one such separation; NaN where ``avalanche_count`` is."""
    effective_contacts: float = math.nan
    """``effective_number`` of the contacts where the flat is closest; NaN where none bears a force, or it is not known.
    """
    sampling_error: float = math.nan
    """Relative scatter from patch to patch of the force there, at the same separation; NaN where it is not known."""
    area_sampling_error: float = math.nan
    """Relative scatter from patch to patch of the contact area, at the same force; NaN where it is not known."""

    @classmethod
    def of(
        cls,
        total: Floats,
        names: list[str],
        separation: Floats,
        givens: Givens,
        assumptions: Assumptions,
        visits: int,
        tabor: float,
        model: str,
    ) -> LoadSeparation:
        """Return the law from ``total`` [row, step].

        OutOfRange where a variable is not representable, or where the contacts have more area than the patch.
        """
        area, force = givens.nominal_area, total[totals.FORCE]
        fraction = None if math.isnan(area) else _over_area("contact_fraction", total[totals.AREA], area)
        if fraction is not None:
            check_contact_fraction(fraction, separation, givens)
        local = fraction if assumptions.contact_fraction is None else assumptions.contact_fraction
        model_error = ModelError.of(assumptions, separation, force, local)
        results = {name: total[totals.TOTAL_INDEX[name]] for name in names if name not in PER_AREA}
        if fraction is not None and not PER_AREA.isdisjoint(names):
            pressure = _over_area("pressure", force, area)
            derived = {"contact_fraction": fraction, "pressure": pressure, "model_error_curve": model_error.curve}
            results |= {name: derived[name] for name in names if name in derived}
        largest, error = (float(np.nanmax(np.abs(row), initial=0.0)) for row in (force, total[totals.ERROR]))
        relative = error / largest if largest > 0.0 else 0.0
        extremes = assumptions.limits._replace(tabor=tabor if model == "jkr" else math.inf)
        law = cls(results, relative, model_error, extremes, visits, tabor, model)
        if "conductance_radius" not in names:
            return law
        return law._replace(conductance_error=conductance_error(assumptions, model_error, fraction))

    def only(self, names: list[str]) -> LoadSeparation:
        """Return the law with these variables, in this order."""
        return self._replace(variables={name: self.variables[name] for name in names})


def effective_number(force: Floats) -> float:
    """Return the effective number of contacts that carry the load, (sum of |F|)^2 / sum of F^2 [1]; NaN for none.

    So many equal contacts have the same sums. Forces of both signs count by their magnitude: pushing and pulling
    contacts do not cancel.
    """
    sizes = np.abs(force)
    largest = float(sizes.max(initial=0.0))
    if largest == 0.0:
        return math.nan
    sizes /= largest
    total = float(sizes.sum())
    return total * total / float(np.square(sizes, out=sizes).sum())


def _over_area(name: str, total: Floats, area: float) -> Floats:
    with np.errstate(over="ignore"):  # refused below
        values = np.asarray(total / area)
    if not np.isfinite(values[np.isfinite(total)]).all():
        raise OutOfRange(f"{name} is not representable on a nominal area of {area:g} m2")
    return values
