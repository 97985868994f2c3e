"""All variables of a result where its curves first reach a force, a pressure, a contact fraction or a separation.

A reference by boundary elements has the error of its grid there. At given force that is the error of the cells at the
edges of contacts alone: that of the contact area, and half of it in the stiffness, which goes with the root of the area
of a contact. At anything else the error of what is given is added in quadrature: at given separation, or a quantity of
the asperities, that of the force; at given area its own.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roughmdr.errors import OutOfRange
from roughmdr.model_error.parts import PLASTIC
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.result.between import AT_A_PLACE, CONFIDENCE, REACH, off_line
from roughmdr.result.curves import PER_AREA, Branch, Read, apply, curve, result_of, stored_curves
from roughmdr.result.model_errors import LOADS, errors_there, lowest_so_far
from roughmdr.result.view import ResultView
from roughmdr.schema.arguments import check_values
from roughmdr.stages.reference import OF_AREA
from roughmdr.variables import LAW_VARIABLES, MODEL_ERROR, SEPARATION

if TYPE_CHECKING:
    import xarray as xr

_IN_JUMPS = ("contact_count", "dissipated_energy", "machine_dissipated_energy")
"""Curves that are constant between jumps."""
_FORCE, _H = "reference_force", SEPARATION.name


def at_value(dataset: "xr.Dataset", name: str, values: ArrayLike, branch: str) -> "xr.Dataset":
    """Return all curves, and the separation, where that of ``name`` first reaches ``values`` on a branch."""
    import xarray as xr

    result = result_of(dataset)
    units = (LAW_VARIABLES | {SEPARATION.name: SEPARATION})[name].units
    wanted = check_values(name, values, units)
    if not np.size(wanted):
        raise OutOfRange(f"{name} is empty; give at least one value")
    if name.endswith("contact_fraction") and np.max(wanted) > 1.0:
        raise OutOfRange(f"{name} is {np.max(wanted):g}; it must be at most 1")
    on = Branch(result, branch)
    own = name.removeprefix("reference_")
    beside = " with reference=True" if own != name else ""
    reached = curve(result, name, f"at_{own}{beside} needs")
    path = curve(result, result.control)
    points = xr.DataArray(np.atleast_1d(wanted), dims=name)
    brackets = apply(_brackets, reached, points, core=[["step"], [name]], out=[[name]] * 3, branch=on)
    found, read = dict[str, xr.DataArray](), dict[str, Read]()
    curves = {name: reached} | _curves(result, name)
    if PLASTIC in result.variables:
        curves[LOADS] = lowest_so_far(curve(result, SEPARATION.name))
    for label, array in curves.items():
        value, error, rise = apply(
            _interpolate,
            *(array, reached, path, *brackets),
            core=[["step"]] * 3 + [[name]] * 3,
            out=[[name]] * 3,
            branch=on,
            in_jumps=label.removesuffix("_mean") in _IN_JUMPS,
        )
        read[label.removesuffix("_mean")] = Read(label, value, rise)
        if label in (name, LOADS):
            continue
        attrs = {key: array.attrs[key] for key in ("units", "long_name") if key in array.attrs}
        about = {"long_name": f"interpolation error of the {attrs['long_name']}"}
        found[label] = value.assign_attrs(attrs | {"ancillary_variables": f"{label}_interpolation_error"})
        found[f"{label}_interpolation_error"] = error.assign_attrs(attrs | about)
    for label, error in errors_there(result, name, curves, read).items():
        found[label].attrs["ancillary_variables"] += f" {label}{MODEL_ERROR}"
        found[f"{label}{MODEL_ERROR}"] = error
    found |= grid_errors(read, name)
    coordinate = (name, points.values, {"units": units, "long_name": LAW_VARIABLES[name].long_name})
    points_found = xr.Dataset(found, attrs=_attributes(dataset, name, branch)).assign_coords({name: coordinate})
    return points_found if np.ndim(wanted) else points_found.isel({name: 0})


def _curves(result: ResultView, name: str) -> "dict[str, xr.DataArray]":
    """Return the separation, all curves, and those that follow from them, but those of ``name`` itself."""
    curves = {each: curve(result, each) for each in dict.fromkeys([result.control, *stored_curves(result)])}
    suffix = "_mean" if result.keeps_statistics else ""
    for derived, total in PER_AREA.items() if "nominal_area" in result.variables else ():
        if not {total, f"{total}{suffix}"}.isdisjoint(curves) and {derived, f"{derived}{suffix}"}.isdisjoint(curves):
            curves[f"{derived}{suffix}" if f"{total}{suffix}" in curves else derived] = curve(result, derived)
    if SEPARATION.name not in curves and f"{SEPARATION.name}_mean" not in curves:
        curves = {SEPARATION.name: curve(result, SEPARATION.name), **curves}
    return {each: array for each, array in curves.items() if each.removesuffix("_mean") != name}


def _attributes(dataset: "xr.Dataset", name: str, branch: str) -> dict[str, str]:
    """Return the attributes of the interpolated values."""
    missing = f"no value where the {branch} never reaches the {name.replace('_', ' ')}, or from steps without a value"
    about = {
        "branch": branch,
        "comment": f"where it is first reached, by linear interpolation between steps; {missing}; "
        f"interpolation errors, jumps between steps included, hold in {100 * CONFIDENCE:g} % of cases",
    }
    return {key: dataset.attrs[key] for key in ("title",) if key in dataset.attrs} | about


def _brackets(curve: Floats, values: Floats, *, branch: Branch) -> tuple[Floats, ...]:
    """Return the brackets in which curves [..., step] first reach values [value]; NaN where they never do.

    A bracket is two steps, and the position of the value from the first (0) to the second (1): each [..., value].
    """
    before, filled, usable = _joined(curve, branch)
    brackets = (_first(filled, value, before, usable) for value in values)
    return tuple(np.stack(part, axis=-1) for part in zip(*brackets, strict=True))


def _joined(y: Floats, branch: Branch) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Return, for each step but the first, the last one before it with a value, the curve, and whether the leg holds
    both; steps without a value have that of the last step with one.
    """
    number = np.arange(y.shape[-1])
    missing = np.isnan(y)
    if not missing.any():
        return number[:-1], y, branch.wanted[1:]
    last = np.maximum.accumulate(np.where(missing, 0, number), axis=-1)
    before = last[..., :-1]
    return before, np.take_along_axis(y, last, axis=-1), branch.wanted[1:] & (before >= branch.start[1:])


