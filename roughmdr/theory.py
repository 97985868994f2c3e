"""Named laws from the literature, to stand beside computed ones. Arrays in and out, SI."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.adhesion import Adhesion
from roughmdr.arguments import Floats, check_number, check_values
from roughmdr.contact import Contact
from roughmdr.errors import OutOfRange
from roughmdr.kernels.elementwise import apply
from roughmdr.shapes import Paraboloid

# Gauss-Legendre panels over the root of the distance to the onset of contact, in which every integrand here is smooth.
_PANELS, _NODES = 48, 16
_TAIL = 12.0  # standard deviations; beyond, a normal distribution holds 4e-33


def greenwood_williamson(*, separation: ArrayLike, modulus: float, radius: float, std: float, density: float) -> Floats:
    """Pressure [Pa] of equal paraboloids with normal heights at separations [m] from the mean summit plane.

    p = 4/3 E* R^(1/2) eta ∫_h^∞ (z - h)^(3/2) phi(z) dz: J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295
    (1966) 300. modulus E* [Pa], radius R [m], std of the heights [m], density eta of summits [1/m2].
    OutOfRange where an argument is not above 0. Accurate to about 1e-13 of itself to six standard deviations.
    """
    contact = Contact.of(Paraboloid(radius), modulus, Adhesion())
    return _pressure(contact, separation, std, density, lambda h: h)


def fuller_tabor(
    *,
    separation: ArrayLike,
    modulus: float,
    radius: float,
    std: float,
    density: float,
    work: float,
    turning: float | None = None,
) -> Floats:
    """Pressure [Pa] of equal JKR paraboloids with normal heights at separations [m] from the mean summit plane.

    K. N. G. Fuller, D. Tabor, Proc. R. Soc. A 345 (1975) 327, with the JKR force of every contact. On the way in the
    summits with z >= h are in contact. On the way back from the closest separation ``turning`` [m] those are that were
    reached and have not let go, z >= max(turning, h + delta_c). work [J/m^2]; the others as for
    ``greenwood_williamson``. OutOfRange where an argument is not above 0, or a separation lies below ``turning``.
    """
    contact = Contact.of(Paraboloid(radius), modulus, Adhesion(check_number("work", work, "J/m^2")))
    if turning is None:
        return _pressure(contact, separation, std, density, lambda h: h)
    lowest = float(check_values("turning", turning))
    closest = float(np.min(check_values("separation", separation), initial=np.inf))
    if closest < lowest:
        raise OutOfRange(f"separation goes down to {closest:g} m; it must not lie below turning, {lowest:g} m")
    return _pressure(contact, separation, std, density, lambda h: max(lowest, h - contact.depth[0]))


def _pressure(
    contact: Contact, separation: ArrayLike, std: float, density: float, first: Callable[[float], float]
) -> Floats:
    """eta ∫ P(z - h) phi(z) dz over z >= first(h)."""
    std = check_number("std", std, "m")
    density = check_number("density", density, "1/m2")
    separations = check_values("separation", separation)
    onset = -contact.depth[0] if contact.law.adhesive else 0.0
    pressures = [density * _mean_force(contact, onset, float(h), first(float(h)), std) for h in separations.flat]
    if not np.isfinite(pressures).all():
        raise OutOfRange(f"the pressure at separations from {separations.min():g} m on is not representable")
    return np.array(pressures).reshape(separations.shape)


def _mean_force(contact: Contact, onset: float, h: float, lowest: float, std: float) -> float:
    """∫ P(z - h) phi(z) dz from ``lowest``, over s = sqrt(z - h - onset)."""
    start = max(lowest, -_TAIL * std)
    stop = max(start, 0.0) + _TAIL * std
    panels = np.linspace(np.sqrt(max(start - h - onset, 0.0)), np.sqrt(stop - h - onset), _PANELS + 1)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(panels)[:, None]
    s = (panels[:-1, None] + half * (1.0 + nodes)).ravel()
    delta = onset + s * s
    distance = contact.reduced(delta, contact.depth).clip(min=0.0)
    force = contact.force * apply(contact.law.force, apply(contact.law.state, distance, contact.form), contact.form)
    density = np.exp(-0.5 * ((h + delta) / std) ** 2) / (std * np.sqrt(2.0 * np.pi))
    return float(np.sum((half * weights).ravel() * 2.0 * s * force * density))
