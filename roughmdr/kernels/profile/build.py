"""The law of asperities with any ``Profile``: what is found out once for each, and the kernels put together."""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np

from roughmdr.kernels.dugdale import branches as dugdale_folds
from roughmdr.kernels.dugdale import equilibrium as dugdale
from roughmdr.kernels.dugdale import paraboloid as dugdale_paraboloid
from roughmdr.kernels.dugdale import zone
from roughmdr.kernels.dugdale import zone_edge as margins
from roughmdr.kernels.profile import branches, folds
from roughmdr.kernels.profile import equilibrium as balance
from roughmdr.kernels.profile import initial_guess as start
from roughmdr.kernels.profile import newton as root
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, RANGE, STRENGTH, TENSION, first_node
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import compiled, specialise
from roughmdr.numerics.vector_math import atan, binade_cell, q_minus_atan
from roughmdr.shapes import Paraboloid, Shape
from roughmdr.shapes.base import ProfileShape
from roughmdr.shapes.power_profiles import profile_of

# Names that ``specialise`` fills.
NODE: int
_place: Callable[..., float]
_ready: Callable[..., None]
find_branches: Callable[..., None]
find_starts: Callable[..., None]


def fill(
    effective_modulus: float, work: float, strength: float, width: float, rise: float, control: float, row: Floats
) -> None:
    """The row of one asperity, whose numbers of the shape stand in it already."""
    row[TENSION] = math.sqrt(2.0 * math.pi * work) / math.sqrt(effective_modulus) * math.sqrt(width) / rise
    row[CONTROL] = control
    row[STRENGTH], row[RANGE] = 2.0 * strength / effective_modulus * width / rise, work / strength / rise
    _ready(row)
    find_branches(row)


def prepare(
    effective_modulus: float,
    work: float,
    strength: float,
    width: Floats,
    rise: Floats,
    form: Floats,
    start: int,
    stop: int,
    control: float,
) -> Floats:
    """A row for each of the asperities from start to stop."""
    rows = np.zeros((stop - start, 2 - NODE))
    for i in range(stop - start):
        rows[i, 0] = form[start + i]
        fill(effective_modulus, work, strength, width[start + i], rise[start + i], control, rows[i])
    find_starts(rows)
    return rows


def prepare_common(
    effective_modulus: float,
    work: float,
    strength: float,
    width: Floats,
    rise: Floats,
    form: Floats,
    start: int,
    stop: int,
    control: float,
) -> Floats:
    """The one row of asperities that are all alike."""
    rows = np.zeros((1, form.shape[1] - NODE))
    rows[0, : form.shape[1]] = form[0]
    fill(effective_modulus, work, strength, width[0], rise[0], control, rows[0])
    find_starts(rows)
    return rows


def own(rows: Floats, i: int) -> Floats:
    """The row of one asperity."""
    return rows[i]


def common(rows: Floats, i: int) -> Floats:
    """The row of all asperities."""
    return rows[0]


def natural(
    effective_modulus: float, work: float, width: float, rise: float, row: Floats
) -> tuple[Pair, float, float, float]:
    """Depth [m], radius [m], force [N] and stiffness [N/m] in which the contact is measured; 0 where there is none."""
    depth = rise * row[DEPTH] if row[COUNT] > 0.0 else 0.0
    return (depth, 0.0), width, 2.0 * effective_modulus * width * rise, 2.0 * effective_modulus * width


def natural_force(effective_modulus: float, work: float, width: float, rise: float, row: Floats) -> tuple[Pair, float]:
    """The depth of a row under dead load [N], and the width [m]."""
    return ((2.0 * effective_modulus * width * rise * row[DEPTH] if row[COUNT] > 0.0 else 0.0), 0.0), width


def state_of_radius(radius: float, width: float, row: Floats) -> float:
    """t at a contact radius [m]."""
    return _place(radius, width, row)


