"""One flat-ended punch under adhesion of finite range: the cohesive zone ends at its edge, c = b.

Between delta = 0 and -beta b the contact shrinks from a = b to 0, a^2 = b^2 - (delta/beta)^2; below, all of the punch
is pulled with the strength. It lets go where the gap at its edge is w/sigma0. The state is delta/b.
Notation of ``row``.
"""

import math

import numpy as np

from roughmdr.kernels.profile import build as curved
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, FOLD, ONSET, RANGE, STRENGTH, UNIT
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled, njit

natural, natural_force = compiled(curved.natural), compiled(curved.natural_force)
own = njit(curved.own, inline=True)
passes = 1
_KERNEL_ERROR = 1e-12  # of the force, as it is tested
_LONGEST = 2.0**26  # times beta: the depth, of whose roundings the edge of a contact that closes makes less than 1e-12


@njit
def _angle(wanted: float, of_force: bool) -> float:
    """The angle from 0 to pi/2 where angle - sin cos, or else angle sin - 1 + cos, is ``wanted``."""
    low, high = 0.0, 0.5 * math.pi
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        sine, cosine = math.sin(middle), math.cos(middle)
        value = middle - sine * cosine if of_force else middle * sine - sine * sine / (1.0 + cosine)
        low, high = (middle, high) if value < wanted else (low, middle)


@njit
def _opening(s: float, row: Floats) -> tuple[float, float, float]:
    """a/b, m/b and the angle at the state s."""
    m = min(max(-s / row[STRENGTH], 0.0), 1.0)
    a = math.sqrt((1.0 - m) * (1.0 + m))
    return a, m, math.atan2(m, a)


@njit
def prepare(
    effective_modulus: float,
    work: float,
    strength: float,
    width: Floats,
    rise: Floats,
    form: Floats,
    start: int,
    stop: int,
    control: float,
) -> Floats:
    """A row for each of the punches from start to stop; COUNT = 0 where the range is so long that contact is lost in
    its roundings.
    """
    rows = np.zeros((stop - start, -UNIT))
    for i in range(stop - start):
        row, b = rows[i], width[start + i]
        beta, reach = 2.0 * strength / effective_modulus, work / strength / b
        row[STRENGTH], row[RANGE], row[CONTROL] = beta, reach, control
        if reach > (1.0 - 2.0 / math.pi) * beta:
            depth, angle = reach + 2.0 / math.pi * beta, 0.5 * math.pi
        else:
            angle = _angle(0.5 * math.pi * reach / beta, False)
            depth = beta * math.sin(angle)
        row[COUNT] = 1.0 if depth <= _LONGEST * beta else 0.0
        row[ONSET] = 1.0 - reach / depth
        pulled = angle + math.sin(angle) * math.cos(angle)
        row[DEPTH] = depth if control == 0.0 else 0.5 * beta * pulled
        row[FOLD] = 0.5 * math.pi - pulled if angle < 0.5 * math.pi else 0.0
    return rows


@njit
def state(x: float, row: Floats) -> float:
    """delta/b at the distance x to where the contact lets go."""
    return (x - 1.0) * row[DEPTH]


@njit
def state_on(x: float, rung: float, row: Floats) -> float:
    """The same: there is one branch."""
    return state(x, row)


@njit
def guess(x: float, row: Floats) -> float:
    """The same: nothing is left to find."""
    return state(x, row)


@njit
def nearer(s: float, x: float, row: Floats) -> tuple[float, float, float]:
    """The state, no step, and the slope."""
    return state(x, row), 0.0, row[DEPTH]


@njit
def arrived(s: float, step: float, x: float, rung: float, row: Floats) -> bool:
    """Always."""
    return True


@njit
def state_of_radius(radius: float, size: float, row: Floats) -> float:
    """None: the radius does not tell the state."""
    return math.nan


@njit
def state_of_force(x: float, row: Floats) -> float:
    """delta/b at the distance x to the pull-off force, over it, of a row under dead load."""
    if x >= 1.0:
        return (x - 1.0) * row[DEPTH]
    rest = row[FOLD] + x * 2.0 * row[DEPTH] / row[STRENGTH]  # pi/2 - (angle + sin cos), angle = asin(m/b)
    return -row[STRENGTH] * math.cos(_angle(rest, True))


@njit
def distance(s: float, row: Floats) -> float:
    """x(s)."""
    return s / row[DEPTH] + 1.0


@njit
def radius(s: float, row: Floats) -> float:
    """a/b."""
    return _opening(s, row)[0]


@njit
def cohesive_radius(s: float, row: Floats) -> float:
    """c/b."""
    return 1.0


@njit
def answer(s: float, row: Floats) -> tuple[float, float, float]:
    """a/b, P over 2 E* b^2, and k over 2 E* b."""
    a, m, angle = _opening(s, row)
    return a, max(s, 0.0) - 0.5 * row[STRENGTH] * (angle + a * m), a


@njit
def force(s: float, row: Floats) -> float:
    """P over 2 E* b^2."""
    _, push, _ = answer(s, row)
    return push


@njit
def stiffness(s: float, row: Floats) -> float:
    """k over 2 E* b."""
    return radius(s, row)


@njit
def pulled(a: float, row: Floats) -> tuple[float, float]:
    """No less than what the attraction takes of delta/b and of P over 2 E* b^2."""
    return row[STRENGTH], row[STRENGTH]


@njit
def errors(row: Floats) -> tuple[float, float]:
    """That of the force as it is tested; the state is the indentation itself."""
    return _KERNEL_ERROR, 0.0


@njit
def energy(s: float, row: Floats) -> float:
    """U, elastic and of both surfaces, over 2 E* b^3 DEPTH."""
    beta = row[STRENGTH]
    a, m, angle = _opening(s, row)
    elastic = s * s * a - beta * s * (angle - a * m) - beta * beta * (1.0 - a) * (1.0 - a) * (2.0 + a) / 3.0
    return (elastic - 0.5 * math.pi * beta * row[RANGE]) / (2.0 * row[DEPTH])


@njit
def rung(x: float, before: float, touched: bool, row: Floats) -> float:
    """1 while the punch is attracted, else 0."""
    return 1.0 if x > 0.0 and (touched or before > 0.0) else 0.0


@njit
def spent(before: float, after: float, row: Floats) -> float:
    """The energy lost where attraction begins, or where it ends."""
    return -energy(-row[RANGE], row) if after > before else energy(-row[DEPTH], row)
