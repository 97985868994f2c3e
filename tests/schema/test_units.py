import math
from itertools import pairwise

import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import adheres
from roughmdr.schema.units import _BASES, axis_unit, dimension_of, format_quantity, quantity, spelled_in_results


@pytest.mark.parametrize(
    ("text", "dimension", "si"),
    [
        ("10 um", "m", 1e-5),
        ("10um", "m", 1e-5),
        ("10 µm", "m", 1e-5),
        ("0.1 nm", "m", 1e-10),
        ("3 Å", "m", 3e-10),
        ("-2.5e3 nm", "m", -2.5e-6),
        ("1 mm^2", "m2", 1e-6),
        ("2 um^2", "m2", 2e-12),
        ("5 /mm^2", "m-2", 5e6),
        ("5 1/mm^2", "m-2", 5e6),
        ("3 MPa", "Pa", 3e6),
        ("70 GPa", "Pa", 7e10),
        ("50 mJ/m^2", "J/m^2", 0.05),
        ("50 mN/m", "J/m^2", 0.05),
        ("72 erg/cm^2", "J/m^2", 0.072),
        ("0.3", "1", 0.3),
        ("2 %", "1", 0.02),
        ("3 fN", "N", 3e-15),
        (4, "m", 4.0),
    ],
)
def test_a_quantity_is_the_nearest_float(text: object, dimension: str, si: float) -> None:
    assert quantity(text, dimension) == si


@pytest.mark.parametrize(
    ("value", "dimension", "says"),
    [
        ("10 MPa", "m", "unit of Pa; expected a unit of m"),
        ("10 parsec", "m", "unknown unit 'parsec'"),
        ("ten um", "m", "expected a number in m"),
        (True, "m", "expected a number"),
        ([1.0], "m", "expected a number"),
        (math.nan, "m", "finite"),
        (math.inf, "Pa", "finite"),
        ("1e400 m", "m", "finite"),
        (10**400, "m", "too large"),
        ("3 m", "1", "plain number"),
        ("", "m", "expected a number"),
    ],
)
def test_what_is_no_quantity_is_refused(value: object, dimension: str, says: str) -> None:
    with pytest.raises(RoughmdrError, match=says):
        quantity(value, dimension)


def test_a_long_unit_is_shown_cut() -> None:
    for dimension in ("m", "1"):
        with pytest.raises(RoughmdrError) as refused:
            quantity("1 " + "m" * 100_000, dimension)
        assert len(str(refused.value)) < 200


@settings(deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from([*_BASES, "1"]))
def test_a_quantity_that_is_shown_is_read_again_to_four_digits(value: float, unit: str) -> None:
    text = format_quantity(value, unit)
    if 0.0 < abs(value) < 1e-300 or abs(value) > 9.9995e307:  # rounded to four digits these may be no floats any more
        return
    assert quantity(text, unit) == pytest.approx(value, rel=5.1e-4, abs=0.0)


@settings(deadline=None)
@given(st.floats(1e-11, 1e11), st.sampled_from(["m", "Pa", "N", "J/m^2"]))
def test_the_prefix_leaves_one_to_three_digits_before_the_point(value: float, unit: str) -> None:
    assert 1.0 <= float(format_quantity(value, unit).split()[0]) < 1000.0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"value": -2.356e-7, "unit": "N"}, "-235.6 nN"),
        ({"value": 0.00099996, "unit": "N"}, "1 mN"),
        ({"value": 0.0, "unit": "Pa"}, "0 Pa"),
        ({"value": math.nan, "unit": "N"}, "nan N"),
        ({"value": 0.01, "unit": "J m-2"}, "10 mJ/m^2"),
        ({"value": 2e9, "unit": "m-2"}, "2000 /mm^2"),
        ({"value": 3e-4, "unit": "m2"}, "300 mm^2"),
        ({"value": 250.0, "unit": "N m-1"}, "250 N/m"),
        ({"value": 0.25, "unit": "1"}, "0.25"),
        ({"value": 1e-7, "to": 2e-6, "unit": "m"}, "0.1 to 2 um"),
        ({"value": -1.234e-6, "error": 5.67e-8, "unit": "N"}, "-1.234 ± 0.057 uN"),
        ({"value": 0.0, "error": 1.2e-5, "unit": "N"}, "0 ± 12 uN"),
        ({"value": -1e-6, "error": math.nan, "unit": "N"}, "-1 uN"),
    ],
)
def test_a_quantity_is_shown_with_a_prefix(arguments: dict[str, float], text: str) -> None:
    assert format_quantity(**arguments) == text  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({}, False),
        ({"adhesion": {"work": 0.0}}, False),
        ({"adhesion": {"work": "50 mJ/m^2"}}, True),
        ({"adhesion": {"work": 0.05}, "sweep": {"adhesion.work": [0.0]}}, False),
        ({"adhesion": {"model": "jkr"}, "sweep": {"adhesion.work": ["0 J/m^2", "1 mJ/m^2"]}}, True),
        ({"adhesion": {}, "sweep": {"adhesion.work": {"linspace": [0.0, 0.05], "num": 3}}}, True),
    ],
)
def test_a_scene_adheres_where_it_has_a_work_in_any_cell(table: dict[str, object], expected: bool) -> None:
    assert adheres(table) is expected


