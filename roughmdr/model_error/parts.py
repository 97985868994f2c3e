"""The parts of the model error, each a share of the force, and their sum along the path."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.validity import ValidityLimits
from roughmdr.ensemble.ensemble import Origin
from roughmdr.model_error.coupling import summits_error
from roughmdr.model_error.interaction import OF_ORIGIN, interaction_error
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import ORIGINS

TRUSTED_FRACTION = 0.02
"""Contact fraction up to which a result is called trusted: the error by interaction is 22 % at most, typically 12 %."""

TRUSTED_ERROR = 0.02
"""Error by interaction up to which the force of coupled asperities is called trusted."""

YIELDED_SHARE = 0.02
"""Share of the load in contacts above the hardness up to which the elastic law is said to hold.

The others bear up to 11 % less than stated, where the Hertzian mean pressure of spheres is the hardness (L. Kogut, I.
Etsion, J. Appl. Mech. 69 (2002) 657).
"""

_SLACK = 1.01  # a path that ends at this contact fraction is trusted all along

PLASTIC = "plasticity_error"
"""The part that contacts have which yield."""
PLASTIC_AT_FORCE = ("plasticity_area_error", "plasticity_stiffness_error", "plasticity_radius_error")
"""Their errors of contact area, stiffness and contact radii at given force by the model of yielding."""
SOFTNESS = "plasticity_softness"
"""Their ``Yielding.softness`` at closest approach."""

PARTS = {
    "interaction_error": "asperities that do not feel each other, or are coupled only so far",
    "slope_error": "slopes that are not small",
    "profile_end_error": "contacts beyond the end of their profile",
    "adhesion_range_error": "JKR, where adhesion reaches further than it supposes",
    "resolution_error": "a map that does not resolve its summits or hills",
    "border_error": "what the border of a map cuts of its hills, or leaves out of its summits",
}
"""The parts of the model error, by their names in results."""

ALL_PARTS = PARTS | {PLASTIC: "the model of yielding, from which others differ"}
"""These parts, and the one that only contacts which yield have."""


class Yielding(NamedTuple):
    """How much models of contacts that yield differ, and how much softer contacts are than elastic ones."""

    force: Floats
    """Largest difference of the forces at given separation, over the largest force, at each step."""
    softness: Floats
    """Slope of the law over that of elastic contacts of these radii, at most 1, at each step.

    What neighbours displace a contact by changes its force by so much less: of a lattice exactly, to first order.
    """
    at_force: tuple[float, ...]
    """Errors ``PLASTIC_AT_FORCE`` on loading, the largest from a tenth of the largest force on; NaN with adhesion."""

    def named(self, separation: Floats) -> dict[str, float]:
        """Return the numbers of a run by their names in results."""
        softness = float(self.softness[np.argmin(separation)])
        return {**dict(zip(PLASTIC_AT_FORCE, self.at_force, strict=True)), SOFTNESS: softness}


class Assumptions(NamedTuple):
    """Departures of an ensemble from the assumptions of the model, where the flat is closest."""

    limits: ValidityLimits
    jkr_error: float = 0.0
    """Estimated error of JKR's force of all contacts [N]; 0 where JKR is not used."""
    resolution_error: float = 0.0
    """The relative error of the force that the resolution of a map causes."""
    border_error: float = 0.0
    """The relative error of the force by what the border of a map cuts."""
    origin: Origin = "asperities"
    """Where the asperities come from."""
    overlap: float = math.nan
    """Share of the contacts that reach into a neighbour's; NaN where it is not known."""
    coupling_error: Floats | None = None
    """The error of coupled asperities at each step; None for independent ones."""
    conductance_error: Floats | None = None
    """The error of their conductance; None for independent ones."""
    neighbours_error: Floats | None = None
    """The error of independent ones from their distances, at each step; None to take it from the contact fraction."""
    contact_fraction: Floats | None = None
    """That where the contacts are, at each step, if they crowd on a part of the patch; None for that of the patch."""
    yielding: Yielding | None = None
    """Numbers of contacts that yield; None for elastic ones."""


