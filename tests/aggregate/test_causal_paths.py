"""A step depends on the path up to it only: parts of random paths have the bits that the whole paths have there."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr

import roughmdr as rm

SIDE, MODULUS, WORK = 2e-5, 4e6, 0.02
COUPLINGS: dict[str, dict[str, Any] | None] = {
    "independent": None,
    "mean field, free": {"model": "mean_field", "boundary": "free"},
    "mean field, periodic": {"model": "mean_field"},
    **{
        f"pairs, {boundary}, order {order}": {"model": "pairwise", "boundary": boundary, "order": order}
        for boundary in ("free", "periodic")
        for order in (1, 2)
    },
}
CONTROLS = "separation", "force", "pressure", "remote"


def placed(rng: np.random.Generator, count: int, side: float, shape: str = "paraboloid") -> xr.Dataset:
    """Asperities at random on a patch of this side [m]."""
    section: dict[str, Any] = {
        "source": "random",
        "shape": shape,
        "count": count,
        "patch": side,
        "height": {"distribution": "normal", "std": 3e-7},
        "radius": {"distribution": "lognormal", "mean": "5 um", "std": "1 um"},
    }
    made = rm.generate(section, seed=int(rng.integers(1 << 30)))
    x, y = rng.uniform(0.0, side, (2, count))
    return made.assign(x=("asperity", x), y=("asperity", y))


def walk(rng: np.random.Generator, control: str, *, adhesive: bool) -> np.ndarray:
    """Values of a control that go up and down at random, or one way."""
    size = int(rng.integers(5, 9))
    low, high = {"separation": (-3e-7, 6e-7), "remote": (-6e-7, 6e-7)}.get(control, (-1e-6 if adhesive else 0.0, 2e-5))
    values = rng.uniform(low, high, size) / (SIDE**2 if control == "pressure" else 1.0)
    return np.sort(values)[::-1].copy() if rng.random() < 0.3 else values


def check_parts(made: xr.Dataset, control: str, values: np.ndarray, rng: np.random.Generator, **given: Any) -> None:
    given |= {"machine_stiffness": 50.0} if control == "remote" else {}
    names = {"force", "contact_area", "contact_count", "stiffness", "contact_radius_sum"} - {control}
    names |= {"energy", "dissipated_energy"} if given.get("work") else set()
    given |= {"effective_modulus": MODULUS, "variables": sorted(names)}
    whole = rm.load_separation(made, **{control: values}, **given)
    end = int(rng.integers(1, values.size))
    part = rm.load_separation(made, **{control: values[:end]}, **given)
    for name in part.data_vars:
        if part[name].dims == ("step",):
            np.testing.assert_array_equal(whole[name].values[:end], part[name].values, err_msg=str(name))


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("coupling", COUPLINGS)
def test_without_adhesion(coupling: str, control: str) -> None:
    rng = np.random.default_rng([1, CONTROLS.index(control)])
    check_parts(
        placed(rng, 10, SIDE), control, walk(rng, control, adhesive=False), rng, interaction=COUPLINGS[coupling]
    )


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("adhesion", ["jkr", "dugdale"])
def test_independent_with_adhesion(adhesion: str, control: str) -> None:
    rng = np.random.default_rng([2, CONTROLS.index(control)])
    given = {"work": WORK, "adhesion": adhesion} | ({"strength": 2e6} if adhesion == "dugdale" else {})
    check_parts(placed(rng, 10, SIDE), control, walk(rng, control, adhesive=True), rng, **given)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", ["separation", pytest.param("force", marks=pytest.mark.large)])
@pytest.mark.parametrize("order", [1, 2])
def test_adhesive_pairs_that_come_to_overlap(order: int, control: str) -> None:
    rng = np.random.default_rng([3, order])
    interaction = {"model": "pairwise", "boundary": "free", "order": order}
    values = walk(rng, control, adhesive=True)
    check_parts(placed(rng, 4, 6e-6), control, values, rng, work=WORK, interaction=interaction)


def two(distance: float) -> xr.Dataset:
    """Equal paraboloids, R = 1, at a distance in units of a0 = 1."""
    columns = {"height": [0.0, 0.0], "radius": [1.0, 1.0], "x": [0.0, distance], "y": [0.0, 0.0]}
    return xr.Dataset({name: ("asperity", values) for name, values in columns.items()}, attrs={"shape": "paraboloid"})


def force_of_two(separation: list[float]) -> np.ndarray:
    free = {"model": "pairwise", "boundary": "free"}
    found = rm.load_separation(
        two(4.0), separation=separation, effective_modulus=1.0, work=0.5 / math.pi, interaction=free
    )
    return np.asarray(found.force.values)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_two_contacts_that_overlap_later_feel_nothing_of_it_before() -> None:
    alone = force_of_two([-0.8])
    np.testing.assert_allclose(alone, 0.68391, rtol=1e-5)
    for deepest in (-4.0, -6.0):
        np.testing.assert_array_equal(force_of_two([-0.8, deepest])[:1], alone)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_two_contacts_that_overlapped_come_back_to_the_same_forces() -> None:
    """No contact jumps between: the way up is the way down, whatever the steps."""
    down = [-0.8, -2.0, -3.5, -6.0]
    there_and_back = force_of_two([*down, -3.5, -2.0, -0.8])
    np.testing.assert_allclose(there_and_back[4:], there_and_back[2::-1], rtol=1e-12)
    np.testing.assert_allclose(force_of_two([-6.0, -0.8]), there_and_back[[3, 0]], rtol=1e-12)
