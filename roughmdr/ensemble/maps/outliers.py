"""Find numbers of a map that are no measured heights: marks of undefined points, spikes, clipped tops, coordinates.

Thresholds were chosen on an optical and an atomic-force map, Gaussian maps of Hurst exponent 0.2 to 1 down to two
points a wave, white noise, pillars, and 300 maps of steep grains, whose sharpest stands out by 4.2 (``_SPIKE``).
"""

import itertools
from collections.abc import Iterable, Iterator
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.maps.height_map import blocks
from roughmdr.ensemble.maps.plateau import find_plateau
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats

Treatment = Literal["undefined", "kept"]

_SPIKE = 5.0
"""Height of a spike beyond all but one of its neighbours, over their range and over a large step of the map."""
_FEWEST, _TIMES = 10, 5.0
"""Numbers of points with one value that chance does not explain: the least, and the least over those of next values."""
_JUMP = 2.5
"""Median step from such points to their neighbours, over the median step of the map, beyond which they are a mark; at a
clipped top it is about 1."""
_LEAST_KNOWN = 0.6  # least share of defined neighbours of a spike: an edge has it, a corner does not
_LARGE = 1.5  # 95 % quantile of steps over that of 80 %, for Gaussian steps
_NEAR = 10  # distinct heights next to a value whose numbers of points are compared with its own
_MOST_MARKS = 8  # most different marks in one map
_SAMPLE = 2**16  # points of the sample for steps and numbers of equal heights
_FEWEST_STEPS = 7  # fewest steps of a row that may be coordinates
_EVEN, _UNEVEN, _LESS_EVEN = 0.3, 0.5, 4.0
"""Relative range of the steps of coordinates at most, with their rounding; of heights in the next row at least, and
over that of the coordinates."""
_CLIPPED = (
    'the tops that touch first are not known; measure with a larger range, or give outliers = "kept" if they are as '
    "flat as that"
)
_REMEDY = 'outliers = "undefined" leaves them out, outliers = "kept" takes them as they are'


class _Finding(NamedTuple):
    text: str
    points: NDArray[np.intp]  # flat indices of points to leave out
    matters: bool = True  # whether a law of light contact depends on them: not on the lowest points


def leave_out_outliers(
    height: Floats, treatment: Treatment | None, unit: str, *, periodic: bool
) -> dict[str, int | str]:
    """Set outliers of a map, heights in ``unit`` over x and y, to NaN, in place; return those found, as attributes.

    Without a ``treatment`` RoughmdrError names outliers that matter, with number, value and position. Unless all are
    "kept", it is also raised for coordinates among the heights and for a clipped highest part, which allow no law.
    """
    if treatment == "kept" or min(height.shape) < 3:
        return {}
    _refuse_coordinates(height)
    with np.errstate(over="ignore", invalid="ignore"):  # marks at the end of the range of floats
        found = list(_marks(height, unit))
        while spikes := list(_spikes(height, unit, periodic=periodic)):
            found += spikes
            if treatment is None:
                break
            for each in spikes:  # set them to NaN, so that spikes beside them are found
                height.flat[each.points] = np.nan
        clipped = list(_clipped(height, unit))
        if not any(each.matters for each in clipped):
            clipped += _levelled(height, unit)
    refused = [each.text for each in clipped if each.matters]
    if treatment is None and any(each.matters for each in found):
        refused = [f"{'; '.join(each.text for each in found)}: {_REMEDY}", *refused]
    if refused:
        raise RoughmdrError("; ".join(refused))
    attrs: dict[str, int | str] = {}
    if treatment == "undefined" and found:
        attrs["outliers"] = sum(each.points.size for each in found)
        found = []
    if found or clipped:
        attrs["doubtful"] = "; ".join(each.text for each in [*found, *clipped])
    return attrs


def _refuse_coordinates(height: Floats) -> None:
    """RoughmdrError where the first row or column counts up evenly, and the next one does not."""
    found = dict[str, float]()
    for name, (first, after) in {"row": height[:2, 1:], "column": height.T[:2, 1:]}.items():
        uneven = _unevenness(first)
        if uneven <= _EVEN and _unevenness(after) > max(_UNEVEN, _LESS_EVEN * uneven):
            found[name] = float(np.mean(np.diff(first)))
    if found:
        steps = " and ".join(f"{step:.4g}" for step in found.values())
        names, those = " and first ".join(found), "they are" if len(found) > 1 else "it is"
        nx, ny = height.shape[0] - ("row" in found), height.shape[1] - ("column" in found)
        raise RoughmdrError(
            f"the first {names} of numbers, of the map as it is read, count up evenly, by {steps}: {those} no heights "
            f"but coordinates; delete them, so that {nx} x {ny} heights are left"
        )


