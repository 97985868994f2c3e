"""The text of ``roughmdr fit``."""

import math
from collections.abc import Iterator

import numpy as np

from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_seconds, format_table, under
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import plain_name

COMPARED = ("aicc", "akaike_weight", "tabor_parameter", "model_residual_rms")
"""Numbers that compare adhesion models."""
_DIGITS = 4, 12  # least and most digits of a fitted number
_SAID = 5  # most failed curves that are named
_LEAST_SHIFT = 1e-3  # shift by the error of the law, over the standard error, below which it does not count


def describe_fit(fit: Labelled) -> str:
    """Return the parameters with standard errors and 95 % intervals, the quality of the fit, and doubts."""
    return format_table(fit_lines(fit))


def describe_parameters(fit: Labelled) -> list[str]:
    """Return a line for each parameter, with its standard error and its 95 % interval."""
    names = parameter_names(fit)
    widest = max(map(len, names))
    return [f"{key:<{widest}}  {_with_interval(fit, name)}" for key, name in names.items()]


def describe_shifts(fit: Labelled) -> str:
    """Return the shifts of the parameters by the error of the law that count; empty where that is not known."""
    shifts = list[str]()
    for key, name in parameter_names(fit).items():
        if f"{name}_model_error" in fit.variables and not is_open(fit, name):
            shift = _number(fit, f"{name}_model_error")
            if shift >= _LEAST_SHIFT * _number(fit, f"{name}_standard_error"):
                shifts.append(f"{key} by {format_quantity(shift, fit.variables[name].attrs['units'])}")
    return f"not in the intervals: that of the law may shift {', '.join(shifts)}" if shifts else ""


def parameter_names(fit: Labelled) -> dict[str, str]:
    """Return the names of the variables of the fitted parameters by their keys."""
    return {key: plain_name(key) for key in map(str, fit.coordinates["parameter_name"].values)}


def load_of(fit: Labelled) -> str:
    """Return the quantity that was measured: "force" or "pressure"."""
    return "pressure" if "pressure_fitted" in fit.variables else "force"


def fit_lines(fit: Labelled) -> Iterator[tuple[str, str]]:
    """Yield the lines of ``describe_fit``: a name and a text."""
    many, fit = fit, typical(fit)
    for i, line in enumerate(describe_parameters(fit)):
        yield "" if i else "fitted", line
    if fit.attrs.get("measured", "measured") != "measured":  # a file
        yield "measured", str(fit.attrs["measured"])
    _, *reasons = str(fit.attrs.get("intervals", "")).split("; ")
    of_many = "median ± median standard error; in parentheses from 5 to 95 % of the curves"
    if shared := [key for key, name in parameter_names(many).items() if not many.variables[name].dims]:
        of_many += f"; of {', '.join(shared)}, one for all, 95 %"
    of_one = "; ".join(["± one standard error; in parentheses 95 %", *reasons])
    yield "intervals", of_many if curve_names(many) else of_one
    yield from under("posterior", _posterior_lines(fit))
    rms, points = 100.0 * _number(fit, "residual_rms"), fit.variables["residual"].values.size
    yield "residual", f"{rms:.2g} % of the largest {load_of(fit)} (r.m.s. of {points} points)"
    if shifts := describe_shifts(fit):
        yield "model error", shifts
    if "aicc" in fit.variables:
        yield from _models(fit)
    yield "trust", str(fit.attrs["trust"])
    yield "computed", f"{_number(fit, 'evaluation_count'):.0f} laws in {format_seconds(_number(fit, 'run_time'))}"
    for text in str(fit.attrs.get("warnings", "")).splitlines():
        yield "warning", text
    failed = [(name, many.coordinates["failure"].values[i]) for i, name in enumerate(curve_names(many))]
    yield from under("failed", [f"{name}: {text}" for name, text in failed if text][:_SAID])


def _posterior_lines(fit: Labelled) -> Iterator[str]:
    """Yield the median and the 95 % interval of each parameter by its draws, and how many these are."""
    arrays = {key: fit.variables.get(f"{name}_posterior") for key, name in parameter_names(fit).items()}
    drawn = {key: array for key, array in arrays.items() if array is not None and array.values.size}
    for key, array in drawn.items():
        low, middle, high = np.quantile(array.values, [0.025, 0.5, 0.975]).tolist()
        digits = _digits(middle, 0.25 * (high - low))
        unit = str(fit.variables[parameter_names(fit)[key]].attrs["units"])
        ends = format_quantity(low, unit, to=high, digits=digits)
        yield f"{key:<{max(map(len, drawn))}}  {format_quantity(middle, unit, digits=digits)} ({ends})"
    if drawn:
        yield str(fit.attrs.get("posterior", "draws of an unknown number"))


def curve_names(fit: Labelled) -> list[str]:
    """Return the names of the curves of a fit of many."""
    return list(map(str, fit.coordinates["curve"].values)) if "curve" in fit.sizes else []


def typical(fit: Labelled) -> Labelled:
    """Return a fit of many curves as that of one: medians, sums of work, and intervals from 5 to 95 % of the curves."""
    names = parameter_names(fit).values()
    shares = {f"{name}_{end}": share for name in names for end, share in (("low", 5.0), ("high", 95.0))}

    def one(name: str, array: Array) -> Array:
        if array.dims[:1] != ("curve",):
            return array
        work = name in ("run_time", "evaluation_count")
        values = np.nansum(array.values, 0) if work else np.nanpercentile(array.values, shares.get(name, 50.0), 0)
        return array._replace(dims=array.dims[1:], values=values)

    return fit._replace(variables={name: one(name, array) for name, array in fit.variables.items()})


def _models(fit: Labelled) -> Iterator[tuple[str, str]]:
    """Yield a line for each adhesion model: how much worse than the best it is, or why it fails."""
    chosen = parse_toml(str(fit.attrs["scene"])).get("adhesion", {}).get("model", "none")
    numbers = [fit.variables[name].values for name in COMPARED]
    texts = [fit.coordinates[name].values for name in ("model_name", "model_failure")]
    for i, (name, failure, aicc, weight, tabor, size) in enumerate(zip(*texts, *numbers, strict=True)):
        worse = aicc - numbers[0].min()
        told = f"AICc +{worse:.3g}, weight {weight:.2g}, Tabor number {tabor:.3g}, residual {100.0 * size:.2g} %"
        yield "" if i else "models", f"{name:<7}  {failure or told + ', chosen' * (name == chosen)}"


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
    position = [*parameter_names(fit).values()].index(name)
    scale = float(fit.variables["parameter_scale"].values[position]) or _number(fit, name)
    return _number(fit, f"{name}_standard_error") > scale


def _number(fit: Labelled, name: str) -> float:
    return float(fit.variables[name].values)
