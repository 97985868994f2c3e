"""The pull-off of a curved body: the largest tension of its unloadings, located between the steps."""

import numpy as np

from roughmdr.aggregate.totals import AREA, COUNT
from roughmdr.expected.pull_off import ends_apart
from roughmdr.layer.curved.follow import Body, Place
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, unloadings
from roughmdr.numerics.arguments import Floats

_PARTS, _MAX_ROUNDS = 8, 12  # of the steps beside the lowest force, which are divided again and again
_FINE = 0.1  # of the error of the force: steps whose forces differ by less are close enough


def pull_off_of(body: Body, places: list[Place], separation: Floats, error: float) -> PullOff:
    """Return the pull-off, given the rings at each step of the path; NaN where no unloading ends out of contact.

    The force is right to ``error`` over the largest.
    """
    force = body.force(places)
    rises = unloadings(separation, force)
    contacts = np.array([body.totals(place)[COUNT] for place in places])
    if not ends_apart(rises, contacts):
        return PullOff()
    if not body.half.law.adhesive:
        return WITHOUT_TENSION
    rise = min(rises, key=lambda each: float(each.force.min()))
    at = rise.last - rise.separation.size + 1 + int(np.argmin(rise.force))
    if not force[at] < 0.0:
        return WITHOUT_TENSION
    lowest, least = places[at], float(force[at])
    before, after = places[max(at - 1, rise.last - rise.separation.size + 1)], separation[min(at + 1, rise.last)]
    for _ in range(_MAX_ROUNDS):
        between = body.along(np.linspace(before.h, after, _PARTS + 1)[1:], before)
        forces = body.force(between)
        k = int(np.argmin(forces))
        if forces[k] < least:
            lowest, least = between[k], float(forces[k])
        last = float(forces[k - 1]) if k > 0 else float(body.force([before])[0])
        before, after = (between[k - 1] if k > 0 else before), between[min(k + 1, _PARTS - 1)].h
        if abs(last - forces[k]) <= _FINE * error * abs(least):
            break
    totals = body.totals(lowest)
    return PullOff(least, lowest.h, totals[COUNT], totals[AREA])
