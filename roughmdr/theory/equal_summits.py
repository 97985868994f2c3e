"""Equal paraboloids of random heights under a flat: Greenwood and Williamson, Fuller and Tabor, Maugis."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, Unpack, get_args

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.quadrature import Rows
from roughmdr.schema.arguments import check_number, check_scalar, check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.shapes import Paraboloid
from roughmdr.theory.heights import Distribution, Heights

Variable = Literal["pressure", "contact_fraction", "contact_density"]
"""Force over nominal area [Pa], real over nominal area of contact [1], contacts per nominal area [1/m2]."""


class SummitMaterial(MaterialArguments, total=False):
    """The elastic constants, and the heights of the summits by one of two arguments."""

    std: float | str | None
    heights: Distribution | None


@named_keywords
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
    radius, density : float or str
        Radius of curvature R [m] of the summits, and their number eta per unit area [1/m2].
    variable : {"pressure", "contact_fraction", "contact_density"}, optional
        Force over nominal area [Pa], real over nominal area of contact [1], contacts per unit area [1/m2].
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
    return _Summits.of(greenwood_williamson, radius, density, material).over(variable, separation)


@named_keywords
def fuller_tabor(
    *,
    separation: ArrayLike,
    radius: float | str,
    density: float | str,
    work: float | str,
    turning: float | str | None = None,
    variable: Variable = "pressure",
    **material: Unpack[SummitMaterial],
) -> Floats:
    """Compute pressure, area or number of contacts of equal paraboloids with adhesion of JKR.

    On loading the summits with z >= h are in contact; on unloading from the closest separation ``turning``, those that
    were reached and have not detached, z >= max(turning, h + delta_c). Each carries the JKR force.

    Parameters
    ----------
    separation, radius, density, variable, **material
        As ``greenwood_williamson``.
    work : float or str
        Work of adhesion [J/m^2], above 0.
    turning : float or str, optional
        Closest separation [m], from which the flat is unloaded; on loading unless given.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``greenwood_williamson``; OutOfRange also where a separation lies below ``turning``.

    References
    ----------
    .. [1] K. N. G. Fuller, D. Tabor, Proc. R. Soc. A 345 (1975) 327.

    Examples
    --------
    >>> import roughmdr as rm
    >>> summits = {"radius": "50 um", "density": 2e9, "std": "1 um", "work": "50 mJ/m^2"}
    >>> p = rm.theory.fuller_tabor(separation="3 um", turning="0 um", effective_modulus="4 MPa", **summits)
    >>> f"{float(p):.4g}"
    '-56.17'
    """
    summits = _Summits.of(fuller_tabor, radius, density, material, check_number("work", work, "J/m^2"))
    if turning is None:
        return summits.over(variable, separation)
    lowest = check_scalar("turning", turning, "m")
    closest = float(np.min(check_values("separation", separation, "m"), initial=np.inf))
    if closest < lowest:
        raise OutOfRange(f"separation goes down to {closest:g} m; it must not lie below turning, {lowest:g} m")
    return summits.over(variable, separation, lowest)


@named_keywords
def dmt_maugis(
    *,
    separation: ArrayLike,
    radius: float | str,
    density: float | str,
    work: float | str,
    variable: Variable = "pressure",
    **material: Unpack[SummitMaterial],
) -> Floats:
    """Compute pressure, area or number of contacts of equal paraboloids with adhesion of DMT.

    Every summit with z >= h is in contact, on the area of Hertz, and carries the force of Hertz less 2 pi w R. It holds
    for small, hard summits (Tabor number well below 1). Included is the attraction around each contact. Not included
    are the attraction of summits that do not touch, the area that adhesion adds to a contact, and hysteresis: loading
    and unloading follow one curve, and a contact goes from -2 pi w R to 0 at h = z.

    Parameters
    ----------
    separation, radius, density, variable, **material
        As ``greenwood_williamson``.
    work : float or str
        Work of adhesion w [J/m^2], above 0.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation; area and number are those of ``greenwood_williamson``.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``greenwood_williamson``.

    References
    ----------
    .. [1] D. Maugis, J. Adhesion Sci. Technol. 10 (1996) 161.

    Examples
    --------
    >>> import roughmdr as rm
    >>> summits = {"radius": "1 um", "density": 2e12, "std": "10 nm", "work": "50 mJ/m^2"}
    >>> p = rm.theory.dmt_maugis(separation="10 nm", modulus="70 GPa", poisson=0.2, **summits)
    >>> f"{float(p):.4g}"
    '1.461e+07'
    """
    summits = _Summits.of(dmt_maugis, radius, density, material)
    attraction = 2.0 * math.pi * check_number("work", work, "J/m^2") * check_number("radius", radius, "m")
    return summits._replace(attraction=attraction).over(variable, separation)


def check_variable(variable: Variable) -> Variable:
    """Return ``variable``; RoughmdrError where it is unknown."""
    if variable not in get_args(Variable):
        raise RoughmdrError(f"variable is {variable!r}; it must be one of {', '.join(map(repr, get_args(Variable)))}")
    return variable


def representable(variable: str, values: Floats, given: Floats) -> Floats:
    """Return ``values`` in the shape of the separations or pressures ``given``; OutOfRange where one is not finite."""
    if not np.isfinite(values).all():
        raise OutOfRange(f"the {variable} for values from {np.min(given):g} on is not representable")
    return values.reshape(given.shape)


class _Summits(NamedTuple):
    """Equal summits: the contact of one, the density of their heights, and their number per area [1/m2]."""

    contact: Contact
    heights: Heights
    density: float
    attraction: float = 0.0  # force [N] that is subtracted from that of every contact

    @classmethod
    def of(
        cls,
        function: Callable[..., Any],
        radius: float | str,
        density: float | str,
        material: SummitMaterial,
        work: float = 0.0,
    ) -> _Summits:
        """Read the arguments of a public ``function``; the work of adhesion [J/m^2] is that of JKR."""
        heights = Heights.of(function.__name__, material.pop("std", None), material.pop("heights", None))
        paraboloid = Paraboloid(check_number("radius", radius, "m"))
        contact = Contact.of(paraboloid, effective_modulus_of(function, material), Adhesion(work))
        return cls(contact, heights, check_number("density", density, "m-2"))

    def over(self, variable: Variable, separation: ArrayLike, turning: float | None = None) -> Floats:
        """Return ``variable`` at each separation h [m] on loading, or on unloading from the separation ``turning``."""
        check_variable(variable)
        given = check_values("separation", separation, "m")
        h = given.ravel()
        onset = -self.contact.depth[0] if self.contact.kernels.adhesive else 0.0
        lowest = h if turning is None else np.maximum(turning, h + onset)
        start = np.maximum(lowest, self.heights.edges[0])
        # Exactly 0 for summits that are about to detach.
        from_onset = start - (h + onset)

        def integrand(rows: Rows, beyond: Floats) -> Floats:
            return self._of_one(variable, from_onset[rows, None] + beyond)

        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            values = self.density * self.heights.mean(start, integrand)
        return representable(variable, values, given)

    def _of_one(self, variable: Variable, from_onset: Floats) -> Floats:
        """Return the force [N], area [m2] or number of one contact at each indentation less that of the onset [m]."""
        contact = self.contact
        if variable == "contact_density":
            return np.ones_like(from_onset)
        state = apply(contact.kernels.state, np.maximum(from_onset.ravel() / contact.depth[0], 0.0), contact.params)
        if variable == "pressure":
            values = contact.force * apply(contact.kernels.force, state, contact.params) - self.attraction
        else:
            values = math.pi * (contact.radius * apply(contact.kernels.radius, state, contact.params)) ** 2
        return np.asarray(values.reshape(from_onset.shape))
