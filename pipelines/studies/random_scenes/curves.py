"""The curves of a result, cell by cell, with how far off they may be, and where their flat comes back to."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene

DONE, _EXPECTED = 0, 2
ROUNDING = 1e-12
"""Of a sum, as the kernels are tested."""
PUSHING = ("force", "pressure")


class Law(NamedTuple):
    """The curves of one cell."""

    scene: Scene
    separation: Floats
    """[step]"""
    curves: dict[str, Floats]
    """[row, step]: each realisation that is done, or mean, least and greatest."""
    error: Floats
    """[row], over the largest force."""
    drawn: bool
    """Whether a row is one realisation."""
    expected: bool
    """Whether it is the expected law, whose error is that of an integral."""

    @property
    def far_reaching(self) -> bool:
        """Whether there may be a force without a touch."""
        return self.scene.work > 0.0 and "dugdale" in self.scene.adhesion_model.candidates

    def slack(self, name: str) -> Floats:
        """By how much values may be off: [row, 1]."""
        largest = np.abs(self.curves[name]).max(axis=1, keepdims=True)
        if name in PUSHING or self.expected:
            return np.asarray(np.maximum(self.error[:, None], ROUNDING if name not in PUSHING else 0.0) * largest)
        return np.asarray(ROUNDING * largest)


def laws_of(result: xr.Dataset, scene: Scene) -> Iterator[Law]:
    """The curves of each cell, in the order of the cells."""
    sizes = scene.sweep.sizes
    separation = result.variables["separation"]
    over = [result.sizes[name] if name in separation.dims else 1 for name in (*sizes, "step")]
    way = np.broadcast_to(separation.values.reshape(over), (*sizes.values(), result.sizes["step"]))

    def values(name: str, place: tuple[int, ...]) -> np.ndarray:
        return np.asarray(result.variables[name].values[place])

    for place, cell in zip(np.ndindex(*sizes.values()), scene.cells, strict=True):
        expected = cell.batch.estimator == "expected"
        if "accuracy_method" in result:
            expected = int(values("accuracy_method", place)) == _EXPECTED
        error, done = values("numerical_error", place), values("status", place) == DONE
        names = scene.output.variables
        if scene.output.keep == "curves":
            curves = {name: values(name, place)[done] for name in names}
            yield Law(cell, way[place], curves, error[done], drawn=not expected, expected=expected)
        else:
            of = ("mean", "min", "max") if done else ()
            curves = {name: np.array([values(f"{name}_{row}", place) for row in of]) for name in names}
            curves = curves if done else {name: np.empty((0, result.sizes["step"])) for name in names}
            errors_of_all = np.repeat(error, len(of))
            yield Law(cell, way[place], curves, errors_of_all, drawn=False, expected=expected)


def excursions(separation: Floats) -> list[tuple[int, int]]:
    """Pairs of steps at the same separation: between them the flat was lower only, or higher only with them swapped."""
    last: dict[float, int] = {}
    pairs = []
    for step, h in enumerate(separation.tolist()):
        if h in last:
            between = separation[last[h] : step]
            if (between <= h).all():
                pairs.append((last[h], step))
            elif (between >= h).all():
                pairs.append((step, last[h]))
        last[h] = step
    return pairs
