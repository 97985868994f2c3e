"""The text of ``roughmdr fit``."""

import math
from collections.abc import Iterator

from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_seconds, format_table
from roughmdr.storage.labelled import Labelled

_DIGITS = 4, 12  # least and most digits of a fitted number


def describe_fit(fit: Labelled) -> str:
    """Return the parameters with standard errors and 95 % intervals, the quality of the fit, and doubts."""
    return format_table(_lines(fit))


def describe_parameters(fit: Labelled) -> list[str]:
    """Return a line for each parameter, with its standard error and its 95 % interval."""
    keys = parameter_keys(fit)
    widest = max(map(len, keys))
    return [f"{key:<{widest}}  {_with_interval(fit, key.replace('.', '_'))}" for key in keys]


def describe_shifts(fit: Labelled) -> str:
    """Return the shifts of the parameters by the error of the law; empty where that is not known."""
    shifts = [_shift(fit, key) for key in parameter_keys(fit) if _has_shift(fit, key.replace(".", "_"))]
    return f"not in the intervals: that of the law may shift {', '.join(shifts)}" if shifts else ""


def parameter_keys(fit: Labelled) -> list[str]:
    """Return the keys of the fitted parameters."""
    return list(map(str, fit.coordinates["parameter_name"].values))


def _lines(fit: Labelled) -> Iterator[tuple[str, str]]:
    for i, line in enumerate(describe_parameters(fit)):
        yield "" if i else "fitted", line
    yield "intervals", "± one standard error; in parentheses 95 %"
    load = "pressure" if "pressure_fitted" in fit.variables else "force"
    points = fit.variables["residual"].values.size
    yield "residual", f"{100.0 * _number(fit, 'residual_rms'):.2g} % of the largest {load} (r.m.s. of {points} points)"
    if shifts := describe_shifts(fit):
        yield "model error", shifts
    yield "trust", str(fit.attrs["trust"])
    yield "computed", f"{_number(fit, 'evaluation_count'):.0f} laws in {format_seconds(_number(fit, 'run_time'))}"
    for text in str(fit.attrs.get("warnings", "")).splitlines():
        yield "warning", text


def _with_interval(fit: Labelled, name: str) -> str:
    unit = str(fit.variables[name].attrs["units"])
    low, high = (_number(fit, f"{name}_{end}") for end in ("low", "high"))
    if is_open(fit, name):
        return f"{format_quantity(_number(fit, name), unit)}, not determined"
    number, error = _number(fit, name), _number(fit, f"{name}_standard_error")
    digits = _digits(number, error)
    value = format_quantity(number, unit, error=error, digits=digits)
    return f"{value} ({format_quantity(low, unit, to=high, digits=digits)})"


def _digits(number: float, error: float) -> int:
    """Return how many digits of a number are shown: two of its standard error, and four at least."""
    if not (number and error > 0.0):
        return _DIGITS[0]
    return min(max(math.floor(math.log10(abs(number))) - math.floor(math.log10(error)) + 2, _DIGITS[0]), _DIGITS[1])


def is_open(fit: Labelled, name: str) -> bool:
    """Return whether a parameter is not determined: a positive one by a factor of several, another by its scale."""
    position = [key.replace(".", "_") for key in parameter_keys(fit)].index(name)
    scale = float(fit.variables["parameter_scale"].values[position]) or _number(fit, name)
    return _number(fit, f"{name}_standard_error") > scale


def _has_shift(fit: Labelled, name: str) -> bool:
    return f"{name}_model_error" in fit.variables and not is_open(fit, name)


def _shift(fit: Labelled, key: str) -> str:
    name = key.replace(".", "_")
    return f"{key} by {format_quantity(_number(fit, f'{name}_model_error'), fit.variables[name].attrs['units'])}"


def _number(fit: Labelled, name: str) -> float:
    return float(fit.variables[name].values)
