"""Asperities under a curved body that feel each other in pairs: limits, other units, a loop, and boundary elements."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import roughmdr as rm
from roughmdr.aggregate.coupled import CoupledTotals, sum_coupled
from roughmdr.aggregate.totals import AREA, COUNT, FORCE, NOMINAL
from roughmdr.batch.realization import problem_of
from roughmdr.elements.path import solve_on_grid
from roughmdr.elements.surface import surface_of_asperities
from roughmdr.ensemble import Ensemble
from roughmdr.interaction.totals import CROWDING, spread_area
from roughmdr.model_error.coupling import coupling_error
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read

MODULUS, RADIUS = 4e6, 1e-2  # [Pa], [m], of the body
SIDE = 1e-3  # [m], of the patch
HALF_SPACE = {"model": "pairwise", "boundary": "free"}


def table(asperities: dict[str, Any], separation: Any, **changes: Any) -> dict[str, Any]:
    """Return a scene of a ball on asperities that feel each other; None leaves a section out."""
    source = {"source": "random", "shape": "paraboloid", "patch": SIDE} | asperities
    sections = {
        "title": "ball",
        "material": {"effective_modulus": MODULUS},
        "interaction": HALF_SPACE,
        "asperities": source,
        "nominal": {"radius": RADIUS},
        "path": {"separation": separation},
        "output": {"variables": ["force", "contact_area", "contact_count", "stiffness"]},
    } | changes
    return {key: section for key, section in sections.items() if section is not None}


def under_body(scene: Scene, seed: int = 0) -> Ensemble:
    """Return a realisation as the body presses it."""
    return scene.pressed(scene.asperities.ensemble(seed, 0, with_positions=True))


def pressed(scene: Scene, ensemble: Ensemble, separation: Floats) -> CoupledTotals:
    """Return the totals of contacts at separations [m]."""
    return sum_coupled(problem_of(scene, ensemble), separation, [CROWDING])


def test_heights_are_lower_by_the_profile_over_the_middle_of_the_patch() -> None:
    scene = read(table({"count": 50, "radius": "30 um", "height": {"distribution": "normal", "std": "1 um"}}, [0.0]))
    drawn = scene.asperities.ensemble(0, 0, with_positions=True)
    found = scene.pressed(drawn)
    away = np.hypot(drawn.positions["x"] - 0.5 * SIDE, drawn.positions["y"] - 0.5 * SIDE)
    np.testing.assert_allclose(found.height, np.sort(drawn.height - away**2 / (2.0 * RADIUS))[::-1], rtol=1e-12)
    assert scene.pressed(found) is found
    flat = read(table({"count": 50, "radius": "30 um", "height": "0 um"}, [0.0], nominal=None))
    assert flat.pressed(drawn) is drawn


def test_a_body_with_an_end_presses_those_under_it() -> None:
    scene = read(
        table({"count": 400, "radius": "30 um", "height": "0 um", "placement": "square"}, [0.0],
              nominal={"shape": "flat_punch", "radius": "0.2 mm"})
    )  # fmt: skip
    found = under_body(scene)
    assert found.height.size == pytest.approx(400 * math.pi * 0.2**2, rel=0.05)
    assert found.nominal_area == pytest.approx(found.height.size / 400 * SIDE**2)
    assert (found.height == 0.0).all()
    small = scene.model_copy(update={"nominal": scene.nominal.model_copy(update={"radius": 1e-6})})
    with pytest.raises(rm.OutOfRange, match="no asperity is under the flat_punch, which ends at a radius of 1e-06 m"):
        under_body(small)


@pytest.mark.parametrize(("side", "within"), [(14, 0.01), (28, 0.003)])
def test_dense_equal_asperities_press_as_the_smooth_ball(side: int, within: float) -> None:
    depth = (0.35 * SIDE) ** 2 / RADIUS
    lattice = {"count": side**2, "placement": "square", "radius": 0.1 * RADIUS * 14 / side, "height": 0.0}
    ball = rm.run(table(lattice, [0.0, -0.5 * depth, -depth])).isel(step=-1)
    assert float(ball.force.item()) == pytest.approx(4 / 3 * MODULUS * math.sqrt(RADIUS) * depth**1.5, rel=within)
    assert float(ball.stiffness.item()) == pytest.approx(2.0 * MODULUS * math.sqrt(RADIUS * depth), rel=0.013)
    assert float(ball.nominal_contact_radius.item()) == pytest.approx(0.35 * SIDE, rel=0.02)


def test_where_asperities_hardly_feel_each_other_the_mean_is_the_expected_law() -> None:
    rough = {"count": 400, "radius": "1 nm", "height": {"distribution": "normal", "std": "3 um"}}
    path = ["8 um", "4 um", "0 um"]
    asked = {"output": {"variables": ["force", "contact_area", "contact_count"]}}
    drawn = rm.run(table(rough, path, batch={"realizations": 60}, **asked))
    law = rm.run(table(rough, path, batch={"estimator": "expected"}, interaction=None, **asked)).isel(realization=0)
    for name in ("force", "contact_area", "contact_count"):
        error = drawn[name].std("realization", ddof=1) / math.sqrt(60)
        assert (np.abs(drawn[name].mean("realization") - law[name]) < 3.0 * error).all(), name
    mean = float(drawn.nominal_contact_radius.isel(step=-1).mean())  # of another moment of the pressure
    assert mean == pytest.approx(float(law.nominal_contact_radius[-1]), rel=0.15)


def test_lengths_in_any_unit_give_one_law() -> None:
    def forces(unit: str, size: float) -> Floats:
        def length(metres: float) -> str:
            return f"{metres / size:.17g} {unit}"

        rough = {"distribution": "normal", "std": length(3e-6)}
        section = {"count": 200, "radius": length(1e-4), "patch": length(SIDE), "height": rough}
        path = [length(each) for each in (4e-6, 0.0, -4e-6)]
        return np.asarray(rm.run(table(section, path, nominal={"radius": length(RADIUS)})).force[0])

    metres = forces("m", 1.0)
    np.testing.assert_allclose(forces("nm", 1e-9), metres, rtol=1e-9)
    np.testing.assert_allclose(1e6 * forces("m", 1e3), metres, rtol=1e-6)  # as "m", lengths a thousand times smaller


def test_an_adhesive_cycle_loses_energy() -> None:
    section = {
        "count": 60, "radius": "100 um", "height": {"distribution": "normal", "std": "2 um"},
        "placement": "hard_core", "min_distance": "90 um",
    }  # fmt: skip
    path = {"start": "clear", "stop": "0 um", "steps": 200}
    made = rm.run(
        table(section, path, adhesion={"model": "jkr", "work": "20 mJ/m^2"},
              path={"separation": path, "unload": True},
              output={"variables": ["force", "energy", "dissipated_energy", "contact_count"]})
    ).isel(realization=0)  # fmt: skip
    lost = made.dissipated_energy.values
    assert lost[-1] > 0.0
    assert (np.diff(lost) >= 0.0).all()
    loop = -float(np.trapezoid(made.force.values, made.separation.values))
    assert loop == pytest.approx(lost[-1], rel=0.05)
    assert made.contact_count.values[-1] == 0.0
    assert made.pull_off_force.item() < 0.0


def test_evenly_spread_contacts_have_the_area_of_their_disc() -> None:
    at = np.random.default_rng(1).uniform(-1.0, 1.0, (20_000, 2))
    at = at[np.hypot(*at.T) < 1.0]
    away = np.hypot(*at.T)
    assert spread_area(at, np.ones(len(at))) == pytest.approx(math.pi, rel=0.02)
    hertz = np.sqrt(1.0 - away**2)
    mean = float(np.average(hertz, weights=hertz)) / math.pi  # of the local fraction, whose integral is 2/3
    assert (2.0 / 3.0) / spread_area(at, hertz) == pytest.approx(10.0 / 9.0 * mean, rel=0.02)
    assert spread_area(at[:0], away[:0]) == 0.0


def test_one_contact_under_the_apex_feels_no_other() -> None:
    scene = read(table({"count": 49, "radius": "100 um", "height": "0 um", "placement": "square"}, [0.0]))
    ensemble = under_body(scene)
    found = pressed(scene, ensemble, ensemble.height[:1] - 1e-8)
    assert found.total[COUNT].item() == 1.0
    assert found.error.item() < 1e-12
    two = pressed(scene, replace(ensemble, axis=(0.0, 0.0)), ensemble.height[:1] - 1e-8)
    assert two.total[FORCE].item() == found.total[FORCE].item()
    assert two.total[NOMINAL].item() == pytest.approx(16.0 / (3.0 * math.pi) * SIDE / math.sqrt(2.0))


UNIT = 1e9
"""E* [Pa] of cases on asperities of radius 1 m; heights go with the fall of an asperity over its spacing."""
CASES = [  # placement, spread of the heights, radius of the body [m], asperities, local contact fractions
    ("random", 2.0, 60.0, 1600, (0.02, 0.10)),
    ("hard_core", 5.0, 40.0, 1600, (0.02, 0.05, 0.14)),
    ("hard_core", 1.0, 150.0, 1600, (0.03,)),
    ("hard_core", 0.5, 150.0, 3600, (0.02, 0.08, 0.14)),
    ("square", 0.0, 100.0, 784, (0.05, 0.10, 0.15)),
]


def flat_asperities(placement: str, spread: float, radius: float, count: int) -> Scene:
    fall = 0.5 * SIDE**2 / count
    scatter = {"distribution": "normal", "std": spread * fall} if spread else 0.0
    apart = {"min_distance": 0.5 * SIDE / math.sqrt(count)} if placement == "hard_core" else {}
    section = {"count": count, "radius": 1.0, "height": scatter, "placement": placement, **apart}
    return read(table(section, [0.0], nominal={"radius": radius}, material={"effective_modulus": UNIT}))


_OF_LIMIT = 3e-4
"""Relative error of that limit, of few contacts on these grids."""


def force_of_elements(ensemble: Ensemble, separation: Floats) -> tuple[float, float]:
    """Return the force [N] in the limit of fine grids, and its error: of asperities that the undeformed body meets."""
    above = ensemble.taken(np.flatnonzero(ensemble.height > separation.min()))
    surface = surface_of_asperities(above, float(separation.min()), periodic=False)
    fine, coarse = (
        solve_on_grid(surface, separation, UNIT, (each, each), stiffness=False).steps[0].force for each in (256, 128)
    )
    return fine + (fine - coarse) / 3.0, abs(fine - coarse) / 3.0 + _OF_LIMIT * fine


@pytest.mark.large
@pytest.mark.parametrize(("placement", "spread", "radius", "count", "fractions"), CASES)
def test_the_stated_error_bounds_that_against_boundary_elements(
    placement: str, spread: float, radius: float, count: int, fractions: tuple[float, ...]
) -> None:
    scene = flat_asperities(placement, spread, radius, count)
    ensemble = under_body(scene, seed=7)
    top, fall = float(ensemble.height[0]), 0.5 * SIDE**2 / count
    along = np.linspace(top, top - max(2.0 * spread, 2.0) * fall - (0.25 * SIDE) ** 2 / radius, 80)
    local = np.nan_to_num(pressed(scene, ensemble, along).fraction)
    for fraction in fractions:
        step = int(np.argmax(local >= fraction))
        assert step > 0
        found = pressed(scene, ensemble, along[step : step + 1])
        force, of_grid = force_of_elements(ensemble, along[step : step + 1])
        off = abs(found.total[FORCE].item() - force)
        assert off < found.error.item() * force + of_grid, fraction
        assert found.total[AREA].item() / SIDE**2 < 0.5 * found.fraction.item()


def test_the_stated_error_does_not_depend_on_how_much_of_the_patch_is_empty() -> None:
    found = []
    for side in (1, 2):
        scene = flat_asperities("square", 0.0, 100.0, 784)
        lattice = scene.asperities.model_copy(update={"count": 784 * side**2, "patch": side * SIDE})
        ensemble = scene.pressed(lattice.ensemble(0, 0, with_positions=True))
        found.append(pressed(scene, ensemble, np.array([-4e-10])))
    small, large = found
    assert large.total[FORCE].item() == pytest.approx(small.total[FORCE].item(), rel=1e-6)
    assert large.fraction.item() == pytest.approx(small.fraction.item(), rel=1e-6)
    assert large.error.item() == pytest.approx(small.error.item(), rel=1e-6)
    by_patch = float(coupling_error(large.total[AREA] / (2.0 * SIDE) ** 2, np.zeros(1)).item())
    assert by_patch < 1e-3 * large.error.item()
