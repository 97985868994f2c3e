"""f, f', g and G of a ``Profile`` over arrays of radii; compiled, so that it is imported when it is first used."""

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import two_product
from roughmdr.numerics.jit import compiled, once, specialise
from roughmdr.shapes.profile import Params, Profile


class _Kernel(ModuleType):
    f_and_slope: Callable[..., tuple[float, float]]


kernel = _Kernel("kernel")
"""Stands for the kernel of the loop, until ``specialise`` puts a profile's in its place."""


def _loop(r: Floats, width: Floats, rise: Floats, params: Floats, f: Floats, slope: Floats) -> None:
    """Fill f [m] and f' [1].

    f is corrected for the rounding of r/width: next to the edge of a flat it is no larger than that.
    """
    for i in range(r.size):
        k = min(i, width.size - 1)
        scaled = r[i] / width[k]
        product, error = two_product(scaled, width[k])
        rounding = ((r[i] - product) - error) / width[k]
        value, steepness = kernel.f_and_slope(scaled, params[k])
        f[i] = rise[k] * (value + (steepness * rounding if rounding != 0.0 else 0.0))
        slope[i] = rise[k] / width[k] * steepness


@once
def _compiled_loop(profile: Profile, name: str) -> Callable[..., Any]:
    kernels = _Kernel(name)
    kernels.f_and_slope = compiled(profile.f_and_slope)
    return specialise(_loop, kernels)


def f_and_slopes(profile: Profile, name: str, columns: tuple[Any, Any, Any], r: Floats) -> tuple[Floats, Floats]:
    """Return f [m] and f' [1] at radii r [m] of one asperity, or of one each; columns are width, rise, params."""
    width, rise, params = (np.atleast_1d(np.asarray(column, dtype=np.float64)) for column in columns)
    f, slope = np.empty(r.size), np.empty(r.size)
    _compiled_loop(profile, name)(np.ravel(r), width, rise, params.reshape(width.size, -1), f, slope)
    return f.reshape(r.shape), slope.reshape(r.shape)


def g(profile: Profile, name: str, columns: tuple[float, float, Any], x: Floats) -> Floats:
    """Return g [m] at x [m]; OutOfRange where that is not finite."""
    mdr_profile = compiled(profile.mdr_profile)
    return _at_radii(profile, name, columns, x, lambda t, params: float(mdr_profile(t, params)[2]))


def G(profile: Profile, name: str, columns: tuple[float, float, Any], radii: Floats) -> Floats:
    """Return G [m2] at contact radii [m]; OutOfRange where that is not finite."""
    if profile.mdr_integral is not None:
        return np.asarray(columns[0] * _at_radii(profile, name, columns, radii, compiled(profile.mdr_integral)))
    mdr_profile, reduced_load = compiled(profile.mdr_profile), compiled(profile.reduced_load)

    def integral(t: float, params: Params) -> float:
        a, _, depth, _ = mdr_profile(t, params)
        return float(a * depth - reduced_load(t, params))

    return np.asarray(columns[0] * _at_radii(profile, name, columns, radii, integral))


def _at_radii(
    profile: Profile, name: str, columns: tuple[float, float, Any], radii: Floats, value: Callable[[float, Any], float]
) -> Floats:
    """Return the rise times ``value`` at contact radii [m]; 0 on the flat."""
    width, rise, params = columns
    numbers, t_of_radius = np.atleast_1d(np.asarray(params, dtype=np.float64)), compiled(profile.t_of_radius)
    begin = width if profile.flat else 0.0
    values = [value(t_of_radius(a, width, numbers), numbers) if a > begin else 0.0 for a in radii.flat]
    results = np.asarray(rise * np.array(values, dtype=np.float64).reshape(radii.shape))
    if not np.isfinite(results).all():
        worst = radii[~np.isfinite(results)].flat[0]
        raise OutOfRange(f"{name}: a radius of {worst:g} m lies beyond what it can touch, or a float can hold")
    return results
