"""The height map that all asperities of a periodic patch make together: at each point the highest of them."""

import math

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.buried import drop, reach
from roughmdr.numerics.arguments import Floats

_AT_A_TIME = 2**21


def union_map(ensemble: Ensemble, sides: Floats, shape: tuple[int, int], floor: float) -> Floats:
    """Return heights [m] on a grid over a patch with ``sides`` [m]; -inf where no asperity is above ``floor`` [m].

    Asperities repeat with the patch. Of one of them the nearest image alone counts: the others are lower everywhere.
    """
    counts = np.array(shape)
    cell = sides / counts
    at = np.column_stack([ensemble.positions[name] for name in ("x", "y")])
    at = at - sides * np.floor(at / sides)
    far = reach(ensemble, ensemble.height - floor)
    half = np.ceil(np.minimum(far[:, None], 0.5 * sides) / cell).astype(np.int64).max(axis=1) + 1
    size = np.where((far > 0.0) | (ensemble.height > floor), np.ceil(2.0 * np.log2(half)), -1.0)
    heights = np.full(counts.prod(), -np.inf)
    for each in np.unique(size[size >= 0.0]):
        members = np.flatnonzero(size == each)
        width = math.ceil(2.0 ** (0.5 * each))
        windows = [
            np.arange(-width, width + 1) if 2 * width < count else np.arange(count) - count // 2 for count in shape
        ]
        parts = math.ceil(members.size * windows[0].size * windows[1].size / _AT_A_TIME)
        for part in np.array_split(members, parts):
            index, away = [], []
            for axis, window in enumerate(windows):
                number = np.floor(at[part, axis] / cell[axis]).astype(np.int64)[:, None] + window
                offset = number * cell[axis] - at[part, axis, None]
                away.append(offset - sides[axis] * np.round(offset / sides[axis]))
                index.append(number % shape[axis])
            distance = np.hypot(away[0][:, :, None], away[1][:, None, :])
            near = np.nonzero(distance <= far[part, None, None])
            who = part[near[0]]
            values = ensemble.height[who] - drop(ensemble, who, distance[near])
            point = index[0][near[0], near[1]] * shape[1] + index[1][near[0], near[2]]
            np.maximum.at(heights, point, np.where(values >= floor, values, -np.inf))
    return heights.reshape(shape)
