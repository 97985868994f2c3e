"""The motion of the flat in time, and the time of loading with the present contacts."""

import sys
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.stages.viscoelasticity.relaxation import Relaxation


class FlatMotion(NamedTuple):
    """A flat that comes from infinity, may dwell at its lowest separation, and retracts."""

    speed: float
    """[m/s]"""
    retraction_speed: float
    """[m/s]"""
    dwell: float
    """[s]"""

    def time(self, separation: Floats) -> Floats:
        """Return the time of each step [s] since the first; the separations [m] fall, and then rise.

        Steps at the lowest separation are spread evenly over the dwell.
        """
        turn = int(np.argmin(separation))
        fallen = (separation[0] - separation[: turn + 1]) / self.speed
        return np.concatenate([fallen, fallen[-1] + sum(self._since_turn(separation[turn + 1 :], separation[turn]))])

    def contacts(self, separation: Floats, relaxation: Relaxation, clear: float) -> tuple[Floats, Floats]:
        """Return the separation [m] of loading with the contacts of each step, and the time [s] since then.

        The separations [m] of the steps fall, and then rise; at ``clear`` [m] and above nothing touches. While the flat
        rises contacts are those of the time t1 of loading with ∫_t1^t phi(t - s) h'(s) ds = 0: one time for all shapes
        and heights (Ting 1966, as in ``law``).
        """
        turn = int(np.argmin(separation))
        lowest, top = float(separation[turn]), max(clear, float(separation.max()))
        dwelt, rising = self._since_turn(separation[turn + 1 :], lowest)
        retracted = self.retraction_speed / self.speed * relaxation.integral(np.zeros_like(rising), rising)
        longest = min((top - lowest) / self.speed, sys.float_info.max)
        before = relaxation.duration(dwelt + rising, retracted, longest)
        left = np.minimum(lowest + self.speed * before, top)
        ages = np.concatenate([np.zeros(turn + 1), dwelt + rising + before])
        return np.concatenate([separation[: turn + 1], left]), ages

    def _since_turn(self, separation: Floats, lowest: float) -> tuple[Floats, Floats]:
        """Return the time [s] of the dwell at the turning point, and since then, for each step after it."""
        still = int(np.count_nonzero(separation == lowest))
        dwelt = self.dwell * np.minimum(np.arange(1, separation.size + 1) / max(still, 1), 1.0)
        return dwelt, (separation - lowest) / self.retraction_speed
