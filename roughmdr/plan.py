"""From a scene to tasks: which runs go together, and what is left out and why."""

import math
from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadSeparation, Route, compute, prepare
from roughmdr.aggregate.route import branches
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.labelled import Array
from roughmdr.scene import Scene
from roughmdr.scene.sweep import in_words
from roughmdr.variables import COORDINATES, LAW
from roughmdr.wording import in_cells

# One asperity drawn and sorted, and one visited at one step, in seconds on one core of a small server: only to cut the
# batch into tasks that are long beside dask's own 0.4 ms.
_DRAW, _VISIT, _VISIT_COHESIVE = 2e-7, 5e-9, 3e-7
_NODES = 10_000  # what an expected law takes, in visits a step
_TASK_SECONDS = 0.1  # a batch that takes less is one task: to load dask takes as long
_TASKS_AT_LEAST = 8  # so that two or three workers finish together


class Cell(NamedTuple):
    """A scene without a sweep, and the way of its flat."""

    scene: Scene
    route: Route


class Plan(NamedTuple):
    """What a run of a scene will do: all realisations of the first cell, then all of the second, and so on."""

    scene: Scene
    cells: tuple[Cell, ...]
    tasks: tuple[range, ...]
    """The runs of each task; run number c * realizations + r is realisation r of cell c."""
    left_out: tuple[str, ...]
    """Lines "part: reason"."""

    @property
    def runs(self) -> int:
        """How many runs there are, over all cells."""
        return len(self.cells) * self.scene.batch.realizations

    @property
    def sizes(self) -> dict[str, int]:
        """The swept dimensions, in their order."""
        return self.scene.sweep.sizes

    def run(self, number: int) -> tuple[Cell, int]:
        """The cell and the realisation of a run."""
        cell, realization = divmod(number, self.scene.batch.realizations)
        return self.cells[cell], realization

    def name_of(self, number: int) -> str:
        """A run in words."""
        cell, realization = divmod(number, self.scene.batch.realizations)
        values = next(islice(self.scene.sweep.cells(), cell, None))
        return ", ".join([*([in_words(values)] if values else []), f"realisation {realization}"])

    def coordinates(self) -> dict[str, Array]:
        """The swept values, the separation over those of them that change it, and the branch."""
        return {
            **self.scene.sweep.coordinates(),
            "separation": self._separation(),
            "branch": self.cells[0].route.branch(),
        }

    def _separation(self) -> Array:
        first = self.cells[0].route
        if all(cell.route is first for cell in self.cells):
            return Array(("step",), first.separation, COORDINATES["separation"].attrs)
        separation = np.array([cell.route.separation for cell in self.cells]).reshape(*self.sizes.values(), -1)
        dims = ["step"]
        for axis, name in reversed(list(enumerate(self.sizes))):
            one = separation.take([0], axis)
            if (separation == one).all():
                separation = one.squeeze(axis)
            else:
                dims.insert(0, name)
        return Array(tuple(dims), separation, COORDINATES["separation"].attrs)


def make_plan(scene: Scene, chunk: int | None = None) -> Plan:
    """The plan of a scene; ``chunk`` runs a task, by default as many as make a task worth its overhead.

    SceneError where a map cannot be read, the way of the flat cannot be laid out, or two cells go different ways, in
    and out.
    """
    cells = tuple(_cells(scene))
    runs = len(cells) * scene.batch.realizations
    tasks = _tasks(scene, cells) if chunk is None else [range(i, min(i + chunk, runs)) for i in range(0, runs, chunk)]
    return Plan(scene, cells, tuple(tasks), tuple(left_out(scene)))


def _cells(scene: Scene) -> Iterator[Cell]:
    known: dict[tuple[bytes, bool], Route] = {}
    first: NDArray[np.str_] | None = None
    for cell, values in zip(scene.cells, scene.sweep.cells(), strict=True):
        way_in = cell.path.separations(cell.asperities.sigma if cell.path.uses_sigma else 0.0)
        key = way_in.tobytes(), cell.work > 0.0
        if key not in known:
            known[key] = Route.along(way_in, unload=cell.path.unload, adhesive=cell.work > 0.0)
            found = branches(known[key].separation)
            first = found if first is None else first
            if not np.array_equal(found, first):
                other = f"sweep: with {in_words(values)} the flat goes another way, in or out,"
                raise SceneError(f"{other} than in the first cell")
        yield Cell(cell, known[key])


