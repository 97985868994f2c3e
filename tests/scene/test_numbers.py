"""A scene with other numbers: the one that is read from a table with them, or the same error."""

import copy
from typing import Any

import pytest

from roughmdr.errors import RoughmdrError
from roughmdr.scene import Scene, read, with_numbers
from roughmdr.scene.keys import set_key

TIP = {
    "source": "random",
    "shape": "power_law",
    "exponent": 2.0,
    "width": 1e-6,
    "rise": 1e-7,
    "count": 3,
    "patch": 1e-5,
}
SCENE: dict[str, Any] = {
    "title": "One tip",
    "asperities": TIP | {"patch": "10 um", "height": {"distribution": "normal", "std": "10 nm"}},
    "material": {"modulus": "1 MPa", "poisson": 0.3},
    "counter": {"modulus": "2 GPa", "poisson": 0.2},
    "adhesion": {"model": "dugdale", "work": 1e-3, "range": 1e-9},
    "path": {"remote": [1e-6, 0.0], "machine_stiffness": 2.0},
}
NUMBERS = {
    "material.modulus": [1e5, -1.0, 1e-320, float("nan")],
    "counter.poisson": [0.4, -2.0],
    "adhesion.range": [1e-8, 0.0],
    "asperities.exponent": [3.0, 0.4, 0.5],
    "asperities.height.std": [1e-9, -1.0],
    "path.machine_stiffness": [3.0, 0.0],
}


def found(of: Any) -> Any:
    try:
        return of()
    except RoughmdrError as error:
        return type(error), str(error)


@pytest.mark.parametrize("key", NUMBERS)
def test_a_number_makes_the_scene_that_is_read_with_it(key: str) -> None:
    scene = read(copy.deepcopy(SCENE))
    for number in NUMBERS[key]:
        table = copy.deepcopy(SCENE)
        set_key(table, key, number)
        expected, made = found(lambda table=table: read(table)), found(lambda n=number: with_numbers(scene, {key: n}))
        if isinstance(expected, Scene):
            assert (made.toml, made.model_fields_set) == (expected.toml, expected.model_fields_set)
            assert [getattr(made, name) for name in Scene.model_fields if name != "sweep"] == [
                getattr(expected, name) for name in Scene.model_fields if name != "sweep"
            ]
        else:
            assert made == expected
    assert read(copy.deepcopy(SCENE)).toml == scene.toml  # which stays as it was
