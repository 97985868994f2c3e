"""The contact of each asperity at one step: all of them together have the force of the law."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.aggregate.each_contact import EachContact, contacts_at
from roughmdr.aggregate.problem import Problem
from roughmdr.ensemble import Ensemble
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read

JKR = {"model": "jkr", "work": "50 mJ/m^2"}
DUGDALE = {"model": "dugdale", "work": "50 mJ/m^2", "strength": "0.5 MPa"}
NESTED = np.array([3.0, 1.0, 0.2, 0.5, 0.9, 0.7, 1.6, 2.2]) * 1e-6
CONES = {"shape": "truncated_cone", "radius": None, "slope": 0.15, "flat_radius": "2 um"}
PROFILE = {"shape": "power_series", "radius": None, "terms": {"2.0": 1e4, "4.0": 1e12}}


def planned(adhesion: Any = None, interaction: Any = None, **asperities: Any) -> tuple[Scene, Ensemble]:
    table = scene(adhesion=adhesion, interaction=interaction, path={"separation": ["1 um"]}, batch=None)
    changed = table["asperities"] | {"count": 60, "patch": "0.6 mm"} | asperities
    table["asperities"] = {key: value for key, value in changed.items() if value is not None}
    if adhesion is None:
        table.pop("adhesion", None)
    one = read(table)
    return one, one.asperities.ensemble(one.seed, 0, with_positions=True)


def law_and_contacts(
    one: Scene, ensemble: Ensemble, separation: Floats, step: int
) -> tuple[LoadSeparation, EachContact]:
    problem = Problem(ensemble, one.effective_modulus, one.adhesion_model, one.interaction)
    path = LoadingPath.along(separation, unload=False, adhesive=one.work > 0.0)
    law = simulate(problem, path, ["force", "contact_radius_sum", "contact_count"])
    return law, contacts_at(problem, separation, step)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("adhesion", "interaction", "asperities"),
    [
        (None, None, {}),
        (JKR, None, {}),
        (JKR, None, CONES),
        (JKR, None, PROFILE),
        (DUGDALE, None, {}),
        (JKR | {"model": "auto", "range": "1 nm"}, None, {}),
        (None, {"model": "mean_field", "boundary": "free"}, {}),
        (None, {"model": "pairwise"}, {}),
        (JKR, {"model": "pairwise"}, {}),
        (JKR, {"model": "pairwise"}, {"placement": "hard_core", "min_distance": "30 um"}),
    ],
)
@pytest.mark.parametrize("step", [*map(large, [1, 2, 6]), 4])
def test_forces_and_radii_add_up_to_the_law(adhesion: Any, interaction: Any, asperities: Any, step: int) -> None:
    one, ensemble = planned(adhesion, interaction, **asperities)
    whole, contacts = law_and_contacts(one, ensemble, NESTED, step)
    law = whole.variables
    force, radius = law["force"][step], law["contact_radius_sum"][step]
    assert math.fsum(contacts.force) == pytest.approx(force, rel=1e-12, abs=1e-13 * np.abs(contacts.force).sum())
    assert math.fsum(contacts.radius) == pytest.approx(radius, rel=1e-12)
    assert np.count_nonzero(contacts.radius) == law["contact_count"][step]
    assert np.array_equal(contacts.active, contacts.radius > 0.0) or contacts.adhesion.cohesive
    if step == NESTED.argmin():
        size = np.abs(contacts.force)
        effective = math.fsum(size) ** 2 / math.fsum(size * size)
        assert whole.effective_contacts == pytest.approx(effective, rel=1e-12)


def test_contacts_remember_how_near_the_flat_was() -> None:
    one, ensemble = planned(JKR)
    separation = np.array([3e-6, 1e-6, 0.2e-6, 1e-6])
    before, after = (law_and_contacts(one, ensemble, separation, step)[1] for step in (1, 3))
    assert np.count_nonzero(after.radius) > np.count_nonzero(before.radius)
    assert after.force.min() < 0.0


def test_a_lone_contact_is_that_of_indent() -> None:
    one, ensemble = planned(JKR)
    contacts = law_and_contacts(one, ensemble, NESTED, 2)[1]
    tip = rm.Paraboloid(radius=float(ensemble.parameters["radius"][0]))
    alone = rm.indent(
        tip, effective_modulus=one.effective_modulus, work=0.05, indentation=float(ensemble.height[0] - NESTED[2])
    )
    assert contacts.force[0] == pytest.approx(float(alone.force), rel=1e-12)
    assert contacts.radius[0] == pytest.approx(float(alone.contact_radius), rel=1e-12)
