"""The path of a scene: its machine, and its steps with the ends that follow from asperities and material: start =
"clear", and stop = { contact_fraction = ... } or { pressure = ... }.

At "clear" no asperity of any realisation touches, or attracts, the flat. Of asperities that are not drawn it is exact.
Of others it lies above the height that is exceeded, with a chance of 1e-3, by any asperity of ten thousand realisations
(or of as many as there can be, if these are more), by the depth of detachment that is the largest where every shape
parameter is between quantiles as extreme. So it depends neither on what is drawn nor on how many of these realisations
there are.

A target is the largest separation at which loading reaches it. It is sought in the expected law where the asperities
have one, else in a stratified realisation; where nothing is drawn, in the asperities themselves. Asperities that feel
each other do so in pairs, as precisely as they are asked to.
"""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.aggregate import LoadingPath, Problem
from roughmdr.batch.realization import problem_of, simulate_ensemble, simulate_problem, simulate_realization
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.loading.first_reached import OutOfReach, first_reached
from roughmdr.loading.machine import MachinePath
from roughmdr.model_error.refusal import Givens, likely_cause
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.identity import Digests
from roughmdr.scene.separation import CLEAR, Target
from roughmdr.schema.units import format_quantity

_RTOL = 1e-14  # error of the stop, over its distance from the start
_MOST_OF_PATCH = 0.3  # area of a contact, over the nominal one, that makes it none of many
_FIRST = 1e-6  # first distance, over the width of an asperity, where all summits are at the start
_CHANCE = 1e-3  # probability that any asperity of all realisations is higher
_REALIZATIONS = 10_000  # least number of realisations allowed for, so that a batch can be extended
_USUAL_CHANCE = 0.1  # or that of the highest asperity of a realisation, for what is usual
_FAR = 1e3  # distance of the start, over the usual one, at which nearly all steps would have no contact


class PathFinder:
    """Finds the steps of the cells of a sweep; the ends that follow from equal scenes are found once."""

    def __init__(self) -> None:
        self._digests, self._found = Digests(), dict[str, tuple[float | None, float | None]]()

    def values(self, cell: Scene) -> Floats:
        """Return the controlled quantity at each step in SI; SceneError where the path cannot be laid out."""
        path, sigma = cell.path, cell.asperities.sigma if cell.path.uses_sigma else 0.0
        if not path.starts_clear and path.target is None:
            return path.whole(path.values(sigma))
        key = self._digests.of(cell)
        if key not in self._found:
            self._found[key] = _found_ends(cell, *path.given(sigma))
        return path.whole(path.values(sigma, *self._found[key]))

    @property
    def notes(self) -> list[str]:
        """Lines that say which separations the ends came to, the range of these in a sweep."""
        names = f"start {CLEAR!r}", "stop where the target is reached"
        found = ([end for end in ends if end is not None] for ends in zip(*self._found.values(), strict=True))
        pairs = [(name, ends) for name, ends in zip(names, found, strict=False) if ends]
        return [f"{name}: {format_quantity(min(ends), 'm', to=max(ends))}" for name, ends in pairs]


def _found_ends(cell: Scene, start: float | None, stop: float | None) -> tuple[float | None, float | None]:
    """Return the start and the stop that follow from a scene [m]; None for those that are given as separations."""
    begin = clear_start(cell) if start is None else start
    clear = begin if start is None else None
    if stop is None:
        assert cell.path.target is not None
        return clear, target_stop(cell, cell.path.target, begin)
    if not stop < begin:
        message = f"must be below {format_quantity(begin, 'm')}, where a path that starts {CLEAR} begins"
        raise SceneError.of([Fault(f"path.{cell.path.control}.stop", format_quantity(stop, "m"), message)])
    return clear, None


def target_stop(scene: Scene, target: Target, start: float) -> float:
    """Return the stop [m] of a scene without a sweep, whose path begins at ``start`` [m].

    SceneError where the target cannot be reached.
    """
    if scene.asperities.nominal_area is None:
        raise _fault(target, "needs a nominal area, which these asperities do not have")
    middle = scene.asperities.extremes(0.5)
    distances = (start - float(np.median(middle.height)), _FIRST * float(middle.columns.width.max()))
    scene, pairwise = scene.without_grid, scene.interaction if scene.needs_positions else None
    rtol = _RTOL if pairwise is None else pairwise.error
    try:
        law, name = _law(scene, start), target.variable
        stop = first_reached(lambda h: law(h, [name])[0], target.value, start, max(distances), rtol, name)
        fraction, contacts = law(np.array([stop]), ["contact_fraction", "contact_count"])[:, 0].tolist()
        if fraction > _MOST_OF_PATCH * contacts:
            givens = Givens(scene.effective_modulus, scene.work, scene.asperities.sigma, 1.0, 0.0)
            reason = f"is reached by contacts of {fraction / contacts:.2g} times the nominal area each"
            raise _fault(target, f"{reason}: {likely_cause(stop, givens)}")
        return stop
    except SceneError:
        raise
    except OutOfReach as error:
        raise _fault(target, str(error)) from error
    except RoughmdrError as error:
        raise _fault(target, f"cannot be looked for: {error}") from error


