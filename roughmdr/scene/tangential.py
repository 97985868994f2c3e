"""[tangential]: friction, the tangential stiffness of the bodies, and what must agree with them in a scene."""

from typing import Annotated

from pydantic import BeforeValidator

from roughmdr.scene.sections import Body, MaterialSection
from roughmdr.schema.quantities import Quantity, Section
from roughmdr.schema.two_bodies import stiffness_ratio

_RATIOS = 0.5, 1.5  # isotropic bodies have 2/3 (nu = 1/2) to 4/3 (nu = -1)


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
