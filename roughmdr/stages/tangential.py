"""[tangential]: friction and the tangential stiffness of the bodies: partial slip, or contacts that stick."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from roughmdr.errors import OutOfRange
from roughmdr.schema.faults import mismatch
from roughmdr.schema.material import dundurs_beta, stiffness_ratio
from roughmdr.schema.quantities import Quantity
from roughmdr.stages.conduction import RADIUS
from roughmdr.stages.stage import Contacts, Given, Law, Stage
from roughmdr.variables import DEFAULT_LATERAL_VARIABLES, TANGENTIAL_VARIABLES

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.loading.lateral import LateralPath, Path
    from roughmdr.numerics.arguments import Floats
    from roughmdr.stages.slip import SlipConstants

_RATIOS = 0.5, 1.5  # allowed G*/E*: isotropic bodies have 2/3 (nu = 1/2) to 4/3 (nu = -1)
_STICKING, _LONE_RADIUS = "tangential_stiffness", "contact_radius_sum"
_ISOTROPIC = ("random", "nayak")  # sources without a preferred direction
_COUPLED = (
    "contacts that feel each other begin to slip at different displacements; the scene without path.lateral gives "
    "their tangential_stiffness before any slips, without [interaction] it gives slip"
)


class Tangential(Stage):
    """[tangential]: coefficient of friction, and G*/E* where the elastic constants do not tell it."""

    key = "tangential"
    about = "Friction, for path.lateral, and the tangential stiffness of the bodies"
    about_absent = "lateral forces"
    examples: ClassVar[Mapping[str, str]] = {"friction": "0.3"}
    small_scene: ClassVar[Mapping[str, Any]] = {
        "tangential": {"friction": 0.3},
        "material": {"modulus": "1 GPa", "poisson": 0.3},
        "path": {"separation": "1 sigma", "lateral": {"amplitude": "1 nm", "steps": 4}},
    }
    fitted = False
    own_variables = tuple(TANGENTIAL_VARIABLES)
    noted = "slip"
    papers: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("Cattaneo1938", "Mindlin1949", "Jaeger1995", "Masing1926", "MindlinDeresiewicz1953"), "slip"
    )

    friction: Annotated[float, Quantity("1", above=0.0)] | None = None
    """Coefficient of friction."""
    stiffness_ratio: Annotated[float, Quantity("1", at_least=_RATIOS[0], at_most=_RATIOS[1])] | None = None
    """G*/E*, tangential over normal stiffness, where only effective_modulus is given."""

    @classmethod
    def usual_variables(cls, table: Mapping[str, Any]) -> list[str] | None:
        path = table.get("path")
        lateral = path.get("lateral") if isinstance(path, dict) else getattr(path, "lateral", None)
        return None if lateral is None else list(DEFAULT_LATERAL_VARIABLES)

    @classmethod
    def check_without(cls, scene: Given) -> None:
        if subject := _asked(scene):
            key = "tangential.friction" if scene.path.lateral is not None else "tangential"
            raise mismatch(key, f"is missing; {subject} needs it")

    def check(self, scene: Given) -> None:
        """Raise a mismatch where lateral forces are asked for and another section forbids them, or G*/E* is unknown."""
        lateral, subject = scene.path.lateral is not None, _asked(scene)
        if self.stiffness_ratio is not None and scene.bodies is not None:
            raise mismatch("tangential.stiffness_ratio", "follows from the modulus and poisson of [material] already")
        if not subject:
            return
        if lateral and self.friction is None:
            raise mismatch("tangential.friction", f"is missing; {subject} needs it")
        if self.ratio(scene) is None:
            message = f"is missing; {subject} needs G*/E*, which material.effective_modulus does not tell; "
            raise mismatch("tangential.stiffness_ratio", f"{message}for example: stiffness_ratio = 0.8")
        if lateral and scene.interaction is not None:
            raise mismatch("interaction", f"does not go with {subject}: {_COUPLED}")
        if lateral and scene.work > 0.0:
            reason = "the shear of adhesive contacts is no difference of normal contacts"
            raise mismatch("path.lateral", f"does not go with adhesion: {reason}")
        for stage in scene.stages:
            if lateral and stage.on_grid:
                reason = "boundary elements press along the normal only"
                raise mismatch(stage.key, f"does not go with {subject}: {reason}")

    @classmethod
    def alone(cls, scene: Given, section: "Tangential | None") -> str:
        return "" if scene.path.lateral is None else "path.lateral"

    @classmethod
    def left_out(cls, scene: Given, section: "Tangential | None") -> Iterator[str]:
        yield from super().left_out(scene, section)
        if section is not None and scene.path.lateral is None:
            yield "slip: the scene has no path.lateral"

    def notes(self, scene: Given) -> Iterator[str]:
        """Yield effects that the theory neglects in lateral forces that are asked for, or are on the path."""
        if TANGENTIAL_VARIABLES.keys().isdisjoint(scene.output.variables):
            return
        bodies = scene.bodies
        if bodies is None:
            yield "shear is taken not to move the surface along the normal, as where Dundurs' beta is 0"
        elif beta := dundurs_beta(*bodies):
            yield f"shear is taken not to move the surface along the normal, though Dundurs' beta is {beta:.2g}"
        if bodies is None or any(bodies[1::2]):
            yield "slip is taken to go along the displacement, as where Poisson's ratio is 0"

    def ratio(self, scene: Given) -> float | None:
        """Return G*/E* [1]; None where it is not known."""
        return self.stiffness_ratio if scene.bodies is None else stiffness_ratio(*scene.bodies)

    def constants(self, scene: Given) -> "SlipConstants":
        """Return the constants of the contacts, for a scene with a known G*/E*."""
        from roughmdr.stages.slip import SlipConstants

        ratio = self.ratio(scene)
        assert ratio is not None  # ``check`` makes sure
        return SlipConstants(scene.effective_modulus, ratio, math.nan if self.friction is None else self.friction)

    def inner_variables(self, names: list[str]) -> list[str]:
        from roughmdr.stages.slip import normal_variables

        return normal_variables(names)

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the law with lateral forces, where it is asked for them.

        OutOfRange as ``partial_slip``, or where no separation bears the constant load.
        """
        from roughmdr.loading.lateral import LateralPath
        from roughmdr.loading.path import LoadingPath

        def along(separation: "Floats", names: list[str]) -> "LoadSeparation":
            return contacts.law(LoadingPath.along(separation, unload=False, adhesive=False), names)

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            if isinstance(path, LateralPath):
                from roughmdr.stages.slip import partial_slip

                return partial_slip(along, _separation(contacts.law, path), path.memory, self.constants(scene), names)
            return self._sticking(scene, contacts, path, names) if _STICKING in names else contacts.law(path, names)

        return law

    def _sticking(self, scene: Given, contacts: Contacts, path: "Path", names: list[str]) -> "LoadSeparation":
        """Return the law with the stiffness of contacts that stick: 2 G* times their conductance radius, and its error.

        Along x a tangential force moves the surface by [1 + (1 - G*/E*) cos(2 theta)]/(pi G* r), a normal one by
        1/(pi E* r) (Cerruti and Boussinesq: K. L. Johnson, Contact Mechanics (1985), sections 3.2 and 3.6). On average
        over the directions theta the coupling of contacts is the same along both.
        """
        from roughmdr.model_error.conductance import sticking_error

        constants, of_contacts = self.constants(scene), [name for name in names if name != _STICKING]
        needed = [*of_contacts, RADIUS, _LONE_RADIUS, "contact_area", "contact_count"]
        law = contacts.law(path, list(dict.fromkeys(needed)))
        radius, lone, area, count = (
            law.variables[name] for name in (RADIUS, _LONE_RADIUS, "contact_area", "contact_count")
        )
        touching = lone > 0.0
        isotropic = scene.asperities.source in _ISOTROPIC
        error = sticking_error(
            law.conductance_error,
            constants.stiffness_ratio,
            1.0 - radius[touching] / lone[touching],
            area[touching] / (scene.nominal_area or math.nan) / (count[touching] if isotropic else 1.0),
        )
        sticking = {_STICKING: constants.stiffness(radius)}
        return law._replace(variables=law.variables | sticking, tangential_error=error).only(names)

    @classmethod
    def cites(cls, table: Mapping[str, Any], variables: list[str]) -> Mapping[str, str]:
        if "lateral" in table.get("path", {}):
            return cls.papers
        return {"Mindlin1949": cls.papers["Mindlin1949"]} if _STICKING in variables else {}


def _asked(scene: Given) -> str:
    """Return in words which entry needs lateral forces, or an empty text; a mismatch where it lacks path.lateral."""
    lateral = scene.path.lateral is not None
    asked = [name for name in scene.output.variables if name in TANGENTIAL_VARIABLES]
    if not lateral and (wrong := [name for name in asked if name != _STICKING]):
        raise mismatch("output.variables", f"{wrong[0]} needs a lateral path: path.lateral")
    return "path.lateral" if lateral else f"{_STICKING} among output.variables" if asked else ""


def _separation(normal: Law, path: "LateralPath") -> float:
    """Return the constant separation [m], or that at which the constant load is borne."""
    from roughmdr.loading.path import LoadingPath

    if isinstance(path.held, LoadingPath):
        return path.held_value
    separation = float(normal(path.held, ["separation"]).variables["separation"][-1])
    if not math.isfinite(separation):
        raise OutOfRange(f"no separation bears the {path.held.control} that is held, {path.held_value:g} in SI")
    return separation
