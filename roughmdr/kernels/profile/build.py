"""The kernels of asperities with any ``Profile``, put together.

What is called once an asperity, or where steps do not lead to a state, is compiled once for all shapes and calls their
profiles by address, and so are the loops of the sum, which call a function of the shape once a block. Under adhesion
with a range, where one evaluation costs as much as such a call, and for profiles that are tables all is compiled for
each shape.
"""

import inspect
import math
from collections.abc import Callable
from types import ModuleType
from typing import Any

from roughmdr.kernels import blocks
from roughmdr.kernels.dugdale import both_edges, edges_table, paraboloid, zone, zone_edge
from roughmdr.kernels.dugdale import branches as dugdale_branches
from roughmdr.kernels.dugdale import equilibrium as dugdale_equilibrium
from roughmdr.kernels.profile import branches, elastic, equilibrium, folds, initial_guess, newton, one_number, rows
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.kernels.profile.layout import FUNCTIONS, first_node
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.by_address import Table, through_row
from roughmdr.numerics.jit import UNCOMPILED, compiled, once, specialise
from roughmdr.shapes import Cone, Paraboloid, Shape, Sphere, TabledShape
from roughmdr.shapes.power_profiles import profile_of
from roughmdr.shapes.profile import Profile


def _no_t_of_q(q: float, params: Floats) -> float:
    """Stand for ``t_of_q`` where a profile has none."""
    return math.nan


_OCTAVES, _OCTAVES_OF_SIMILAR = 24, 40
_OCTAVES_OF_EDGES = 14  # a node costs as much as two visits
_SPLIT = 6  # times an octave of the initial guess is halved where all asperities share one row
# Shapes whose contacts have one stable branch under adhesion with a range, as 3000 random ones of each had.
_ONE_BRANCH = {Cone, Paraboloid, Sphere}
_VECTOR_CODE: set[Callable[..., Any]] = {
    equilibrium.indentation_at,
    equilibrium.radius_force_stiffness,
    elastic.y_of_x,
    elastic.x_of_y,
    elastic.indentation_at,
    elastic.contact_near,
    elastic.radius_force_stiffness,
    initial_guess.y_of_x,
    initial_guess.cubic,
    initial_guess.shortening,
    initial_guess.y_over_part,
    initial_guess.initial_guess,
    initial_guess.x_of_y,
    initial_guess.extrapolate_node,
    initial_guess.trusted,
    newton.newton_step,
    newton.one_step,
    newton.two_steps,
    newton.converged,
    equilibrium.adhesion_terms,
    equilibrium.relative_errors,
}
_INLINE_OF_EDGES: set[Callable[..., Any]] = {
    zone.gap_integrals_closed,
    zone_edge.contact_edge,
    zone_edge.gap_at,
    zone_edge.zone_guess,
    both_edges.newton_of_both,
}
_VECTOR_CODE_OF_PARABOLOID: set[Callable[..., Any]] = {
    paraboloid.zone_edge,
    paraboloid.gap_integrals,
    dugdale_equilibrium.state_along,
    dugdale_equilibrium.state_between,
    dugdale_equilibrium.indentation_at,
    dugdale_equilibrium.radius_force_stiffness,
}


def _functions(*modules: ModuleType) -> dict[str, Callable[..., Any]]:
    """Return the public functions of modules by name; those of later modules take the place of earlier ones."""
    return {
        name: function
        for module in modules
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and not name.startswith("_") and name != "build"
    }


