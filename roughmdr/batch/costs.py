"""Rough costs of runs, by which they are split into tasks and the cheapest method for an asked error is chosen.

Seconds on one core of a small server (``pipelines/study.py``: work_precision, scaling), right to a factor of about
three. They are constants, never measured, so that every machine chooses alike.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.batch.plan import Cell, Plan
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import MachinePath, legs_of
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES, TabledShape
from roughmdr.storage.room import IN_MEMORY
from roughmdr.variables import LOSSES

START_UP = 1.2
"""Seconds of ``roughmdr run`` for a scene of one asperity, once its kernels are compiled: 1.1 to 1.3 s of one core."""
_LAWS_OF_DERIVATIVE = 4  # number of laws beside that of the scene, for each number that it is differentiated by
_RUN, _DRAW = 1.5e-4, 2e-7  # seconds to begin a run; to draw and sort an asperity
_STRATIFY = 8e-4  # seconds to begin stratified draws
_VISIT, _VISIT_PROFILE, _VISIT_DUGDALE = 5e-9, 4e-8, 8e-8  # seconds of an asperity at a step
_VISIT_DUGDALE_PROFILE, _VISIT_DUGDALE_TABLE = 9e-7, 2e-5
_ENERGETIC = 10.0  # factor on a visit where energies are asked for: 6 to 17 (spheres, truncated cones); paraboloids 1.1
_FIRST_RULE, _MORE_NODES = 8, 1.5  # with the first rule's nodes to this power, an expected law takes longer


class _Law(NamedTuple):
    """Seconds of an expected law: begin, each step, and nodes**_MORE_NODES times node and at each step node_step."""

    begin: float
    """Its tables."""
    step: float
    node: float
    """The tables of a node."""
    node_step: float


_ELASTIC, _JKR, _DUGDALE = (
    _Law(3e-3, 1.2e-5, 1.5e-3, 1.5e-6),
    _Law(1.2e-2, 5e-5, 1.8e-3, 1e-5),
    _Law(1.5e-2, 1e-4, 5e-2, 2e-4),
)
_PARABOLOIDS, _HEIGHTS_DEPEND = 0.3, 6.0  # factors on the seconds of a node
_SOUGHT, _SOUGHT_PAIRS, _SOUGHT_ADHERING = 2.5, 4.0, 3.6
"""How many times as long a path takes whose separations are sought: 2.3 to 2.8 (2000 and 20 000 paraboloids), 3.4 to
4.7 (100 to 900 in pairs, under a pressure), 3.6 (median of 150 ensembles of 2 to 8 adhesive pairs)."""
_JUMP, _JUMP_VISITS, _JUMP_VISITS_PROFILE = 3e-5, 4.0, 24.0
"""Seconds for each contact whose jump on a machine is located, and visits that it takes of each other contact: of
paraboloids 1.6 to 5.4 (2000 to 7600 contacts), of spheres 23 to 27 (190 to 2700), on each leg."""
_HEIGHTS = 1000  # asperities that are drawn to tell which share touches
_YIELDING, _YIELDING_PAIRS = 10, 4.0  # with a hardness, separations more; factor on pairs: 1.9 to 5 (400 asperities)
_MEAN_FIELD_PASSES = 6  # factor on independent asperities: Newton's method takes all steps at once
# Seconds of asperities that feel each other in pairs: to begin, each separation of the path (solved once), and each
# asperity and each contact there: right to 1.4 for 9 ensembles of 100 to 4000 paraboloids.
_PAIRWISE_BEGIN, _PAIRWISE_STEP, _PAIRWISE_VISIT, _PAIRWISE_CONTACT = 2e-2, 2.2e-3, 3e-7, 1.4e-5
# Seconds with adhesion: to begin, a step of the path, and each contact that is made and lost, which grows with their
# number: right to 1.4 for 12 ensembles of 100 to 2000 paraboloids with up to 160 contacts, and 4000 with some 900.
_ADHERING_BEGIN, _ADHERING_STEP, _ADHERING, _ADHERING_EACH = 0.5, 1.4e-3, 4.5e-2, 2e-5
_GRID_STEP = 1.2  # seconds of a separation by boundary elements, should they be needed
_FIND_HILL = 2e-3  # seconds to find a hill, where each realisation has a map of its own
_NUMBER = 8  # bytes
_ASPERITY = 110  # bytes of an asperity: of a paraboloid, drawn and summed with JKR, 86 to 105 were measured
_PAIRED_ASPERITY = 2000  # bytes where they feel each other in pairs: a million took 2.0 GB
_ADHERING_PAIR = 100  # bytes of each two asperities with adhesion: four matrices, and parts of them
_MAP_POINT = 20  # bytes of a point of a map that is drawn: 18 to 36 with its summits, 30 to 60 with its hills
_RUN_BYTES = 1000  # bytes of the numbers of a run beside its curves: 50 000 runs took 0.96 kB each
_BRANCH, _STEP_IN_FILE = 36, 68  # bytes: the name of the branch of a step in memory; that and its separation on disk


def seconds(cell: Cell, estimator: str) -> float:
    """Return about how long one run takes [s]: the search for its separations and jumps, and what stages compute beside
    its law.
    """
    law = along_seconds(cell, estimator) * _search_factor(cell, estimator)
    law += _jump_seconds(cell) if locates_jumps(cell, estimator) else 0.0
    return (1 + _LAWS_OF_DERIVATIVE * len(cell.scene.output.derivatives)) * law + beside(cell)[0]


def along_seconds(cell: Cell, estimator: str) -> float:
    """Return about how long the law of one run takes [s] along separations that are given."""
    adhesion, section, steps = cell.scene.adhesion_model, cell.scene.asperities, cell.controlled.solutions
    if cell.scene.interaction is not None and not cell.scene.needs_positions:
        steps *= _MEAN_FIELD_PASSES
    hard = cell.scene.material.hardness is not None
    steps += sum(stage.more_separations for stage in cell.scene.stages) + (_YIELDING if hard else 0)
    if estimator == "expected":
        return _expected_seconds(cell.scene, steps)
    begin = _RUN + (_STRATIFY if estimator == "stratified" else 0.0)
    if section.shape_name == "mdr_table" and section.is_random:
        begin += section.expected_count * _FIND_HILL
    if cell.scene.needs_positions:
        return begin + section.expected_count * _DRAW + paired_seconds(cell) * (_YIELDING_PAIRS if hard else 1.0)
    energetic = adhesion.work > 0.0 and not {"energy", *LOSSES}.isdisjoint(cell.scene.output.variables)
    visit = max([_visit_seconds(adhesion, section.shape_name), *(stage.visit_seconds for stage in cell.scene.stages)])
    visit *= _ENERGETIC if energetic and section.shape_name != "paraboloid" else 1.0
    return begin + section.expected_count * (_DRAW + visit * steps)


def _search_factor(cell: Cell, estimator: str) -> float:
    """Return how many times as long a run takes whose separations a load, a spring or a preload leads to."""
    if not isinstance(cell.controlled, MachinePath) or estimator == "expected":
        return 1.0
    if not cell.scene.needs_positions:
        return _SOUGHT
    return _SOUGHT_ADHERING if cell.scene.work > 0.0 else _SOUGHT_PAIRS


def locates_jumps(cell: Cell, estimator: str) -> bool:
    """Return whether jumps of the flat are located, since the energy that they lose is asked for."""
    alone = estimator != "expected" and not cell.scene.needs_positions and cell.scene.work > 0.0
    return alone and not cell.controlled.rigid and not LOSSES.isdisjoint(cell.scene.output.variables)


def _jump_seconds(cell: Cell) -> float:
    """Return about how long it takes to locate the jumps by which all contacts are made, and lost [s]."""
    assert isinstance(cell.controlled, MachinePath)  # ``locates_jumps`` makes sure
    scene, contacts = cell.scene, touching(cell)
    visit = _visit_seconds(scene.adhesion_model, scene.asperities.shape_name)
    visits = _JUMP_VISITS if scene.asperities.shape_name == "paraboloid" else _JUMP_VISITS_PROFILE
    return len(legs_of(cell.controlled.demand)) * contacts * (_JUMP + visits * contacts * visit)


def touching(cell: Cell) -> float:
    """Return about how many asperities the flat reaches, as a few of them tell, or of drawn maps a normal height."""
    source = cell.scene.asperities
    if source.map_points:
        above = cell.path.separation.min() - np.median(source.extremes(0.5).height)
        return 0.5 * source.expected_count * math.erfc(above / (math.sqrt(2.0) * source.sigma))
    if cell.scene.flat:
        heights = source.limited_to(_HEIGHTS).ensemble(cell.scene.seed, 0).height
    else:  # a part of the patch would be a part of the body
        heights = cell.scene.pressed(source.ensemble(cell.scene.seed, 0, with_positions=True)).height
    reached = np.count_nonzero(heights > cell.path.separation.min())
    return source.expected_count * reached / max(heights.size, 1)


def _visit_seconds(adhesion: Adhesion, shape: str) -> float:
    """Return about how long an asperity takes at a step [s]."""
    simple = shape == "paraboloid" or not adhesion.work
    if "dugdale" not in adhesion.candidates:
        return _VISIT if simple else _VISIT_PROFILE
    table = SHAPES[shape].shared or issubclass(SHAPES[shape], TabledShape)
    return _VISIT_DUGDALE if simple else _VISIT_DUGDALE_TABLE if table else _VISIT_DUGDALE_PROFILE


def _expected_seconds(scene: Scene, steps: int) -> float:
    """Return about how long an expected law takes [s]."""
    section, adhesion = scene.asperities, scene.adhesion_model
    nodes = section.node_count(_FIRST_RULE)
    for stage in scene.stages:
        if (own := stage.expected_seconds(nodes, steps, adhering=adhesion.work > 0.0)) is not None:
            return own
    law = (_DUGDALE if "dugdale" in adhesion.candidates else _JKR) if adhesion.work else _ELASTIC
    weight = nodes**_MORE_NODES if nodes > 1 else 0.0
    tables, each = law.node, law.node_step
    if section.heights_depend:
        tables, each = _HEIGHTS_DEPEND * tables, _HEIGHTS_DEPEND * each
    elif section.shape_name == "paraboloid" and law is not _DUGDALE:
        tables, each = _PARABOLOIDS * tables, 0.0
    return law.begin + weight * tables + steps * (law.step + weight * each)


def paired_seconds(cell: Cell) -> float:
    """Return about how long one realisation takes [s] whose asperities feel each other in pairs.

    Each step is one on the grid, where ``beyond`` allows that.
    """
    count, contacts = cell.scene.asperities.expected_count, touching(cell)
    if cell.scene.work > 0.0:
        return _ADHERING_BEGIN + cell.steps * _ADHERING_STEP + contacts * (_ADHERING + contacts * _ADHERING_EACH)
    beyond = None if cell.scene.interaction is None else cell.scene.interaction.beyond
    grid = _GRID_STEP if beyond == "boundary_elements" else 0.0
    each = grid + _PAIRWISE_STEP + count * _PAIRWISE_VISIT + contacts * _PAIRWISE_CONTACT
    return _PAIRWISE_BEGIN + np.unique(cell.path.separation).size * each


def beside(cell: Cell, *, finest: bool = False) -> tuple[float, float]:
    """Return about how long [s] and how much memory [byte] stages take beside the law of a realisation.

    That is on the grids that they begin with, or on the ``finest``.
    """
    separations = np.unique(cell.path.separation).size
    own = [stage.beside(cell.scene, separations, finest=finest) for stage in cell.scene.stages]
    return sum(time for time, _ in own), sum(memory for _, memory in own)


def file_bytes(plan: Plan, runs: int) -> int:
    """Return about how large the result file of so many runs is."""
    return _STEP_IN_FILE * plan.steps + _value_bytes(plan, runs)


def result_bytes(plan: Plan, runs: int, *, on_disk: bool = True) -> int:
    """Return the memory [byte] while the result is assembled: as it came, unless curves got their places at once, and
    in its places.

    Curves beyond some are ``on_disk`` where they are written to a file and there is space.
    """
    values, beside_curves, copies = _value_bytes(plan, runs), 0, 2
    if plan.scene.output.keep == "curves":
        beside_curves, copies = _RUN_BYTES * runs, 1 if plan.scene.accuracy is None else 2
        values = min(values, IN_MEMORY) if on_disk else values
    return _BRANCH * plan.steps + copies * values + beside_curves


def ensemble_bytes(plan: Plan) -> float:
    """Return the memory [byte] of the largest ensemble that is drawn, while its law is computed."""
    scenes = (cell.scene for cell in plan.cells if cell.scene.estimators[0] != "expected")
    return max((_drawn_bytes(scene) for scene in scenes if scene.asperities.is_random), default=0.0)


def _drawn_bytes(scene: Scene) -> float:
    """Return the memory [byte] of the asperities of a realisation, with their map."""
    count = scene.asperities.expected_count
    paired = _PAIRED_ASPERITY + (_ADHERING_PAIR * count if scene.work > 0.0 else 0.0)
    return count * (paired if scene.needs_positions else _ASPERITY) + _MAP_POINT * scene.asperities.map_points


def _value_bytes(plan: Plan, runs: int) -> int:
    """Return the size of the variables: the curves of all runs or, of each cell, four statistics."""
    output = plan.scene.output
    curves = _NUMBER * plan.steps * len(output.variables)
    return curves * runs if output.keep == "curves" else 4 * curves * len(plan.cells)
