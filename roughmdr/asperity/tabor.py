"""The Tabor number of one asperity, the adhesion model that follows from it, and warnings about both."""

import math
from typing import Unpack

import numpy as np

from roughmdr.asperity import validity
from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, tabor_number
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, exactly_one
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.shapes import Shape


@named_keywords
def tabor(
    shape: Shape,
    *,
    work: float | str,
    strength: float | str | None = None,
    range: float | str | None = None,  # noqa: A002 - as in a scene
    **material: Unpack[MaterialArguments],
) -> float:
    """Compute the Tabor number dl(a) strength/(pi^(2/3) work) of a contact.

    dl(a) = sqrt(2 pi a work/E*), and a is the radius at which JKR detaches under fixed grips.
    Where the number is large JKR holds; where it is small the attraction reaches far beyond the contact (DMT). For the
    paraboloid it is (R work^2/E*^2)^(1/3) strength/work.

    Parameters
    ----------
    shape, **material
        Profile and E* as in ``indent``.
    work : float or str
        Work of adhesion [J/m^2], above 0.
    strength, range : float or str, optional
        One of both: the stress of the attraction [Pa], or its range work/strength [m], above 0.

    Returns
    -------
    float
        The Tabor number [1].

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] D. Tabor, J. Colloid Interface Sci. 58 (1977) 2.

    Examples
    --------
    >>> import roughmdr as rm
    >>> round(rm.tabor(rm.Paraboloid(radius=1e-6), effective_modulus=1e9, work=0.05, strength="5 MPa"), 3)
    0.136
    """
    exactly_one("tabor", strength=strength, range=range)
    asked = Adhesion.checked("jkr", check_number("work", work, "J/m^2"), strength, range)
    return tabor_of(shape, effective_modulus_of(tabor, material), asked)


def resolved(shape: object, effective_modulus: float, adhesion: Adhesion) -> Adhesion:
    """Return the model itself: for "auto" JKR where its pull-off force is near enough to Dugdale's."""
    if adhesion.model != "auto" or not isinstance(shape, Shape) or adhesion.work == 0.0:
        return adhesion.resolved(0.0)
    try:
        with np.errstate(all="ignore"):  # a contact that is not representable has no finite force
            jkr, dugdale = (
                float(
                    Contact.of(shape, effective_modulus, adhesion._replace(model=model)).pull_off("force")["force"][0]
                )
                for model in adhesion.candidates
            )
    except OutOfRange:
        return adhesion.resolved(math.inf)
    known = math.isfinite(jkr) and math.isfinite(dugdale) and dugdale < 0.0
    return adhesion.resolved(abs(jkr / dugdale - 1.0) if known else math.inf)


def tabor_of(shape: Shape, effective_modulus: float, adhesion: Adhesion) -> float:
    """Return the Tabor number of the adhesion that is asked for."""
    contact = Contact.of(shape, effective_modulus, Adhesion(adhesion.work))
    radius = float(contact.pull_off("displacement")["contact_radius"][0])
    return tabor_number(radius, effective_modulus, adhesion.work, adhesion.strength)


def warnings_of(shape: object, radius: Floats, effective_modulus: float, adhesion: Adhesion) -> list[str]:
    """Return warnings of contact radii [m] of a shape, or a range of its adhesion, for which the theory is doubtful."""
    if not isinstance(shape, Shape):
        return []
    limits = validity.ValidityLimits.of(radius, shape.df(radius), np.array(shape.end))
    if adhesion.model == "jkr" and adhesion.tabor_known:
        limits = limits._replace(tabor=tabor_of(shape, effective_modulus, adhesion))
    return limits.warnings
