"""start = "clear": the separation above which no asperity of any realisation touches, or attracts, the flat.

Of asperities that are not drawn it is exact. Of others it lies above the height that is exceeded, with a chance of
1e-3, by any asperity of ten thousand realisations (or of as many as there can be, if these are more), by the depth of
detachment that is the largest where every shape parameter is between quantiles as extreme. So it depends neither on
what is drawn nor on how many of these realisations there are.
"""

import math

from roughmdr.aggregate import Problem
from roughmdr.errors import Fault, SceneError
from roughmdr.scene import Scene
from roughmdr.scene.separation import CLEAR

_CHANCE = 1e-3  # that any asperity of all realisations is higher
_REALIZATIONS = 10_000  # that are allowed for in any case, so that a batch can be extended
_USUAL_CHANCE = 0.1  # or that of the highest asperity of a realisation, for what is usual
_FAR = 1e3  # times as far as usual: nearly all steps would be where usual realisations have no contact


def clear_start(scene: Scene) -> float:
    """Return the start [m] of a scene without a sweep; SceneError where there is none that makes sense."""
    most = scene.batch.realizations if scene.accuracy is None else scene.accuracy.max_realizations
    count = max(scene.asperities.expected_count, 1.0)
    start = _exceeded(scene, -math.expm1(math.log1p(-_CHANCE) / (count * max(_REALIZATIONS, most))))
    if not math.isfinite(start):
        raise _fault("cannot be found: no float holds the contact of asperities as extreme as there may be")
    start += sum((stage.clear_above(scene) for stage in scene.stages), start=0.0)
    if scene.asperities.is_random:
        usual = _exceeded(scene, min(_USUAL_CHANCE, 1.0 / count))
        middle = float(scene.asperities.extremes(0.5).height.max())
        if start - middle > _FAR * (usual - middle):
            far = "some may be very high, or detach very late"
            raise _fault(f"would be {start:.3g} m, where most realisations need {usual:.3g} m: {far}")
    return start


def _exceeded(scene: Scene, chance: float) -> float:
    """Return the separation [m] that is clear of all asperities but those more extreme than this chance."""
    return Problem(scene.asperities.extremes(chance), scene.effective_modulus, scene.adhesion_model).clear


def _fault(message: str) -> SceneError:
    hint = 'give it as a separation, as start = "4 sigma"'
    return SceneError.of([Fault("path.separation.start", f'"{CLEAR}"', f"{message}; {hint}")])
