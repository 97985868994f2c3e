"""How far one curve of a path is from another: errors where as many are in contact, and where jumps are."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.versus_adhesive_bem.cases import DETACHED


class Judged(NamedTuple):
    """Differences of a source from boundary elements."""

    loading: float
    """The largest of the force over the largest tension, at steps where as many are in contact, and not none,"""
    unloading: float
    middle: float
    """and the root mean square of both branches."""
    area: float
    """The largest of the contact area over the largest area, at such steps."""
    pull_off: float
    """Of the largest tension on unloading, relative."""
    on: float
    """Mean lag of the jumps on over the stretch at which one alone lets go; > 0 where it jumps on at a smaller gap."""
    off: float
    """The lag at letting go; > 0 where it lets go at a smaller gap."""
    before: float
    """The largest tension of boundary elements before the first contact, over the largest of all."""
    apart: float
    """Share of the steps in contact where not as many are in contact."""


def turning(separation: Floats) -> int:
    """Return the step at which the path turns."""
    return int(np.nanargmin(separation))


def jumps(count: Floats, separation: Floats) -> tuple[Floats, Floats]:
    """Return the separations at which one more and one less comes into contact, each midway between two steps."""
    turn = turning(separation)
    change = np.diff(count, prepend=0.0)
    middle = 0.5 * (separation + np.roll(separation, 1))
    on, off = (np.maximum(sign * part, 0).astype(int)
               for sign, part in ((1, change[: turn + 1]), (-1, change[turn + 1 :])))  # fmt: skip
    return np.repeat(middle[: turn + 1], on), np.repeat(middle[turn + 1 :], off)


def judge(case: xr.Dataset, source: str, truth: str = "bem") -> Judged:
    """Judge a source against boundary elements on the fine grid, or another truth."""
    case = case.isel(step=np.flatnonzero(case["separation"].notnull().to_numpy()))
    separation = case["separation"].to_numpy()
    turn = turning(separation)
    force, area, count = (case[name].sel(source=source).to_numpy() for name in ("force", "area", "count"))
    force_bem, area_bem, count_bem = (case[name].sel(source=truth).to_numpy() for name in ("force", "area", "count"))
    tension = -force_bem[turn:].min()
    alike = count == count_bem
    contact = (count > 0) | (count_bem > 0)
    judged = alike & contact
    off = np.where(judged, np.abs(force - force_bem), 0.0) / tension
    areas_off = np.where(judged, np.abs(area - area_bem), 0.0) / area_bem.max()
    lags = [
        float(np.mean(np.sort(true) - np.sort(found))) / -DETACHED if true.size == found.size else np.nan
        for found, true in zip(jumps(count, separation), jumps(count_bem, separation), strict=True)
    ]
    return Judged(
        loading=float(off[: turn + 1].max()),
        unloading=float(off[turn:].max()),
        middle=float(np.sqrt(np.mean(off[judged] ** 2))),
        area=float(areas_off.max()),
        pull_off=float(-force[turn:].min() / tension - 1.0),
        on=lags[0],
        off=lags[1],
        before=float(-force_bem[: turn + 1][count_bem[: turn + 1] == 0].min() / tension),
        apart=float(np.mean(~alike[contact])),
    )
