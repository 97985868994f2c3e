"""Theory curves of Gaussian surfaces: Bush, Gibson and Thomas; Greenwood's mildly elliptic contacts; Persson."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.batch.plan import Cell
from roughmdr.ensemble import NayakAsperities
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.theory_curves.base import TheoryCurve, check_no_adhesion
from roughmdr.theory import (
    bush_gibson_thomas,
    bush_gibson_thomas_asymptote,
    greenwood_elliptic,
    persson_contact_fraction,
    persson_pressure,
)
from roughmdr.theory.equal_summits import Variable

_DEFORMED = "its separation is the mean gap to the deformed surface, the scene's is from the undeformed mean plane"


class _SummitTheory(Protocol):
    """A theory of all summits of a surface, given by the moments of its spectrum."""

    def __call__(
        self, *, separation: ArrayLike, effective_modulus: float, m0: float, m2: float, m4: float, variable: Variable
    ) -> Floats: ...


def _surface(cell: Cell) -> NayakAsperities:
    """Return the surface of a scene; RoughmdrError unless it is Gaussian and without adhesion."""
    section = cell.scene.asperities
    if not isinstance(section, NayakAsperities):
        raise RoughmdrError(f"asperities.source is {section.source!r}, not 'nayak'")
    check_no_adhesion(cell.scene)
    return section


def _evaluate_summits(theory: _SummitTheory, cell: Cell, variable: Variable) -> Floats:
    m0, m2, m4 = _surface(cell).summits.moments
    separation, effective_modulus = cell.path.separation, cell.scene.effective_modulus
    return theory(separation=separation, effective_modulus=effective_modulus, m0=m0, m2=m2, m4=m4, variable=variable)


def _asymptote(cell: Cell, variable: Variable) -> Floats:
    pressure = _evaluate_summits(bush_gibson_thomas, cell, "pressure")
    slope = math.sqrt(2.0 * _surface(cell).summits.moments.m2)
    return bush_gibson_thomas_asymptote(
        pressure=pressure, effective_modulus=cell.scene.effective_modulus, rms_slope=slope
    )


def _persson(cell: Cell, variable: Variable) -> Floats:
    spectrum, effective_modulus = _surface(cell).spectrum, cell.scene.effective_modulus
    if spectrum is None:
        raise RoughmdrError("it needs a self-affine spectrum, but the scene gives m0, m2 and m4")
    h = cell.path.separation
    values = np.full_like(h, math.nan)
    open_ = h > 0.0  # at full contact the mean gap is 0
    pressure = persson_pressure(separation=h[open_], effective_modulus=effective_modulus, spectrum=spectrum)
    if variable == "contact_fraction":
        values[open_] = persson_contact_fraction(
            pressure=pressure, effective_modulus=effective_modulus, rms_slope=spectrum.rms_slope
        )
    else:
        values[open_] = pressure
    return values


CURVES = {
    "bush_gibson_thomas": TheoryCurve(lambda cell, variable: _evaluate_summits(bush_gibson_thomas, cell, variable)),
    "bush_gibson_thomas_asymptote": TheoryCurve(
        _asymptote, ("contact_fraction",), "at the pressure of bush_gibson_thomas"
    ),
    "greenwood_elliptic": TheoryCurve(lambda cell, variable: _evaluate_summits(greenwood_elliptic, cell, variable)),
    "persson_separation": TheoryCurve(_persson, ("pressure",), _DEFORMED),
    "persson_contact_fraction": TheoryCurve(
        _persson, ("contact_fraction",), f"at the pressure of persson_separation; {_DEFORMED}"
    ),
}
