"""Readers of the arrays that describe one profile for all asperities."""

from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.units import DIMENSIONLESS, quantity
from roughmdr.shapes import PowerSeries

TERMS: JsonSchema = {
    "type": "object",
    "minProperties": 1,
    "propertyNames": {"pattern": r"^\s*[-+]?[\d._]+(?:[eE][-+]?\d+)?\s*$"},
    "additionalProperties": Quantity(DIMENSIONLESS).json_schema(),
}
LENGTHS: JsonSchema = {"type": "array", "items": Quantity("m").json_schema()}


def read_terms(value: object) -> dict[str, float]:
    """Read the terms of a power series, { "exponent" = coefficient }."""
    if not isinstance(value, dict) or not value:
        raise RoughmdrError('must be a table of exponents and coefficients, as { "2" = 1e4, "4" = 1e14 }')
    terms = {}
    for exponent, coefficient in value.items():
        try:
            float(exponent)
        except ValueError:
            raise EntryError(exponent, coefficient, 'the exponent must be a number, as in { "2" = 1e4 }') from None
        try:
            terms[exponent] = quantity(coefficient, DIMENSIONLESS)
        except RoughmdrError as error:
            hint = '; an exponent with a point needs quotes, as "2.5"' if isinstance(coefficient, dict) else ""
            raise EntryError(exponent, coefficient, f"{error}{hint}") from None
    PowerSeries(terms)
    return terms


def read_lengths(value: object) -> list[float]:
    """Read a list of lengths."""
    if not isinstance(value, list):
        raise RoughmdrError('must be a list of lengths, as [0, "1 um", "2 um"]')
    return [quantity(entry, "m") for entry in value]
