"""The MDR profile of a hill from the mean heights under its contacts.

The contact of radius a carries 2 E* (a (H - D) - G(a)), G = a (H - <h>_a), H the height of the summit, and the force is
the largest of these: that of the convex hull of G, whose slope is g.
"""

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

LEAST_GROWTH = 0.4
"""Least growth of g from point to point, over that of a paraboloid; less in a valley, where the next hill begins."""


def points_of(radius: Floats) -> Floats:
    """Return the radii of the tables: between two contact radii where a^2 has its mean, from the tip on."""
    before = np.append(0.0, radius[:-1])
    return np.asarray(np.sqrt((radius * radius + radius * before + before * before) / 3.0))


@njit
def fill_table(radius: Floats, mean: Floats, summit: float, points: Floats, g: Floats) -> bool:
    """Fill g [m] at ``points`` from the means [m] under contacts of rising radii; False where the hill does not fall.

    Where G is not convex, g is the mean over the radii of the hull, at their root-mean-square point; between such
    points it is linear in a^2.
    """
    count = radius.size
    begin, level, place = np.zeros(count), np.empty(count), np.empty(count)
    pieces, start, before = 0, 0.0, 0.0
    for k in range(count):
        end, total = radius[k], radius[k] * (summit - mean[k])
        start, value = (radius[k - 1], total - before) if k > 0 else (0.0, total)
        rate = value / (end - start)
        while pieces > 0 and rate <= level[pieces - 1]:
            pieces -= 1
            value += level[pieces] * (start - begin[pieces])
            start = begin[pieces]
            rate = value / (end - start)
        begin[pieces], level[pieces] = start, rate
        place[pieces] = (end * end + end * start + start * start) / 3.0
        pieces += 1
        before = total
    first = 0
    while first < pieces and level[first] <= 0.0:
        first += 1
    if first == pieces:
        return False
    last = first
    for k in range(count):
        s = points[k] * points[k]
        while last < pieces - 2 and s > place[last + 1]:
            last += 1
        if s <= place[first] or pieces - first == 1:
            g[k] = level[first] * s / place[first]
        else:
            slope = (level[last + 1] - level[last]) / (place[last + 1] - place[last])
            g[k] = level[last] + slope * (s - place[last])
        if k > 0:
            g[k] = max(g[k], g[k - 1] * (1.0 + LEAST_GROWTH * (s / (points[k - 1] * points[k - 1]) - 1.0)))
    return True
