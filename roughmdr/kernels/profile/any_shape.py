"""Kernels of any shape, compiled once, which call the functions of a shape by addresses in its rows.

A call by address is for work once an asperity, or where steps do not lead to a state, or for a block of a sum.
"""

from collections.abc import Callable
from typing import Any, cast

from roughmdr.kernels.blocks import evaluate_all, find_by_steps, find_near
from roughmdr.kernels.profile import elastic, equilibrium
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.kernels.profile.layout import FUNCTIONS
from roughmdr.kernels.profile.parts import (
    OCTAVES,
    OCTAVES_OF_SIMILAR,
    VECTOR_CODE,
    constants_of,
    elastic_or_jkr,
    functions_of,
)
from roughmdr.numerics.jit import once, specialise
from roughmdr.numerics.numba_parts import Table, through_row

_ROW, _ROWS = "float64[::1]", "float64[:, ::1]"
_ONCE_EACH = {
    "mdr_profile": f"UniTuple(float64, 4)(float64, {_ROW})",
    "reduced_load": f"float64(float64, {_ROW})",
    "softening_count": f"int64({_ROW})",
    "softening_interval": f"UniTuple(float64, 2)(int64, {_ROW})",
    "kink": f"boolean(float64, float64, {_ROW})",
    "note_shape": f"void({_ROW})",
    "steepness": f"float64(float64, {_ROW})",
    "one_step_all": f"void(float64, {_ROWS}, {_ROWS})",
}
"""Functions of a shape that are called for an asperity, not at each step of a path, and their types."""
_IN_SUMS = {
    "one_step": f"UniTuple(float64, 3)(float64, float64, {_ROW})",
    "radius_force_stiffness": f"UniTuple(float64, 3)(float64, {_ROW})",
    "find_all": f"void(int64, {_ROWS}, {_ROWS})",
}
_OF_ENERGY = {"energy": f"float64(float64, {_ROW})"}
_BY_ADDRESS = _ONCE_EACH | _IN_SUMS | _OF_ENERGY
OF_SHAPE = {
    *functions_of(equilibrium, elastic),
    *("newton_step", "one_step", "two_steps", "approach", "one_step_all", "note_shape", "steepness", "state_of_radius"),
} - {"prepare", "y_of_x", "x_of_y", "relative_errors", "adhesion_terms"}
"""Parts that are compiled for each shape nevertheless."""


@once
def of_any(similar: bool) -> ProfileKernels:
    """Return the kernels that call the functions of a shape by address; ``similar`` as in ``build``."""
    whole = ProfileKernels("any_similar" if similar else "any")
    called = {name: through_row(i, FUNCTIONS, types) for i, (name, types) in enumerate(_BY_ADDRESS.items())}
    vars(whole).update(constants_of(similar, similar, OCTAVES_OF_SIMILAR if similar else OCTAVES, 2))
    for name, part in elastic_or_jkr(similar).items():
        inline = name in ("params_of", "shared_params")
        vars(whole)[name] = specialise(part, whole, inline=inline, small=part in VECTOR_CODE)
    vars(whole).update(called)
    if similar:
        whole.params_of = whole.shared_params
    return whole


def functions_by_address(whole: ProfileKernels, inlined: ProfileKernels) -> Callable[[bool, bool], float]:
    """Return ``Kernels.functions`` for kernels of a shape, and for those with the functions that become vector code."""

    def function(name: str) -> Callable[..., Any]:
        if name != "find_all":
            return cast(Callable[..., Any], getattr(whole, name))
        loops = inlined.copy()
        loops.evaluate_all = specialise(evaluate_all, inlined, inline=True)
        return specialise(find_near if whole.found_near else find_by_steps, loops)

    table = Table(function, _BY_ADDRESS)

    def address(summed: bool, energetic: bool) -> float:
        return table.address({*_ONCE_EACH, *(_IN_SUMS if summed else ()), *(_OF_ENERGY if energetic else ())})

    return address
