"""The error that the assumptions of the model cause in the force, as far as it can be estimated beside the result.

``interaction.py`` has that of asperities that do not feel each other, ``coupling.py`` that of those that do,
``parts.py`` all parts together, and ``refusal.py`` says beyond which contact fraction there is no answer, and what the
likely cause is.
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
