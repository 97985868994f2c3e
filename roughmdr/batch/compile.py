"""What a round needs is compiled once, before several threads or a clock need it; nothing that no run asks for."""

from collections.abc import Iterable
from contextlib import suppress

from roughmdr.aggregate import LoadingPath, prepare
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.tasks import RunRange
from roughmdr.errors import RoughmdrError


def prepare_all(plan: Plan, stretches: Iterable[RunRange]) -> None:
    """Compile what these runs of a plan need."""
    kinds: set[tuple[object, ...]] = set()
    for stretch in stretches:
        cell = plan.cells[stretch.cell]
        law, shape, expected = (
            cell.scene.adhesion_model,
            cell.scene.asperities.shape_name,
            stretch.estimator == "expected",
        )
        kind = shape, law.work > 0.0, law.candidates, law.tabor_known, expected
        if kind in kinds:
            continue
        kinds.add(kind)
        if expected:
            _prepare_expected(cell, plan.scene.output.variables)
        else:
            prepare(shape, law)


def _prepare_expected(cell: Cell, variables: list[str]) -> None:
    from roughmdr import expected

    scene = cell.scene
    one = LoadingPath.along(cell.path.separation[:1], unload=False, adhesive=scene.work > 0.0)
    with suppress(RoughmdrError):  # that is said of the whole path
        expected.prepare(
            scene.asperities,
            one,
            effective_modulus=scene.effective_modulus,
            adhesion=scene.adhesion_model,
            variables=variables,
        )
