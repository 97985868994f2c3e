"""Steps of an iteration, improved by those before (D. G. Anderson, J. ACM 12 (1965) 547)."""

import numpy as np

from roughmdr.numerics.arguments import Floats

_REMEMBERED = 8
_RCOND = 1e-12


class Mixing:
    """The steps from the points of an iteration, and the ways from each point to the next."""

    def __init__(self) -> None:
        self._steps = list[Floats]()
        self._ways = list[Floats]()

    def improved(self, step: Floats) -> Floats:
        """Return the way to where the steps so far, with this one, say that there is none."""
        self._steps = [*self._steps[-_REMEMBERED:], step]
        if not self._ways:
            return step
        ways = np.array(self._ways[-_REMEMBERED:]).T
        changes = np.diff(np.array(self._steps), axis=0).T
        part = np.linalg.lstsq(changes, step, rcond=_RCOND)[0]
        return np.asarray(step - (ways + changes) @ part)

    def go(self, way: Floats) -> None:
        """Have the iteration go a way from its last point."""
        self._ways.append(way)
