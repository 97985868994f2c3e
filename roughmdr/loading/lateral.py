"""The path of a flat that is moved sideways at constant separation or constant normal load."""

from typing import NamedTuple

import numpy as np

from roughmdr.loading.machine import MachinePath
from roughmdr.loading.masing import Masing
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES, LATERAL, SEPARATION


class LateralPath(NamedTuple):
    """The lateral displacement at each step, from rest at 0."""

    held: LoadingPath | MachinePath
    """The normal path, of one step, to the constant separation or load."""
    displacement: Floats
    """Lateral displacement [m], [step]."""
    memory: Masing

    @classmethod
    def along(cls, held: LoadingPath | MachinePath, displacement: Floats) -> "LateralPath":
        """Return the path of these displacements [m]."""
        return cls(held, displacement, Masing.along(displacement))

    @property
    def held_value(self) -> float:
        """The constant separation, force or pressure, in SI."""
        return float(self.held.values[-1])

    @property
    def control(self) -> str:
        """The quantity that is controlled."""
        return LATERAL.name

    @property
    def values(self) -> Floats:
        """The displacement at each step [m]."""
        return self.displacement

    @property
    def watched(self) -> str:
        """The variable whose error [accuracy] controls."""
        return "tangential_force"

    @property
    def rigid(self) -> bool:
        """Whether the flat is held at a separation (fixed grips)."""
        return self.held.rigid

    @property
    def unloads(self) -> bool:
        """Whether the flat rises anywhere: never."""
        return False

    @property
    def solutions(self) -> int:
        """The number of amplitudes, at each of which the normal contacts are solved once."""
        return int(np.unique(self.memory.amplitude).size)

    def over(self, usual: LoadingPath) -> "LateralPath":
        """Return the path of the flat, with the separation that ``usual`` asperities give it under a load."""
        return self._replace(held=LoadingPath.along(usual.separation[:1], unload=False, adhesive=False))

    @staticmethod
    def variables(names: list[str]) -> list[str]:
        """Return the variables of a law that is asked for ``names``: with the separation, which every one has."""
        return [SEPARATION.name, *names]

    def coordinates(self) -> dict[str, Array]:
        """Return the displacement and the branch of each step, labelled."""
        return {LATERAL.name: Array(("step",), self.displacement, LATERAL.attrs), "branch": self.branch()}

    def branch(self) -> Array:
        """Return the branch of each step, labelled: "unloading" backward."""
        names = np.where(self.memory.direction < 0.0, "unloading", "loading")
        return Array(("step",), names, {"long_name": COORDINATES["branch"].long_name})


Path = LoadingPath | MachinePath | LateralPath
"""Any path along which a law is computed."""
