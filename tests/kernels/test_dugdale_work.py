"""How contacts of finite range are found: by how many evaluations of the integrals, and to the state of a search."""

import math

import numba
import numpy as np
import pytest
from twins.evaluations import CONTACTS, EXAMPLES, MODULUS, WORK, evaluations

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.layout import COUNT
from roughmdr.shapes import SHAPES
from roughmdr.shapes.power_profiles import profile_of

counted = pytest.mark.skipif(not numba.config.DISABLE_JIT, reason="calls are counted where nothing is compiled")


@counted
@pytest.mark.parametrize("strength", [2e4, 2e5, 2e6], ids=["soft", "middling", "strong"])
@pytest.mark.parametrize("name", EXAMPLES)
def test_few_integrals_are_evaluated(name: str, strength: float) -> None:
    once, each, searches = evaluations(name, strength)
    assert 0 < once <= 600
    assert 0 < each <= 7 * CONTACTS
    assert searches <= CONTACTS // 12


@counted
def test_asperities_that_are_alike_are_prepared_once() -> None:
    one, many = (evaluations("cone", 2e5, alike) for alike in (1, 5))
    assert many == one


def test_every_shape_with_closed_forms_is_counted() -> None:
    closed = {name for name, shape in SHAPES.items() if name not in ("flat_punch", "paraboloid")}
    assert {name for name in closed if profile_of(SHAPES[name]).zone_integrals is not None} == set(EXAMPLES)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="a contact so deep overflows to inf where it is compiled")
@pytest.mark.parametrize("strength", [2e4, 2e6], ids=["soft", "strong"])
@pytest.mark.parametrize("name", ["cone", "power_law", "capped_paraboloid", "sphere"])
def test_both_edges_together_are_those_of_the_search(name: str, strength: float) -> None:
    """Also beyond the table of guesses, and in rows of asperities that differ or not."""
    shape = SHAPES[name](**EXAMPLES[name])
    width, rise, params = (np.full(3, each) for each in shape.nondimensional())
    width[2] *= 1.3
    kernels = choose(name, Adhesion(WORK, "dugdale", strength), params)
    material = kernels.material(MODULUS, Adhesion(WORK, "dugdale", strength))
    rows = kernels.prepare(material, Columns(width, rise, params), 0, 3, 0.0, math.inf)
    np.testing.assert_array_equal(rows[1], rows[0])
    np.testing.assert_array_equal(
        rows[2], kernels.prepare(material, Columns(width, rise, params), 2, 3, 0.0, math.inf)[0]
    )
    search = vars(kernels)["state_by_search"]
    for row in rows[1:]:
        for x in [*np.geomspace(1e-2, 1e3, 25), *np.geomspace(2e4, 1e6, 4)]:
            state, *found = kernels.contact_at(x, row[COUNT], row)
            sought = search(x, row[COUNT], row)
            assert state == pytest.approx(sought, rel=1e-9)
            a, push, k = kernels.radius_force_stiffness(sought, row)
            scale = abs(push) + sum(kernels.adhesion_terms(a, row)[1:])
            assert abs(found[0] - a) <= 1e-9 * max(a, kernels.cohesive_radius(sought, row))
            assert abs(found[1] - push) <= 1e-11 * scale
            assert found[2] == pytest.approx(k, rel=1e-6)
