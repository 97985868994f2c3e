"""Greenwood and Williamson: equal summits without adhesion."""

from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Paraboloid
from roughmdr.theory.equal_summits import Summits, Variable
from roughmdr.theory.heights import Distribution, Heights


def greenwood_williamson(
    *,
    separation: ArrayLike,
    effective_modulus: float,
    radius: float,
    density: float,
    std: float | None = None,
    heights: Distribution | None = None,
    variable: Variable = "pressure",
) -> Floats:
    """Pressure [Pa] of equal paraboloids at separations [m] from the mean summit plane, or area or number of contacts.

    J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295 (1966) 300: with phi the density of the heights z,
    number ("contact_density") eta ∫_h^∞ phi dz [1/m2],
    area ("contact_fraction") pi R eta ∫_h^∞ (z - h) phi dz [1],
    force ("pressure") 4/3 E* R^(1/2) eta ∫_h^∞ (z - h)^(3/2) phi dz [Pa], each over the nominal area.

    effective_modulus E* [Pa], radius R [m], density eta of summits [1/m2]. Heights are either normal of this std [m]
    and mean 0, or ``heights``, any frozen continuous distribution of scipy.stats; the separation is from their zero.
    The shape is that of separation, a number or one-dimensional. OutOfRange where an argument is not above 0 or the
    mean does not exist, RoughmdrError unless exactly one of std and heights is given.
    Accurate to about 1e-13 of itself where the density is; to about 1e-10 where the density jumps inside its support,
    and to 1e-8 of its largest values where it is infinite at a height other than 0.
    """
    contact = Contact.of(Paraboloid(radius), effective_modulus, Adhesion())
    return Summits(contact, Heights.of(std, heights), density).over(variable, separation, lambda h: h)
