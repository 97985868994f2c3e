"""A block of asperities in the sum: its arrays, and the kernels that a sum is compiled with."""

from collections.abc import Callable
from typing import Any, NamedTuple

from numpy import bool_
from numpy.typing import NDArray

from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats

# Rows of the natural scales of a block.
DEPTH_SCALE, PER_DEPTH, RADIUS_SCALE, FORCE_SCALE, STIFFNESS_SCALE, ENERGY_SCALE = range(6)
SCALES = 6
# Rows of its contacts; the next three after the state are filled where the kernels find them together with it, the last
# where they approach it by steps.
STATE, RADIUS, FORCE, STIFFNESS, STATE_ERROR = range(5)
CONTACT_ROWS = 5


class Block(NamedTuple):
    """Arrays over the asperities of a block, from the highest to the lowest.

    Loops take the arrays out first: an array that is taken out of a tuple within a loop keeps it from vector code.
    """

    z: Floats
    """Heights [m]."""
    params: Any
    """As ``Kernels.prepare`` returns them."""
    scales: Floats
    """Natural scales, [row, asperity] in SI."""
    max_scales: Floats
    """The largest of each row."""
    in_contact: Floats
    """1 in contact, else 0; with several branches the number of the branch."""
    in_contact_before: Floats
    """As ``in_contact`` at the step before."""
    contacts: Floats
    """[row, asperity], over natural scales."""
    scratch: Floats


class Totals(NamedTuple):
    """The sums over all asperities."""

    wanted: NDArray[bool_]
    """Which rows are asked for."""
    total: Floats
    """[row, step] in SI."""
    compensation: Floats
    """The rounding errors of ``total``."""
    max_radius: Floats
    """The contact radius [m] of each asperity where the flat is closest."""


class SumKernels(Kernels):
    """Kernels of a shape under an adhesion model, with the parts of the sum that are compiled with them."""

    energetic: bool
    """Whether energies can be asked for: else none of their kernels is compiled."""
    natural_scales: Callable[..., bool]
    lowest_in_contact: Callable[..., float]
    update_contact: Callable[..., None]
    evaluate: Callable[..., None]
    place: Callable[..., None]
    solve_contacts: Callable[..., None]
    radius_at: Callable[[Floats, Any, int], float]
    """(contacts, params, i) -> a of one contact over its natural scale; the next two alike P and k."""
    force_at: Callable[[Floats, Any, int], float]
    stiffness_at: Callable[[Floats, Any, int], float]
    total_error: Callable[..., float]
    bounded_stiffness: Callable[[Floats, Any, int], float]
    """(contacts, params, i) -> |k| of one contact as the error bound takes it."""
    error_bound: Callable[..., float]
    jumps: Callable[..., float]
    add_totals: Callable[..., None]
    loop: Callable[..., int]
    block_at: Callable[..., Block]
    """This and the next: of a flat on a machine."""
    add_response: Callable[..., None]


law = SumKernels("law")
"""Stands for the kernels in parts of the sum that ``specialise`` is given."""
