"""The memory of friction on a lateral path: Masing's rule, with return points that are remembered and wiped out.

A system of elastic parts that slip at limits of their own, loaded for the first time, follows a first curve T1(u).
After a turning point (u_r, T_r) it follows the same curve, twice as large,

    T = T_r +- 2 T1(|u - u_r|/2),

and loses 2 D1(|u - u_r|/2) by slip, where D1(u) is lost on the first curve. Where it comes back to the turning point
before, the loop is closed and forgotten, as if it had never been made: 4 D1 of half its width are lost in it. Beyond
its largest displacement, on either side, it is on the first curve again.

Sources: G. Masing, Proc. 2nd Int. Congr. Appl. Mech., Zürich (1926) 332; W. D. Iwan, J. Appl. Mech. 33 (1966) 893, for
any displacements. The rule is exact for parts whose limits do not change.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats, Ints

_BRANCH, _LOOP = 2.0, 4.0
"""Size of a branch over the first curve; loss of a closed loop, of two branches, over that of the first curve."""


class Masing(NamedTuple):
    """The branch that each step of a lateral path is on, and the loops that are closed on its way there."""

    amplitude: Floats
    """Half the distance [m] from the turning point where the branch begins; on the first curve all of it: [step]."""
    direction: Floats
    """1 forward, -1 backward: [step]."""
    origin: Ints
    """The step of that turning point; -1 on the first curve: [step]."""
    closed_at: Ints
    """The step that closes a loop, in order: [loop]."""
    closed: Ints
    """The step at the far end of the loop, whose amplitude is half the width of the loop: [loop]."""
    lost: Floats
    """Energy lost in it, over the loss of the first curve up to that amplitude: [loop]."""

    @classmethod
    def along(cls, displacement: Floats) -> "Masing":
        """Return the memory on a path of displacements [m] that begins at rest, at 0."""
        direction = directions(displacement)
        turns: list[int] = []
        amplitude, origin = np.empty(displacement.size), np.empty(displacement.size, dtype=np.int64)
        closed: list[tuple[int, int, float]] = []
        u = displacement.tolist()
        for step, (here, sign) in enumerate(zip(u, direction.tolist(), strict=True)):
            if step and sign != direction[step - 1]:
                turns.append(step - 1)
            while turns:
                back = u[turns[-2]] if len(turns) > 1 else -u[turns[0]]
                if sign * (here - back) < 0.0:
                    break
                closed.append((step, turns[-1], _LOOP if len(turns) > 1 else _BRANCH))
                del turns[-2:]
            origin[step] = turns[-1] if turns else -1
            amplitude[step] = abs(0.5 * here - 0.5 * u[turns[-1]]) if turns else abs(here)
        at, far, lost = zip(*closed, strict=True) if closed else ((), (), ())
        ints = np.int64
        return cls(amplitude, direction, origin, np.array(at, ints), np.array(far, ints), np.array(lost, float))

    def force(self, first: Floats) -> Floats:
        """Return the force at each step, from that of the first curve at the amplitude of each step."""
        return self._summed(self.direction * first)

    def loss(self, first: Floats) -> Floats:
        """Return the energy lost up to each step, from the loss on the first curve up to the amplitude of each step.

        It never falls: roundings that would make it fall are left out.
        """
        in_loops = np.bincount(self.closed_at, self.lost * first[self.closed], minlength=first.size)
        return np.asarray(np.maximum.accumulate(self._summed(first) + np.cumsum(in_loops)))

    def _summed(self, first: Floats) -> Floats:
        """Return the sums along the open branches that lead to each step."""
        total = np.where(self.origin < 0, first, _BRANCH * first)
        for turn in np.unique(self.origin[self.origin >= 0]).tolist():  # each after that which it begins at
            if self.origin[turn] >= 0:
                total[turn] += total[self.origin[turn]]
        turned = self.origin >= 0
        reached = np.zeros(first.size, dtype=bool)
        reached[self.origin[turned]] = True
        rest = turned & ~reached
        total[rest] += total[self.origin[rest]]
        return total


def directions(displacement: Floats) -> Floats:
    """Return the direction of each step, 1 or -1, from rest at 0; a step without motion has that of the next one."""
    moves = np.sign(np.diff(displacement, prepend=0.0))
    moving = np.flatnonzero(moves)
    if not moving.size:
        return np.ones(displacement.size)
    following = np.searchsorted(moving, np.arange(displacement.size))
    return np.asarray(moves[moving[np.minimum(following, moving.size - 1)]])
