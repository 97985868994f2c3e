"""Theory curves beside a result: the scenes to which each applies, and its values along the path of the flat."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from roughmdr import theory
from roughmdr.aggregate.tabor import JkrValidity, jkr_validity
from roughmdr.batch.plan import Cell
from roughmdr.ensemble import Ensemble, NayakAsperities, RandomAsperities, SurfaceAsperities
from roughmdr.ensemble.gaussian.summit_distribution import SUMMITS_LESS, SummitDistribution
from roughmdr.ensemble.maps.height_map import MapWaves
from roughmdr.ensemble.maps.words import describe_moments, describe_spectrum
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.spectrum import MapSpectrum, Moments, SelfAffine
from roughmdr.stages.conduction import Conduction
from roughmdr.stages.plastic.empirical import TABOR_HARDNESS
from roughmdr.stages.plasticity import Plasticity
from roughmdr.theory.equal_summits import Variable

_DMT_MAX_TABOR = 0.1
"""Tabor number below which DMT holds: K. L. Johnson, J. A. Greenwood, J. Colloid Interface Sci. 192 (1997) 326."""


class TheoryCurve(NamedTuple):
    """A theory as it is drawn over a result."""

    evaluate: Callable[[Cell, Any], Floats]
    """Return a variable at each step of a cell, NaN where the theory gives none; RoughmdrError if it does not apply."""
    variables: tuple[str, ...] = get_args(Variable)  # or "conductance": thermal, per area
    note: str = ""  # how the theory differs from the scene
    on_maps: Callable[[MapWaves], str] = describe_moments  # the numbers of a map that it needs, in words
    bodies: str = ""  # the bodies that it is of: empty for elastic ones, else as ``Stage.unlike`` has them

    def remark(self, cell: Cell) -> str:
        """Return how the theory differs from the scene of a cell, and the numbers that it needs of a map; or empty."""
        section = cell.scene.asperities
        taken = self.on_maps(section.waves) if isinstance(section, SurfaceAsperities) else ""
        return "; ".join(filter(None, (self.note, taken)))


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
    if isinstance(section, SurfaceAsperities):
        return {"effective_modulus": scene.effective_modulus, **_mean_summits(section.waves)}
    if not isinstance(section, RandomAsperities):
        raise RoughmdrError(f"asperities.source is {section.source!r}, not 'random' or 'surface'")
    if section.shape != "paraboloid":
        raise RoughmdrError(f"asperities.shape is {section.shape!r}, not 'paraboloid'")
    if section.second is not None:
        raise RoughmdrError("there are two populations of asperities")
    radius = section.distributions["radius"].constant
    if radius is None:
        raise RoughmdrError("radii differ")
    if section.height.constant is not None:
        raise RoughmdrError("all heights are the same")
    density, heights = section.expected_count / section.nominal_area, _Heights(section.height)
    return {"effective_modulus": scene.effective_modulus, "radius": radius, "density": density, "heights": heights}


def _mean_summits(waves: MapWaves) -> dict[str, Any]:
    """Return equal summits with the mean curvature, the density and the heights of those of a Gaussian surface.

    J. I. McCool, Wear 107 (1986) 37.
    """
    law = SummitDistribution(Moments.checked(*waves.moments))
    heights = _Heights(Distribution("norm", (), waves.mean + law.mean, law.sigma))
    return {"radius": 0.375 * math.sqrt(math.pi / law.moments.m4), "density": law.density, "heights": heights}


def _check_no_adhesion(scene: Scene) -> None:
    if scene.work > 0.0:
        raise RoughmdrError("the scene has adhesion")


def _jkr_validity(scene: Scene, radius: float) -> JkrValidity:
    """Return how the adhesion range limits JKR; RoughmdrError if there is no adhesion."""
    if scene.work == 0.0:
        raise RoughmdrError("the scene has no adhesion")
    one = Ensemble("paraboloid", np.zeros(1), {"radius": np.array([radius])})
    modulus, adhesion = scene.effective_modulus, scene.adhesion_model
    return jkr_validity(one.shape, scene.asperities.sigma, one.columns, modulus, adhesion)


def _greenwood_williamson(cell: Cell, variable: Variable) -> Floats:
    arguments = _equal_summits(cell.scene)
    _check_no_adhesion(cell.scene)
    return theory.greenwood_williamson(separation=cell.path.separation, variable=variable, **arguments)


def _fuller_tabor(cell: Cell, variable: Variable) -> Floats:
    """Evaluate the loading, and the unloading with the closest separation as its turning point."""
    arguments, h = _equal_summits(cell.scene), cell.path.separation
    if cell.scene.adhesion_model.resolved(_jkr_validity(cell.scene, arguments["radius"]).jkr_error).model != "jkr":
        raise RoughmdrError("the adhesion is of finite range, not that of JKR")
    turn = int(h.argmin())
    if (np.diff(h[: turn + 1]) > 0.0).any() or (np.diff(h[turn:]) < 0.0).any():
        raise RoughmdrError("the path is not one loading and one unloading")
    arguments |= {"work": cell.scene.work, "variable": variable}
    loading = theory.fuller_tabor(separation=h[: turn + 1], **arguments)
    return np.append(loading, theory.fuller_tabor(separation=h[turn + 1 :], turning=h[turn], **arguments))


def _dmt_maugis(cell: Cell, variable: Variable) -> Floats:
    arguments = _equal_summits(cell.scene) | {"work": cell.scene.work, "variable": variable}
    tabor = _jkr_validity(cell.scene, arguments["radius"]).tabor
    if not cell.scene.adhesion_model.tabor_known:
        raise RoughmdrError("neither strength nor range of the adhesion is given")
    if not tabor < _DMT_MAX_TABOR:
        raise RoughmdrError(f"the Tabor number is {tabor:.3g}, not below {_DMT_MAX_TABOR:g}")
    return theory.dmt_maugis(separation=cell.path.separation, **arguments)


class _Surface(NamedTuple):
    """A Gaussian surface, or a map that is taken for one."""

    moments: Moments
    spectrum: SelfAffine | MapSpectrum | None
    mean: float  # height of its mean plane above the datum plane [m]

    @classmethod
    def of(cls, scene: Scene) -> "_Surface":
        """Return the surface of a scene; RoughmdrError unless it has one, without adhesion."""
        section = scene.asperities
        if not isinstance(section, NayakAsperities | SurfaceAsperities):
            raise RoughmdrError(f"asperities.source is {section.source!r}, not 'nayak' or 'surface'")
        _check_no_adhesion(scene)
        if isinstance(section, NayakAsperities):
            return cls(section.summits.moments, section.spectrum, 0.0)
        return cls(Moments.checked(*section.waves.moments), section.waves.spectrum, section.waves.mean)


def _gaussian_summits(compute: Callable[..., Floats], cell: Cell, variable: Variable) -> Floats:
    """Evaluate a theory of all summits of a surface, which is given by the moments of its spectrum."""
    moments, _, mean = _Surface.of(cell.scene)
    modulus, h = cell.scene.effective_modulus, cell.path.separation - mean
    return compute(separation=h, effective_modulus=modulus, variable=variable, **moments._asdict())


def _asymptote(cell: Cell, _: Variable) -> Floats:
    pressure = _gaussian_summits(theory.bush_gibson_thomas, cell, "pressure")
    modulus, slope = cell.scene.effective_modulus, math.sqrt(2.0 * _Surface.of(cell.scene).moments.m2)
    return theory.bush_gibson_thomas_asymptote(pressure=pressure, effective_modulus=modulus, rms_slope=slope)


def _persson(cell: Cell, variable: Variable) -> Floats:
    _, spectrum, mean = _Surface.of(cell.scene)
    modulus, h = cell.scene.effective_modulus, cell.path.separation - mean
    if spectrum is None:
        if isinstance(cell.scene.asperities, SurfaceAsperities):
            raise RoughmdrError("the map has undefined points, and so no spectrum")
        raise RoughmdrError("it needs a self-affine spectrum, but the scene gives m0, m2 and m4")
    values = np.full_like(h, math.nan)
    open_ = h > 0.0  # at full contact the mean gap is 0
    values[open_] = theory.persson_pressure(separation=h[open_], effective_modulus=modulus, spectrum=spectrum)
    if variable == "contact_fraction":
        values[open_] = theory.persson_contact_fraction(
            pressure=values[open_], effective_modulus=modulus, rms_slope=spectrum.rms_slope
        )
    return values


def _surface_below(scene: Scene) -> tuple[Moments, float]:
    """Return the moments of a surface and the height of its mean plane: of equal summits those of McCool's inverted."""
    section = scene.asperities
    if not isinstance(section, RandomAsperities):
        surface = _Surface.of(scene)
        return surface.moments, surface.mean
    _check_no_adhesion(scene)
    summits = _equal_summits(scene)
    if section.height.family != "norm" or section.height.truncated:
        raise RoughmdrError("heights are not normal")
    m4 = math.pi * (0.375 / summits["radius"]) ** 2
    m2 = m4 / (6.0 * math.pi * math.sqrt(3.0) * summits["density"])
    m0 = section.height.scale**2 + SUMMITS_LESS * m2 * m2 / m4
    law = SummitDistribution(Moments.checked(m0, m2, m4))
    return law.moments, section.height.loc - law.mean


