"""Cases of a test that are long forms, which ``make test-all`` runs."""

import pytest
from _pytest.mark import ParameterSet


def large(*values: object) -> ParameterSet:
    """Return the values of one case, marked as a long form."""
    return pytest.param(*values, marks=pytest.mark.large)
