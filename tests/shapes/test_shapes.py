"""f, g and G against integrals of the slope f' alone, and what a shape refuses."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from oracles.jkr import kappa
from oracles.multiprecision import Number, mp

import roughmdr as rm
from roughmdr.shapes.kappa import kappa as kappa_of_package

SHAPES = [
    rm.Paraboloid(radius=3.7e-9),
    rm.Paraboloid(radius=2.0),
    rm.Cone(slope=1e-3),
    rm.Cone(slope=47.0),
    rm.PowerLaw(exponent=0.51, coefficient=3e-4),
    rm.PowerLaw(exponent=1.5, coefficient=80.0),
    rm.PowerLaw(exponent=4.0, coefficient=2e5),
    rm.PowerLaw(exponent=0.75, width=2e-6, rise=5e-8),
    rm.PowerLaw(exponent=13.3, width=1e-9, rise=3e-9),
    rm.PowerLaw(exponent=200.0, width=1e-4, rise=1e-5),
]


def slope(shape: rm.Paraboloid | rm.Cone | rm.PowerLaw, r: Number) -> Number:
    given = {name: mp.mpf(value) for name, value in shape.parameters.items()}
    if "radius" in given:
        return r / given["radius"]
    if "slope" in given:
        return given["slope"]
    n = given["exponent"]
    if "coefficient" in given:
        return n * given["coefficient"] * r ** (n - 1)
    return n * given["rise"] / given["width"] * (r / given["width"]) ** (n - 1)


def radii(shape: rm.Paraboloid | rm.Cone | rm.PowerLaw) -> np.ndarray:
    return np.array([0.3, 0.9, 1.7]) * shape.parameters.get("width", 1e-6)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_profiles_are_the_integrals_of_the_slope(shape: rm.Paraboloid | rm.Cone | rm.PowerLaw) -> None:
    got = {"f": shape.f(radii(shape)), "g": shape.g(radii(shape)), "G": shape.G(radii(shape))}
    exponent = shape.parameters.get("exponent", 1.0)
    with mp.workdps(30):
        for i, x in enumerate(mp.mpf(x) for x in radii(shape)):
            steepest = slope(shape, x)

            def relative(s: Number, x: Number = x, steepest: Number = steepest) -> Number:
                return slope(shape, x * s) / steepest

            # r = x sin(angle) takes the root out of both integrands.
            angles = [0, 1, mp.pi / 2]
            exact = {
                "f": x * steepest * mp.quad(relative, [0, mp.mpf(1) / 2, 1]),
                "g": x * steepest * mp.quad(lambda t: relative(mp.sin(t)), angles),
                "G": x * x * steepest * mp.quad(lambda t: relative(mp.sin(t)) * mp.cos(t) ** 2, angles),
            }
            for name, numbers in got.items():
                error = abs(numbers[i] - exact[name]) / exact[name]
                assert error <= (exponent + 8.0) * sys.float_info.epsilon, name


b, S, R = 3e-7, 0.4, 2e-5
EDGES: list[tuple[Any, Callable[[Number], Number], Callable[[Number], Number]]] = [
    (rm.TruncatedCone(S, b), lambda r: S * max(r - b, 0), lambda r: S * (r > b)),
    (rm.TruncatedParaboloid(R, b), lambda r: max(r**2 - mp.mpf(b) ** 2, 0) / (2 * R), lambda r: r / R * (r > b)),
    (rm.RoundedCone(S, b), lambda r: S * (r**2 / (2 * b) if r < b else r - b / 2), lambda r: S * min(r / b, 1)),
    (
        rm.CappedParaboloid(R, 1e9 * R, b),
        lambda r: (min(r, b) ** 2 / 1e9 + max(r**2 - mp.mpf(b) ** 2, 0)) / (2 * R),
        lambda r: r / R / (1 if r > b else 1e9),
    ),
    (rm.RoundedPunch(b, R), lambda r: max(r - b, 0) ** 2 / (2 * R), lambda r: max(r - b, 0) / R),
    (rm.Sphere(b), lambda r: b - mp.sqrt((b - r) * (b + r)), lambda r: r / mp.sqrt((b - r) * (b + r))),
    (rm.PowerSeries({1.0: S, 2.0: 1 / R}), lambda r: S * r + r**2 / R, lambda r: S + 2 * r / R),
]


@pytest.mark.parametrize(("shape", "f", "slope"), EDGES, ids=lambda value: getattr(value, "name", ""))
def test_profiles_are_right_next_to_an_edge_and_far_from_it(
    shape: Any, f: Callable[[Number], Number], slope: Callable[[Number], Number]
) -> None:
    near = b * (1.0 + np.array([-1e-3, -1e-9, -1e-15, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1]))
    radii = np.concatenate([b * 10.0 ** np.arange(-6.0, 7.0), near])
    if shape.name == "sphere":
        radii = radii[radii < b]
    found = shape.f(radii), shape.df(radii), shape.G(radii)
    with mp.workdps(50):
        for r, f_found, slope_found, integral in zip(map(mp.mpf, radii.tolist()), *found, strict=True):
            assert abs(f_found - f(r)) <= 1e-15 * f(r)
            assert abs(slope_found - slope(r)) <= 1e-15 * slope(r)
            # G = ∫ f' sqrt(a^2 - r^2) dr, with r = a sin(angle).
            ends = [0, mp.pi / 2] if r <= b else [0, mp.asin(b / r), (mp.asin(b / r) + mp.pi / 2) / 2, mp.pi / 2]
            exact = r**2 * mp.quad(lambda angle, r=r: slope(r * mp.sin(angle)) * mp.cos(angle) ** 2, ends)
            assert abs(integral - exact) <= 1e-12 * exact


@pytest.mark.parametrize("n", [5e-324, 1e-18, 0.99e-18, 3e-5, 0.99e18, 1.01e18, 1.7e308])
def test_kappa_of_any_exponent(n: float) -> None:
    with mp.workdps(60):
        exact = mp.sqrt(mp.pi * mp.mpf(n) / 2) if n > 1e15 else kappa(mp.mpf(n))
    assert abs(mp.mpf(kappa_of_package(n)) / exact - 1) <= 5e-16


def test_known_kappa() -> None:
    assert kappa_of_package(1.0) == pytest.approx(np.pi / 2, rel=4e-16)
    assert kappa_of_package(2.0) == pytest.approx(2.0, rel=4e-16)


@pytest.mark.parametrize("exponent", [1e-6, 0.3, 0.51, 1.0, 7.7, 47.9, 48.1, 200.0, 1e5])
def test_kappa(exponent: float) -> None:
    assert abs(kappa_of_package(exponent) / kappa(exponent) - 1) <= 1e-15


def test_profiles_keep_the_form_of_their_argument() -> None:
    shape = rm.PowerLaw(exponent=1.5, coefficient=80.0)
    for profile in (shape.f, shape.g, shape.G):
        assert profile(2.0).shape == ()
        assert profile(np.ones((2, 3))).shape == (2, 3)
        assert profile([0.0, 1.0])[0] == 0.0


@pytest.mark.parametrize("value", [-1.5, 0.0, float("nan"), float("inf"), "blunt"])
@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda v: rm.Paraboloid(radius=v), "radius"),
        (lambda v: rm.Cone(slope=v), "slope"),
        (lambda v: rm.PowerLaw(exponent=v, coefficient=1.0), "exponent"),
        (lambda v: rm.PowerLaw(exponent=2.0, coefficient=v), "coefficient"),
        (lambda v: rm.PowerLaw(exponent=2.0, width=v, rise=1.0), "width"),
        (lambda v: rm.PowerLaw(exponent=2.0, width=1.0, rise=v), "rise"),
        (lambda v: rm.Sphere(radius=v), "radius"),
        (lambda v: rm.TruncatedCone(slope=v, flat_radius=1e-6), "slope"),
        (lambda v: rm.RoundedPunch(flat_radius=v, edge_radius=1e-6), "flat_radius"),
    ],
)
def test_a_bad_parameter_is_refused_by_name_and_value(make: object, name: str, value: object) -> None:
    shown = "'blunt': expected a " if value == "blunt" else f"{value:g}; it must be a finite number above 0"
    with pytest.raises(rm.ShapeError, match=rf"^[a-z_]+: {name} is {shown}"):
        make(value)


@pytest.mark.parametrize(
    ("r", "f", "says"),
    [
        (["0 um", "x", "2 um"], [0.0, 1e-6, 2e-6], "tabulated: r is 'x': expected a number in m"),
        ([0.0, {}, 2e-6], [0.0, 1e-6, 2e-6], "tabulated: r is .*; it must be a list of numbers"),
        ([0.0, 1e-6], [0.0, 1e-6], r"tabulated: r has the shape \(2,\); it must be a row of at least 3"),
        ([0.0, 1e-6, 2e-6], [0.0, np.nan, 1e-6], r"tabulated: f\[1\] is nan; it must be finite"),
        ([0.0, 1e-6, 2e-6], [1e-9, 1e-8, 1e-6], r"tabulated: f\[0\] is 1e-09 m; the table must begin at the tip"),
        ([0.0, 1e-6, 2e-6, 3e-6], [0.0, 1e-6, 2e-6], "tabulated: r holds 4 numbers and f 3"),
        ([0.0, 2e-6, 1e-6], [0.0, 1e-9, 1e-6], r"r\[2\] is 1e-06 m after 2e-06 m; r must rise"),
        ([0.0, 1e-6, 2e-6], [0.0, 1e-6, 1e-9], r"f\[2\] is 1e-09 m after 1e-06 m; f must not fall"),
    ],
)
def test_a_table_that_is_no_profile_is_refused_by_what_is_wrong(r: object, f: object, says: str) -> None:
    with pytest.raises(rm.ShapeError, match=says):
        rm.Tabulated(r, f)


def test_parameters_that_do_not_go_together_are_refused() -> None:
    with pytest.raises(rm.ShapeError, match=r"cap_radius is 1e-06; .*at least"):
        rm.CappedParaboloid(radius=2e-6, cap_radius=1e-6, blend_radius=1e-7)
    for terms, says in (({}, "terms is {}"), ({2.0: -1.0}, "coefficient of r.2.0 is -1")):
        with pytest.raises(rm.ShapeError, match=says):
            rm.PowerSeries(terms)
    with pytest.raises(rm.OutOfRange, match="not be a disc"):
        rm.Tabulated([0.0, 1e-6, 2e-6, 3e-6, 4e-6], [0.0, 1e-6, 1.1e-6, 1.11e-6, 1.12e-6])


@pytest.mark.parametrize(
    "given",
    [
        {"exponent": 2.0},
        {"exponent": 2.0, "width": 1.0},
        {"exponent": 2.0, "rise": 1.0},
        {"exponent": 2.0, "coefficient": 1.0, "width": 1.0},
        {"exponent": 2.0, "coefficient": 1.0, "width": 1.0, "rise": 1.0},
    ],
)
def test_a_spelling_that_does_not_exist_is_refused_by_its_names(given: dict[str, float]) -> None:
    with pytest.raises(rm.ShapeError, match=" and ".join(given) + ";"):
        rm.PowerLaw(**given)
