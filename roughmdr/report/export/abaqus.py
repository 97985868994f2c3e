"""Tables as options of a surface interaction of Abaqus and CalculiX, to be included under *SURFACE INTERACTION."""

from collections.abc import Iterator

from roughmdr.errors import StoreError
from roughmdr.report.export.comments import comment_lines
from roughmdr.report.export.document import Document


def write_abaqus(document: Document) -> str:
    """Return the options of Abaqus."""
    option = {
        "pressure": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        "thermal_conductance": "*GAP CONDUCTANCE, PRESSURE",
        "electrical_conductance": "*GAP ELECTRICAL CONDUCTANCE, PRESSURE",
    }
    return _text(document, "abaqus", option)


def write_calculix(document: Document) -> str:
    """Return the options of CalculiX, whose gap conductance is over the pressure, without a word for it."""
    option = {
        "pressure": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        "thermal_conductance": "*GAP CONDUCTANCE",
    }
    return _text(document, "calculix", option)


def _text(document: Document, code: str, options: dict[str, str]) -> str:
    lines = list(comment_lines(document, code, "**"))
    if document.quantity == "tangential":
        lines += _friction(document, code)
    else:
        name = "pressure" if document.quantity == "pressure" else document.variable
        if name not in options:
            raise StoreError(f"{code} has no option for {name.replace('_', ' ')}s of a gap; csv and json take them")
        lines.append(options[name])
        pairs = zip(document.value.values.tolist(), document.argument.values.tolist(), strict=True)
        lines += [f"{_number(value)}, {_number(argument)}" for value, argument in pairs]
    return "\n".join([*lines, ""])


def _friction(document: Document, code: str) -> Iterator[str]:
    """Yield friction with the elastic slip, or the stick slope, at the largest pressure."""
    if document.friction is None:
        raise StoreError(f"quantity 'tangential' for {code} needs a coefficient of friction: [tangential] friction")
    stiffness, pressure = (float(column.values[-1]) for column in (document.value, document.argument))
    if code == "abaqus":
        yield f"*FRICTION, ELASTIC SLIP={_number(document.friction * pressure / stiffness)}"
        yield _number(document.friction)
    else:
        yield "*FRICTION"
        yield f"{_number(document.friction)}, {_number(stiffness)}"


def _number(value: float) -> str:
    """Return a number in the 20 characters that CalculiX reads."""
    return f"{value:.12e}"
