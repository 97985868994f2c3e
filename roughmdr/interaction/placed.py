"""The positions and the patch of an ensemble, as an interaction of its asperities needs them."""

import math
from dataclasses import replace

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.settings import Interaction


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
