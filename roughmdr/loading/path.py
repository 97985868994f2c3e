"""The path of the flat, step by step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.loading.staircase import Staircase, no_memory, staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES, SEPARATION


class LoadingPath(NamedTuple):
    """The separation at each step [m], and the memory that the contacts have of the steps before."""

    separation: Floats
    memory: Staircase

    @classmethod
    def along(cls, approach: Floats, *, unload: bool, adhesive: bool) -> "LoadingPath":
        """Return the path of these separations [m]; ``unload`` adds them in reverse, the turning point repeated."""
        # A new array in any case: for a strided or read-only one numba would compile all loops again.
        separation = np.concatenate([approach, approach[::-1]] if unload else [approach])
        return cls(separation, staircase(separation) if adhesive else no_memory(separation))

    @property
    def control(self) -> str:
        """The quantity that is controlled."""
        return SEPARATION.name

    @property
    def values(self) -> Floats:
        """The controlled quantity at each step, in SI."""
        return self.separation

    @property
    def watched(self) -> str:
        """The variable whose error [accuracy] controls."""
        return "force"

    @property
    def rigid(self) -> bool:
        """Whether the flat is displacement-controlled by a rigid machine (fixed grips)."""
        return True

    @property
    def unloads(self) -> bool:
        """Whether the flat rises anywhere."""
        return rises_anywhere(self.separation)

    @property
    def solutions(self) -> int:
        """The number of separations at which contacts are solved."""
        return int(self.separation.size)

    def variables(self, names: list[str]) -> list[str]:
        """Return the variables of a law that is asked for ``names``."""
        return names

    def over(self, usual: "LoadingPath") -> "LoadingPath":
        """Return the path of the flat, given its path over ``usual`` asperities."""
        return self

    def relative_to(self, origin: float) -> "LoadingPath":
        """Return the path with separations and memory as differences to ``origin`` [m]."""
        first, bottom, top = self.memory
        return LoadingPath(self.separation - origin, Staircase(first, bottom - origin, top - origin))

    def coordinates(self) -> dict[str, Array]:
        """Return the separation and the branch of each step, labelled."""
        return {
            "separation": Array(("step",), self.separation, COORDINATES["separation"].attrs),
            "branch": self.branch(),
        }

    def branch(self) -> Array:
        """Return the branch of each step, labelled."""
        return labelled_branches(self.separation)

    def at_detachment(self) -> NDArray[np.bool_]:
        """Return for each step whether contacts may be exactly at their detachment.

        They may be where the flat has been lower, and is now at its highest position since.
        """
        last = self.memory.first[1:] - 1
        return np.asarray((self.memory.top[last] == self.separation) & (self.memory.bottom[last] < self.separation))


def branches(separation: Floats) -> NDArray[np.str_]:
    """Return "unloading" where the flat rises or stands at the turning point for the second time, else "loading"."""
    before = np.concatenate([[np.inf], separation[:-1]])
    changes = np.flatnonzero(separation[1:] != separation[:-1]) + 1
    following = np.searchsorted(changes, np.arange(separation.size), side="right")
    next_other = np.append(separation[changes], np.inf)[following]
    rises = (separation > before) | ((separation == before) & (next_other > separation))
    return np.where(rises, "unloading", "loading")


def rises_anywhere(values: Floats) -> bool:
    """Return whether values grow from any step to the next."""
    return bool((np.diff(values) > 0.0).any())


def labelled_branches(separation: Floats) -> Array:
    """Return the branch of each step, labelled."""
    return Array(("step",), branches(separation), {"long_name": COORDINATES["branch"].long_name})
