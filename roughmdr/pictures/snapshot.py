"""The contacts of one realisation of a result at one step, computed again from the scene that the result holds."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import Problem
from roughmdr.aggregate.each_contact import EachContact, contacts_at
from roughmdr.ensemble import Ensemble
from roughmdr.errors import StoreError
from roughmdr.loading.path import branches
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.style import in_words
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene, read
from roughmdr.schema.wording import short_repr
from roughmdr.variables import SEPARATION

_RTOL = 1e-6  # difference of the forces of contacts and curve, over the largest of the curve, that is allowed
_FAR = 1e3  # height above the path, over its depth, at which no contact is left


class Snapshot(NamedTuple):
    """The asperities of a realisation and their contacts at a step."""

    scene: Scene
    """The scene of the cell, without a sweep."""
    ensemble: Ensemble
    contacts: EachContact
    separation: float
    """[m]."""
    place: str
    """Cell, realisation, step and separation, in words."""

    @classmethod
    def of(
        cls,
        result: ResultView,
        file: Path | None,
        *,
        cell: tuple[int, ...] | None = None,
        realization: int = 0,
        step: int | None = None,
        placed: bool,
    ) -> "Snapshot":
        """Return the contacts at a step, by default the first at which the flat is closest, in a cell, by default the
        first; ``file`` is that of the result, if any, and ``placed`` asperities have positions.

        StoreError where there is no such cell, realisation or step, where it was not computed from asperities, or where
        these are not those of the result; SceneError where its scene cannot be read again.
        """
        cells = result.cells
        cell = cells[0] if cell is None else cell
        if cell not in cells:
            last = ", ".join(map(str, cells[-1]))
            raise StoreError(f"cell is {short_repr(cell)}; it must be an index of the swept keys, up to ({last})")
        _check_realization(result, cell, realization)
        path = _separations(result, cell, realization)
        step = _closest(result, (*cell, realization), path) if step is None else step
        if not 0 <= step < path.size:
            raise StoreError(f"step is {step}; the path of the result has steps 0 to {path.size - 1}")
        if np.isnan(path[step]):
            raise StoreError(f"step is {step}, at which there is no separation: the load has pulled the flat off")
        scene = read(file or result.scene).cells[cells.index(cell)]
        if scene.unlike and (scene.flat or not scene.needs_positions):
            raise StoreError(f"the result is of {scene.unlike}: single contacts are not computed of its scene")
        method = result.method(cell) or result.estimator
        if method == "expected":
            raise StoreError(
                "the result is an expected law, which has no asperities; run its scene with batch.estimator = 'sampled'"
            )
        drawn, placed = {"stratified": method == "stratified"}, placed or scene.needs_positions
        ensemble = scene.pressed(scene.asperities.ensemble(scene.seed, realization, **drawn, with_positions=placed))
        above = np.nanmax(path) + _FAR * (np.ptp(path[np.isfinite(path)]) + abs(np.nanmax(path)))
        problem = Problem(ensemble, scene.effective_modulus, scene.adhesion_model, scene.interaction)
        contacts = contacts_at(problem, np.where(np.isnan(path), above, path), step)
        on_grid = _on_grid(result, (*cell, realization))
        if not on_grid:
            _check_force(result, (*cell, realization), step, float(contacts.force.sum()))
        branch = branches(np.where(np.isnan(path), above, path))[step]
        where = (
            f"realisation {realization}, step {step} of {path.size} ({branch}), separation {in_words(path[step], 'm')}"
        )
        if on_grid:
            where += "; the result is by boundary elements, these are contacts coupled in pairs"
        label = result.label(cell)
        return cls(scene, ensemble, contacts, float(path[step]), f"{label}, {where}" if label else where)


def _check_realization(result: ResultView, cell: tuple[int, ...], realization: int) -> None:
    """Raise StoreError unless a realisation of a cell was computed."""
    kept = result.keeps_runs
    count = result.sizes["realization"] if kept else int(result.variables["realization_count"].values[cell])
    if not 0 <= realization < count:
        raise StoreError(f"realization is {realization}; the result has realisations 0 to {count - 1}")
    if not result.done[(*cell, realization) if kept else cell]:
        raise StoreError(f"realization is {realization}, which was not computed in this cell")


def _separations(result: ResultView, cell: tuple[int, ...], realization: int) -> Floats:
    """Return the separation at each step [m]; NaN where a load has pulled the flat off."""
    if result.control == SEPARATION.name:
        return np.array(result.path[cell])
    if SEPARATION.name not in result.variables:
        raise StoreError(
            f"the result has {result.control} for its path, and not the separations of each realisation; "
            "run its scene with output.keep = 'curves'"
        )
    return np.array(result.variables[SEPARATION.name].values[(*cell, realization)])


def _closest(result: ResultView, run: tuple[int, ...], path: Floats) -> int:
    """Return the first step at which the flat is closest, among those with a force if the result has forces."""
    force = result.variables.get("force")
    known = np.isfinite(path)
    if force is not None and (known & np.isfinite(force.values[run])).any():
        known &= np.isfinite(force.values[run])
    return int(np.argmin(np.where(known, path, np.inf)))


def _on_grid(result: ResultView, run: tuple[int, ...]) -> bool:
    """Return whether a run was computed by boundary elements; with statistics alone, whether any of its cell was."""
    if "grid_points" not in result.variables:
        return False
    grid = result.variables["grid_points"].values
    return bool(grid[run[: grid.ndim]] > 0.0)


def _check_force(result: ResultView, run: tuple[int, ...], step: int, force: float) -> None:
    """Raise StoreError where contacts have another force than the result."""
    if "force" not in result.variables:
        return
    curve = result.variables["force"].values[run]
    if not abs(force - curve[step]) <= _RTOL * np.nanmax(np.abs(curve)):
        raise StoreError(
            f"the asperities of the scene have a force of {in_words(force, 'N')} at step {step}, the result has "
            f"{in_words(curve[step], 'N')}: their file, or the code, has changed since; run the scene again"
        )
