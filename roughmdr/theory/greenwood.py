"""Greenwood and Williamson: equal summits without adhesion."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.theory.equal_summits import SummitMaterial, Summits, Variable


def greenwood_williamson(
    *,
    separation: ArrayLike,
    radius: float | str,
    density: float | str,
    variable: Variable = "pressure",
    **material: Unpack[SummitMaterial],
) -> Floats:
    """Compute pressure, area or number of contacts of equal paraboloids without adhesion.

    With phi the density of the heights z, over the nominal area: the number eta ∫_h^∞ phi dz, the area
    pi R eta ∫_h^∞ (z - h) phi dz, the force 4/3 E* R^(1/2) eta ∫_h^∞ (z - h)^(3/2) phi dz.

    Parameters
    ----------
    separation : array_like, shape () or (n,)
        Separations h [m] of the flat from the mean plane of the summits, or from the zero of ``heights``.
    radius : float or str
        Radius of curvature R of the summits [m].
    density : float or str
        Summits of a unit of area, eta [1/m2].
    variable : {"pressure", "contact_fraction", "contact_density"}, optional
        Force over nominal area [Pa], real over nominal area of contact [1], contacts of a unit of area [1/m2].
    **material
        E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with counter_poisson).
        Either std [m], for normal heights of mean 0, or heights, any frozen continuous distribution of scipy.stats.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation. Its relative accuracy is about 1e-13 where that of the density is;
        about 1e-10 where the density jumps inside its support, and 1e-8 of its largest values where it is infinite at a
        height other than 0.

    Raises
    ------
    OutOfRange
        Where an argument is not above 0, or the mean over the heights does not exist.
    RoughmdrError
        Unless exactly one of std and heights is given, and E* in exactly one way.

    References
    ----------
    .. [1] J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295 (1966) 300.

    Examples
    --------
    >>> import roughmdr as rm
    >>> summits = {"radius": "50 um", "density": 2e9, "std": "1 um"}
    >>> p = rm.theory.greenwood_williamson(separation=["2 um", "1 um"], effective_modulus="4 MPa", **summits)
    >>> [f"{value:.4g}" for value in p]
    ['501.4', '5707']
    """
    return Summits.of(greenwood_williamson, radius, density, material).over(variable, separation)
