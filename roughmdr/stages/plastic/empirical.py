"""Spheres that yield, by formulas fitted to finite elements: Jackson and Green, and Kogut and Etsion.

Loading: R. L. Jackson, I. Green, J. Tribol. 127 (2005) 343; L. Kogut, I. Etsion, J. Appl. Mech. 69 (2002) 657.
Unloading of both: I. Etsion, Y. Kligerman, Y. Kadin, Int. J. Solids Struct. 42 (2005) 3716. No adhesion and no energy.
Ranges of the fits do not meet, as published: forces of Kogut and Etsion jump by 3 % where contacts begin to yield, and
by 8 % at a Poisson's ratio of 0.3 (37 % at 0) where they are plastic altogether; those of Jackson and Green by 0.5 %.
"""

import math

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, once, specialise
from roughmdr.stages.plastic.body import CRITICAL, LIMIT, NO_MARK, RADIUS, Body, Mark, PlasticKernels, State, hertz

TABOR_HARDNESS = 2.8
"""Hardness over yield strength [1]: D. Tabor, The Hardness of Metals, Oxford 1951; that of Kogut and Etsion."""
_JG_ELASTIC = 1.9  # largest indentation, over the critical one, that Jackson and Green call elastic
_JG_HARDNESS, _JG_FALL, _JG_POWER = 2.84, 0.82, 0.7  # H_G/Y = 2.84 (1 - e^(-0.82 (a/R)^-0.7))
_KE_RANGES = ((6.0, 1.03, 1.425, 0.93, 1.136), (110.0, 1.40, 1.263, 0.94, 1.146))
"""Kogut and Etsion: up to which indentation over the critical one; factor and power of the force, and of the area."""
_CHANGE = 1e-6  # relative change of an indentation in differences: right to 1e-10, as near as published powers need


@njit
def _jg_constant(body: Body) -> float:
    """C of Jackson and Green [1], by which yielding begins."""
    return 1.295 * math.exp(0.736 * body.poisson)


@njit
def _critical(constant: float, asperity: Floats, body: Body) -> float:
    """Critical indentation (pi C Y/(2 E*))^2 R [m]."""
    root = math.pi * constant * body.yield_strength / (2.0 * body.effective_modulus)
    return float(root * root * asperity[RADIUS])


@njit
def _prepare_jg(asperity: Floats, body: Body) -> None:
    """Fill in the critical indentation (pi C Y/(2 E*))^2 R, and that of first yielding."""
    asperity[CRITICAL] = _critical(_jg_constant(body), asperity, body)
    asperity[LIMIT] = _JG_ELASTIC * asperity[CRITICAL]


@njit
def _prepare_ke(asperity: Floats, body: Body) -> None:
    """Fill in the critical indentation (pi K H/(2 E*))^2 R, K = 0.454 + 0.41 nu."""
    constant = (0.454 + 0.41 * body.poisson) * TABOR_HARDNESS
    asperity[CRITICAL] = asperity[LIMIT] = _critical(constant, asperity, body)


@njit
def _load_jg(deepest: float, asperity: Floats, body: Body) -> tuple[float, float]:
    """Force [N] and radius [m] of Jackson and Green beyond ``LIMIT``."""
    radius, critical = asperity[RADIUS], asperity[CRITICAL]
    w = deepest / critical
    exponent = 0.14 * math.exp(23.0 * body.yield_strength / body.effective_modulus)
    a = math.sqrt(radius * deepest * (w / _JG_ELASTIC) ** exponent)
    hardness = _JG_HARDNESS * (1.0 - math.exp(-_JG_FALL * (a / radius) ** -_JG_POWER))  # H_G/Y [1]
    small, large = math.exp(-0.25 * w ** (5.0 / 12.0)), 1.0 - math.exp(-(w ** (5.0 / 9.0)) / 25.0)
    unit = hertz(critical, asperity, body).force
    return unit * (small * w * math.sqrt(w) + 4.0 * hardness / _jg_constant(body) * large * w), a


@njit
def _load_ke(deepest: float, asperity: Floats, body: Body) -> tuple[float, float]:
    """Force [N] and radius [m] of Kogut and Etsion beyond ``LIMIT``."""
    radius, critical = asperity[RADIUS], asperity[CRITICAL]
    w = deepest / critical
    unit = hertz(critical, asperity, body).force
    for end, force, power, area, power_of_area in _KE_RANGES:
        if w <= end:
            return unit * force * w**power, math.sqrt(radius * critical * area * w**power_of_area)
    area = 2.0 * radius * deepest
    return math.pi * area * TABOR_HARDNESS * body.yield_strength, math.sqrt(area)


def _mark(deepest: float, asperity: Floats, body: Body) -> Mark:
    """Force [N] and radius [m] there, and the indentation [m] that is left; no mark before yielding."""
    if deepest <= asperity[LIMIT]:
        return NO_MARK
    force, radius = kernel.load(deepest, asperity, body)
    w = deepest / asperity[CRITICAL]
    return Mark(force, radius, deepest * (1.0 - w**-0.28) * (1.0 - w**-0.69))  # Etsion, Kligerman and Kadin


@njit
def _ends(deepest: float, mark: Mark, asperity: Floats, body: Body) -> tuple[float, float]:
    """Rise of the flat [m] at which contact is made again and lost."""
    return deepest - mark.third, deepest - mark.third


def _state(indentation: float, rise: float, mark: Mark, asperity: Floats, body: Body) -> State:
    """The contact after the flat has risen from the deepest indentation."""
    if mark.first == 0.0:
        elastic = hertz(indentation, asperity, body)
        return State(elastic.force, elastic.radius, elastic.stiffness, math.nan)
    deepest = indentation + rise
    if rise == 0.0:
        change = _CHANGE * deepest
        more, less = kernel.load(deepest + change, asperity, body)[0], kernel.load(deepest - change, asperity, body)[0]
        return State(mark.first, mark.second, 0.5 * (more - less) / change, math.nan)
    x = 1.0 - rise / (deepest - mark.third)
    if x <= 0.0:
        return State(0.0, 0.0, 0.0, math.nan)
    w = deepest / asperity[CRITICAL]
    power = 1.5 * w**-0.0331
    force = mark.first * x**power
    radius = mark.second * math.sqrt(x ** (w**-0.12))
    return State(force, radius, power * force / (x * (deepest - mark.third)), math.nan)


@njit
def _lost(deepest: float, mark: Mark, asperity: Floats, body: Body) -> float:
    """No energy is known."""
    return math.nan


kernel = PlasticKernels("kernel")
"""Stands for the kernels of either model in ``_mark`` and ``_state``."""


@once
def kernels(model: str) -> PlasticKernels:
    """Return the kernels of "jackson-green" or "kogut-etsion"."""
    found = PlasticKernels(model.replace("-", "_"))
    green = model == "jackson-green"
    found.prepare, found.load = (_prepare_jg, _load_jg) if green else (_prepare_ke, _load_ke)
    found.kinks = (math.inf,) if green else (*(end for end, *_ in _KE_RANGES), math.inf)
    found.mark, found.state = specialise(_mark, found), specialise(_state, found)
    found.adhesive, found.ends, found.lost = False, _ends, _lost
    return found