_ROW, _ROWS, _EACH = "float64[::1]", "float64[:, ::1]", "float64[::1]"
_BY_ADDRESS = {
    "mdr_profile": f"UniTuple(float64, 4)(float64, {_ROW})",
    "reduced_load": f"float64(float64, {_ROW})",
    "softening_count": f"int64({_ROW})",
    "softening_interval": f"UniTuple(float64, 2)(int64, {_ROW})",
    "kink": f"boolean(float64, float64, {_ROW})",
    "note_shape": f"void({_ROW})",
    "step_nodes": f"int64(int64, int64, {_ROWS}, {_ROWS})",
    "one_step": f"UniTuple(float64, 3)(float64, float64, {_ROW})",
    "radius_force_stiffness": f"UniTuple(float64, 3)(float64, {_ROW})",
    "approach_all": f"void(int64, {_EACH}, {_EACH}, {_EACH}, {_ROWS})",
    "evaluate_all": f"void(int64, {_EACH}, {_EACH}, {_EACH}, {_EACH}, {_ROWS})",
    "near_all": f"void(int64, {_EACH}, {_EACH}, {_EACH}, {_EACH}, {_EACH}, {_EACH}, {_ROWS})",
    "energy": f"float64(float64, {_ROW})",
}
"""The functions of a shape that kernels of any shape call, and their types."""
_IN_SUMS = {"one_step", "radius_force_stiffness", "approach_all", "evaluate_all"}
_IN_SUMS_OF_SIMILAR = {"one_step", "radius_force_stiffness", "near_all"}
_OF_SHAPE = {
    *_functions(equilibrium, elastic),
    *("newton_step", "one_step", "two_steps", "approach", "note_shape", "step_nodes", "state_of_radius"),
} - {"prepare", "y_of_x", "x_of_y", "relative_errors", "adhesion_terms"}
"""Parts that are compiled for each shape all the same."""


def _constants(shared: bool, similar: bool, octaves: int, node_size: int) -> dict[str, Any]:
    """Return what kernels of all shapes have: how contacts are found, and the layout of rows."""
    split = _SPLIT if shared else 0
    return {
        "iterative": True,
        "found_together": True,
        "shared": shared,
        "found_near": similar,
        "octaves": octaves,
        "split": split,
        "first_node": first_node(octaves, split, node_size),
        "node_size": node_size,
    }


def _elastic_or_jkr(similar: bool) -> dict[str, Callable[..., Any]]:
    """Return the parts without adhesion, and of JKR; ``similar`` for asperities that share one row."""
    own = (elastic,) if similar else ()
    return _functions(folds, newton, initial_guess, branches, rows, equilibrium, *own)


@once
def _of_any(similar: bool) -> ProfileKernels:
    """Return the kernels that call the functions of a shape by address; ``similar`` as in ``build``."""
    whole = ProfileKernels("any_similar" if similar else "any")
    called = {name: through_row(i, FUNCTIONS, types) for i, (name, types) in enumerate(_BY_ADDRESS.items())}
    vars(whole).update(_constants(similar, similar, _OCTAVES_OF_SIMILAR if similar else _OCTAVES, 2))
    for name, part in _elastic_or_jkr(similar).items():
        inline = name in ("params_of", "shared_params")
        vars(whole)[name] = specialise(part, whole, inline=inline, small=part in _VECTOR_CODE)
    vars(whole).update(called)
    if similar:
        whole.params_of = whole.shared_params
    return whole


def _functions_of(whole: ProfileKernels, inlined: ProfileKernels, similar: bool) -> Callable[[bool, bool], float]:
    """Return ``Kernels.functions`` for kernels of a shape, and for those with the functions that become vector code."""
    in_sums = _IN_SUMS_OF_SIMILAR if similar else _IN_SUMS
    loops = {name: part for name, part in _functions(blocks).items() if name in in_sums}

    def function(name: str) -> Callable[..., Any]:
        return specialise(loops[name], inlined) if name in loops else getattr(whole, name)

    table, always = Table(function, _BY_ADDRESS), set(_BY_ADDRESS) - _IN_SUMS - _IN_SUMS_OF_SIMILAR - {"energy"}

    def address(summed: bool, energetic: bool) -> float:
        return table.address(always | (in_sums if summed else set()) | ({"energy"} if energetic else set()))

    return address


