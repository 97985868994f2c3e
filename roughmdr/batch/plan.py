"""The plan of a scene: its cells, each with the path of its flat or its machine, and what is left out."""

from collections.abc import Iterator
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath
from roughmdr.batch.choice import Choice
from roughmdr.batch.paths import PathFinder, machine_path, usual_path
from roughmdr.errors import SceneError
from roughmdr.interaction.placed import check_placed
from roughmdr.loading.lateral import LateralPath, Path
from roughmdr.loading.machine import MachinePath, attributes_of
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.lateral import displacements
from roughmdr.scene.sweep import describe_cell
from roughmdr.schema.wording import count_by_cell
from roughmdr.stages import STAGES
from roughmdr.storage.labelled import Array
from roughmdr.variables import COORDINATES, OUTPUT_VARIABLES


class Cell(NamedTuple):
    """A scene without a sweep, and the path of its flat."""

    scene: Scene
    path: LoadingPath
    """The path of the flat; under a machine that over usual asperities, by which costs and contacts are foreseen."""
    controlled: Path
    """The path that is controlled."""

    @property
    def values(self) -> Floats:
        """The controlled quantity at each step, in SI."""
        return self.controlled.values

    @property
    def steps(self) -> int:
        """Number of steps of the path."""
        return int(self.path.separation.size)


class Plan(NamedTuple):
    """The cells of a scene, and what they do not need."""

    scene: Scene
    cells: tuple[Cell, ...]
    left_out: tuple[str, ...]  # lines "part: reason"
    path_notes: tuple[str, ...] = ()  # which separations "clear" and targets came to
    choice: Choice | None = None  # how a quantity is computed that is asked for

    @property
    def sizes(self) -> dict[str, int]:
        """The swept dimensions, in their order."""
        return self.scene.sweep.sizes

    @property
    def steps(self) -> int:
        """Number of steps of the paths, which is the same in all cells."""
        return self.cells[0].steps

    @property
    def watched(self) -> str:
        """The variable that [accuracy] is about."""
        return self.cells[0].controlled.watched if self.choice is None else self.choice.variable

    @property
    def keeps_statistics(self) -> bool:
        """Whether statistics over the realisations are kept, not their curves."""
        return self.scene.output.keep == "statistics"

    @property
    def unloads(self) -> bool:
        """Whether the flat rises anywhere on its path, which is so in all cells or in none."""
        return self.cells[0].controlled.unloads

    @property
    def control(self) -> str:
        """The quantity that the path controls."""
        return self.cells[0].controlled.control

    @property
    def variables(self) -> list[str]:
        """The variables of the result over its steps."""
        asked = self.cells[0].controlled.variables(self.scene.output.variables)
        return [*asked, *(name for stage in self.scene.stages for name in stage.more_variables(asked))]

    @property
    def warnings(self) -> list[str]:
        """Warnings of entries that may not be as intended, with the number of cells where not in all."""
        of_cells = (text for cell in self.cells for text in (*cell.scene.doubts, *cell.scene.asperities.warnings))
        return count_by_cell(of_cells, len(self.cells))

    @property
    def stage_notes(self) -> dict[str, list[str]]:
        """Lines on what the theory of each stage neglects, by name, with the number of cells where not in all."""

        def lines(noted: str) -> Iterator[str]:
            stages = ((cell.scene, stage) for cell in self.cells for stage in cell.scene.stages)
            yield from (text for scene, stage in stages if stage.noted == noted for text in stage.notes(scene))

        return {stage.noted: count_by_cell(lines(stage.noted), len(self.cells)) for stage in STAGES if stage.noted}

    @property
    def lattice_lines(self) -> list[str]:
        """Lines on the lattices that asperities fill, with the number of cells where not of all."""
        lines = filter(None, (cell.scene.asperities.lattice_in_words for cell in self.cells))
        return count_by_cell(lines, len(self.cells))

    @property
    def map_lines(self) -> list[str]:
        """Lines on the maps of the asperities, with the number of cells where not of all."""
        return count_by_cell((text for cell in self.cells for text in cell.scene.map_lines), len(self.cells))

    def name_of(self, cell: int) -> str:
        """Describe the first run of a cell: its swept values, and its realisation."""
        values = next(islice(self.scene.sweep.cells(), cell, None))
        return ", ".join([*([describe_cell(values)] if values else []), "realisation 0"])

    def coordinates(self) -> dict[str, Array]:
        """Return the swept values and, over the steps, the controlled quantity, the branch and perhaps the time."""
        steps = {self.control: self._over_changing([cell.values for cell in self.cells], attributes_of(self.control))}
        for number, stage in enumerate(self.scene.stages):
            own = [cell.scene.stages[number].coordinates(cell.values) for cell in self.cells]
            steps |= {
                name: self._over_changing([each[name] for each in own], COORDINATES[name].attrs)
                for name in stage.coordinates(self.cells[0].values)
            }
        return {**self.scene.sweep.coordinates(), **steps, "branch": self.cells[0].controlled.branch()}

    def _over_changing(self, rows: list[Floats], attrs: dict[str, str]) -> Array:
        """Return rows over the steps, one for each cell, over those swept keys that change them, and the steps."""
        values, dims = rows[0], ["step"]
        if any(row is not rows[0] for row in rows):
            values = np.array(rows).reshape(*self.sizes.values(), -1)
            for axis, name in reversed(list(enumerate(self.sizes))):
                first_only = values.take([0], axis)
                if (values == first_only).all():
                    values = first_only.squeeze(axis)
                else:
                    dims.insert(0, name)
        return Array(tuple(dims), values, attrs)