def _unevenness(values: Floats) -> float:
    """Return the range of the steps over their mean; infinite where their signs differ, or they are too few."""
    steps = np.diff(values)
    one_way = bool((steps > 0.0).all() or (steps < 0.0).all())
    if steps.size < _FEWEST_STEPS or not one_way:
        return np.inf
    return float(np.ptp(steps) / np.abs(steps).mean())


def _marks(height: Floats, unit: str) -> Iterator[_Finding]:
    """Yield values that mark undefined points, and set these to NaN: values far from all others, or of many points that
    are far from their neighbours.
    """
    for _ in range(_MOST_MARKS):
        levels, counts = _levels(height)
        if not levels.size:
            return
        low, high = _ends(height, ())
        low_of_rest, high_of_rest = _ends(height, (low, high))
        candidates = dict.fromkeys([low, high, 0.0, float(levels[np.argmax(counts)])])
        median_step = _step(height, 0.5, candidates)
        apart = {low: low_of_rest - low, high: high - high_of_rest}
        for value in candidates:
            points = np.flatnonzero(height == value)
            detached = 0.0 < high_of_rest - low_of_rest < apart.get(value, 0.0)
            many = _is_frequent(value, points.size, levels, counts, height.size)
            if points.size and (detached or (many and _jump(height, points, value) > _JUMP * median_step)):
                yield _Finding(f"{_at(height, points)} exactly {value:g} {unit}, far from neighbouring heights", points)
                height.flat[points] = np.nan
                break
        else:
            return


def _clipped(height: Floats, unit: str) -> Iterator[_Finding]:
    """Yield where the highest or lowest points of a map are flat, at the end of the range of the instrument."""
    levels, counts = _levels(height)
    if not levels.size:
        return
    for value, end in zip(_ends(height, ()), ("lowest", "highest"), strict=True):
        points = np.flatnonzero(height == value)
        if _is_frequent(value, points.size, levels, counts, height.size) and _is_flat(height, points, value):
            text = f"its {end} part is clipped: {_at(height, points)} exactly {value:g} {unit}, with their neighbours"
            yield _Finding(f"{text}; {_CLIPPED}" if end == "highest" else text, points, matters=end == "highest")


def _levelled(height: Floats, unit: str) -> Iterator[_Finding]:
    """Yield the highest points of a map where they are a smooth plane: clipped, and levelled or noisy after that."""
    plateau = find_plateau(height)
    if plateau is None:
        return
    values = height.flat[plateau.points]
    plane = f"{_at(height, plateau.points)} from {values.min():.4g} to {values.max():.4g} {unit} on one smooth plane"
    if plateau.is_exact:
        text = f"its highest part is clipped, and was levelled after that: {plane}, with none above; {_CLIPPED}"
    else:
        text = (
            f"its tops are flat: {plane} but for noise of {plateau.thickness:.2g} {unit}, with none above. Either the "
            "instrument was at the end of its range, and the tops that touch first are not known, or they were worn or "
            'made so; measure with a larger range, or say outliers = "kept"'
        )
    yield _Finding(text, plateau.points, matters=plateau.is_exact)


def _spikes(height: Floats, unit: str, *, periodic: bool) -> Iterator[_Finding]:
    """Yield points, single or 2 x 2, beyond all neighbours but one by more than the range of these and other steps."""
    least = _SPIKE * _LARGE * _step(height, 0.8)  # robust to spikes at up to 10 % of the points
    if not least > 0.0:
        return
    nx, ny = height.shape
    points: NDArray[np.intp]
    up, down = list[int](), list[int]()
    for side, rows in itertools.product((1, 2), blocks(nx, ny)):
        numbers = np.arange(rows.start - 1, rows.stop + side)
        part = np.pad(height[numbers % nx], ((0, 0), (1, side)), mode="wrap")
        if not periodic:
            part[:, 0] = part[:, ny + 1 :] = np.nan
            part[(numbers < 0) | (numbers >= nx)] = np.nan
        seen = {
            (i, j): part[1 + i : 1 + i + rows.stop - rows.start, 1 + j : 1 + j + ny]
            for i in range(-1, side + 1)
            for j in range(-1, side + 1)
        }
        inside = [(i, j) for i in range(side) for j in range(side)]
        around = [each for at, each in seen.items() if at not in inside]
        known = sum((np.isfinite(each).view(np.int8) for each in around), np.zeros(around[0].shape, np.int8))
        for sign, found in ((1.0, up), (-1.0, down)):
            inner = np.minimum.reduce([sign * seen[at] for at in inside])
            below = sum(((inner - sign * each > least).view(np.int8) for each in around), np.zeros_like(known))
            at = np.nonzero((below >= known - 1) & (known > _LEAST_KNOWN * len(around)))
            beside = np.sort(np.stack([sign * each[at] for each in around]), axis=0)  # undefined ones come last
            second = np.take_along_axis(beside, known[at][None].astype(np.intp) - 2, 0)[0]
            row, column = (each[inner[at] - second > _SPIKE * (second - beside[1])] for each in at)
            found.extend(k for i, j in inside for k in ((row + rows.start + i) % nx * ny + (column + j) % ny).tolist())
    for spikes, where in ((up, "above"), (down, "below")):
        if spikes:
            points = np.unique(np.array(spikes, dtype=np.intp))
            values = height.flat[points]
            span = f"{values.min():.4g}{f' to {values.max():.4g}' * (points.size > 1)} {unit}"
            text = f"{_at(height, points)} {span}, far {where} neighbouring heights"
            yield _Finding(text, points, matters=where == "above")


