"""From a scene to its cells: where the flat of each goes, how each is computed, what is left out and why."""

from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath, LoadSeparation, compute
from roughmdr.errors import SceneError
from roughmdr.loading.path import branches
from roughmdr.scene import Scene
from roughmdr.scene.sweep import describe_cell
from roughmdr.schema.wording import count_by_cell
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES, CURVE_VARIABLES


class Cell(NamedTuple):
    """A scene without a sweep, and the way of its flat."""

    scene: Scene
    path: LoadingPath


class Plan(NamedTuple):
    """What a run of a scene will do."""

    scene: Scene
    cells: tuple[Cell, ...]
    left_out: tuple[str, ...]
    """Lines "part: reason"."""
    chunk: int | None = None
    """How many runs make a task; None for as many as make it worth its overhead."""

    @property
    def sizes(self) -> dict[str, int]:
        """The swept dimensions, in their order."""
        return self.scene.sweep.sizes

    @property
    def warnings(self) -> list[str]:
        """Warn of asperities that may not be as they were meant; in how many cells, where not in all."""
        return count_by_cell((text for cell in self.cells for text in cell.scene.asperities.warnings), len(self.cells))

    def name_of(self, cell: int, realization: int) -> str:
        """A run in words."""
        values = next(islice(self.scene.sweep.cells(), cell, None))
        return ", ".join([*([describe_cell(values)] if values else []), f"realisation {realization}"])

    def coordinates(self) -> dict[str, Array]:
        """The swept values, the separation over those of them that change it, and the branch."""
        return {
            **self.scene.sweep.coordinates(),
            "separation": self._separation(),
            "branch": self.cells[0].path.branch(),
        }

    def _separation(self) -> Array:
        first = self.cells[0].path
        if all(cell.path is first for cell in self.cells):
            return Array(("step",), first.separation, COORDINATES["separation"].attrs)
        separation = np.array([cell.path.separation for cell in self.cells]).reshape(*self.sizes.values(), -1)
        dims = ["step"]
        for axis, name in reversed(list(enumerate(self.sizes))):
            one = separation.take([0], axis)
            if (separation == one).all():
                separation = one.squeeze(axis)
            else:
                dims.insert(0, name)
        return Array(tuple(dims), separation, COORDINATES["separation"].attrs)


def make_plan(scene: Scene, chunk: int | None = None) -> Plan:
    """The plan of a scene; ``chunk`` as in Plan.

    SceneError where a map cannot be read, the way of the flat cannot be laid out, or two cells go different ways, in
    and out.
    """
    cells = tuple(_cells(scene))
    return Plan(scene, cells, tuple(left_out(scene)), chunk)


def _cells(scene: Scene) -> Iterator[Cell]:
    known: dict[tuple[bytes, bool], LoadingPath] = {}
    first: NDArray[np.str_] | None = None
    for cell, values in zip(scene.cells, scene.sweep.cells(), strict=True):
        way_in = cell.path.separations(cell.asperities.sigma if cell.path.uses_sigma else 0.0)
        key = way_in.tobytes(), cell.work > 0.0
        if key not in known:
            known[key] = LoadingPath.along(way_in, unload=cell.path.unload, adhesive=cell.work > 0.0)
            found = branches(known[key].separation)
            first = found if first is None else first
            if not np.array_equal(found, first):
                other = f"sweep: with {describe_cell(values)} the flat goes another way, in or out,"
                raise SceneError(f"{other} than in the first cell")
        yield Cell(cell, known[key])


def simulate_realization(
    scene: Scene, path: LoadingPath, realization: int, variables: list[str], estimator: str
) -> LoadSeparation:
    """The law of one realisation of a scene without a sweep, by an estimator."""
    effective_modulus, adhesion, section = scene.effective_modulus, scene.adhesion_model, scene.asperities
    if estimator == "expected":
        from roughmdr import expected

        return expected.compute(
            section, path, effective_modulus=effective_modulus, adhesion=adhesion, variables=variables
        )
    ensemble = section.ensemble(scene.seed, realization, stratified=estimator == "stratified")
    return compute(ensemble, path, effective_modulus=effective_modulus, adhesion=adhesion, variables=variables)


def left_out(scene: Scene) -> list[str]:
    """What the scene does not need, and why, as lines "part: reason"; in which cells, where not in all."""
    return count_by_cell((line for cell in scene.cells for line in _left_out(cell)), len(scene.cells))


def _left_out(scene: Scene) -> Iterator[str]:
    if scene.adhesion is None:
        yield "adhesion: the scene has no [adhesion]"
    elif scene.work == 0.0:
        yield "adhesion: adhesion.work is 0"
    if scene.adhesion_model.model == "auto":
        yield f"range of the adhesion: where JKR is off by less than {scene.adhesion_model.error:g}, see tabor_number"
    elif scene.work > 0.0 and not scene.adhesion_model.cohesive:
        yield "range of the adhesion: adhesion.model is 'jkr'"
    if scene.work == 0.0:
        yield "hysteresis: without adhesion a contact has no memory"
    if scene.batch.estimator == "expected":
        yield "random draws: batch.estimator is 'expected'"
    if scene.accuracy is not None and scene.accuracy.method == "expected":
        yield "random draws: accuracy.method is 'expected'"
    if scene.asperities.is_random:
        yield "positions: asperities are independent; nothing depends on where they stand"
    yield "interaction: asperities are independent; the scene has no [interaction]"
    unasked = [name for name in CURVE_VARIABLES if name not in scene.output.variables]
    if unasked:
        yield f"{', '.join(unasked)}: not among output.variables"
    if scene.output.keep == "statistics":
        yield "curves of the realisations: not stored, output.keep is 'statistics'"
    yield "asperities out of reach: not visited"
