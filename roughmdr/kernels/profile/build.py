"""The kernels of asperities with any ``Profile``, put together; and the rows that they read, filled once for each."""

import inspect
import math
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from roughmdr.kernels.dugdale import both_edges, edges_table, paraboloid, zone, zone_edge
from roughmdr.kernels.dugdale import branches as dugdale_branches
from roughmdr.kernels.dugdale import equilibrium as dugdale_equilibrium
from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile import branches, elastic, equilibrium, folds, initial_guess, newton, one_number
from roughmdr.kernels.profile.interface import ProfileKernels, law
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, NUMBER, RANGE, STRENGTH, TENSION, first_node
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import compiled, once, specialise
from roughmdr.shapes import Cone, Paraboloid, Shape, Sphere, TabledShape
from roughmdr.shapes.power_profiles import profile_of
from roughmdr.shapes.profile import Profile


def fill_params(material: Material, width: float, rise: float, control: float, params: Floats) -> None:
    """Fill the row of one asperity, in which the parameters of its shape stand already."""
    modulus, work, strength = material
    params[TENSION] = math.sqrt(2.0 * math.pi * work) / math.sqrt(modulus) * math.sqrt(width) / rise
    params[CONTROL], params[NUMBER] = control, params[0]
    params[STRENGTH], params[RANGE] = 2.0 * strength / modulus * width / rise, work / strength / rise
    law.precompute(params)
    law.find_branches(params)


def repeated(columns: Columns, i: int) -> bool:
    """Return whether asperity i > 0 is like the one before."""
    width, rise, params = columns
    return bool(width[i] == width[i - 1] and rise[i] == rise[i - 1] and params[i] == params[i - 1])


def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return a row for each of the asperities from start to stop; the branches of those like the one before are not
    sought again.
    """
    rows, last = np.zeros((stop - start, 2 - law.first_node)), 0
    for i in range(stop - start):
        if i > 0 and law.repeated(columns, start + i):
            for j in range(rows.shape[1]):
                rows[i, j] = rows[i - 1, j]
            continue
        rows[i, 0] = columns.params[start + i]
        law.fill_params(material, columns.width[start + i], columns.rise[start + i], control, rows[i])
        last = max(last, law.node_beyond(deepest / columns.rise[start + i], rows[i]))
    law.fill_nodes(last, rows)
    return rows


def prepare_tabled(
    material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float
) -> Floats:
    """Return as ``prepare`` where the params of an asperity are a row themselves."""
    size = columns.params.shape[1]
    rows, last = np.zeros((stop - start, size - law.first_node)), 0
    for i in range(stop - start):
        rows[i, :size] = columns.params[start + i]
        law.fill_params(material, columns.width[start + i], columns.rise[start + i], control, rows[i])
        last = max(last, law.node_beyond(deepest / columns.rise[start + i], rows[i]))
    law.fill_nodes(last, rows)
    return rows


def prepare_shared(
    material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float
) -> Floats:
    """Return the one row of asperities that are all alike."""
    size = columns.params.shape[1]
    rows = np.zeros((1, size - law.first_node))
    rows[0, :size] = columns.params[0]
    law.fill_params(material, columns.width[0], columns.rise[0], control, rows[0])
    law.fill_nodes(law.node_beyond(deepest / columns.rise[0], rows[0]), rows)
    return rows


def params_of(rows: Floats, i: int) -> Floats:
    """Return the row of one asperity."""
    return rows[i]


def shared_params(rows: Floats, i: int) -> Floats:
    """Return the row of all asperities."""
    return rows[0]


def scales(
    effective_modulus: float, work: float, width: float, rise: float, params: Floats
) -> tuple[Pair, float, float, float]:
    """Return the natural depth [m], radius [m], force [N] and stiffness [N/m]; depth 0 where there is no contact."""
    depth = rise * params[DEPTH] if params[COUNT] > 0.0 else 0.0
    return (depth, 0.0), width, 2.0 * effective_modulus * width * rise, 2.0 * effective_modulus * width


def force_scales(
    effective_modulus: float, work: float, width: float, rise: float, params: Floats
) -> tuple[Pair, float]:
    """Return the pull-off force [N], DEPTH of a row under dead load in SI, and the width [m]."""
    return ((2.0 * effective_modulus * width * rise * params[DEPTH] if params[COUNT] > 0.0 else 0.0), 0.0), width


def state_of_radius(radius: float, width: float, params: Floats) -> float:
    """Return t at a contact radius [m]."""
    return law.t_of_radius(radius, width, params)


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


@once
def build(shape: type[Shape], *, cohesive: bool, similar: bool = False) -> ProfileKernels:
    """Return the kernels of a shape that is not a flat punch; ``cohesive`` where adhesion has a range; ``similar`` for
    asperities without adhesion that share one row.
    """
    profile, tabled = profile_of(shape), issubclass(shape, TabledShape)
    shared = shape.shared or similar
    parts = _functions(folds, newton, initial_guess, branches, inspect.getmodule(build) or ModuleType(""), equilibrium)
    if cohesive:
        last = (paraboloid,) if shape is Paraboloid else (both_edges, edges_table)
        parts["state_by_search"] = parts["state_on_branch"]
        parts |= _functions(zone, zone_edge, dugdale_equilibrium, dugdale_branches, *last)
        closed = parts.pop("gap_integrals_closed")
        if profile.zone_integrals is not None:
            parts["gap_integrals"] = closed
    if similar:
        parts |= _functions(elastic)
    plain: dict[str, Any] = profile._asdict()
    one_by_one = cohesive and shape is not Paraboloid
    octaves, node_size = (_OCTAVES_OF_EDGES, 4) if one_by_one else (_OCTAVES_OF_SIMILAR if similar else _OCTAVES, 2)
    split = _SPLIT if shared else 0
    constants = {
        **{name: plain.pop(name) for name in ("corner", "flat", "end")},
        "has_t_of_q": profile.t_of_q is not None,
        "terms_cancel": profile.term_sizes is not None,
        "stride": 2.0 if shape in _ONE_BRANCH else math.sqrt(2.0),
        "iterative": True,
        "found_together": True,
        "octaves": octaves,
        "shared": shared,
        "found_near": similar,
        "of_pieces": tabled or shape.shared,
        "split": split,
        "first_node": first_node(octaves, split, node_size),
        "node_size": node_size,
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
    for name, part in parts.items():
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
