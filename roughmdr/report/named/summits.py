"""The laws of equal summits: Greenwood and Williamson, Fuller and Tabor, Maugis."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate.tabor import JkrValidity, jkr_validity
from roughmdr.batch.plan import Cell
from roughmdr.ensemble import Ensemble, RandomAsperities
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.named.law import TheoryCurve, check_no_adhesion
from roughmdr.scene import Scene
from roughmdr.theory import dmt_maugis, fuller_tabor, greenwood_williamson
from roughmdr.theory.equal_summits import Variable

_DMT_BELOW = 0.1
"""The Tabor number below which DMT is right: K. L. Johnson, J. A. Greenwood, J. Colloid Interface Sci. 192 (1997) 326.
"""


class _Heights(NamedTuple):
    """The heights of a scene, from its datum plane, as the laws ask for them."""

    own: Distribution

    def pdf(self, x: ArrayLike) -> Floats:
        return self.own.density(np.asarray(x, dtype=np.float64))

    def ppf(self, q: ArrayLike) -> Floats:
        return self.own.quantile(np.asarray(q, dtype=np.float64))

    def support(self) -> Floats:
        return self.ppf([0.0, 1.0])


def _equal_summits(scene: Scene) -> dict[str, Any]:
    """What every law of equal summits takes; RoughmdrError where the summits are not equal."""
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


def _range(scene: Scene, radius: float) -> JkrValidity:
    """Whether the range of the adhesion matters; RoughmdrError where there is no adhesion."""
    if scene.work == 0.0:
        raise RoughmdrError("the scene has no adhesion")
    one = Ensemble("paraboloid", np.zeros(1), {"radius": np.array([radius])})
    return jkr_validity(
        one.shape, scene.asperities.sigma, one.nondimensional(), scene.effective_modulus, scene.adhesion_model
    )


def _greenwood_williamson(cell: Cell, variable: Variable) -> Floats:
    given = _equal_summits(cell.scene)
    check_no_adhesion(cell.scene)
    return greenwood_williamson(separation=cell.path.separation, variable=variable, **given)


def _fuller_tabor(cell: Cell, variable: Variable) -> Floats:
    """In to the closest separation without, from there on with it as the turning point."""
    given, h = _equal_summits(cell.scene), cell.path.separation
    if cell.scene.adhesion_model.resolved(_range(cell.scene, given["radius"]).jkr_error).model != "jkr":
        raise RoughmdrError("the adhesion is of finite range, not that of JKR")
    turn = int(h.argmin())
    if (np.diff(h[: turn + 1]) > 0.0).any() or (np.diff(h[turn:]) < 0.0).any():
        raise RoughmdrError("the flat does not go straight in and straight out")
    given |= {"work": cell.scene.work, "variable": variable}
    way_in = fuller_tabor(separation=h[: turn + 1], **given)
    return np.append(way_in, fuller_tabor(separation=h[turn + 1 :], turning=h[turn], **given))


def _dmt_maugis(cell: Cell, variable: Variable) -> Floats:
    given, work = _equal_summits(cell.scene), cell.scene.work
    tabor = _range(cell.scene, given["radius"]).tabor
    if not cell.scene.adhesion_model.tabor_known:
        raise RoughmdrError("neither strength nor range of the adhesion is given")
    if not tabor < _DMT_BELOW:
        raise RoughmdrError(f"the Tabor number is {tabor:.3g}, not below {_DMT_BELOW:g}")
    return dmt_maugis(separation=cell.path.separation, work=work, variable=variable, **given)


LAWS = {
    "greenwood_williamson": TheoryCurve(_greenwood_williamson),
    "fuller_tabor": TheoryCurve(_fuller_tabor),
    "dmt_maugis": TheoryCurve(_dmt_maugis, note="summits that do not touch do not pull in it"),
}
