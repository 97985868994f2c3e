"""A step depends on the path up to it only: parts of random paths have the bits that the whole paths have there."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.variables import MODEL_ERROR

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
SHAPES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": {"distribution": "lognormal", "mean": "5 um", "std": "1 um"}},
    "cone": {"slope": 0.3},
    "flat_punch": {"radius": {"distribution": "lognormal", "mean": "0.8 um", "std": "0.1 um"}},
    "truncated_cone": {"slope": 0.3, "flat_radius": "0.4 um"},
}
FREE, PERIODIC = ({"model": "pairwise", "boundary": boundary} for boundary in ("free", "periodic"))


def placed(rng: np.random.Generator, count: int, side: float, shape: str = "paraboloid") -> xr.Dataset:
    """Asperities at random on a patch of this side [m]."""
    section: dict[str, Any] = {
        "source": "random",
        "shape": shape,
        "count": count,
        "patch": side,
        "height": {"distribution": "normal", "std": 3e-7},
    } | SHAPES[shape]
    made = rm.generate(section, seed=int(rng.integers(1 << 30)))
    x, y = rng.uniform(0.0, side, (2, count))
    return made.assign(x=("asperity", x), y=("asperity", y))


def walk(rng: np.random.Generator, control: str, *, adhesive: bool) -> np.ndarray:
    """Values of a control that go up and down at random, or one way."""
    size = int(rng.integers(5, 9))
    low, high = {"separation": (-3e-7, 6e-7), "remote": (-6e-7, 6e-7)}.get(control, (-1e-6 if adhesive else 0.0, 2e-5))
    values = rng.uniform(low, high, size) / (SIDE**2 if control == "pressure" else 1.0)
    return np.sort(values)[::-1].copy() if rng.random() < 0.3 else values


def check_parts(
    made: xr.Dataset, control: str, values: np.ndarray, rng: np.random.Generator, **given: Any
) -> xr.Dataset:
    """Return the law along the whole path."""
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
    return whole


@pytest.mark.few(1)
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("coupling", COUPLINGS)
def test_without_adhesion(coupling: str, control: str) -> None:
    rng = np.random.default_rng([1, CONTROLS.index(control)])
    check_parts(
        placed(rng, 10, SIDE), control, walk(rng, control, adhesive=False), rng, interaction=COUPLINGS[coupling]
    )


@pytest.mark.few(2)
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("adhesion", ["jkr", large("dugdale")])
def test_independent_with_adhesion(adhesion: str, control: str) -> None:
    rng = np.random.default_rng([2, CONTROLS.index(control)])
    given = {"work": WORK, "adhesion": adhesion} | ({"strength": 2e6} if adhesion == "dugdale" else {})
    check_parts(placed(rng, 10, SIDE), control, walk(rng, control, adhesive=True), rng, **given)


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("order", [large(1), 2])
@pytest.mark.parametrize("coupling", [FREE, PERIODIC], ids=["free", "periodic"])
def test_adhesive_pairs_that_come_to_overlap(coupling: dict[str, Any], order: int, control: str) -> None:
    rng = np.random.default_rng([3, order, CONTROLS.index(control)])
    deepest = {"separation": -4e-7, "force": 1.2e-5, "pressure": 1.2e-5 / SIDE**2, "remote": -6e-7}[control]
    values = np.append(walk(rng, control, adhesive=True), deepest)
    corners = 3e-6 * np.array([[0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]]) + rng.uniform(0.0, 5e-7, (2, 4))
    height, (x, y) = rng.normal(0.0, 1e-7, 4), (("asperity", each) for each in corners)
    made = placed(rng, 4, SIDE).assign(height=("asperity", height), x=x, y=y)
    found = check_parts(made, control, values, rng, work=WORK, interaction=coupling | {"order": order})
    assert found.overlap_count > 0


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("seed", range(16))
def test_more_adhesive_pairs(seed: int) -> None:
    rng, control = np.random.default_rng([4, seed]), CONTROLS[seed % 4]
    interaction = (FREE, PERIODIC)[seed // 4 % 2] | {"order": 1 + seed // 8 % 2}
    count = int(rng.integers(2, 30))
    made = placed(rng, count, float(rng.uniform(6e-6, 1.2e-5) * math.sqrt(count)))
    check_parts(made, control, walk(rng, control, adhesive=True), rng, work=WORK, interaction=interaction)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("interaction", [None, PERIODIC], ids=["independent", "pairs"])
@pytest.mark.parametrize("work", [0.0, WORK])
@pytest.mark.parametrize("shape", ["cone", "flat_punch", pytest.param("truncated_cone", marks=pytest.mark.large)])
def test_other_shapes(shape: str, work: float, interaction: dict[str, Any] | None) -> None:
    rng = np.random.default_rng(5)
    values = walk(rng, "separation", adhesive=True)
    check_parts(placed(rng, 8, 8e-6, shape), "separation", values, rng, work=work, interaction=interaction)


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("interaction", [None, PERIODIC], ids=["independent", "pairs"])
def test_the_way_to_a_preload_knows_nothing_of_the_way_back(interaction: dict[str, Any] | None) -> None:
    made = placed(np.random.default_rng(6), 6, 1.2e-5)
    given = {"preload": 4e-6, "machine_stiffness": 50.0, "steps": 6, "effective_modulus": MODULUS, "work": WORK}
    there, back = (
        rm.load_separation(made, unload=unload, interaction=interaction, **given) for unload in (False, True)
    )
    for name in ("force", "separation", "contact_area"):
        np.testing.assert_array_equal(there[name].values, back[name].values[:6])


def check_parts_of_scene(path: dict[str, Any], key: str, end: int, atol_of_error: float = 0.0, **sections: Any) -> None:
    """Hold a part of a list in the path of a scene against the whole list."""
    asperities = {**ASPERITIES, "count": 40, "radius": "50 um"}
    found = []
    for values in (path[key], path[key][:end]):
        table = scene(**{"adhesion": None, "asperities": asperities, "path": path | {key: values}, **sections})
        found.append(rm.run(table))
    whole, part = found
    for name, values in part.data_vars.items():
        if "step" in values.dims and not str(name).endswith(MODEL_ERROR):  # parts of these are the largest of a path
            atol = atol_of_error * float(part.numerical_error.max() + whole.numerical_error.max())
            begun = whole[name].isel(step=slice(end)).values
            np.testing.assert_allclose(
                begun, values.values, rtol=0.0, atol=atol * float(np.abs(values).max()), err_msg=str(name)
            )


ESTIMATORS = [{"estimator": "expected"}, {"realizations": 2}]


@pytest.mark.few(2)
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("control", ["separation", "force", "remote"])
@pytest.mark.parametrize("adhesion", [None, {"model": "jkr", "work": "50 mJ/m^2"}], ids=["without", "jkr"])
def test_expected_laws(adhesion: dict[str, Any] | None, control: str) -> None:
    rng = np.random.default_rng(7)
    low, high = (0.0, 1e-3) if control == "force" else (-5e-7, 2e-6)
    path = {control: rng.uniform(low, high, 5).tolist()}
    path |= {"machine_stiffness": "2 kN/m"} if control == "remote" else {}
    check_parts_of_scene(path, control, 3, adhesion=adhesion, batch=ESTIMATORS[0])


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("batch", ESTIMATORS, ids=["expected", "sampled"])
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_laws_of_the_mean_field(boundary: str, batch: dict[str, Any]) -> None:
    values = np.random.default_rng(8).uniform(-5e-7, 2e-6, 6).tolist()
    interaction = {"model": "mean_field", "boundary": boundary}
    check_parts_of_scene({"separation": values}, "separation", 4, interaction=interaction, batch=batch)


@pytest.mark.parametrize("batch", ESTIMATORS, ids=["expected", "sampled"])
@pytest.mark.parametrize("held", [{"separation": "1 sigma"}, {"force": "1 mN"}], ids=["separation", "force"])
def test_lateral_paths(held: dict[str, str], batch: dict[str, Any]) -> None:
    lateral = np.append(0.0, np.random.default_rng(9).uniform(-1e-7, 1e-7, 7)).tolist()
    variables = ["tangential_force", "tangential_stiffness", "friction_energy", "force"]
    sections = {"tangential": {"friction": 0.3}, "batch": batch, "output": {"variables": variables}}
    check_parts_of_scene(held | {"lateral": lateral}, "lateral", 5, **sections)


@pytest.mark.parametrize("batch", ESTIMATORS, ids=["expected", "sampled"])
@pytest.mark.parametrize("end", [3, 7])
def test_relaxing_moduli_to_their_error(end: int, batch: dict[str, Any]) -> None:
    """Where the flat has turned, bit for bit; before, the steps of the integral follow the lowest separation."""
    terms = [{"time": "10 ms", "share": 0.3}, {"time": "1 s", "share": 0.4}]
    body = {"relaxation": terms, "speed": "1 um/s", "retraction_speed": "4 um/s"}
    values = [3e-6, 2e-6, 1e-6, 5e-7, 0.0, 3e-7, 6e-7, 1e-6, 2e-6]
    turned = end > 5
    check_parts_of_scene(
        {"separation": values}, "separation", end, 0.0 if turned else 1.0, viscoelastic=body, batch=batch
    )


def test_curved_bodies_to_their_error() -> None:
    """The rings follow the whole path."""
    values = [3e-6, 1e-6, -1e-6, 2e-6, -2e-6]
    sections = {"nominal": {"radius": "20 mm"}, "batch": ESTIMATORS[0], "output": {"variables": ["force"]}}
    check_parts_of_scene({"separation": values}, "separation", 3, 1.0, **sections)


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
