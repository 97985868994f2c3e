"""The positions and the patch of an ensemble, as an interaction of its asperities needs them."""

import math
from dataclasses import replace

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.settings import Interaction
from roughmdr.numerics.arguments import Floats

_AT_BORDER = (
    "contacts reach the border of the patch under the curved body: where the rough surface goes on beyond, asperities "
    "are missing that the body would touch too; make the patch larger, or end the path higher"
)


def sides_of(ensemble: Ensemble) -> tuple[float, float] | None:
    """Return the sides of the patch along x and y [m]; None where they are not known.

    A patch of which only the area is known is a square.
    """
    attrs, area = ensemble.attrs, ensemble.nominal_area
    if "patch" in attrs:
        return float(attrs["patch"]), float(attrs["patch"])
    if "patch_x" in attrs and "patch_y" in attrs:
        return float(attrs["patch_x"]), float(attrs["patch_y"])
    return None if area is None else (math.sqrt(area), math.sqrt(area))


def middle_of(ensemble: Ensemble) -> tuple[float, float]:
    """Return x and y [m] of the middle of the patch; of the positions where not all of them lie on it."""
    x, y = (ensemble.positions[name] for name in ("x", "y"))
    sides = sides_of(ensemble)
    if sides is not None and min(x.min(), y.min()) >= 0.0 and x.max() <= sides[0] and y.max() <= sides[1]:
        return 0.5 * sides[0], 0.5 * sides[1]
    return 0.5 * float(x.min() + x.max()), 0.5 * float(y.min() + y.max())


def border_warnings(ensemble: Ensemble, radius: Floats) -> list[str]:
    """Return the warning of contacts under a curved body that are less than the mean spacing from the border.

    Contact radii [m] of all asperities, 0 for none.
    """
    sides = sides_of(ensemble)
    if ensemble.axis is None or sides is None or ensemble.nominal_area is None:
        return []
    on, spacing = radius > 0.0, math.sqrt(ensemble.nominal_area / max(radius.size, 1))
    away = [np.abs(ensemble.positions[name][on] - at) for name, at in zip("xy", ensemble.axis, strict=True)]
    near = any((each > 0.5 * side - spacing).any() for each, side in zip(away, sides, strict=True))
    return [_AT_BORDER] if near else []


def check_placed(ensemble: Ensemble, interaction: Interaction) -> None:
    """SceneError unless an ensemble has the positions and the patch that its interaction needs."""
    pairwise = interaction.model == "pairwise"
    if interaction.beyond == "boundary_elements" and ensemble.origin == "hills":
        raise SceneError(
            "interaction.beyond is 'boundary_elements'; it does not go with hills, which do not say how their map "
            "looks between them"
        )
    missing = [name for name in ("x", "y") if name not in ensemble.positions]
    if pairwise and missing:
        raise SceneError(
            f"ensemble: {' and '.join(missing)} [m] are missing; with interaction.model = 'pairwise' every asperity "
            "needs a position"
        )
    if sides_of(ensemble) is None and not (pairwise and interaction.boundary == "free"):
        raise SceneError(
            "ensemble: attributes patch, patch_x and patch_y, and nominal_area are missing; interaction.model = "
            f"{interaction.model!r} with boundary = {interaction.boundary!r} needs the patch"
        )


def part_of(ensemble: Ensemble, count: int) -> Ensemble:
    """Return about ``count`` neighbouring asperities of a placed ensemble, on a patch that is so much smaller.

    They are the nearest to the middle of the positions, by the larger of |x|/side and |y|/side.
    """
    size = ensemble.height.size
    if size <= count:
        return ensemble
    sides = sides_of(ensemble)
    positions = [ensemble.positions[name] for name in ("x", "y")]
    scales = sides or [float(np.ptp(values)) or 1.0 for values in positions]
    offsets = [np.abs(each - np.median(each)) / scale for each, scale in zip(positions, scales, strict=True)]
    near = np.sort(np.argpartition(np.maximum(*offsets), count)[:count])
    share = math.sqrt(count / size)
    attrs = {name: value for name, value in ensemble.attrs.items() if name not in ("patch", "patch_x", "patch_y")}
    if sides is not None:
        attrs |= {"patch_x": share * sides[0], "patch_y": share * sides[1]}

    area = None if ensemble.nominal_area is None else ensemble.nominal_area * (count / size)
    return replace(ensemble.taken(near), nominal_area=area, attrs=attrs)
