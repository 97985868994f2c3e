"""Tests and cases that are long forms, which ``make test-all`` runs."""

import pytest
from _pytest.mark import ParameterSet

COMPILED = {"paraboloid", "sphere"}
"""Shapes whose tests are no long forms where functions are compiled: kernels in closed form, and those of a profile.
Tests of the others run uncompiled instead. Of adhesion of finite range and of pairs, paraboloids alone are compiled."""


def large(*values: object) -> ParameterSet:
    """Return the values of one case, marked as a long form."""
    return pytest.param(*values, marks=pytest.mark.large)


large_where_compiled = pytest.mark.uncompiled
"""Marks a test that runs at once where nothing is compiled, and is a long form where functions are."""