@once
def build(shape: type[Shape], *, cohesive: bool, similar: bool = False) -> ProfileKernels:
    """Return the kernels of a shape that is not a flat punch; ``cohesive`` where adhesion has a range; ``similar`` for
    asperities without adhesion that share one row.
    """
    profile, tabled = profile_of(shape), issubclass(shape, TabledShape)
    shared = shape.shared or similar
    parts = _elastic_or_jkr(similar)
    if cohesive:
        last = (paraboloid,) if shape is Paraboloid else (both_edges, edges_table)
        parts["state_by_search"] = parts["state_on_branch"]
        parts |= _functions(zone, zone_edge, dugdale_equilibrium, dugdale_branches, *last)
        closed = parts.pop("gap_integrals_closed")
        if profile.zone_integrals is not None:
            parts["gap_integrals"] = closed
    plain: dict[str, Any] = profile._asdict()
    one_by_one = cohesive and shape is not Paraboloid
    octaves, node_size = (_OCTAVES_OF_EDGES, 4) if one_by_one else (_OCTAVES_OF_SIMILAR if similar else _OCTAVES, 2)
    constants = {
        **_constants(shared, similar, octaves, node_size),
        **{name: plain.pop(name) for name in ("corner", "flat", "end")},
        "has_t_of_q": profile.t_of_q is not None,
        "terms_cancel": profile.term_sizes is not None,
        "stride": 2.0 if shape in _ONE_BRANCH else math.sqrt(2.0),
        "softens": shape.branched(),
        "of_pieces": tabled or shape.shared,
        "one_by_one": one_by_one,
        "adhesive": cohesive,
        "branched": cohesive,
        "cohesive": cohesive,
    }
    plain["t_of_q"] = profile.t_of_q or _no_t_of_q
    parts["approach"] = parts["one_step" if shared else "two_steps"]
    plain["kink_between"] = parts.pop("kink_between", profile.kink)
    if cohesive:
        plain["kink"] = parts.pop("kink")
    if profile.elastic_integral is not None:
        parts.pop("elastic_integral")
    whole = ProfileKernels(f"dugdale_{shape.name}" if cohesive else f"{shape.name}_similar" if similar else shape.name)
    vars(whole).update(constants, **{name: compiled(part) for name, part in plain.items() if part is not None})
    # What a table looks up is no vector code.
    vector: dict[str, Callable[..., Any]] = {}
    if not (shape.shared or tabled):
        alone = ProfileKernels(f"{shape.name}_alone")
        vars(alone).update({name: compiled(plain[name], small=True) for name in ("mdr_profile", "reduced_load")})
        several = profile.precompute is not Profile._field_defaults["precompute"]
        vector = (
            dict(vars(alone))
            if several
            else {name: specialise(part, alone, small=True) for name, part in _functions(one_number).items()}
        )
    if cohesive and profile.zone_integrals is not None:
        vector["zone_integrals"] = compiled(profile.zone_integrals, small=True)
    if not tabled:
        vector["kink_between"] = compiled(plain["kink_between"], small=True)
    inlined = whole.copy()
    small = _VECTOR_CODE | (_VECTOR_CODE_OF_PARABOLOID if shape is Paraboloid else _INLINE_OF_EDGES)
    by_address = not (cohesive or tabled or shape.shared or UNCOMPILED)
    if by_address:
        whole.of_any, whole.functions = _of_any(similar), _functions_of(whole, inlined, similar)
    for name, part in parts.items():
        if by_address and name not in _OF_SHAPE:
            vars(whole)[name] = getattr(whole.of_any, name)
            continue
        kernels = inlined if part in small else whole
        inline = name in ("params_of", "shared_params")
        vars(whole)[name] = specialise(part, kernels, inline=inline, small=part in small)
    whole.state_of_force = whole.state  # of a row under dead load
    if shared:
        whole.params_of = whole.shared_params
    if shape.shared:
        whole.prepare = whole.prepare_shared
    if tabled:
        whole.prepare = whole.prepare_tabled
    vars(inlined).update({**vars(whole), **vector})
    return whole
