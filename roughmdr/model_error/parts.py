"""The parts of the model error, each a share of the force, and their sum along the path."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.validity import ValidityLimits
from roughmdr.model_error.interaction import ASPERITIES, SUMMITS, interaction_error
from roughmdr.numerics.arguments import Floats

TRUSTED_FRACTION = 0.02
"""Contact fraction up to which a force is told to be right within an error: by interaction 22 %, typically 12 %."""

_SLACK = 1.01  # a path that ends at this contact fraction is trusted all along
_FORCE_PER_RADIUS = 0.5  # exponent: Hertz's force grows as the square root of the radius

PARTS = {
    "interaction_error": "asperities that do not feel each other",
    "slope_error": "slopes that are not small",
    "profile_end_error": "contacts beyond the end of their profile",
    "adhesion_range_error": "JKR, where adhesion reaches further than it supposes",
    "resolution_error": "radii of summits that the map does not resolve",
}
"""The parts of the model error, by their names in results."""


class Assumptions(NamedTuple):
    """How far the contacts of an ensemble strain the assumptions of the model where the flat is closest."""

    limits: ValidityLimits
    jkr_error: float = 0.0
    """About the error of JKR's force of all contacts [N]; 0 where it is not used."""
    radius_uncertainty: float = 0.0
    """Relative uncertainty of the radii of a map's summits."""
    of_surface: bool = False
    """Whether the asperities are the summits of a continuous surface."""
    overlap: float = math.nan
    """Share of the contacts that reach into a neighbour's; NaN where it is not known."""


class ModelError(NamedTuple):
    """The estimated relative error of the force that the assumptions of the model cause."""

    curve: Floats
    """At each step; NaN where the nominal area is not known."""
    parts: dict[str, float]
    """The largest of each of ``PARTS`` over the steps."""
    largest_fraction: float
    """The largest contact fraction; NaN where the nominal area is not known."""
    trusted_separation: float
    """The least separation down to which the contact fraction is at most ``TRUSTED_FRACTION``; NaN where it always is,
    or is not known.
    """
    overlap: float
    """Share of the contacts that reach into a neighbour's; NaN where it is not known."""

    @property
    def named(self) -> dict[str, float]:
        """The largest error over the steps and all that describes it, by their names in results."""
        return {
            "model_error": float(self.curve.max(initial=0.0)),
            **self.parts,
            "overlap_fraction": self.overlap,
            "largest_contact_fraction": self.largest_fraction,
            "trusted_separation": self.trusted_separation,
        }

    @classmethod
    def of(
        cls, assumptions: Assumptions, separation: Floats, force: Floats, contact_fraction: Floats | None
    ) -> "ModelError":
        """Return the error along a path: separation [m], force [N] and contact fraction at each step.

        The parts add up, each and all to at most 1, the whole force; that of JKR is over the largest force. Where the
        force is 0 there is no error.
        """
        limits, largest = assumptions.limits, float(np.abs(force).max(initial=0.0))
        constant = {
            "slope_error": limits.slope_error,
            "profile_end_error": limits.end_error,
            "adhesion_range_error": min(assumptions.jkr_error / largest, 1.0) if largest > 0.0 else 0.0,
            "resolution_error": min(_FORCE_PER_RADIUS * assumptions.radius_uncertainty, 1.0),
        }
        if contact_fraction is None:
            curve = np.where(force != 0.0, math.nan, 0.0)
            return cls(curve, {"interaction_error": math.nan, **constant}, math.nan, math.nan, math.nan)
        interaction = interaction_error(contact_fraction, SUMMITS if assumptions.of_surface else ASPERITIES)
        curve = np.where(force != 0.0, np.minimum(interaction + sum(constant.values()), 1.0), 0.0)
        beyond = separation[contact_fraction > _SLACK * TRUSTED_FRACTION]
        return cls(
            curve,
            {"interaction_error": float(interaction.max(initial=0.0)), **constant},
            float(contact_fraction.max(initial=0.0)),
            float(beyond.max()) if beyond.size else math.nan,
            assumptions.overlap,
        )