def _law(scene: Scene, start: float) -> Callable[[Floats, list[str]], Floats]:
    """Return the function: falling separations [m] -> variables [name, step] there, in loading from ``start`` [m].

    Coupled contacts, for which the start makes no difference, go on from where they have been.
    """
    source, begin = scene.asperities, np.empty(0) if scene.needs_positions else np.array([start])
    expected = source.is_random and not scene.reason_against("expected")
    drawn = None if expected else source.evenly_drawn(scene.seed, with_positions=scene.needs_positions)
    problem = None if drawn is None else problem_of(scene, drawn)

    def law(separations: Floats, names: list[str]) -> Floats:
        path = LoadingPath.along(np.append(begin, separations), unload=False, adhesive=scene.work > 0.0)
        if problem is None:
            found = simulate_realization(scene, path, 0, names, "expected")
        else:
            found = simulate_problem(scene, path, problem, names)
        return np.array([found.variables[name][begin.size :] for name in names])

    return law


def _fault(target: Target, message: str) -> SceneError:
    return SceneError.of([Fault(f"path.separation.stop.{target.variable}", f"{target.value:g}", message)])


def clear_start(scene: Scene) -> float:
    """Return the start [m] of a scene without a sweep; SceneError where there is none that makes sense."""
    most = scene.batch.realizations if scene.accuracy is None else scene.accuracy.max_realizations
    count = max(scene.asperities.expected_count, 1.0)
    start = _exceeded(scene, -math.expm1(math.log1p(-_CHANCE) / (count * max(_REALIZATIONS, most))))
    if not math.isfinite(start):
        raise _no_start("cannot be found: no float holds the contact of asperities as extreme as there may be")
    start += sum((stage.clear_above(scene) for stage in scene.stages), start=0.0)
    if scene.asperities.is_random:
        usual = _exceeded(scene, min(_USUAL_CHANCE, 1.0 / count))
        middle = float(scene.asperities.extremes(0.5).height.max())
        if start - middle > _FAR * (usual - middle):
            far = "some may be very high, or detach very late"
            raise _no_start(f"would be {start:.3g} m, where most realisations need {usual:.3g} m: {far}")
    return start


def _exceeded(scene: Scene, chance: float) -> float:
    """Return the separation [m] that is clear of all asperities but those more extreme than this chance."""
    return Problem(scene.asperities.extremes(chance), scene.effective_modulus, scene.adhesion_model).clear


def _no_start(message: str) -> SceneError:
    hint = 'give it as a separation, as start = "4 sigma"'
    return SceneError.of([Fault("path.separation.start", f'"{CLEAR}"', f"{message}; {hint}")])


def machine_path(cell: Scene, values: Floats) -> MachinePath:
    """Return the path of a machine that controls these values, in SI; SceneError where it needs a nominal area."""
    path, area = cell.path, cell.asperities.nominal_area
    if path.area_key and area is None:
        raise SceneError.of([Fault(path.area_key, "", "needs a nominal area, which these asperities do not have")])
    if path.to_preload:
        stiffness, adhesive = path.machine_stiffness, cell.work > 0.0
        return MachinePath.to_preload(values, path.to_preload, machine_stiffness=stiffness, adhesive=adhesive)
    return MachinePath.along(
        path.control,
        values,
        machine_stiffness=path.machine_stiffness or 0.0,
        area=area or 1.0,
        adhesive=cell.work > 0.0,
    )


def usual_path(cell: Scene, machine: MachinePath) -> LoadingPath:
    """Return the path of the flat on evenly drawn, independent asperities; clear of them where it has been pulled off.

    SceneError where there is none.
    """
    ensemble, alone = cell.asperities.evenly_drawn(cell.seed), cell.model_copy(update={"interaction": None})
    try:
        law = simulate_ensemble(alone, machine, ensemble, ["separation"])
    except RoughmdrError as error:
        raise SceneError.of([Fault(f"path.{cell.path.key}", "", f"cannot be followed: {error}")]) from error
    clear = Problem(ensemble, cell.effective_modulus, cell.adhesion_model).clear
    separation = np.where(np.isnan(law.variables["separation"]), clear, law.variables["separation"])
    return LoadingPath.along(separation, unload=False, adhesive=machine.adhesive)
