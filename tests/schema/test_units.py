import math

import pytest

from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import quantity


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
