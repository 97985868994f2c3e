"""The asperities of an ensemble as their interaction needs them: placed, and none of them buried."""

import math

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.interaction.buried import Buried, buried
from roughmdr.interaction.green import Periodic
from roughmdr.interaction.interface import Asperities
from roughmdr.interaction.placed import sides_of
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Kernels, Material
from roughmdr.numerics.arguments import Floats

_SMALLEST = np.finfo(np.float64).tiny


class Placed:
    """Asperities with their positions, from the highest down, in units of the side of the patch."""

    def __init__(self, ensemble: Ensemble, effective_modulus: float, interaction: Interaction) -> None:
        at = np.column_stack([ensemble.positions[name] for name in ("x", "y")])
        first = at.min(axis=0)
        at -= first
        sides = sides_of(ensemble)
        if interaction.boundary == "free" or sides is None:
            whole = float(np.ptp(at, axis=0).max())
            sides = (whole, whole) if whole > 0.0 else (1.0, 1.0)
        self.length, self.interaction, self.total = sides[0], interaction, ensemble.height.size
        self.modulus = effective_modulus
        """[Pa]."""
        self.force_unit = math.pi * effective_modulus * self.length * self.length
        """[N], of loads."""
        self.patch = Periodic.of(sides[1] / sides[0])
        _check_apart(ensemble, at / self.length, self.sides)
        if ensemble.origin == "hills":  # each is a part of the surface
            below = Buried.none(ensemble.height.size)
        else:
            below = buried(ensemble, at, None if self.sides is None else self.sides * self.length)
        self.kept = np.flatnonzero(~below.hidden)
        """The numbers of the asperities that are not buried."""
        ensemble = ensemble.taken(self.kept)
        self._columns = ensemble.columns
        self.kernels_alone = choose(ensemble.shape, Adhesion(), self._columns.params)
        """Their kernels without adhesion."""
        self._material = self.kernels_alone.material(effective_modulus, Adhesion())
        self.at = at[self.kept] / self.length
        self.axis = None if ensemble.axis is None else (np.array(ensemble.axis) - first) / self.length
        """Position of the apex of a curved body; None under a flat."""
        self.height = ensemble.height / self.length
        self.emerging = below.emerging[self.kept] / self.length
        """Radii from which on the flanks of summits that are buried are in their contacts; inf for none."""
        depth, size = _natural_scales(self.kernels_alone, self._columns, self._material, self.height.size)
        self.depth, self.size = depth / self.length, size / self.length
        """Natural depths and radii."""

    @property
    def sides(self) -> Floats | None:
        """Sides of the patch that repeats."""
        return np.array([1.0, self.patch.side_y]) if self.interaction.boundary == "periodic" else None

    def asperities(self, count: int) -> Asperities:
        """Return the ``count`` highest."""
        params = self.kernels_alone.prepare(self._material, self._columns, 0, max(count, 1), 0.0, math.inf)
        return Asperities(self.height[:count], self.depth[:count], self.size[:count], params)


def _natural_scales(kernels: Kernels, columns: Columns, material: Material, count: int) -> tuple[Floats, Floats]:
    """Return natural depths and radii [m]; OutOfRange where one is not representable."""
    params = kernels.prepare(material, columns, 0, count, 0.0, 0.0)
    found = np.empty((2, count))
    for i in range(count):
        own = kernels.params_of(params, i)
        (depth, _), size, _, _ = kernels.scales(material.effective_modulus, 0.0, columns.width[i], columns.rise[i], own)
        found[:, i] = depth, size
    if not ((found >= _SMALLEST) & np.isfinite(found)).all():
        raise OutOfRange("the contact of an asperity is not representable")
    return found[0], found[1]


def _check_apart(ensemble: Ensemble, at: Floats, sides: Floats | None) -> None:
    """Raise SceneError where two asperities have the same position; ``at`` over the side of the patch."""
    wrapped = at if sides is None else at - sides * np.floor(at / sides)
    order = np.lexsort(wrapped.T)
    same = (np.diff(wrapped[order], axis=0) == 0.0).all(axis=1)
    if same.any():
        first = int(order[np.argmax(same)])
        x, y = (float(ensemble.positions[name][first]) for name in ("x", "y"))
        raise SceneError(
            f"ensemble: two asperities have the same position, x = {x:.6g} m, y = {y:.6g} m; "
            "interaction needs them apart"
        )