_SPLIT = 5  # times an octave of the first guess is halved where all asperities share one row
_PASSES, _PASSES_OF_SPLIT = 3, 1  # of Newton's method, after which nine in ten contacts have arrived
_VECTOR_CODE = (
    balance.stretched,
    balance.answer,
    start.scale,
    start.guess,
    start.place,
    start.extrapolated,
    root.nearer,
    root.arrived,
)
_VECTOR_CODE_OF_PARABOLOID = (
    dugdale_paraboloid.margins,
    dugdale_paraboloid.zone,
    dugdale.along,
    dugdale.stretched,
    dugdale.answer,
)
_ENDS = (fill, prepare, prepare_common, own, common, natural, natural_force)
_SEARCH = (*root.PARTS, *start.PARTS, *branches.PARTS)


def _parts(shape: type[Shape], cohesive: bool) -> tuple[Callable[..., Any], ...]:
    """What the kernels are made of, each after what it is made of itself."""
    if not cohesive:
        return (*balance.PARTS, *folds.PARTS, *_SEARCH, *_ENDS, state_of_radius)
    zone_and_margins = (*zone.PARTS, *margins.PARTS)
    if shape is Paraboloid:
        closed = dugdale_paraboloid
        zone_and_margins = (
            zone.widest,
            *closed.PARTS,
            margins.find_junction,
            margins.opened,
            margins.extent,
            *closed.AFTER,
        )
    search = (*folds.LISTING, *dugdale_folds.PARTS, *_SEARCH)
    return (balance.strain, *zone_and_margins, *dugdale.PARTS, *search, *_ENDS)


@cache
def build(shape: type[Shape], cohesive: bool) -> dict[str, Any]:
    """The kernels of a shape, by the names that ``Law`` has for them; ``cohesive`` where adhesion has a range."""
    profile, shared = profile_of(shape), issubclass(shape, ProfileShape) and shape.common
    split = _SPLIT if shared else 0
    kernels: dict[str, Any] = {
        "_curve": compiled(profile.mdr_profile),
        "_push": compiled(profile.reduced_load),
        "_place": compiled(profile.t_of_radius),
        "_height": compiled(profile.f_and_slope),
        "_dip_count": compiled(profile.softening_count),
        "_dip": compiled(profile.softening_interval),
        "_kink": compiled(dugdale.kink if cohesive else profile.kink),
        "_edge_count": compiled(profile.breakpoint_count),
        "_edge": compiled(profile.breakpoint),
        "_ready": compiled(profile.precompute),
        "_roundings": compiled(profile.roundings),
        "magnitude": None if profile.term_sizes is None else compiled(profile.term_sizes),
        "_beyond": None if profile.t_of_q is None else compiled(profile.t_of_q),
        "_corner": profile.corner,
        "_flat": profile.flat,
        "_end": profile.end,
        "_STRIDE": 2.0 if shape is Paraboloid else math.sqrt(2.0),
        "binade_cell": compiled(binade_cell, small=True),
        "atan": compiled(atan, small=True),
        "q_minus_atan": compiled(q_minus_atan, small=True),
        "SPLIT": split,
        "NODE": first_node(split),
        "passes": _PASSES_OF_SPLIT if shared else _PASSES,
    }
    # What a table looks up is no vector code.
    vector = {} if shared else {"_curve": profile.mdr_profile, "_push": profile.reduced_load}
    small = {name: compiled(part, small=True) for name, part in vector.items()}
    forced = (*_VECTOR_CODE, *(_VECTOR_CODE_OF_PARABOLOID if shape is Paraboloid else ()))
    for part in _parts(shape, cohesive):
        known = (
            compiled(profile.elastic_integral)
            if part is balance.strain and profile.elastic_integral is not None
            else None
        )
        kernels[part.__name__] = known or specialise(
            cast(FunctionType, part),
            f"dugdale_{shape.name}" if cohesive else shape.name,
            {**kernels, **small} if part in forced else kernels,
            inline=part in (own, common),
            small=part in forced,
        )
    kernels["state_of_force"] = kernels["state"]
    if shared:
        kernels |= {"prepare": kernels["prepare_common"], "own": kernels["common"]}
    return kernels
