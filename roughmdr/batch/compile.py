"""Compiles what the runs of a round need, before several threads or a clock need it, and nothing that no run needs."""

from collections.abc import Iterable
from contextlib import suppress

from roughmdr.aggregate import LoadingPath, prepare
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.tasks import RunRange
from roughmdr.errors import RoughmdrError


def prepare_all(plan: Plan, ranges: Iterable[RunRange]) -> None:
    """Compile what these runs of a plan need."""
    prepared: set[tuple[object, ...]] = set()
    for runs in ranges:
        scene, expected = runs.cell.scene, runs.estimator == "expected"
        adhesion, shape = scene.adhesion_model, scene.asperities.shape_name
        kind = shape, adhesion.work > 0.0, adhesion.candidates, adhesion.tabor_known, expected
        if kind in prepared:
            continue
        prepared.add(kind)
        if expected:
            _prepare_expected(runs.cell, plan.scene.output.variables)
        else:
            prepare(shape, adhesion)


def _prepare_expected(cell: Cell, variables: list[str]) -> None:
    from roughmdr import expected

    scene = cell.scene
    one = LoadingPath.along(cell.path.separation[:1], unload=False, adhesive=scene.work > 0.0)
    with suppress(RoughmdrError):  # the run itself will report it
        expected.prepare(
            scene.asperities,
            one,
            effective_modulus=scene.effective_modulus,
            adhesion=scene.adhesion_model,
            variables=variables,
        )
