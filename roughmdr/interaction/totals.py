"""The totals of coupled asperities at one separation."""

from typing import NamedTuple

CROWDING = "crowding"
"""Asks for it among the names of variables."""


class Overlap(NamedTuple):
    """Contacts that overlap a neighbour's, or are near to one."""

    contacts: int
    share: float
    """Share of the force of contacts that overlap."""
    crowding: float = 0.0
    """About the error of the force by contacts near to each other [1]; 0 where it is not asked for."""


class Step(NamedTuple):
    """The totals at one separation, in SI."""

    force: float = 0.0
    radius_sum: float = 0.0
    area: float = 0.0
    stiffness: float = 0.0
    contacts: int = 0
    error: float = 0.0
    """About that of the force [N]; inf where there is no equilibrium."""
    overlap: Overlap = Overlap(0, 0.0)
    lost: int = 0
    """Number of contacts that are no discs."""
    energy: float = 0.0
    dissipated: float = 0.0
    """By all jumps up to here."""
    by_machine: float = 0.0
    """The part of it that a machine loses."""
    conductance: float = 0.0
    """The conductance radius."""
    doubted: float = 0.0
    """Pull-off forces, each alone, of asperities out of contact that attraction with a range may have pulled on, and of
    contacts that overlap."""
    held: float = 0.0
    """Pull-off forces of all other contacts."""
