"""The error that the assumptions of the model cause in the force, as far as it can be estimated beside the result.

``interaction.py`` has the error of independent asperities, ``coupling.py`` that of coupled ones, ``parts.py`` all parts
together, ``at_force.py`` and ``at_given.py`` the errors of other quantities, and ``refusal.py`` the contact fraction
beyond which there is no answer, with the likely cause.
"""

from roughmdr.model_error.parts import PARTS, Assumptions, ModelError
from roughmdr.model_error.refusal import Givens, check_contact_fraction, crowd_warnings, fraction_warnings

__all__ = [
    "PARTS",
    "Assumptions",
    "Givens",
    "ModelError",
    "check_contact_fraction",
    "crowd_warnings",
    "fraction_warnings",
]
