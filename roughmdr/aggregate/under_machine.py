"""The separations of a flat on a machine, from the demand of the machine at each step."""

import math

import numpy as np

from roughmdr.aggregate import machine_stand, response
from roughmdr.aggregate.block import SumKernels
from roughmdr.aggregate.loop import compiled_sum
from roughmdr.aggregate.machine_jumps import record, through_jumps
from roughmdr.aggregate.machine_stand import Jumps, Search, Stand, stand_at
from roughmdr.aggregate.passage import passage, sink
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.response import stand
from roughmdr.errors import OutOfRange
from roughmdr.kernels.interface import Kernels
from roughmdr.loading.machine import Jump, Machine, legs_of
from roughmdr.loading.staircase import staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import as_argument, njit, once, specialise
from roughmdr.numerics.underway import filling

_BESIDE = 4.0  # distance from a detachment at which it is certainly passed [rounding]
_NONE = np.zeros(0)


@once
def _compiled(kernels: Kernels) -> SumKernels:
    """Return the kernels with the parts of the response, compiled with them."""
    whole = SumKernels(kernels.name)
    of_sum = vars(compiled_sum(kernels, energetic=False))
    vars(whole).update({**of_sum, "__name__": kernels.name, "hardening": kernels.hardening})
    for part in (response.block_at, response.add_response, response.response):
        vars(whole)[part.__name__] = specialise(part, whole)
    return whole


def separations_of(
    problem: Problem, machine: Machine, demand: Floats, *, jumps: bool = False
) -> tuple[Floats, list[Jump]]:
    """Return the separation [m] at each demand of a machine whose flat comes from infinity; inf where it has flown off.

    Return its ``jumps`` too if they are asked for. OutOfRange where a contact is not representable.
    """
    found, height, adhesion = list[Jump](), problem.ensemble.height, problem.adhesion
    if not height.size:
        return (demand if machine.weight > 0.0 else np.full(demand.size, np.inf)), found
    kernels, columns = problem.kernels, problem.ensemble.columns
    material = kernels.material(problem.effective_modulus, adhesion)
    touches = releases = _NONE
    release = height
    if kernels.adhesive:
        release = height + problem.depths(adhesion)
        touches, releases = np.sort(height + adhesion.range), np.sort(release)
    asperities = response.keep(height, columns, material, adhesion.range, release, kernels.prepare)
    compiled = _compiled(kernels)
    compiled.block_at(asperities, 0)  # the depths of the first block are the scale of first steps
    first_touch = float(height[0] + adhesion.range)
    top = max(float(releases[-1]) if releases.size else first_touch, first_touch)
    beside = _BESIDE * float(np.spacing(max(abs(top), abs(float(height[-1])))))
    separation, h = np.empty(demand.size), np.inf
    turns: list[float] = []
    for leg in legs_of(demand):
        if h == np.inf:
            turns.clear()
            asperities.in_contact[:] = 0.0
        else:
            turns.append(h)
        events = releases if leg.rises else touches
        memory = _memory(turns if kernels.adhesive else [])
        look = as_argument(compiled.response, h, True, asperities, memory)
        place = first_touch, top, beside
        search = machine_stand.Search(look, not leg.rises, machine, asperities, memory, events, *place)
        asperities.far.number[:] = 0
        filled = separation[leg.first : leg.first + leg.demand.size]
        room = _room(events.size + 1 if jumps and kernels.adhesive else 0)
        with filling(filled):
            follow(h, leg.demand, search, filled, room)
        if np.isnan(filled).any():
            raise OutOfRange(
                f"the contact of an asperity is not representable: {kernels.name} with "
                f"effective modulus {problem.effective_modulus:g} Pa, {adhesion}"
            )
        found += [
            Jump(leg.first + int(room.step[i]), float(room.demand[i]), *room.limits[i].tolist())
            for i in range(room.number[0])
        ]
        h = float(filled[-1])
    return separation, found


def _room(count: int) -> machine_stand.Jumps:
    """Return room for the jumps of a leg."""
    steps = np.zeros(count, dtype=np.int64)
    return machine_stand.Jumps(np.zeros(1, dtype=np.int64), steps, np.empty((count, 2)), np.empty(count))


def _memory(turns: list[float]) -> response.Memory:
    """Return the memory that a leg begins with."""
    if turns:
        first, bottom, top = staircase(np.array(turns))
        bottom, top = bottom[first[-2] :].copy(), top[first[-2] :].copy()
    else:
        bottom = top = np.zeros(0)
    room = bottom.size + 1
    return response.Memory(np.zeros(1, dtype=np.int64), bottom, top, np.empty(room), np.empty(room))


@njit
def arrive(target: float, search: Search, jumps: Jumps, step: int) -> Stand:
    """Return the separation that a flat from infinity comes to, just above first touch at most; inf if a load pulls.

    Without any load it is pulled down at first touch.
    """
    if search.machine.weight > 0.0 and target > search.first_touch:
        return Stand(target, target, 1.0, 1.0, True, math.nan, math.nan)
    if search.machine.weight == 0.0 and target > 0.0:
        return Stand(math.inf, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    at: Stand = stand_at(search.first_touch + search.beside, search)
    stand(search.asperities)
    if search.events.size and not at.demand > target:
        beyond: Stand = stand_at(search.first_touch - search.beside, search)
        stand(search.asperities)
        if beyond.demand > target:
            snapped: Stand = sink(beyond, target, search)
            record(jumps, step, target, at.h, snapped.h)
            return snapped
        at = stand_at(search.first_touch, search)
        stand(search.asperities)
    return at


@njit
def follow(h: float, demand: Floats, search: Search, separation: Floats, jumps: Jumps) -> None:
    """Fill in the separations [m] of a leg that begins at h [m], inf from afar; inf where a dead load pulls off.

    NaN where a natural scale is not representable. Jumps are recorded where there is room for them.
    """
    at = Stand(h, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    if h < math.inf:
        at = stand_at(h, search)
    for step in range(demand.size):
        target = demand[step]
        if at.h == math.inf and search.falls:
            at = arrive(target, search, jumps, step)
        separation[step] = math.inf
        if at.h < math.inf:
            if jumps.limits.size:
                at = through_jumps(at, target, search, jumps, step)
            at, separation[step] = passage(at, target, search)
        if search.asperities.ready[0] < 0:
            separation[:] = math.nan
            return