def _cooper(cell: Cell, variable: str) -> Floats:
    """Evaluate the pressure of plane sections, H erfc(h/(sqrt(2) sigma))/2, and the conductance there."""
    from scipy.special import erfc

    scene = cell.scene
    yielding, conducting = scene.stage(Plasticity), scene.stage(Conduction)
    assert yielding is not None  # the curve is of contacts that yield
    conductivity = 0.0 if conducting is None else 0.5 * conducting.factors.get("thermal_conductance", 0.0)
    if conductivity == 0.0:
        raise RoughmdrError("the scene has no conduction.conductivity")
    moments, mean = _surface_below(scene)
    sigma, hardness = math.sqrt(moments.m0), TABOR_HARDNESS * yielding.constants(scene).yield_strength
    fraction = 0.5 * erfc((cell.path.separation - mean) / (math.sqrt(2.0) * sigma))
    if variable != "conductance":
        return np.asarray(fraction if variable == "contact_fraction" else hardness * fraction)
    return theory.cooper_mikic_yovanovich(
        pressure=hardness * fraction,
        hardness=hardness,
        rms_height=sigma,
        mean_slope=math.sqrt(2.0 * moments.m2 / math.pi),
        conductivity=conductivity,
    )


_DEFORMED = "its separation is the mean gap to the deformed surface, the scene's is from the undeformed mean plane"
THEORY_CURVES = {
    "greenwood_williamson": TheoryCurve(_greenwood_williamson),
    "fuller_tabor": TheoryCurve(_fuller_tabor),
    "dmt_maugis": TheoryCurve(_dmt_maugis, note="it neglects the attraction of summits that do not touch"),
    "bush_gibson_thomas": TheoryCurve(partial(_gaussian_summits, theory.bush_gibson_thomas)),
    "bush_gibson_thomas_asymptote": TheoryCurve(
        _asymptote, ("contact_fraction",), "at the pressure of bush_gibson_thomas"
    ),
    "greenwood_elliptic": TheoryCurve(partial(_gaussian_summits, theory.greenwood_elliptic)),
    "persson_separation": TheoryCurve(_persson, ("pressure",), _DEFORMED, describe_spectrum),
    "persson_contact_fraction": TheoryCurve(
        _persson, ("contact_fraction",), f"at the pressure of persson_separation; {_DEFORMED}", describe_spectrum
    ),
    "cooper_mikic_yovanovich": TheoryCurve(
        _cooper,
        ("pressure", "contact_fraction", "conductance"),
        "all contacts have yielded, as plane sections of the surface; x = pressure draws it over the pressure",
        bodies=Plasticity.unlike,
    ),
}