def make_plan(scene: Scene) -> Plan:
    """Return the plan of a scene.

    SceneError where a map cannot be read, a path cannot be laid out, or two cells differ in where they load and unload.
    """
    paths: dict[tuple[object, ...], LoadingPath] = {}
    cells: list[Cell] = []
    first: NDArray[Any] | None = None
    last: Path | None = None
    finder = PathFinder()
    for cell, values in zip(scene.cells, scene.sweep.cells(), strict=True):
        try:
            _check_asperities_read(cell)
            planned = _planned(cell, finder.values(cell), paths)
        except SceneError as error:
            raise scene.located(error, describe_cell(values)) from None
        if planned.controlled is not last:
            last, branch = planned.controlled, planned.controlled.branch().values
            first = branch if first is None else first
            if not np.array_equal(branch, first):
                others = "the flat loads and unloads at other steps than in the first cell"
                raise SceneError(f"sweep: with {describe_cell(values)} {others}")
        cells.append(planned)
    left_out = count_by_cell((line for cell in scene.cells for line in _left_out(cell)), len(scene.cells))
    return Plan(scene, tuple(cells), tuple(left_out), tuple(finder.notes))


def _planned(cell: Scene, values: Floats, paths: dict[tuple[object, ...], LoadingPath]) -> Cell:
    """Return a cell with its path; those of separations are made once for equal ``values``."""
    for stage in cell.stages:
        stage.check_path(values)
    if cell.path.lateral is not None:
        return _moved_sideways(cell, values[:1])
    if cell.path.control == "separation":
        key = values.tobytes(), cell.work > 0.0
        if key not in paths:
            paths[key] = LoadingPath.along(values, unload=False, adhesive=cell.work > 0.0)
        return Cell(cell, paths[key], paths[key])
    machine = machine_path(cell, values)
    return Cell(cell, usual_path(cell, machine), machine)


def _moved_sideways(cell: Scene, held: Floats) -> Cell:
    """Return a cell whose flat is moved sideways while a separation or a load, in SI, is held."""
    assert cell.path.lateral is not None
    displacement = cell.path.whole(displacements(cell.path.lateral))
    usual = LoadingPath.along(held, unload=False, adhesive=False)
    holding: LoadingPath | MachinePath = usual
    if cell.path.control != "separation":
        holding = machine_path(cell, held)
        usual = usual_path(cell, holding)
    stays = LoadingPath.along(np.full(displacement.size, usual.separation[0]), unload=False, adhesive=False)
    return Cell(cell, stays, LateralPath.along(holding, displacement))


def _check_asperities_read(cell: Scene) -> None:
    """SceneError where asperities that are read, not drawn, lack what their interaction or a stage needs."""
    if cell.asperities.is_random or not (cell.placed or cell.interaction):
        return
    ensemble = cell.asperities.ensemble(cell.seed, 0)
    for stage in cell.stages:
        stage.check_read(cell, ensemble)
    if cell.interaction is not None:
        check_placed(ensemble, cell.interaction)


def _left_out(scene: Scene) -> Iterator[str]:
    """Yield what a scene without a sweep does not need, and why, as lines "part: reason"."""
    if scene.adhesion is None:
        yield "adhesion: the scene has no [adhesion]"
    elif scene.work == 0.0:
        yield "adhesion: adhesion.work is 0"
    if scene.adhesion_model.model == "auto":
        least = f"{scene.adhesion_model.error:g} along the path, jumps into contact included"
        yield f"range of the adhesion: where JKR is off by less than {least}; adhesion_law tells where that is"
    elif scene.work > 0.0 and not scene.adhesion_model.cohesive:
        yield "range of the adhesion: adhesion.model is 'jkr'"
    if scene.batch.estimator == "expected":
        yield "random draws: batch.estimator is 'expected'"
    if scene.accuracy is not None and scene.accuracy.method == "expected":
        yield "random draws: accuracy.method is 'expected'"
    if scene.asperities.is_random and not scene.placed:
        independent = "interaction.model is 'mean_field'" if scene.interaction else "asperities are independent"
        yield f"positions: {independent}; nothing depends on their positions"
    if scene.interaction is None:
        yield "interaction: asperities are independent; the scene has no [interaction]"
    absent = list[str]()
    for stage in STAGES:
        section = getattr(scene, stage.key)
        yield from stage.left_out(scene, section)
        absent += stage.own_variables if section is None else ()
    if unasked := [name for name in OUTPUT_VARIABLES if name not in (*absent, *scene.output.variables)]:
        yield f"{', '.join(unasked)}: not among output.variables"
    if scene.output.keep == "statistics":
        yield "curves of the realisations: not stored, output.keep is 'statistics'"
    yield "asperities too low for contact: not visited"
