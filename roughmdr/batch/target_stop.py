"""stop = { contact_fraction = ... } or { pressure = ... }: the largest separation at which loading reaches it.

It is sought in the expected law where the asperities have one, else in a stratified realisation; where nothing is
drawn, in the asperities themselves. Asperities that feel each other do so in pairs, as precisely as they are asked to.
"""

from collections.abc import Callable

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.batch.realization import simulate_ensemble, simulate_realization
from roughmdr.errors import Fault, RoughmdrError, SceneError, TooMuchContact
from roughmdr.model_error.refusal import Givens, likely_cause
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.separation import Target

_POINTS = 16  # separations that the law is computed at together
_RTOL = 1e-14  # of the distance from the start
_MAX_DOUBLINGS = 60
_MOST_OF_PATCH = 0.3  # of the nominal area: a contact that is none of many
_FIRST = 1e-6  # of the width of an asperity: the first distance where all summits are at the start

_Law = Callable[[Floats], Floats]


def target_stop(scene: Scene, target: Target, start: float) -> float:
    """Return the stop [m] of a scene without a sweep, whose path begins at ``start`` [m].

    SceneError where the target cannot be reached.
    """
    if scene.asperities.nominal_area is None:
        raise _fault(target, "needs a nominal area, which these asperities do not have")
    middle = scene.asperities.extremes(0.5)
    distances = (start - float(np.median(middle.height)), _FIRST * float(middle.nondimensional().width.max()))
    scene, pairwise = scene.without_grid, scene.interaction_model if scene.needs_positions else None
    rtol = _RTOL if pairwise is None else pairwise.error
    try:
        stop = _first_reached(_law(scene, [target.variable], start), target, start, max(distances), rtol)
        at_stop = (_law(scene, [name], start)(np.array([stop]))[0] for name in ("contact_fraction", "contact_count"))
        fraction, contacts = map(float, at_stop)
        if fraction > _MOST_OF_PATCH * contacts:
            givens = Givens(scene.effective_modulus, scene.work, scene.asperities.sigma, 1.0, 0.0)
            reason = f"is reached by contacts of {fraction / contacts:.2g} times the nominal area each"
            raise _fault(target, f"{reason}: {likely_cause(stop, givens)}")
        return stop
    except SceneError:
        raise
    except RoughmdrError as error:
        raise _fault(target, f"cannot be looked for: {error}") from error


def _law(scene: Scene, names: list[str], start: float) -> _Law:
    """Return the function: falling separations [m] -> the variable there, in loading from ``start`` [m]."""
    source, variable = scene.asperities, names[0]

    def path(separations: Floats) -> LoadingPath:
        return LoadingPath.along(np.append(start, separations), unload=False, adhesive=scene.work > 0.0)

    if source.is_random and not scene.reason_against("expected"):
        return lambda h: simulate_realization(scene, path(h), 0, names, "expected").variables[variable][1:]
    stratified = source.is_random and not source.reason_against("stratified")
    ensemble = source.ensemble(scene.seed, 0, stratified=stratified, with_positions=scene.needs_positions)
    return lambda h: simulate_ensemble(scene, path(h), ensemble, names).variables[variable][1:]


def _first_reached(law: _Law, target: Target, start: float, distance: float, rtol: float) -> float:
    """Return the largest separation [m] with the target, by search in ever longer and then ever shorter intervals."""
    if law(np.array([start]))[0] >= target.value:
        raise _fault(target, f"is reached above the start, {start:.4g} m; start must be higher")
    above, below, most = start, start - distance, 0.0
    for _ in range(_MAX_DOUBLINGS):
        h, values = _between(law, above, below)
        if (values >= target.value).any():
            break
        most = max(most, float(values.max()))
        above, below, distance = below, below - 2.0 * distance, 2.0 * distance
    else:
        raise _fault(target, f"is out of reach: the largest {target.variable} of these asperities is {most:.4g}")
    while True:
        first = int(np.argmax(values >= target.value))
        above, below = float(h[first - 1]) if first else above, float(h[first])
        resolution = max(rtol * (start - below), float(np.spacing(max(abs(above), abs(below)))))
        if above - below <= resolution:
            return below
        h, values = _between(law, above, below)


def _between(law: _Law, above: float, below: float) -> tuple[Floats, Floats]:
    """Return separations [m] from next to ``above`` to ``below``, and the law there."""
    h = np.linspace(above, below, _POINTS + 1)[1:]
    return h, _capped(law, h)


def _capped(law: _Law, separations: Floats) -> Floats:
    """Return the law at falling separations [m]: inf where there would be more contact than nominal area."""
    try:
        return law(separations)
    except TooMuchContact:
        if separations.size == 1:
            return np.array([np.inf])
        half = separations.size // 2
        first, rest = _capped(law, separations[:half]), np.full(separations.size - half, np.inf)
        return np.concatenate([first, _capped(law, separations[half:]) if np.isfinite(first[-1]) else rest])


def _fault(target: Target, message: str) -> SceneError:
    return SceneError.of([Fault(f"path.separation.stop.{target.variable}", f"{target.value:g}", message)])
