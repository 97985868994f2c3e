"""Theory curves of equal summits: Greenwood and Williamson, Fuller and Tabor, Maugis."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate.tabor import JkrValidity, jkr_validity
from roughmdr.batch.plan import Cell
from roughmdr.ensemble import Ensemble, RandomAsperities
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.theory_curves.base import TheoryCurve, check_no_adhesion
from roughmdr.scene import Scene
from roughmdr.theory import dmt_maugis, fuller_tabor, greenwood_williamson
from roughmdr.theory.equal_summits import Variable

_DMT_MAX_TABOR = 0.1
"""Tabor number below which DMT holds: K. L. Johnson, J. A. Greenwood, J. Colloid Interface Sci. 192 (1997) 326."""


class _Heights(NamedTuple):
    """Distribution of the heights above the datum plane, with the methods of scipy.stats that theories call."""

    distribution: Distribution

    def pdf(self, x: ArrayLike) -> Floats:
        return self.distribution.density(np.asarray(x, dtype=np.float64))

    def ppf(self, q: ArrayLike) -> Floats:
        return self.distribution.quantile(np.asarray(q, dtype=np.float64))

    def support(self) -> Floats:
        return self.ppf([0.0, 1.0])


def _equal_summits(scene: Scene) -> dict[str, Any]:
    """Return the arguments of theories of equal summits; RoughmdrError if the summits are not equal."""
    section = scene.asperities
    if not isinstance(section, RandomAsperities):
        raise RoughmdrError(f"asperities.source is {section.source!r}, not 'random'")
    if section.shape != "paraboloid":
        raise RoughmdrError(f"asperities.shape is {section.shape!r}, not 'paraboloid'")
    if section.second is not None:
        raise RoughmdrError("there are two populations of asperities")
    radius = section.distributions["radius"].constant
    if radius is None:
        raise RoughmdrError("radii differ")
    if section.height.constant is not None:
        raise RoughmdrError("all heights are the same")
    density = section.expected_count / section.nominal_area
    return {
        "effective_modulus": scene.effective_modulus,
        "radius": radius,
        "density": density,
        "heights": _Heights(section.height),
    }


def _jkr_validity(scene: Scene, radius: float) -> JkrValidity:
    """Return how the adhesion range limits JKR; RoughmdrError if there is no adhesion."""
    if scene.work == 0.0:
        raise RoughmdrError("the scene has no adhesion")
    one = Ensemble("paraboloid", np.zeros(1), {"radius": np.array([radius])})
    return jkr_validity(
        one.shape, scene.asperities.sigma, one.nondimensional(), scene.effective_modulus, scene.adhesion_model
    )


def _greenwood_williamson(cell: Cell, variable: Variable) -> Floats:
    arguments = _equal_summits(cell.scene)
    check_no_adhesion(cell.scene)
    return greenwood_williamson(separation=cell.path.separation, variable=variable, **arguments)


def _fuller_tabor(cell: Cell, variable: Variable) -> Floats:
    """Evaluate the loading, and the unloading with the closest separation as its turning point."""
    arguments, h = _equal_summits(cell.scene), cell.path.separation
    if cell.scene.adhesion_model.resolved(_jkr_validity(cell.scene, arguments["radius"]).jkr_error).model != "jkr":
        raise RoughmdrError("the adhesion is of finite range, not that of JKR")
    turn = int(h.argmin())
    if (np.diff(h[: turn + 1]) > 0.0).any() or (np.diff(h[turn:]) < 0.0).any():
        raise RoughmdrError("the path is not one loading and one unloading")
    arguments |= {"work": cell.scene.work, "variable": variable}
    loading = fuller_tabor(separation=h[: turn + 1], **arguments)
    return np.append(loading, fuller_tabor(separation=h[turn + 1 :], turning=h[turn], **arguments))


def _dmt_maugis(cell: Cell, variable: Variable) -> Floats:
    arguments, work = _equal_summits(cell.scene), cell.scene.work
    tabor = _jkr_validity(cell.scene, arguments["radius"]).tabor
    if not cell.scene.adhesion_model.tabor_known:
        raise RoughmdrError("neither strength nor range of the adhesion is given")
    if not tabor < _DMT_MAX_TABOR:
        raise RoughmdrError(f"the Tabor number is {tabor:.3g}, not below {_DMT_MAX_TABOR:g}")
    return dmt_maugis(separation=cell.path.separation, work=work, variable=variable, **arguments)


CURVES = {
    "greenwood_williamson": TheoryCurve(_greenwood_williamson),
    "fuller_tabor": TheoryCurve(_fuller_tabor),
    "dmt_maugis": TheoryCurve(_dmt_maugis, note="it neglects the attraction of summits that do not touch"),
}