def _first(y: Floats, value: float, before: Ints, usable: NDArray[np.bool_]) -> Floats:
    """Return the first bracket of a value on each curve: [part, ...]."""
    if y.shape[-1] < 2:
        return np.full((3, *y.shape[:-1]), np.nan)
    below, above = y <= value, y >= value
    crossed = (below[..., :-1] & above[..., 1:]) | (above[..., :-1] & below[..., 1:])
    crossed &= usable
    at = crossed.argmax(axis=-1)
    reached = np.take_along_axis(crossed, at[..., None], axis=-1)[..., 0]
    lower = before[at] if before.ndim == 1 else np.take_along_axis(before, at[..., None], axis=-1)[..., 0]
    first, second = (np.take_along_axis(y, step[..., None], axis=-1)[..., 0] for step in (lower, at + 1))
    rise = second - first
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = np.where(rise == 0.0, 0.0, (value - first) / rise)
    return np.where(reached, np.stack([lower, at + 1, fraction]), np.nan)


def _interpolate(
    curve: Floats, reached: Floats, path: Floats, *bracket: Floats, branch: Branch, in_jumps: bool
) -> tuple[Floats, Floats, Floats]:
    """Return curves at a bracket of curves that are ``reached`` for each value, their errors and changes there.

    Curves and the ``path``, the controlled quantity, are [..., step]; the bracket and the returned arrays [..., value].
    A bracket gives a line, the curve over the reached one. The error is the deviation of the curve from that line
    between the steps; for a curve that changes ``in_jumps`` only, and where too few steps are known, the difference to
    the farther step.
    """
    fraction = bracket[2]
    known = ~np.isnan(fraction)
    lower, upper = (np.where(known, step, 0.0).astype(np.int64) for step in bracket[:2])
    first, second = (_at(curve, step[..., None])[..., 0] for step in (lower, upper))
    rise = second - first
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(known, np.where(fraction == 0.0, first, first + fraction * rise), np.nan)
        error = np.maximum(np.abs(first - value), np.abs(second - value))
        if not in_jumps:
            near, there = _near(lower, upper, branch)
            way = _at(reached, near)
            over = way[..., REACH + 1] - way[..., REACH]
            slope = np.where(over == 0.0, 0.0, rise / over)[..., None]
            around = np.where(there, _at(curve, near) - slope * way, np.nan)
            off = sum(off_line(_at(path, near), around, spreads=AT_A_PLACE))
            error = np.where(np.isnan(off), error, off)
    return value, np.where(np.isnan(value), np.nan, error), np.where(known, rise, np.nan)


