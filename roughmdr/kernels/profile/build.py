"""The kernels of asperities with any ``Profile``, put together.

Without adhesion and under JKR most is compiled once for all shapes (``any_shape``). Under adhesion with a range, where
loops by address are a seventh slower, and for profiles that are tables or series all is compiled for each shape.
"""

import math
from collections.abc import Callable
from typing import Any

from roughmdr.kernels.dugdale import (
    both_edges,
    branches as dugdale_branches,
    edges_table,
    equilibrium as dugdale_equilibrium,
    paraboloid,
    zone,
    zone_edge,
)
from roughmdr.kernels.profile import one_number
from roughmdr.kernels.profile.any_shape import OF_SHAPE, functions_by_address, of_any
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.kernels.profile.parts import (
    OCTAVES,
    OCTAVES_OF_EDGES,
    OCTAVES_OF_SIMILAR,
    VECTOR_CODE,
    constants_of,
    elastic_or_jkr,
    functions_of,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import UNCOMPILED, compiled, once, specialise
from roughmdr.shapes import Cone, Paraboloid, Shape, Sphere, TabledShape
from roughmdr.shapes.power_profiles import profile_of
from roughmdr.shapes.profile import Profile


def _no_t_of_q(q: float, params: Floats) -> float:
    """Stand for ``t_of_q`` where a profile has none."""
    return math.nan


# Shapes whose contacts have one stable branch under adhesion with a range, as 3000 random ones of each had.
_ONE_BRANCH = {Cone, Paraboloid, Sphere}
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


def _vector_code(
    shape: type[Shape], profile: Profile, plain: dict[str, Any], cohesive: bool
) -> dict[str, Callable[..., Any]]:
    """Return those functions of a profile that become vector code where inlined; look-ups in a table do not."""
    vector: dict[str, Callable[..., Any]] = {}
    tabled = issubclass(shape, TabledShape)
    if not (shape.shared or tabled):
        alone = ProfileKernels(f"{shape.name}_alone")
        vars(alone).update({name: compiled(plain[name], small=True) for name in ("mdr_profile", "reduced_load")})
        several = profile.precompute is not Profile._field_defaults["precompute"]
        vector = (
            dict(vars(alone))
            if several
            else {name: specialise(part, alone, small=True) for name, part in functions_of(one_number).items()}
        )
    if cohesive and profile.zone_integrals is not None:
        vector["zone_integrals"] = compiled(profile.zone_integrals, small=True)
    if not tabled:
        vector["kink_between"] = compiled(plain["kink_between"], small=True)
    return vector


@once
def build(shape: type[Shape], *, cohesive: bool, similar: bool = False) -> ProfileKernels:
    """Return the kernels of a shape that is not a flat punch; ``cohesive`` where adhesion has a range; ``similar`` for
    asperities without adhesion that share one row.
    """
    profile, tabled = profile_of(shape), issubclass(shape, TabledShape)
    shared = shape.shared or similar
    parts = elastic_or_jkr(similar)
    if cohesive:
        last = (paraboloid,) if shape is Paraboloid else (both_edges, edges_table)
        parts["state_by_search"] = parts["state_on_branch"]
        parts |= functions_of(zone, zone_edge, dugdale_equilibrium, dugdale_branches, *last)
        closed = parts.pop("gap_integrals_closed")
        if profile.zone_integrals is not None:
            parts["gap_integrals"] = closed
    plain: dict[str, Any] = profile._asdict()
    one_by_one = cohesive and shape is not Paraboloid
    octaves, node_size = (OCTAVES_OF_EDGES, 4) if one_by_one else (OCTAVES_OF_SIMILAR if similar else OCTAVES, 2)
    constants = {
        **constants_of(shared, similar, octaves, node_size),
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
    vector = _vector_code(shape, profile, plain, cohesive)
    inlined = whole.copy()
    small = VECTOR_CODE | (_VECTOR_CODE_OF_PARABOLOID if shape is Paraboloid else _INLINE_OF_EDGES)
    by_address = not (cohesive or tabled or shape.shared or UNCOMPILED)
    if by_address:
        whole.of_any, whole.functions = of_any(similar), functions_by_address(whole, inlined)
    for name, part in parts.items():
        if by_address and name not in OF_SHAPE:
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
