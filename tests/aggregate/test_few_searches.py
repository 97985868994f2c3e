"""How the sum finds its contacts: few are searched for, the others take as few evaluations as their shape needs.

Where guesses are lost, or nodes filled that no contact needs, all results stay right: only counts tell.
"""

import math

import numba
import pytest
from twins.evaluations import EXAMPLES, OTHERS, WORK, in_the_sum

from roughmdr.shapes import SHAPES

pytestmark = pytest.mark.skipif(not numba.config.DISABLE_JIT, reason="calls are counted where nothing is compiled")
BY_PROFILE = [name for name in [*EXAMPLES, *OTHERS] if SHAPES[name].uses_profile]
"""Shapes of which the state has no closed form without adhesion or with JKR."""
SIMILAR = [name for name in BY_PROFILE if SHAPES[name].similar]


@pytest.mark.parametrize("name", SIMILAR)
def test_without_adhesion_one_evaluation_finds_a_contact(name: str) -> None:
    searches, evaluations, _ = in_the_sum(name, 0.0, math.inf)
    assert searches <= 0.02
    assert 1.0 <= evaluations <= 1.1


@pytest.mark.parametrize("name", [name for name in BY_PROFILE if name not in SIMILAR])
def test_without_adhesion_three_do_where_rows_differ_or_profiles_are_pieced(name: str) -> None:
    searches, evaluations, _ = in_the_sum(name, 0.0, math.inf)
    assert searches <= 0.1, "next to a kink"
    assert 2.0 <= evaluations <= 3.45, "the contacts that steps do not find are evaluated once more"


@pytest.mark.few(4)
@pytest.mark.parametrize("name", BY_PROFILE)
def test_three_find_a_contact_with_jkr(name: str) -> None:
    searches, evaluations, once = in_the_sum(name, WORK, math.inf)
    assert searches <= 0.02
    assert 1.9 <= evaluations <= 3.15
    assert 0.0 < once <= (60.0 if SHAPES[name].shared else 30.0), "nodes that contacts need, and no more"


@pytest.mark.few(5)
@pytest.mark.parametrize("name", [*EXAMPLES, *OTHERS])
def test_few_more_find_one_and_its_zone(name: str) -> None:
    searches, evaluations, once = in_the_sum(name, WORK, 2e5)
    assert searches <= 0.02
    assert 2.0 <= evaluations <= 5.0
    assert 0.0 < once <= 400.0