@pytest.mark.parametrize("unit", _BASES)
def test_a_result_spells_a_unit_so_that_its_dimension_is_found_again(unit: str) -> None:
    assert dimension_of(spelled_in_results(unit)) == unit
    assert "/" not in spelled_in_results(unit)
    value = quantity(format_quantity(0.25, spelled_in_results(unit)), unit)
    assert value == pytest.approx(0.25)


LADDER = ["f", "p", "n", "u", "m", "", "k", "M", "G", "T"]
POWERS = {"m2": 2, "m-2": -2}


@pytest.mark.parametrize("dimension", _BASES)
def test_prefixes_are_a_thousand_apart_in_every_spelling(dimension: str) -> None:
    """Squares of lengths have the square of the prefix, and densities its inverse square."""
    step = 1000.0 ** POWERS.get(dimension, 1)
    for base, _ in _BASES[dimension]:
        slash, unit = ("/", base[1:]) if base.startswith("/") else ("", base)
        sizes = [quantity(f"1 {slash}{prefix}{unit}", dimension) for prefix in LADDER]
        assert sizes[LADDER.index("")] == 1.0
        assert [larger / smaller for smaller, larger in pairwise(sizes)] == pytest.approx(
            [step] * (len(LADDER) - 1), rel=1e-12
        )
        centi = quantity(f"1 {slash}c{unit}", dimension)
        assert centi == pytest.approx(sizes[LADDER.index("m")] * 10.0 ** POWERS.get(dimension, 1), rel=1e-12)
        assert quantity(f"1 {slash}µ{unit}", dimension) == quantity(f"1 {slash}u{unit}", dimension)


@pytest.mark.parametrize("prefix", [*LADDER, "c"])
def test_so_many_squares_of_a_length_are_a_square_metre(prefix: str) -> None:
    square = quantity(f"1 {prefix}m^2", "m2")
    assert quantity(f"1 {prefix}m", "m") ** 2 == pytest.approx(square, rel=1e-12)
    for spelled in (f"/{prefix}m^2", f"{prefix}m^-2", f"1/{prefix}m^2", f"1 / {prefix}m^2".replace(" / ", "/")):
        assert quantity(f"4 {spelled}", "m-2") * square == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize(("word", "symbol"), [("nano", "n"), ("micro", "u"), ("milli", "m"), ("centi", "c"), ("", "")])
def test_metres_are_spelled_out(word: str, symbol: str) -> None:
    for ending in ("metre", "meter", "metres", "meters"):
        assert quantity(f"2.5 {word}{ending}", "m") == quantity(f"2.5 {symbol}m", "m")
    assert quantity("3 microns", "m") == quantity("3 micron", "m") == quantity("3 um", "m")
    assert quantity("3 angstrom", "m") == quantity("0.3 nm", "m")


@pytest.mark.parametrize("text", ["1e-400 m", "-1e-400 m", "1e-320 nm", "4e-325 m", "0.1e-323 pm"])
def test_what_is_too_near_to_0_is_refused_not_taken_for_0(text: str) -> None:
    with pytest.raises(RoughmdrError, match="too near to 0"):
        quantity(text, "m")


def test_the_smallest_floats_and_0_itself_are_numbers() -> None:
    assert quantity("5e-324 m", "m") == 5e-324
    assert quantity("5e-321 km", "m") == pytest.approx(5e-318, rel=1e-3)
    for zero in ("0 nm", "-0.0 m", 0, "0e-999 m"):
        assert quantity(zero, "m") == 0.0


@pytest.mark.parametrize("unit", _BASES)
def test_an_axis_has_numbers_from_1_to_1000(unit: str) -> None:
    """Squares have numbers to a million; the unit is one that is read, of that size."""
    power = abs(POWERS.get(unit, 1))
    for largest in (2.5e-9, 3.1e-4, 0.99, 7.0, 4.5e5):
        size, name = axis_unit(largest, unit)
        assert quantity(f"1 {name}", unit) == pytest.approx(size, rel=1e-12)
        assert 1.0 <= largest / size < 1000.0**power