def _at(height: Floats, points: NDArray[np.intp]) -> str:
    """Return the number of points and the position of the first, as the subject of a sentence."""
    row, column = divmod(int(points[0]), height.shape[1])
    first = f"point {row + 1} along x and {column + 1} along y"
    return f"the height at {first} is" if points.size == 1 else f"{points.size} heights, the first at {first}, are"


def _ends(height: Floats, without: tuple[float, ...]) -> tuple[float, float]:
    """Return the lowest and the highest value other than the given ones; infinite where there is none."""
    low, high = np.inf, -np.inf
    for rows in blocks(*height.shape):
        kept = height[rows][np.isfinite(height[rows]) & ~np.isin(height[rows], without)]
        low, high = min(low, float(kept.min(initial=np.inf))), max(high, float(kept.max(initial=-np.inf)))
    return low, high


def _levels(height: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Return the distinct heights of a sample of rows, and estimates of the number of points of the map with each."""
    every = -(-height.size // _SAMPLE)
    sample = height[::every]
    levels, counts = np.unique(sample[np.isfinite(sample)], return_counts=True)
    return levels, counts * every


def _is_frequent(value: float, number: int, levels: Floats, counts: NDArray[np.intp], size: int) -> bool:
    """Return whether many more points have a value than have the values next to it."""
    at = int(np.searchsorted(levels, value))
    others = [k for k in range(max(at - _NEAR, 0), min(at + _NEAR + 1, levels.size)) if levels[k] != value]
    if number < _FEWEST or len(others) < _NEAR:
        return False
    return bool(number > _TIMES * float(np.mean(counts[others])))


def _step(height: Floats, quantile: float, without: Iterable[float] = ()) -> float:
    """Return a quantile of the unequal steps of neighbours, but for given values, in a sample of rows; 0 for none."""
    rows = np.arange(0, height.shape[0] - 1, -(-height.size // _SAMPLE))
    part, after = (np.where(np.isin(each, list(without)), np.nan, each) for each in (height[rows], height[rows + 1]))
    steps = np.abs(np.concatenate([(after - part).ravel(), np.diff(part, axis=1).ravel()]))
    steps = steps[(steps > 0.0) & np.isfinite(steps)]
    return float(np.quantile(steps, quantile)) if steps.size else 0.0


def _beside(height: Floats, points: NDArray[np.intp]) -> Iterator[Floats]:
    """Yield the heights of the four neighbours of points; NaN beyond the edge."""
    nx, ny = height.shape
    row, column = np.divmod(points, ny)
    for i, j in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        inside = (row + i >= 0) & (row + i < nx) & (column + j >= 0) & (column + j < ny)
        yield np.where(inside, height[(row + i) % nx, (column + j) % ny], np.nan)


def _jump(height: Floats, points: NDArray[np.intp], value: float) -> float:
    """Return the median step from points that share a value to neighbours that do not."""
    steps = np.abs(np.concatenate(list(_beside(height, points))) - value)
    steps = steps[(steps > 0.0) & np.isfinite(steps)]
    return float(np.median(steps)) if steps.size else 0.0


def _is_flat(height: Floats, points: NDArray[np.intp], value: float) -> bool:
    """Return whether most of the points that share a value have a neighbour that does."""
    return bool(np.mean(np.any([each == value for each in _beside(height, points)], axis=0)) > 0.5)
