"""[viscoelastic]: the body and the motion of a scene, the paths that it allows, and its law from the elastic one."""

import numpy as np

from roughmdr.aggregate import LoadSeparation
from roughmdr.errors import Fault, SceneError
from roughmdr.layer.motion import FlatMotion
from roughmdr.layer.relaxation import Relaxation
from roughmdr.layer.viscoelastic import ElasticLaw, Viscoelasticity, viscoelastic_law
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.schema.units import format_quantity


def body_of(scene: Scene) -> Viscoelasticity:
    """Return the viscoelastic body of a scene, and the motion of its flat."""
    section = scene.viscoelastic
    assert section is not None
    shares, times = ([getattr(term, name) for term in section.relaxation] for name in ("share", "time"))
    motion = FlatMotion(section.speed, section.speed_of_retraction, section.dwell)
    return Viscoelasticity(Relaxation(np.array(shares), np.array(times)), motion)


def law_of(
    scene: Scene, separation: Floats, names: list[str], elastic: ElasticLaw, highest: float, area: float | None
) -> LoadSeparation:
    """Return the viscoelastic law of asperities up to the ``highest`` summit [m] on a nominal area [m2].

    SceneError where the separations [m] fall again after they rose.
    """
    _check_order(separation)
    clear = np.nextafter(highest, np.inf)  # a contact at first touch is none there
    return viscoelastic_law(elastic, separation, names, body_of(scene), clear=float(clear), nominal_area=area)


def time_of(scene: Scene, separation: Floats) -> Floats:
    """Return the time of each step [s] since the first."""
    return body_of(scene).motion.time(separation)


def check_path(scene: Scene, separation: Floats) -> None:
    """Raise SceneError unless separations [m] fall, stay at the lowest and rise, in a finite time."""
    _check_order(separation)
    section = scene.viscoelastic
    assert section is not None
    if section.dwell > 0.0 and np.argmin(separation) == separation.size - 1:
        message = "has no step to end at: path.hold adds steps at the lowest separation, path.unload a retraction"
        raise _fault("viscoelastic.dwell", message, format_quantity(section.dwell, "s"))
    with np.errstate(over="ignore", invalid="ignore"):
        if not np.isfinite([*time_of(scene, separation), section.speed_of_retraction / section.speed]).all():
            raise _fault("viscoelastic", "has speeds by which the path takes longer than a float holds")


def _check_order(separation: Floats) -> None:
    """Raise SceneError unless separations [m] fall, stay at the lowest and rise."""
    first, last = np.flatnonzero(separation == separation.min())[[0, -1]]
    step, change = np.arange(1, separation.size), np.diff(separation)
    wrong = step[np.where(step <= first, change >= 0.0, np.where(step <= last, change != 0.0, change <= 0.0))]
    if wrong.size:
        reached = format_quantity(float(separation[wrong[0]]), "m")
        message = "must fall to its lowest value and rise from there, once, with [viscoelastic]"
        raise _fault("path.separation", f"{message}; step {wrong[0]}, {reached}, is against that")


def _fault(key: str, message: str, value: str = "") -> SceneError:
    return SceneError.of([Fault(key, value, message)])
