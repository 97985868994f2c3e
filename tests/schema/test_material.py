"""Young's modulus and E*: rm.effective_modulus, and the keyword arguments of every function that takes E*."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import roughmdr as rm

TIP = rm.Paraboloid(radius=1e-6)
SURFACE = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave=1e-4, short_wave=5e-6, rms_slope=0.1)
ASPERITIES = rm.generate(
    {"source": "random", "shape": "paraboloid", "count": 20, "patch": "1 mm", "radius": "50 um",
     "height": {"distribution": "normal", "std": "1 um"}},
    seed=1,
)  # fmt: skip
SUMMITS = {"separation": 1e-6, "radius": 5e-5, "density": 1e9, "std": 1e-6}
MOMENTS = {"separation": 1e-6, **SURFACE.moments._asdict()}
LOAD = {"pressure": 1e6, "rms_slope": 0.1}
LINE = {"spectrum": SURFACE, "length": 1e-4, "points": 64, "seed": 0}
TAKE_E: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "indent": (rm.indent, {"shape": TIP, "indentation": 1e-9}),
    "pull_off": (rm.pull_off, {"shape": TIP, "work": 0.05}),
    "tabor": (rm.tabor, {"shape": TIP, "work": 0.05, "strength": 5e6}),
    "equilibria": (rm.equilibria, {"shape": TIP, "work": 0.05, "indentation": 1e-9}),
    "pressure": (rm.pressure, {"shape": TIP, "r": 0.0, "indentation": 1e-9}),
    "surface_displacement": (rm.surface_displacement, {"shape": TIP, "r": 0.0, "indentation": 1e-9}),
    "load_separation": (rm.load_separation, {"ensemble": ASPERITIES, "separation": 1e-6}),
    "greenwood_williamson": (rm.theory.greenwood_williamson, SUMMITS),
    "fuller_tabor": (rm.theory.fuller_tabor, {**SUMMITS, "work": 0.05}),
    "dmt_maugis": (rm.theory.dmt_maugis, {**SUMMITS, "work": 0.05}),
    "bush_gibson_thomas": (rm.theory.bush_gibson_thomas, MOMENTS),
    "greenwood_elliptic": (rm.theory.greenwood_elliptic, MOMENTS),
    "bush_gibson_thomas_asymptote": (rm.theory.bush_gibson_thomas_asymptote, LOAD),
    "persson_contact_fraction": (rm.theory.persson_contact_fraction, LOAD),
    "persson_separation": (rm.theory.persson_separation, {"pressure": 1e6, "spectrum": SURFACE}),
    "persson_pressure": (rm.theory.persson_pressure, {"separation": 1e-6, "spectrum": SURFACE}),
    "rough_line": (rm.theory.rough_line, {"separation": 1e-6, **LINE}),
}
every_function = pytest.mark.parametrize("name", TAKE_E)


def numbers(result: Any) -> np.ndarray:
    """All numbers of a result, one after another."""
    if hasattr(result, "dims"):
        parts = result.data_vars.values() if hasattr(result, "data_vars") else [result]
        return np.concatenate([np.ravel(part.values).astype(float) for part in parts])
    return np.ravel(result).astype(float)


def test_effective_modulus() -> None:
    assert rm.effective_modulus(3e6, 0.49) == pytest.approx(3e6 / (1 - 0.49**2), rel=1e-15)
    both = 1 / ((1 - 0.09) / 70e9 + (1 - 0.0625) / 210e9)
    assert rm.effective_modulus(70e9, 0.3, 210e9, 0.25) == pytest.approx(both, rel=1e-15)
    assert rm.effective_modulus(70e9, 0.3, 210e9, 0.25) == rm.effective_modulus(210e9, 0.25, 70e9, 0.3)
    by_name = rm.effective_modulus(modulus="70 GPa", poisson=0.3, counter_modulus="210 GPa", counter_poisson=0.25)
    assert by_name == rm.effective_modulus(70e9, 0.3, 210e9, 0.25)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((-1.0, 0.3), "modulus is -1"),
        ((math.nan, 0.3), "modulus is nan"),
        ((1.0, 0.6), "poisson is 0.6"),
        ((1.0, 0.3, 0.0), "counter_modulus is 0"),
        ((1.0, 0.3, 1.0, -1.0), "counter_poisson is -1"),
        ((math.inf, 0.3), "modulus is inf"),
        (("3", None), "poisson is None"),
        (("3 um", 0.3), r"modulus is '3 um': 'um' is a unit of m; expected a unit of Pa, like \"3 MPa\""),
        ((1e-320, 0.3), "not representable"),
    ],
)
def test_effective_modulus_refuses(arguments: tuple[Any, ...], says: str) -> None:
    with pytest.raises(rm.OutOfRange, match=says):
        rm.effective_modulus(*arguments)


@every_function
def test_young_modulus_with_poisson_stands_for_the_effective_modulus(name: str) -> None:
    function, given = TAKE_E[name]
    expected = numbers(function(**given, effective_modulus=rm.effective_modulus(3e6, 0.49)))
    np.testing.assert_array_equal(numbers(function(**given, modulus="3 MPa", poisson=0.49)), expected)
    both = numbers(function(**given, effective_modulus=rm.effective_modulus(3e6, 0.49, 1e9, 0.3)))
    counter = {"counter_modulus": "1 GPa", "counter_poisson": 0.3}
    np.testing.assert_array_equal(numbers(function(**given, modulus=3e6, poisson=0.49, **counter)), both)


@every_function
@pytest.mark.parametrize(
    ("material", "says"),
    [
        ({}, "needs effective_modulus, or modulus and poisson; got none of them"),
        ({"modulus": 1e6}, "needs effective_modulus, or modulus and poisson; got modulus"),
        ({"poisson": 0.3}, "needs effective_modulus, or modulus and poisson; got poisson"),
        (
            {"effective_modulus": 1e6, "modulus": 1e6},
            "alone.*; got effective_modulus and modulus",
        ),
        ({"effective_modulus": 1e6, "poisson": 0.3}, "takes effective_modulus alone"),
        ({"effective_modulus": 1e6, "counter_modulus": 1e6, "counter_poisson": 0.3}, "without a counter body"),
        ({"modulus": 1e6, "poisson": 0.3, "counter_modulus": 1e6}, "counter_modulus and counter_poisson together"),
        ({"effective_modulus": "1 um"}, "'um' is a unit of m"),
        ({"modulus": 1e6, "poisson": 0.6}, "poisson is 0.6"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, dict) else "",
)
def test_a_material_is_told_in_one_way(name: str, material: dict[str, Any], says: str) -> None:
    function, given = TAKE_E[name]
    with pytest.raises(rm.RoughmdrError, match=says):
        function(**given, **material)


@every_function
def test_an_unknown_keyword_is_refused(name: str) -> None:
    function, given = TAKE_E[name]
    with pytest.raises(TypeError, match=rf"^{name}\(\) got .* 'modulos'; did you mean 'modulus'\?$"):
        function(**given, modulos=1e6, poisson=0.3)


def test_a_misspelt_argument_of_the_function_itself_is_recognised() -> None:
    with pytest.raises(TypeError, match="'contact_radis'; did you mean 'contact_radius'"):
        rm.pressure(TIP, r=0.0, contact_radis=1e-8, effective_modulus=1e6)


def test_the_stress_on_the_axis_takes_poisson_in_any_case() -> None:
    given: dict[str, Any] = {"shape": TIP, "z": [1e-8, 2e-8], "contact_radius": 2e-8}
    expected = rm.axis_stress(**given, effective_modulus=rm.effective_modulus(1e9, 0.3), poisson=0.3)
    assert rm.axis_stress(**given, modulus="1 GPa", poisson=0.3).identical(expected)
    for material in ({"effective_modulus": 1e9}, {"modulus": 1e9}, {}):
        with pytest.raises(rm.RoughmdrError, match="axis_stress needs the poisson of the half-space"):
            rm.axis_stress(**given, **material)
    with pytest.raises(rm.RoughmdrError, match="takes effective_modulus alone"):
        rm.axis_stress(**given, effective_modulus=1e9, modulus=1e9, poisson=0.3)


def test_units_are_read_wherever_a_number_is_taken() -> None:
    tip = rm.Paraboloid(radius="1 um")
    assert tip == TIP
    plain: dict[str, Any] = {"effective_modulus": 1e9, "work": 0.05}
    named: dict[str, Any] = {"effective_modulus": "1 GPa", "work": "50 mJ/m^2"}
    for control, texts, values in (
        ("indentation", ["-1 nm", "2 nm"], [-1e-9, 2e-9]),
        ("force", "10 nN", 1e-8),
        ("contact_radius", ["30 nm", 4e-8], [3e-8, 4e-8]),
    ):
        assert rm.indent(tip, **named, **{control: texts}).identical(rm.indent(TIP, **plain, **{control: values}))
    dugdale = rm.pull_off(tip, **named, adhesion="dugdale", strength="5 MPa", control="displacement")
    assert dugdale.identical(rm.pull_off(TIP, **plain, adhesion="dugdale", strength=5e6, control="displacement"))
    assert rm.tabor(tip, **named, strength="5 MPa") == rm.tabor(TIP, **plain, strength=5e6)
    assert rm.equilibria(tip, **named, indentation="-1 nm").identical(rm.equilibria(TIP, **plain, indentation=-1e-9))
    field = rm.pressure(tip, r=["0 nm", "10 nm"], contact_radius="50 nm", **named)
    assert field.identical(rm.pressure(TIP, r=[0.0, 1e-8], contact_radius=5e-8, **plain))
    curve = rm.load_separation(ASPERITIES, separation=["2 um", "1 um"], **named)
    assert curve.identical(rm.load_separation(ASPERITIES, separation=[2e-6, 1e-6], **plain))
    texts = {"separation": "1 um", "radius": "50 um", "density": "1000 /mm^2", "std": "1 um"}
    law = rm.theory.greenwood_williamson
    assert law(**texts, effective_modulus="1 GPa") == law(**SUMMITS, effective_modulus=1e9)
    named_surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
    assert named_surface == SURFACE


@pytest.mark.parametrize(
    ("refused", "error", "says"),
    [
        (lambda: rm.Paraboloid(radius="1 Pa"), rm.ShapeError, "paraboloid: radius is '1 Pa': 'Pa' is a unit of Pa"),
        (lambda: rm.Paraboloid(radius="-1 um"), rm.ShapeError, "radius is -1e-06"),
        (lambda: rm.Cone(slope="0.1 m"), rm.ShapeError, "slope is '0.1 m': has the unit 'm', but is a plain number"),
        (
            lambda: rm.indent(TIP, effective_modulus=1e9, indentation=["1 nm", "1 N"]),
            rm.OutOfRange,
            "indentation is '1 N': 'N' is a unit of N; expected a unit of m",
        ),
        (
            lambda: rm.pull_off(TIP, effective_modulus=1e9, work="5 mJ", control="displacement"),
            rm.OutOfRange,
            "work is '5 mJ': unknown unit 'mJ'; expected a unit of J/m",
        ),
    ],
)
def test_a_wrong_unit_is_named(refused: Callable[[], Any], error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says):
        refused()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"effective_modulus": 0.0}, "effective_modulus is 0 Pa; it must be a finite number above 0 Pa"),
        ({"modulus": 1e6, "poisson": 0.7}, "poisson is 0.7; it must be a number above -1 and at most 0.5"),
        ({"modulus": 1e6, "poisson": 10**400}, "...; it must be a number above -1 and at most 0.5"),
        ({"modulus": 1e6, "poisson": "3 kg"}, "poisson is '3 kg': has the unit 'kg', but is a plain number"),
        (
            {"effective_modulus": 1e6, "adhesion": "auto", "strength": 1e6, "error": 2.0},
            "error is 2; it must be a number above 0 and at most 1",
        ),
    ],
)
def test_arguments_are_held_to_the_bounds_of_the_scene(given: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.OutOfRange) as caught:
        rm.indent(TIP, indentation=1e-9, work=0.05, **given)
    assert str(caught.value).endswith(says)
