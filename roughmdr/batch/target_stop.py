"""stop = { contact_fraction = ... } or { pressure = ... }: the largest separation at which loading reaches it.

It is sought in the expected law where the asperities have one, else in a stratified realisation; where nothing is
drawn, in the asperities themselves. Asperities that feel each other do so in pairs, as precisely as they are asked to.
"""

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.batch.realization import simulate_ensemble, simulate_realization
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.loading.first_reached import Law, OutOfReach, first_reached
from roughmdr.model_error.refusal import Givens, likely_cause
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.separation import Target

_RTOL = 1e-14  # of the distance from the start
_MOST_OF_PATCH = 0.3  # of the nominal area: a contact that is none of many
_FIRST = 1e-6  # of the width of an asperity: the first distance where all summits are at the start


def target_stop(scene: Scene, target: Target, start: float) -> float:
    """Return the stop [m] of a scene without a sweep, whose path begins at ``start`` [m].

    SceneError where the target cannot be reached.
    """
    if scene.asperities.nominal_area is None:
        raise _fault(target, "needs a nominal area, which these asperities do not have")
    middle = scene.asperities.extremes(0.5)
    distances = (start - float(np.median(middle.height)), _FIRST * float(middle.columns.width.max()))
    scene, pairwise = scene.without_grid, scene.interaction_model if scene.needs_positions else None
    rtol = _RTOL if pairwise is None else pairwise.error
    try:
        law = _law(scene, [target.variable], start)
        stop = first_reached(law, target.value, start, max(distances), rtol, target.variable)
        at_stop = (_law(scene, [name], start)(np.array([stop]))[0] for name in ("contact_fraction", "contact_count"))
        fraction, contacts = map(float, at_stop)
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


def _law(scene: Scene, names: list[str], start: float) -> Law:
    """Return the function: falling separations [m] -> the variable there, in loading from ``start`` [m]."""
    source, variable = scene.asperities, names[0]

    def path(separations: Floats) -> LoadingPath:
        return LoadingPath.along(np.append(start, separations), unload=False, adhesive=scene.work > 0.0)

    if source.is_random and not scene.reason_against("expected"):
        return lambda h: simulate_realization(scene, path(h), 0, names, "expected").variables[variable][1:]
    stratified = source.is_random and not source.reason_against("stratified")
    ensemble = source.ensemble(scene.seed, 0, stratified=stratified, with_positions=scene.needs_positions)
    return lambda h: simulate_ensemble(scene, path(h), ensemble, names).variables[variable][1:]


def _fault(target: Target, message: str) -> SceneError:
    return SceneError.of([Fault(f"path.separation.stop.{target.variable}", f"{target.value:g}", message)])