def _tasks(scene: Scene, cells: tuple[Cell, ...]) -> Iterator[range]:
    """Runs in their order, as many a task as take about as long as a task should."""
    seconds = [_seconds(cell) for cell in cells]
    realizations = scene.batch.realizations
    runs, in_all = len(cells) * realizations, sum(seconds) * realizations
    if in_all <= _TASK_SECONDS:
        yield range(runs)
        return
    enough = min(_TASK_SECONDS, in_all / _TASKS_AT_LEAST)
    begin, number, filled = 0, 0, 0.0
    for cell, each in enumerate(seconds, start=1):
        while number < cell * realizations:
            taken = min(max(math.ceil((enough - filled) / each), 1), cell * realizations - number)
            number, filled = number + taken, filled + taken * each
            if filled >= enough or number == runs:
                yield range(begin, number)
                begin, filled = number, 0.0


def _seconds(cell: Cell) -> float:
    visit = _VISIT_COHESIVE if "dugdale" in cell.scene.law.candidates else _VISIT
    if cell.scene.batch.estimator == "expected":
        return _NODES * visit * cell.route.separation.size
    return cell.scene.asperities.expected_count * (_DRAW + visit * cell.route.separation.size)


def prepare_all(plan: Plan) -> None:
    """Compile what a plan needs, once, before several threads or a clock need it."""
    needed: dict[tuple[object, ...], Cell] = {}
    for cell in plan.cells:
        law = cell.scene.law
        needed.setdefault((cell.scene.asperities.shape_name, law.work > 0.0, law.candidates, law.known), cell)
    for scene, route in needed.values():
        if scene.batch.estimator == "expected":
            one = Route.along(route.separation[:1], unload=False, adhesive=scene.work > 0.0)
            with suppress(RoughmdrError):  # that is said of the whole path
                law_of(scene, one, 0, plan.scene.output.variables)
        else:
            prepare(scene.asperities.shape_name, scene.law)


def law_of(scene: Scene, route: Route, realization: int, variables: list[str]) -> LoadSeparation:
    """The law of one realisation of a scene without a sweep, by its estimator."""
    modulus, adhesion, section = scene.modulus, scene.law, scene.asperities
    if scene.batch.estimator == "expected":
        from roughmdr import expected

        return expected.compute(section, route, modulus=modulus, adhesion=adhesion, variables=variables)
    ensemble = section.ensemble(scene.seed, realization, stratified=scene.batch.estimator == "stratified")
    return compute(ensemble, route, modulus=modulus, adhesion=adhesion, variables=variables)


def left_out(scene: Scene) -> list[str]:
    """What the scene does not need, and why, as lines "part: reason"; in which cells, where not in all."""
    return in_cells((line for cell in scene.cells for line in _left_out(cell)), len(scene.cells))


def _left_out(scene: Scene) -> Iterator[str]:
    if scene.adhesion is None:
        yield "adhesion: the scene has no [adhesion]"
    elif scene.work == 0.0:
        yield "adhesion: adhesion.work is 0"
    if scene.law.model == "auto":
        yield f"range of the adhesion: where JKR is off by less than {scene.law.error:g}, see tabor_number"
    elif scene.work > 0.0 and not scene.law.cohesive:
        yield "range of the adhesion: adhesion.model is 'jkr'"
    if scene.work == 0.0:
        yield "hysteresis: without adhesion a contact has no memory"
    if scene.batch.estimator == "expected":
        yield "random draws: batch.estimator is 'expected'"
    if scene.asperities.drawn:
        yield "positions: asperities are independent; nothing depends on where they stand"
    yield "interaction: asperities are independent; the scene has no [interaction]"
    unasked = [name for name in LAW if name not in scene.output.variables]
    if unasked:
        yield f"{', '.join(unasked)}: not among output.variables"
    if scene.output.keep == "statistics":
        yield "curves of the realisations: not stored, output.keep is 'statistics'"
    yield "asperities out of reach: not visited"
