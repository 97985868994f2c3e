"""Constants of two elastic bodies under tangential load: G*/E*, and the coupling of shear and pressure."""

import math


def stiffness_ratio(
    modulus: float, poisson: float, counter_modulus: float = math.inf, counter_poisson: float = 0.0
) -> float:
    """Return G*/E*, the tangential over the normal stiffness of a contact [1].

    1/G* = (2 - nu1)/(4 G1) + (2 - nu2)/(4 G2) and 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, with G = E/(2 (1 + nu)); it
    is 2 (1 - nu)/(2 - nu) for equal bodies, or where the counter body is rigid. Moduli [Pa] above 0, inf for a rigid
    body; ratios of Poisson [1] above -1 and at most 1/2.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), section 7.2, for spheres; the method of dimensionality reduction has
       it for any shape.
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
    0 for equal bodies, and for an incompressible one on a rigid one.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), section 5.4.
    """
    first, second = 1.0 + poisson, modulus / counter_modulus * (1.0 + counter_poisson)  # 1/G over 2/E of the first
    coupled = first * (1.0 - 2.0 * poisson) - second * (1.0 - 2.0 * counter_poisson)
    return coupled / (2.0 * (first * (1.0 - poisson) + second * (1.0 - counter_poisson)))
