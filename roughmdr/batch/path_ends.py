"""The steps of a scene's path, with the ends that follow from its asperities and its material."""

from typing import NamedTuple

from roughmdr.errors import Fault, SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.identity import Digests
from roughmdr.scene.separation import CLEAR
from roughmdr.schema.units import format_quantity


class PathEnds(NamedTuple):
    """Ends of a path [m]; None where the scene gives them as separations."""

    clear: float | None = None
    reached: float | None = None


class PathFinder:
    """Finds the steps of the cells of a sweep; the ends that follow from equal scenes are found once."""

    def __init__(self) -> None:
        self._digests, self._found = Digests(), dict[str, PathEnds]()

    def values(self, cell: Scene) -> Floats:
        """Return the controlled quantity at each step in SI; SceneError where the path cannot be laid out."""
        path, sigma = cell.path, cell.asperities.sigma if cell.path.uses_sigma else 0.0
        if not path.starts_clear and path.target is None:
            return path.whole(path.values(sigma))
        key = self._digests.of(cell)
        if key not in self._found:
            self._found[key] = _find(cell, *path.given(sigma))
        return path.whole(path.values(sigma, *self._found[key]))

    @property
    def notes(self) -> list[str]:
        """Lines that say which separations the ends came to, the range of these in a sweep."""
        names = {"clear": f"start {CLEAR!r}", "reached": "stop where the target is reached"}
        found = {name: [getattr(ends, name) for ends in self._found.values()] for name in names}
        known = {name: [value for value in values if value is not None] for name, values in found.items()}
        lines = {name: (min(values), max(values)) for name, values in known.items() if values}
        return [f"{names[name]}: {format_quantity(low, 'm', to=high)}" for name, (low, high) in lines.items()]


def _find(cell: Scene, start: float | None, stop: float | None) -> PathEnds:
    """Return the ends that are not given as separations [m]."""
    from roughmdr.batch.found_ends import clear_start, target_stop

    clear = clear_start(cell) if start is None else None
    begin = clear if start is None else start
    assert begin is not None
    if stop is not None:
        if not stop < begin:
            message = f"must be below {format_quantity(begin, 'm')}, where a path that starts {CLEAR} begins"
            raise SceneError.of([Fault(f"path.{cell.path.control}.stop", format_quantity(stop, "m"), message)])
        return PathEnds(clear)
    assert cell.path.target is not None
    return PathEnds(clear, target_stop(cell, cell.path.target, begin))