class ModelError(NamedTuple):
    """The estimated relative error of the force that the assumptions of the model cause."""

    curve: Floats
    """The error at each step; NaN where the nominal area is not known."""
    named: dict[str, float]
    """The largest error over the steps, with those over the largest force as they are, and all that describes it, by
    their names in results: NaN where it follows from a nominal area that is not known.
    """

    @property
    def parts(self) -> dict[str, float]:
        """The largest of each of ``PARTS`` over the steps; ``PLASTIC`` where contacts yield."""
        return {name: self.named[name] for name in ALL_PARTS if name in self.named}

    @classmethod
    def of(
        cls, assumptions: Assumptions, separation: Floats, force: Floats, contact_fraction: Floats | None
    ) -> "ModelError":
        """Return the error along a path: separation [m], force [N] and contact fraction at each step.

        The parts add up, each and all to at most 1, the whole force; those of JKR are over the largest force. So is
        that of yielding where the flat has been lower, or contacts pull, but along the path it is over the force.
        Where the force is 0 only the error by interaction is left: of contacts that push and pull, or that JKR makes
        late.
        """
        limits, largest = assumptions.limits, float(np.nanmax(np.abs(force), initial=0.0))
        constant = {
            "slope_error": limits.slope_error,
            "profile_end_error": limits.end_error,
            "adhesion_range_error": min(assumptions.jkr_error / largest, 1.0) if largest > 0.0 else 0.0,
            "resolution_error": assumptions.resolution_error,
            "border_error": assumptions.border_error,
        }
        others, plastic, stated = sum(constant.values()), np.zeros(()), np.zeros(())
        if (yielding := assumptions.yielding) is not None:
            by_model = yielding.force
            at_step = np.divide(by_model * largest, np.abs(force), out=np.zeros_like(force), where=force != 0.0)
            plastic = np.minimum(at_step, 1.0)
            loads = (separation <= np.minimum.accumulate(separation)) & (force.min() >= 0.0)
            stated = np.where(loads, plastic, np.minimum(by_model, 1.0))
            constant[PLASTIC] = float(stated.max(initial=0.0))
        named = {
            **dict.fromkeys(("model_error", "interaction_error"), math.nan),
            **constant,
            **({} if yielding is None or contact_fraction is None else yielding.named(separation)),
            **dict.fromkeys(("overlap_fraction", "largest_contact_fraction", "trusted_separation"), math.nan),
            "asperity_origin": ORIGINS.index(assumptions.origin),
        }
        if contact_fraction is None:
            return cls(np.where(force != 0.0, math.nan, 0.0), named)
        coupled, known = assumptions.coupling_error, assumptions.neighbours_error
        coefficients = OF_ORIGIN[assumptions.origin]
        if coupled is None:
            interaction = interaction_error(contact_fraction, coefficients) if known is None else np.minimum(known, 1.0)
        else:
            interaction = np.where(np.isnan(force), math.nan, coupled)
        if yielding is not None:
            flanks = summits_error(contact_fraction, assumptions.origin)
            interaction = np.minimum(interaction, flanks + (interaction - flanks) * yielding.softness)
        curve, errors = (
            np.minimum(interaction + np.where(force != 0.0, others + each, 0.0), 1.0) for each in (plastic, stated)
        )
        if coupled is None:
            trusted = interaction <= interaction_error(np.array(_SLACK * TRUSTED_FRACTION), coefficients)
        else:  # the error of hills is the same at every contact fraction
            trusted = np.isfinite(force) if assumptions.origin == "hills" else interaction <= TRUSTED_ERROR
        beyond = separation[~trusted]
        named |= {
            "model_error": float(np.nanmax(errors, initial=0.0)),
            "interaction_error": float(np.nanmax(interaction, initial=0.0)),
            "overlap_fraction": assumptions.overlap,
            "largest_contact_fraction": float(np.nanmax(contact_fraction, initial=0.0)),
            "trusted_separation": float(beyond.max()) if beyond.size else math.nan,
        }
        return cls(curve, named)
