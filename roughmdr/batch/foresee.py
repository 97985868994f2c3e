"""Foresees the physics of a cell from a few evenly drawn asperities: contact fraction, model error, Tabor number."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.batch.costs import paired_seconds
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.realization import simulate_ensemble, simulate_realization
from roughmdr.ensemble import Ensemble
from roughmdr.errors import RoughmdrError, TooMuchContact
from roughmdr.interaction import Interaction
from roughmdr.interaction.placed import part_of
from roughmdr.interaction.settings import reason_against_adhesion
from roughmdr.loading.lateral import Path
from roughmdr.loading.machine import MachinePath
from roughmdr.scene import Scene
from roughmdr.variables import LATERAL

_MAX_ASPERITIES = 1000
_MAX_STEPS = 60
_MAX_PAIRED, _MAX_PAIRED_STEPS = 200, 12  # where asperities feel each other in pairs, which takes longer
_MAX_CELLS, _MAX_CHECKED = 12, 100  # most cells to foresee, and to check before a run


class Foreseen(NamedTuple):
    """The law of a cell as a few asperities tell it."""

    path: LoadingPath
    """Some steps of the path of the cell."""
    law: LoadSeparation
    """Its contact fraction, pressure, effective number of contacts and sampling errors are those of all asperities."""
    fraction_at_pull_off: float
    """NaN where there is none, or no nominal area."""
    cell: int = 0
    """Number of the cell in its plan."""
    summits: bool = False
    """Whether its asperities are summits of a surface."""


class Prospect(NamedTuple):
    """Cells of a plan before they are run."""

    foreseen: tuple[Foreseen, ...]
    failures: tuple[str, ...]
    """Which of the cells that were tried cannot be computed, and why."""
    coupled_seconds: float
    """About how long a realisation would take [s] if its asperities felt each other; inf where their adhesion, another
    law or a lateral path does not let them."""
    interaction: Interaction | None
    """How asperities feel each other."""


def foresee_cells(plan: Plan) -> Prospect:
    """Foresee some cells of a plan, evenly chosen, the first and the last among them.

    RoughmdrError where none of these can be computed.
    """
    foreseen, failures = [], list[str]()
    for number in some_cells(plan):
        cell = plan.cells[number]
        separation, most = cell.path.separation, _MAX_PAIRED_STEPS if cell.scene.needs_positions else _MAX_STEPS
        steps = int(min([most, *(stage.most_foreseen for stage in cell.scene.stages)]))
        if separation.size > steps:
            some = np.linspace(0, separation.size - 1, steps).astype(int)
            separation = separation[np.unique(np.append(some, np.argmin(separation)))]
        path = LoadingPath.along(separation, unload=False, adhesive=cell.scene.work > 0.0)
        try:
            foresee = _foreseen if cell.scene.flat or cell.scene.needs_positions else _foreseen_curved
            foreseen.append(foresee(cell.scene, path)._replace(cell=number))
        except RoughmdrError as error:
            failures.append(f"{plan.name_of(number)}: {error}")
    if not foreseen:
        raise RoughmdrError(failures[0])
    coupled = max(
        math.inf
        if cell.scene.unlike
        or plan.control == LATERAL.name
        or reason_against_adhesion(Interaction(model="pairwise"), cell.scene.adhesion_model)
        else paired_seconds(cell)
        for cell in (plan.cells[number] for number in some_cells(plan))
    )
    return Prospect(tuple(foreseen), tuple(failures), coupled, plan.scene.interaction)


def some_cells(plan: Plan, most: int = _MAX_CELLS) -> list[int]:
    """Return the numbers of ``most`` cells at most, evenly chosen, the first and the last among them."""
    numbers: list[int] = np.unique(np.linspace(0, len(plan.cells) - 1, most).astype(int)).tolist()
    return numbers


def check_foreseen(plan: Plan) -> None:
    """Raise TooMuchContact where a run of one of some cells would have more contact area than its patch.

    The runs of the others tell it themselves, as do those of cells without random asperities, and expected laws.
    """
    checked, refused = some_cells(plan, _MAX_CHECKED), list[tuple[int, str]]()
    for number in checked:
        scene, closest = plan.cells[number].scene, np.array([plan.cells[number].path.separation.min()])
        if not scene.asperities.is_random or scene.estimators == ("expected",):
            continue
        try:
            _foreseen(scene, LoadingPath.along(closest, unload=False, adhesive=scene.work > 0.0))
        except TooMuchContact as error:
            refused.append((number, str(error)))
        except RoughmdrError:
            pass  # the runs will tell
    if refused:
        number, reason = refused[0]
        others = f" ({len(refused)} of {len(checked)} cells that were checked)" if len(plan.cells) > 1 else ""
        raise TooMuchContact(f"{plan.name_of(number)}: {reason}{others}")


def _foreseen(scene: Scene, path: LoadingPath) -> Foreseen:
    """Return the law of a part of the asperities on a part of the patch; coupled in pairs, never on a grid."""
    ensemble = _part(scene)
    variables = ["force"] if ensemble.nominal_area is None else ["force", "contact_fraction", "pressure"]
    variables = variables if scene.flat else _under_body(scene)
    law = _law_of_part(scene, path, ensemble, variables)
    area = ensemble.nominal_area if scene.flat else None
    area = math.nan if area is None else area
    return Foreseen(path, law, law.pull_off.contact_area / area, summits=ensemble.origin == "summits")


def foresee_law(cell: Cell, variables: list[str]) -> LoadSeparation:
    """Return the law of a part of the asperities along the path that is controlled, under so much less of a load."""
    ensemble, path = _part(cell.scene), cell.controlled
    if isinstance(path, MachinePath) and path.machine.is_dead_load:
        path = path._replace(demand=path.demand * _share(cell.scene, ensemble))
    return _law_of_part(cell.scene, path, ensemble, variables)


def _part(scene: Scene) -> Ensemble:
    """Return a part of the asperities of a scene; in pairs fewer, and under a curved body those it touches first."""
    source, paired = scene.asperities, scene.needs_positions
    count = _MAX_PAIRED if paired else _MAX_ASPERITIES
    if paired and not scene.flat:
        whole = scene.pressed(source.evenly_drawn(scene.seed, with_positions=True))
        few, area = whole.taken(np.arange(min(count, whole.height.size))), whole.nominal_area or math.nan
        return replace(few, nominal_area=area * few.height.size / max(whole.height.size, 1))
    if scene.interaction is not None and scene.interaction.boundary == "free" and not paired:
        count = math.ceil(source.expected_count)  # a larger patch sinks deeper under a pressure
    ensemble = source.limited_to(count).evenly_drawn(scene.seed, with_positions=paired)
    return part_of(ensemble, count) if paired else ensemble


def _share(scene: Scene, part: Ensemble) -> float:
    """Return the share of the nominal area that a part of the asperities stands on; 1 where none is known."""
    whole = scene.nominal_area
    return 1.0 if whole is None or part.nominal_area is None else part.nominal_area / whole


def _law_of_part(scene: Scene, path: Path, part: Ensemble, variables: list[str]) -> LoadSeparation:
    """Return the law of a part of the asperities, with the number of contacts and the scatter of all."""
    law, share = simulate_ensemble(_coarse(scene.without_grid), path, part, variables), _share(scene, part)
    scatter = {name: getattr(law, name) * math.sqrt(share) for name in ("sampling_error", "area_sampling_error")}
    return law._replace(effective_contacts=law.effective_contacts / share, **scatter)


def _foreseen_curved(scene: Scene, path: LoadingPath) -> Foreseen:
    """Return the law of a curved body as few rings tell it."""
    return Foreseen(path, simulate_realization(_coarse(scene), path, 0, _under_body(scene), "expected"), math.nan)


def _under_body(scene: Scene) -> list[str]:
    """Return the force, with the variables that stages add to it."""
    return ["force", *(name for stage in scene.stages for name in stage.more_variables(["force"]))]


def _coarse(scene: Scene) -> Scene:
    """Return a scene whose stages have larger errors and take less time."""
    return scene.model_copy(update={stage.key: stage.coarse() for stage in scene.stages})
