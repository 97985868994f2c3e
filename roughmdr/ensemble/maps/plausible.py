"""Whether the size and the unit of a map can be right, by its slopes, sides and heights."""

from collections.abc import Mapping

from roughmdr.schema.units import format_quantity

IMPLAUSIBLE = "size or unit is implausible"

_SLOPES = 1e-6, 10.0
"""R.m.s. slopes: flatter is less than an atom from point to point of any scan, steeper no instrument sees."""
_SIDES = 1e-8, 1.0
"""Sides of maps [m]: from a few atoms to the size of a table."""
_HEIGHTS = 1e-11, 1e-2
"""R.m.s. heights [m]: from a tenth of an atom to more than any instrument's range."""


def implausible(attrs: Mapping[str, float | int | str]) -> str:
    """Return which numbers of a map, from the attributes of its ensemble, are impossible with a correct size and unit;
    empty for none.
    """
    slope, height = float(attrs["rms_slope"]), float(attrs["rms_height"])
    sides = [float(attrs[name]) for name in ("patch_x", "patch_y")]
    reasons = []
    if not _SLOPES[0] <= slope <= _SLOPES[1]:
        reasons.append(f"an r.m.s. slope of {slope:.2g}")
    if min(sides) < _SIDES[0] or max(sides) > _SIDES[1]:
        reasons.append(f"{' x '.join(format_quantity(side, 'm') for side in sides)}")
    if not _HEIGHTS[0] <= height <= _HEIGHTS[1]:
        reasons.append(f"an r.m.s. height of {format_quantity(height, 'm')}")
    return f"its {IMPLAUSIBLE}: {', '.join(reasons)}; give size, and unit of the heights, as measured" * bool(reasons)
