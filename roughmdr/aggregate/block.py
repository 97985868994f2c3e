"""A block of asperities in the sum: its arrays, and the kernels that a sum is compiled with."""

from collections.abc import Callable
from typing import Any, NamedTuple

from numpy import bool_
from numpy.typing import NDArray

from roughmdr.kernels.interface import Columns, Kernels, Material
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import as_argument

# Rows of the natural scales of a block.
DEPTH_SCALE, PER_DEPTH, RADIUS_SCALE, FORCE_SCALE, STIFFNESS_SCALE, ENERGY_SCALE = range(6)
SCALES = 6


class Block(NamedTuple):
    """Arrays over the asperities of a block, from the highest to the lowest.

    Loops take the arrays out first: an array that is taken out of a tuple within a loop keeps it from vector code. They
    are few, as each one that is passed on takes long to compile.
    """

    z: Floats
    """Heights [m]."""
    params: Any
    """Prepared parameters, from ``Kernels.prepare``."""
    scales: Floats
    """Natural scales, [row, asperity] in SI."""
    max_scales: Floats
    """The largest scale of each row; that of the energy is filled only where energies can be asked for."""
    contacts: Floats
    """State and results of each contact over natural scales, [row, asperity]."""


class Totals(NamedTuple):
    """The sums over all asperities."""

    wanted: NDArray[bool_]
    """Which rows are asked for."""
    total: Floats
    """[row, step] in SI."""
    compensation: Floats
    """The rounding errors of ``total``."""
    closest: Floats
    """Contact radius [m] and force [N] of each asperity where the flat is closest, [2, asperity]."""


class SumKernels(Kernels):
    """Kernels of a shape under an adhesion model, with the parts of the sum that are compiled with them."""

    energetic: bool
    """Whether energies can be asked for: else none of their kernels is compiled."""
    natural_scales: Callable[..., bool]
    lowest_in_contact: Callable[..., float]
    update_contact: Callable[..., None]
    place: Callable[..., None]
    follow: Callable[..., None]
    follow_branches: Callable[..., None]
    guess_states: Callable[..., None]
    solve_contacts: Callable[..., None]
    radius_at: Callable[[Floats, Any, int], float]
    """(contacts, params, i) -> a of one contact over its natural scale; the next two return P and k."""
    force_at: Callable[[Floats, Any, int], float]
    stiffness_at: Callable[[Floats, Any, int], float]
    total_error: Callable[..., float]
    error_bound: Callable[..., float]
    jumps: Callable[..., float]
    jumps_between_branches: Callable[..., float]
    jumps_of_one: Callable[..., float]
    add_totals: Callable[..., None]
    loop: Callable[..., int]
    block_at: Callable[..., Block]
    """Builds the block that begins at an asperity; it and the two below serve a flat on a machine."""
    add_response: Callable[..., None]
    response: Callable[..., Any]


def prepare_of(kernels: Kernels, columns: Columns, material: Material) -> Callable[..., Any]:
    """Return ``prepare`` of the kernels as an argument: a loop calls it once a block and need not hold its code."""
    return as_argument(kernels.prepare, material, columns, 0, 0, 0.0, 0.0)


kernel = SumKernels("kernel")
"""Stands for the kernels in parts of the sum that ``specialise`` is given."""
