"""The curves of a result, cell by cell, with their tolerances, and the steps at which the flat returns to a height."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene

ROUNDING = 1e-12  # relative rounding of a sum, to which the kernels are tested
FORCES = ("force", "pressure")


class Curves(NamedTuple):
    """The curves of one cell."""

    scene: Scene
    separation: Floats  # [step]
    values: dict[str, Floats]  # [row, step]: each realisation that is done, or mean, least and greatest
    error: Floats  # [row], over the largest force
    realizations: bool  # whether each row is one realisation
    expected: bool  # whether it is the expected curve, whose error is that of an integral

    @property
    def attracts_at_a_distance(self) -> bool:
        """Whether there may be a force without contact."""
        return self.scene.work > 0.0 and "dugdale" in self.scene.adhesion_model.candidates

    def tolerance(self, name: str) -> Floats:
        """Return by how much values may be off: [row, 1]."""
        rounding = 0.0 if name in FORCES else ROUNDING
        error = np.maximum(self.error[:, None], rounding) if name in FORCES or self.expected else rounding
        return np.asarray(error * np.abs(self.values[name]).max(axis=1, keepdims=True))

    def given(self, *names: str) -> Iterator[tuple[str, Floats, Floats]]:
        """Yield name, values and tolerance of each of these variables that was asked for."""
        return ((name, self.values[name], self.tolerance(name)) for name in names if name in self.values)


def curves_of(result: xr.Dataset, scene: Scene) -> Iterator[Curves]:
    """Yield the curves of each cell, in the order of the cells."""
    view = ResultView(result)
    path = view.over_steps("separation")
    for index, cell in zip(view.cells, scene.cells, strict=True):

        def values(name: str, index: tuple[int, ...] = index) -> Floats:
            return np.asarray(view.variables[name].values[index])

        expected = (view.method(index) or cell.batch.estimator) == "expected"
        error, done = values("numerical_error"), view.done[index]
        if view.keeps_runs:
            curves, error = {name: values(name)[done] for name in scene.output.variables}, error[done]
        else:
            rows = ("mean", "min", "max") if done else ()
            error, shape = np.repeat(error, len(rows)), (len(rows), path.shape[-1])
            curves = {
                name: np.array([values(f"{name}_{row}") for row in rows]).reshape(shape)
                for name in scene.output.variables
            }
        yield Curves(cell, path[index], curves, error, not expected and view.keeps_runs, expected)


def returns(separation: Floats) -> list[tuple[int, int]]:
    """Return pairs of steps at the same separation between which the flat was lower only.

    Pairs between which it was higher only are swapped.
    """
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
