"""How far the law of a method is from that of boundary elements over a cycle."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats

_LEAST = 0.003  # contact fraction of boundary elements from which on steps are compared


class Judged(NamedTuple):
    """Differences from boundary elements; NaN where the method has no law."""

    loading: float
    """r.m.s. of the force over its largest size,"""
    unloading: float
    """on the way back,"""
    area: float
    """and of the contact area over the largest, both ways."""
    pull_off: float
    """The largest tension of unloading over that of boundary elements."""
    loss: float
    """The energy lost over the cycle, over the pull-off force of boundary elements times the stretch of a contact."""


def judge(case: xr.Dataset, source: str) -> Judged:
    """Judge a source in a case; NaN spreads from steps without a value."""
    separation = case["separation"].to_numpy()
    turn = separation.size // 2
    true, found = (case["force"].sel(source=name).to_numpy() for name in ("elements", source))
    true_area, area = (case["contact_fraction"].sel(source=name).to_numpy() for name in ("elements", source))
    compared = true_area >= _LEAST
    off = (found - true) / np.abs(true).max()
    return Judged(
        loading=_rms(off[: turn + 1][compared[: turn + 1]]),
        unloading=_rms(off[turn:][compared[turn:]]),
        area=_rms((area - true_area)[compared] / true_area.max()),
        pull_off=float(found[turn:].min() / true[turn:].min()),
        loss=float(np.trapezoid(found, separation) / (true[turn:].min() * case["stretch"])),
    )


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
