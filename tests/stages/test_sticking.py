"""The tangential stiffness of contacts that stick and feel each other, against the coupled discs themselves."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from oracles.pairwise import periodic_green
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.model_error.conductance import sticking_error

ASKED = {"variables": ["tangential_stiffness", "conductance_radius", "contact_radius_sum"]}
PLACED = {**ASPERITIES, "count": 40, "placement": "hard_core", "min_distance": "60 um"}
PATH = {"separation": ["2 um", "0.5 um"]}


def stiffness(x: Any, y: Any, radius: Any, poisson: float) -> tuple[float, float]:
    """Return the normal and the tangential stiffness of discs far apart on one rigid plate, E* = 1.

    From the displacements by point forces, along x and y and across: nothing is averaged over directions.
    """
    ratio = 2.0 * (1.0 - poisson) / (2.0 - poisson)  # G*/E*
    dx, dy = x[:, None] - x, y[:, None] - y
    apart, angle = np.hypot(dx, dy) + np.eye(x.size), np.arctan2(dy, dx)
    own, others = np.diag(0.5 / radius), (1.0 - np.eye(x.size)) / (math.pi * apart)
    turn = poisson / (2.0 - poisson)
    along, across = (1.0 + turn * np.cos(2.0 * angle)) * others, turn * np.sin(2.0 * angle) * others
    beside = (1.0 - turn * np.cos(2.0 * angle)) * others
    both = np.block([[own + along, across], [across, own + beside]]) / ratio
    moved = np.repeat([1.0, 0.0], x.size)
    return np.linalg.solve(own + others, np.ones(x.size)).sum(), np.linalg.solve(both, moved)[: x.size].sum()


@settings(max_examples=60, deadline=None)
@given(
    count=st.integers(2, 40), poisson=st.floats(-0.9, 0.5), oblong=st.floats(0.0, 1.0), seed=st.integers(0, 2**32 - 1)
)
def test_what_the_average_over_directions_leaves_out_is_bounded(
    count: int, poisson: float, oblong: float, seed: int
) -> None:
    random = np.random.default_rng(seed)
    site = random.permutation(count)
    x, y = 10.0 * (site + random.uniform(-0.2, 0.2, count)), 10.0 * oblong * random.uniform(0.0, count, count)
    radius = random.uniform(0.2, 1.0, count)
    normal, true = stiffness(x, y, radius, poisson)
    ratio = 2.0 * (1.0 - poisson) / (2.0 - poisson)
    lowered = 1.0 - normal / (2.0 * radius.sum())
    assert abs(ratio * normal / true - 1.0) <= abs(1.0 - ratio) * lowered + 1e-13


def test_in_a_patch_that_repeats_directions_cancel_but_for_chance() -> None:
    """Where the counter pressure hides what neighbours change."""
    count, fraction, turn, worst = 16, 0.02, 0.3, 0.0
    for seed in range(8):
        placed = rm.generate({**PLACED, "count": count, "patch": 1.0, "min_distance": 0.6 / 4.0}, seed=seed)
        x, y = placed.x.to_numpy(), placed.y.to_numpy()
        own = periodic_green(x, y, 1.0, 1.0) + np.eye(count) * 0.5 / math.sqrt(fraction / math.pi / count)
        dx, dy = x[:, None] - x, y[:, None] - y
        along, across = np.zeros((2, count, count))
        for i, j in np.ndindex(9, 9):
            by = dx - np.round(dx) + i - 4 + 1j * (dy - np.round(dy) + j - 4)
            pull = np.where(by == 0.0, 0.0, by**2 / np.where(by == 0.0, 1.0, abs(by)) ** 3) / math.pi
            along, across = along + turn * pull.real, across + turn * pull.imag
        both = np.block([[own + along, across], [across, own - along]])
        true = np.linalg.solve(both, np.repeat([1.0, 0.0], count))[:count].sum()
        worst = max(worst, abs(np.linalg.solve(own, np.ones(count)).sum() / true - 1.0))
    stated = sticking_error(0.0, 1.0 - turn, np.zeros(1), np.array([fraction / count]))
    assert 0.2 * stated < worst < stated


@pytest.mark.parametrize("poisson", [0.5, 0.0, -0.5])
def test_the_bound_is_reached_by_two_in_line(poisson: float) -> None:
    for x, y in (([0.0, 9.0], [0.0, 0.0]), ([0.0, 0.0], [0.0, 9.0])):
        normal, true = stiffness(np.array(x), np.array(y), np.array([1.0, 1.0]), poisson)
        ratio = 2.0 * (1.0 - poisson) / (2.0 - poisson)
        lowered = 1.0 - normal / 4.0
        assert abs(ratio * normal / true - 1.0) == pytest.approx(abs(1.0 - ratio) * lowered, rel=1e-9, abs=1e-14)


@pytest.mark.large
@pytest.mark.parametrize(
    "changes",
    [
        {"interaction": {"model": "pairwise"}, "adhesion": None},
        {"interaction": {"model": "pairwise"}},
        {"interaction": {"model": "mean_field", "boundary": "free"}, "adhesion": None},
        {"adhesion": None},
    ],
    ids=["pairs", "adhesive pairs", "mean field", "alone"],
)
def test_a_scene_has_it_with_its_error(changes: dict[str, Any]) -> None:
    made = scene(asperities=PLACED, path=PATH, output=ASKED, tangential={}, batch={"realizations": 2}, **changes)
    found = rm.run(made)
    ratio, modulus = 2.0 * 0.51 / 1.51, rm.effective_modulus(3e6, 0.49)
    np.testing.assert_allclose(found.tangential_stiffness, 2.0 * ratio * modulus * found.conductance_radius, rtol=1e-14)
    coupled = np.abs(1.0 - found.conductance_radius / found.contact_radius_sum).max("step")
    assert ((coupled > 1e-4) == ("interaction" in changes)).all()
    least = found.conductance_error + (1.0 - ratio) * coupled
    assert (found.tangential_error >= np.minimum(least, 1.0) * (1.0 - 1e-12)).all()
    assert (found.tangential_error <= least + (1.0 - ratio) * 2.2 * 0.1).all()
    without = rm.run({**made, "output": {"variables": ["force"]}})
    assert "tangential_error" not in without


def test_where_directions_are_not_at_random_many_contacts_cancel_nothing(tmp_path: Path) -> None:
    """Asperities of a file may stand in line: their error is not less by the root of their number."""
    rm.generate(PLACED, seed=0).to_netcdf(tmp_path / "mine.nc")
    names, extra = ["tangential_stiffness", "conductance_radius", "contact_fraction", "contact_count"], []
    for asperities in (PLACED, {"source": "file", "file": str(tmp_path / "mine.nc")}):
        made = scene(asperities=asperities, path=PATH, output={"variables": names}, tangential={}, adhesion=None)
        found = rm.run({**made, "seed": 0, "batch": {"realizations": 1}})
        share = found.contact_fraction / (found.contact_count if asperities is PLACED else 1.0)
        extra.append(float(((found.tangential_error - found.conductance_error) / np.sqrt(share.max("step"))).squeeze()))
    assert extra[1] == pytest.approx(extra[0], rel=1e-9)
