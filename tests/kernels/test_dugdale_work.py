"""How often the integrals over a cohesive zone are evaluated: for an asperity once, and for a contact and step."""

import pytest
from benchmarks.evaluations import CONTACTS, EXAMPLES, evaluations
from benchmarks.process import in_new_process

from roughmdr.shapes import SHAPES
from roughmdr.shapes.power_profiles import profile_of


@pytest.mark.parametrize("strength", [2e4, 2e5, 2e6], ids=["soft", "middling", "strong"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_few_integrals_are_evaluated(name: str, strength: float) -> None:
    once, each, searches = in_new_process(evaluations, name, strength, NUMBA_DISABLE_JIT="1")
    assert 0 < once <= 600
    assert 0 < each <= 7 * CONTACTS
    assert searches <= CONTACTS // 12


def test_every_shape_with_closed_forms_is_counted() -> None:
    closed = {name for name, shape in SHAPES.items() if name not in ("flat_punch", "paraboloid")}
    assert {name for name in closed if profile_of(SHAPES[name]).zone_integrals is not None} == set(EXAMPLES)
