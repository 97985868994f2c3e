"""Elastic constants of two bodies in contact: the effective modulus E*, G*/E*, how shear and pressure couple."""

import math
from collections.abc import Callable
from typing import Any, TypedDict

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.quantities import Quantity

MODULUS = Quantity("Pa", above=0.0)
POISSON = Quantity("1", above=-1.0, at_most=0.5)


class MaterialArguments(TypedDict, total=False):
    """Keyword arguments that tell E*: effective_modulus alone, or modulus with poisson.

    The latter may be joined by counter_modulus with counter_poisson; without them the counter body is rigid.
    """

    effective_modulus: float | str
    modulus: float | str
    poisson: float
    counter_modulus: float | str
    counter_poisson: float


@named_keywords
def effective_modulus(
    modulus: float | str, poisson: float, counter_modulus: float | str = math.inf, counter_poisson: float = 0.0
) -> float:
    """Return the effective modulus E* of two elastic bodies, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Parameters
    ----------
    modulus : float or str
        Young's modulus E1 of one body [Pa], above 0, or a string with a unit such as "3 MPa".
    poisson : float
        Its Poisson's ratio nu1 [1], above -1 and at most 1/2.
    counter_modulus : float or str, optional
        Young's modulus E2 of the other body [Pa]; infinite, for a rigid body, unless given.
    counter_poisson : float, optional
        Its Poisson's ratio nu2 [1].

    Returns
    -------
    float
        E* [Pa].

    Raises
    ------
    OutOfRange
        Where a modulus or a ratio is out of its range, or E* is not representable.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), chapter 4.

    Examples
    --------
    >>> import roughmdr as rm
    >>> round(rm.effective_modulus("70 GPa", 0.33, counter_modulus="210 GPa", counter_poisson=0.3) / 1e9, 2)
    58.61
    """
    compliance = 0.0
    bodies = (("", modulus, poisson), ("counter_", counter_modulus, counter_poisson))
    for prefix, stiffness, ratio in bodies:
        nu = POISSON.argument(f"{prefix}poisson", ratio)
        if not prefix or stiffness != math.inf:
            compliance += (1.0 - nu * nu) / MODULUS.argument(f"{prefix}modulus", stiffness)
    if not 1e-300 < compliance < 1e300:
        moduli = f"modulus = {modulus!r} and counter_modulus = {counter_modulus!r}"
        raise OutOfRange(f"E* of {moduli} [Pa] is not representable")
    return 1.0 / compliance


def check_one_body(effective_modulus: object, modulus: object, poisson: object) -> None:
    """Raise RoughmdrError unless either effective_modulus is given, or modulus and poisson are."""
    if effective_modulus is not None:
        if modulus is not None or poisson is not None:
            raise RoughmdrError("takes effective_modulus alone, or modulus and poisson")
    elif modulus is None or poisson is None:
        raise RoughmdrError("needs effective_modulus, or modulus and poisson")


def effective_modulus_of(function: Callable[..., Any], material: MaterialArguments) -> float:
    """Return E* [Pa] from the keyword arguments that a public ``function`` was given beside its own.

    RoughmdrError unless they tell E* in exactly one way, OutOfRange for a number.
    """
    given: dict[str, Any] = {name: value for name, value in material.items() if value is not None}
    try:
        check_one_body(*(given.get(name) for name in ("effective_modulus", "modulus", "poisson")))
        if counter := sorted(name for name in given if name.startswith("counter_")):
            if "effective_modulus" in given:
                raise RoughmdrError("takes effective_modulus, which holds both bodies already, without a counter body")
            if len(counter) == 1:
                raise RoughmdrError("takes counter_modulus and counter_poisson together")
    except RoughmdrError as error:
        raise RoughmdrError(f"{function.__name__} {error}; got {' and '.join(given) or 'none of them'}") from None
    if "effective_modulus" in given:
        return MODULUS.argument("effective_modulus", given["effective_modulus"])
    return effective_modulus(**given)


def stiffness_ratio(
    modulus: float, poisson: float, counter_modulus: float = math.inf, counter_poisson: float = 0.0
) -> float:
    """Return G*/E*, the tangential over the normal stiffness of a contact [1].

    1/G* = (2 - nu1)/(4 G1) + (2 - nu2)/(4 G2) and 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, with G = E/(2 (1 + nu)); it
    is 2 (1 - nu)/(2 - nu) for equal bodies, or where the counter body is rigid. Moduli [Pa] above 0, inf for a rigid
    body; ratios of Poisson [1] above -1 and at most 1/2. K. L. Johnson, Contact Mechanics (1985), section 7.2, has it
    for spheres, the method of dimensionality reduction for any shape.
    """
    bodies = ((1.0, poisson), (modulus / counter_modulus, counter_poisson))  # compliances over that of the first body
    normal = sum(compliance * (1.0 - nu * nu) for compliance, nu in bodies)
    tangential = sum(compliance * (2.0 - nu) * (1.0 + nu) for compliance, nu in bodies)
    return 2.0 * normal / tangential


def dundurs_beta(
    modulus: float, poisson: float, counter_modulus: float = math.inf, counter_poisson: float = 0.0
) -> float:
    """Return Dundurs' beta [1], by which shear displaces the surface along the normal, and pressure across it.

    beta = [(1 - 2 nu1)/G1 - (1 - 2 nu2)/G2]/(2 [(1 - nu1)/G1 + (1 - nu2)/G2]), arguments as ``stiffness_ratio``. It is
    0 for equal bodies, and for an incompressible one on a rigid one (K. L. Johnson, Contact Mechanics, 1985, section
    5.4).
    """
    first, second = 1.0 + poisson, modulus / counter_modulus * (1.0 + counter_poisson)  # 1/G over 2/E of the first
    coupled = first * (1.0 - 2.0 * poisson) - second * (1.0 - 2.0 * counter_poisson)
    return coupled / (2.0 * (first * (1.0 - poisson) + second * (1.0 - counter_poisson)))
