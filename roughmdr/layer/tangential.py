"""Lateral forces of a scene: partial slip along a lateral path, or the stiffness of contacts that stick on another."""

import math
from collections.abc import Callable, Iterable, Iterator

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.errors import OutOfRange
from roughmdr.layer.conductance import RADIUS
from roughmdr.layer.slip import Tangential, partial_slip
from roughmdr.loading.lateral import LateralPath
from roughmdr.loading.machine import MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.model_error.conductance import sticking_error
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.tangential import bodies_of, ratio_of
from roughmdr.schema.two_bodies import dundurs_beta
from roughmdr.variables import TANGENTIAL_VARIABLES

Path = LoadingPath | MachinePath | LateralPath
NormalLaw = Callable[[LoadingPath | MachinePath, list[str]], LoadSeparation]
"""A path of the flat, or of a machine, and the variables asked for -> the law along it."""
_STICKING, _LONE_RADIUS = "tangential_stiffness", "contact_radius_sum"
_ISOTROPIC = ("random", "nayak")  # sources whose asperities stand in no direction rather than in another


def tangential_of(scene: Scene) -> Tangential | None:
    """Return the constants of a scene under tangential load; None where it has none."""
    if scene.tangential is None:
        return None
    ratio, friction = ratio_of(scene.tangential, bodies_of(scene.material, scene.counter)), scene.tangential.friction
    if ratio is None:
        return None
    return Tangential(scene.effective_modulus, ratio, math.nan if friction is None else friction)


def unneeded(scene: Scene) -> Iterator[str]:
    """Yield what a scene does not need of lateral forces, and why, as lines "part: reason"."""
    if scene.tangential is None:
        yield "lateral forces: the scene has no [tangential]"
    elif scene.path.lateral is None:
        yield "slip: the scene has no path.lateral"


def neglected(scene: Scene, names: Iterable[str]) -> Iterator[str]:
    """Yield what the theory neglects in lateral forces of a scene that are among the ``names``, or lie on its path."""
    bodies = bodies_of(scene.material, scene.counter)
    if TANGENTIAL_VARIABLES.keys().isdisjoint(names):
        return
    if bodies is None:
        yield "shear is taken not to move the surface along the normal, as where Dundurs' beta is 0"
    elif beta := dundurs_beta(*bodies):
        yield f"shear is taken not to move the surface along the normal, though Dundurs' beta is {beta:.2g}"
    if bodies is None or any(bodies[1::2]):
        yield "slip is taken to go along the displacement, as where Poisson's ratio is 0"


def with_tangential(scene: Scene, normal: NormalLaw, path: Path, names: list[str]) -> LoadSeparation:
    """Return the law of a scene along a path, with lateral forces where these are among the ``names``.

    OutOfRange as ``partial_slip``, or where no separation bears the load that is held.
    """
    if not isinstance(path, LateralPath) and _STICKING not in names:
        return normal(path, names)
    if not isinstance(path, LateralPath):
        return _sticking(scene, normal, path, names)
    tangential = tangential_of(scene)
    assert tangential is not None  # as ``Scene`` validates

    def along(separation: Floats, names: list[str]) -> LoadSeparation:
        return normal(LoadingPath.along(separation, unload=False, adhesive=False), names)

    return partial_slip(along, _separation(normal, path), path.memory, tangential, names)


def _sticking(scene: Scene, normal: NormalLaw, path: LoadingPath | MachinePath, names: list[str]) -> LoadSeparation:
    """Return the law with the stiffness of contacts that stick: 2 G* times their conductance radius, and its error.

    Along x a tangential force moves the surface by [1 + (1 - G*/E*) cos(2 theta)]/(pi G* r), a normal one by
    1/(pi E* r) (Cerruti and Boussinesq: K. L. Johnson, Contact Mechanics (1985), sections 3.2 and 3.6). On average over
    the directions theta contacts are coupled alike along both.
    """
    tangential, of_contacts = tangential_of(scene), [name for name in names if name != _STICKING]
    assert tangential is not None  # as ``Scene`` validates
    law = normal(path, list(dict.fromkeys([*of_contacts, RADIUS, _LONE_RADIUS, "contact_area", "contact_count"])))
    radius, lone, area, count = (
        law.variables[name] for name in (RADIUS, _LONE_RADIUS, "contact_area", "contact_count")
    )
    touching = lone > 0.0
    isotropic = scene.asperities.source in _ISOTROPIC
    error = sticking_error(
        law.conductance_error,
        tangential.stiffness_ratio,
        1.0 - radius[touching] / lone[touching],
        area[touching] / (scene.nominal_area or math.nan) / (count[touching] if isotropic else 1.0),
    )
    sticking = {_STICKING: tangential.stiffness(radius)}
    return law._replace(variables=law.variables | sticking, tangential_error=error).only(names)


def _separation(normal: NormalLaw, path: LateralPath) -> float:
    """Return the separation [m] that is held, or at which what is held is borne."""
    if isinstance(path.held, LoadingPath):
        return path.held_value
    separation = float(normal(path.held, ["separation"]).variables["separation"][-1])
    if not math.isfinite(separation):
        raise OutOfRange(f"no separation bears the {path.held.control} that is held, {path.held_value:g} in SI")
    return separation
