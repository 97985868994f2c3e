"""The error that the assumptions of the model cause in the force, as far as it can be estimated beside the result.

``interaction.py`` has the error of independent asperities, ``coupling.py`` that of coupled ones, ``parts.py`` all parts
together, ``at_force.py`` and ``at_given.py`` the errors of other quantities, and ``refusal.py`` the contact fraction
beyond which there is no answer, with the likely cause.
"""
