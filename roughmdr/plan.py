"""From a scene to tasks: which realisations go together, and what is left out and why."""

from typing import NamedTuple

from roughmdr.aggregate import Route
from roughmdr.ensemble import RandomAsperities
from roughmdr.scene import Scene
from roughmdr.variables import LAW

# One asperity drawn and sorted, and one visited at one step, in seconds on one core of a small server: only to cut the
# batch into tasks that are long beside dask's own 0.4 ms.
_DRAW, _VISIT = 2e-7, 5e-9
_TASK_SECONDS = 0.1
_TASKS_AT_LEAST = 8  # so that two or three workers finish together


class Plan(NamedTuple):
    """What a run of a scene will do."""

    scene: Scene
    route: Route
    chunks: tuple[tuple[int, ...], ...]
    """The realisations of each task."""
    left_out: tuple[str, ...]
    """Lines "part: reason"."""


def make_plan(scene: Scene, chunk: int | None = None) -> Plan:
    """The plan of a scene; ``chunk`` realisations a task, by default as many as make a task worth its overhead."""
    way_in = scene.path.separations(scene.asperities.sigma)
    route = Route.along(way_in, unload=scene.path.unload, adhesive=scene.work > 0.0)
    count = scene.batch.realizations
    size = chunk if chunk is not None else _chunk(scene, route)
    chunks = tuple(tuple(range(start, min(start + size, count))) for start in range(0, count, size))
    return Plan(scene, route, chunks, tuple(left_out(scene)))


def _chunk(scene: Scene, route: Route) -> int:
    asperities = scene.asperities.count if isinstance(scene.asperities, RandomAsperities) else 1000
    seconds = asperities * (_DRAW + _VISIT * route.separation.size)
    fair = -(-scene.batch.realizations // _TASKS_AT_LEAST)
    return max(1, min(fair, round(_TASK_SECONDS / seconds)))


def left_out(scene: Scene) -> list[str]:
    """What the scene does not need, and why, as lines "part: reason"."""
    lines = []
    if scene.adhesion is None:
        lines.append("adhesion: the scene has no [adhesion]")
        lines.append("hysteresis: without adhesion a contact has no memory")
    elif scene.work == 0.0:
        lines.append("adhesion: adhesion.work is 0")
    if isinstance(scene.asperities, RandomAsperities):
        lines.append("positions: asperities are independent; nothing depends on where they stand")
    lines.append("interaction: asperities are independent; the scene has no [interaction]")
    unasked = [name for name in LAW if name not in scene.output.variables]
    if unasked:
        lines.append(f"{', '.join(unasked)}: not among output.variables")
    lines.append("asperities out of reach: not visited")
    return lines
