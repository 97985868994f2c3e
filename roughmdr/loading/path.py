"""The way of the flat, step by step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.loading.staircase import Staircase, no_memory, staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES


class LoadingPath(NamedTuple):
    """A path of the flat, with what the contacts remember of it."""

    separation: Floats
    memory: Staircase

    @classmethod
    def along(cls, way_in: Floats, *, unload: bool, adhesive: bool) -> "LoadingPath":
        """The way in [m] and, with ``unload``, the way back with the turning point repeated."""
        separation = np.concatenate([way_in, way_in[::-1]]) if unload else way_in
        return cls(separation, staircase(separation) if adhesive else no_memory(separation))

    def seen_from(self, origin: float) -> "LoadingPath":
        """The path with separations and memory as differences to ``origin`` [m]."""
        first, bottom, top = self.memory
        return LoadingPath(self.separation - origin, Staircase(first, bottom - origin, top - origin))

    def branch(self) -> Array:
        """The branch of each step."""
        return Array(("step",), branches(self.separation), {"long_name": COORDINATES["branch"].long_name})

    def snaps(self) -> NDArray[np.bool_]:
        """Whether contacts may be at the very point of letting go: the flat is as high as ever since it was lower."""
        last = self.memory.first[1:] - 1
        return np.asarray((self.memory.top[last] == self.separation) & (self.memory.bottom[last] < self.separation))


def branches(separation: Floats) -> NDArray[np.str_]:
    """The branch of each step: unloading where the flat rises, or stands at the turning point for the second time."""
    before = np.concatenate([[np.inf], separation[:-1]])
    changes = np.flatnonzero(separation[1:] != separation[:-1]) + 1
    following = np.searchsorted(changes, np.arange(separation.size), side="right")
    ahead = np.append(separation[changes], np.inf)[following]  # the next separation that is another one
    rises = (separation > before) | ((separation == before) & (ahead > separation))
    return np.where(rises, "unloading", "loading")