def _near(lower: Ints, upper: Ints, branch: Branch) -> tuple[Ints, NDArray[np.bool_]]:
    """Return the steps around brackets, [..., value, step], and whether the leg of the bracket has each."""
    away = np.arange(REACH + 1)
    steps = np.concatenate([lower[..., None] - away[::-1], upper[..., None] + away], axis=-1)
    near = np.clip(steps, 0, branch.start.size - 1)
    start = branch.start[upper][..., None]
    return near, (near == steps) & (near >= start) & ((near <= upper[..., None]) | (branch.start[near] == start))


def _at(curve: Floats, steps: Ints) -> Floats:
    """Return curves [..., step] at steps [..., value, step]."""
    runs, points = steps.shape[:-2], steps.shape[-2:]
    count = max(curve.ndim - 1, len(runs))
    flat = steps.reshape((1,) * (count - len(runs)) + (*runs, -1))
    taken = np.take_along_axis(curve.reshape((1,) * (count + 1 - curve.ndim) + curve.shape), flat, axis=-1)
    return np.asarray(taken.reshape(*taken.shape[:-1], *points))


def grid_errors(read: dict[str, Read], at: str) -> "dict[str, xr.DataArray]":
    """Return ``reference_NAME_error`` of curves that are read where that of ``at`` has a value.

    The separation has one where ``at`` is of the reference. No value where the grid may have missed all contacts.
    """
    if not {_FORCE, "reference_error", "reference_area_error"} <= read.keys():
        return {}
    force, relative = read[_FORCE].value, read["reference_error"].value
    of_force = (relative * force).where((force > 0.0) | (relative == 0.0))

    def slope(name: str, over: str) -> "xr.DataArray":
        run, base = read[over].rise, read[over].value
        where_path_turns = read[name].value / base.where(base > 0.0, np.inf) if name in OF_AREA else np.nan
        return abs(read[name].rise / run.where(run != 0.0)).where(run != 0.0, where_path_turns)

    def own(name: str) -> "xr.DataArray":
        if name == _H:
            return slope(_H, _FORCE) * of_force
        return OF_AREA[name] * read["reference_area_error"].value * read[name].value

    of_reference = at in OF_AREA
    over, given = (at, own(at)) if of_reference else (_FORCE, of_force)
    errors = {}
    for name in sorted((read.keys() & {*OF_AREA, *([_H] * of_reference)}) - {at}):
        total = (own(name) ** 2 + (slope(name, over) * given) ** 2) ** 0.5
        total *= OF_AREA.get(name) != OF_AREA.get(at)  # pressure follows from force, the fraction from the area
        about = f"error of the {name.removeprefix('reference_').replace('_', ' ')} by the grid of boundary elements"
        total.attrs = {"units": LAW_VARIABLES[name].units, "long_name": about}
        errors[f"reference_{read[name].label.removeprefix('reference_')}_error"] = total
    return errors
