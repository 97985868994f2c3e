"""[tangential]: friction, the tangential stiffness of the bodies, and what must agree with them in a scene."""

from typing import TYPE_CHECKING, Annotated

from pydantic import BeforeValidator

from roughmdr.scene.sections import Body, MaterialSection
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import Quantity, Section
from roughmdr.schema.two_bodies import stiffness_ratio
from roughmdr.variables import TANGENTIAL_VARIABLES

if TYPE_CHECKING:
    from roughmdr.scene.scene import Scene


_RATIOS = 0.5, 1.5  # isotropic bodies have 2/3 (nu = 1/2) to 4/3 (nu = -1)
_STICKING = "tangential_stiffness"


class TangentialSection(Section):
    """[tangential]: coefficient of friction, and G*/E* where the elastic constants do not tell it."""

    friction: Annotated[float, BeforeValidator(Quantity("1", above=0.0))] | None = None
    stiffness_ratio: (
        Annotated[float, BeforeValidator(Quantity("1", at_least=_RATIOS[0], at_most=_RATIOS[1]))] | None
    ) = None


Bodies = tuple[float, ...]
"""Modulus [Pa] and Poisson's ratio of both bodies, or of the first where the counter body is rigid."""


def bodies_of(material: MaterialSection, counter: Body | None) -> Bodies | None:
    """Return the elastic constants of the bodies; None where only E* is known."""
    if material.modulus is None or material.poisson is None:
        return None
    return (material.modulus, material.poisson, *(() if counter is None else (counter.modulus, counter.poisson)))


def ratio_of(tangential: TangentialSection, bodies: Bodies | None) -> float | None:
    """Return G*/E* [1]; None where nothing tells it."""
    return tangential.stiffness_ratio if bodies is None else stiffness_ratio(*bodies)


def check_tangential(scene: "Scene") -> None:
    """Raise a mismatch where lateral forces are asked for that other sections do not go with, or do not tell."""
    tangential, path, bodies = scene.tangential, scene.path, bodies_of(scene.material, scene.counter)
    against = {"interaction": scene.interaction, "adhesion": scene.work or None, "reference": scene.reference}
    lateral, asked = path.lateral is not None, [name for name in scene.output.variables if name in TANGENTIAL_VARIABLES]
    if not lateral and (wrong := [name for name in asked if name != _STICKING]):
        raise mismatch("output.variables", f"{wrong[0]} needs a lateral path: path.lateral")
    if tangential is not None and tangential.stiffness_ratio is not None and bodies is not None:
        raise mismatch("tangential.stiffness_ratio", "follows from the modulus and poisson of [material] already")
    if not lateral and not asked:
        return
    subject = "path.lateral" if lateral else f"{_STICKING} among output.variables"
    if tangential is None or (lateral and tangential.friction is None):
        raise mismatch("tangential.friction" if lateral else "tangential", f"is missing; {subject} needs it")
    if ratio_of(tangential, bodies) is None:
        message = f"is missing; {subject} needs G*/E*, which material.effective_modulus does not tell"
        raise mismatch("tangential.stiffness_ratio", message)
    for section, key, only_lateral, reason in _AGAINST:
        if against[section] is not None and (lateral or not only_lateral):
            raise mismatch(key, f"does not go with {subject if key != 'path.lateral' else section}: {reason}")


_AGAINST = (
    (
        "interaction",
        "interaction",
        False,
        "a tangential load moves the surface beside it in other ways than a normal one, which the coupling of "
        "asperities does not know",
    ),
    (
        "adhesion",
        "path.lateral",
        True,
        "the shear of adhesive contacts is no difference of normal contacts",
    ),
    ("reference", "reference", True, "boundary elements press along the normal only"),
)
"""Section, key at fault, whether only a lateral path does not go with it, and why."""
