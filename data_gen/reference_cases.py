"""Which asperities the reference tables are of: random, of few digits, over all that double precision can hold."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from oracles.profiles import Floats, Parameters, knot_slopes

SEED = 2012
MODULUS = (1e3, 1e13)
WORK = (1e-9, 10.0)
OMEGA = (1e-4, 1e4)


@dataclass(frozen=True)
class Case:
    """What one asperity is, and the lengths [m] that its rows without adhesion are measured in."""

    shape: str
    parameters: Parameters
    effective_modulus: float
    work: float
    width: float
    rise: float
    slopes: list[float] | None = None


class Draw:
    """Random numbers of few digits, so that the tables can be read."""

    def __init__(self, shape: str) -> None:
        self._random = np.random.Generator(np.random.Philox([SEED, *shape.encode()]))

    def among(self, least: float, most: float) -> float:
        """A number between two, evenly in its logarithm."""
        return few(math.exp(self._random.uniform(math.log(least), math.log(most))))

    def spread(self, count: int, least: float = OMEGA[0], most: float = OMEGA[1]) -> list[float]:
        """``count`` numbers between two, one in each of as many equal parts of the logarithm."""
        ratio = (most / least) ** (1.0 / count)
        return [self.among(least * ratio**i, least * ratio ** (i + 1)) for i in range(count)]

    def material(self, width: float, rise: float, omega: float) -> tuple[float, float] | None:
        """Modulus [Pa] and work [J/m2] with dl(width) = omega rise; None where they would be out of range."""
        ratio = (omega * rise) ** 2 / (2.0 * math.pi * width)
        least, most = max(MODULUS[0], WORK[0] / ratio), min(MODULUS[1], WORK[1] / ratio)
        if least >= most:
            return None
        effective_modulus = self.among(least, most)
        return effective_modulus, float(f"{effective_modulus * ratio:.12g}")


def few(number: float) -> float:
    """``number`` to six digits."""
    return float(f"{number:.6g}")


def adhesive(
    draw: Draw, shape: str, omega: float, form: Callable[[float, float], Parameters], aspect: tuple[float, float]
) -> Case:
    """A case of reduced adhesion ``omega``; ``form`` makes the parameters of a width and a rise [m]."""
    while True:
        width = draw.among(1e-10, 1.0)
        rise = few(width * draw.among(*aspect))
        found = draw.material(width, rise, omega)
        if found is not None:
            return Case(shape, form(width, rise), *found, width=width, rise=rise)


def bare(draw: Draw, shape: str, form: Callable[[float, float], Parameters], aspect: tuple[float, float]) -> Case:
    """A case without adhesion."""
    width = draw.among(1e-10, 1.0)
    rise = few(width * draw.among(*aspect))
    return Case(shape, form(width, rise), draw.among(*MODULUS), 0.0, width, rise)


ASPECT = (1e-3, 10.0)
FORMS: dict[str, Callable[[float, float], Parameters]] = {
    "flat_punch": lambda b, _: {"radius": b},
    "cone": lambda b, h: {"slope": few(h / b)},
    "paraboloid": lambda b, h: {"radius": few(b * b / h)},
    "sphere": lambda b, _: {"radius": b},
    "truncated_cone": lambda b, h: {"slope": few(h / b), "flat_radius": b},
    "truncated_paraboloid": lambda b, h: {"radius": few(b * b / h), "flat_radius": b},
    "rounded_cone": lambda b, h: {"slope": few(h / b), "blend_radius": b},
    "rounded_punch": lambda b, h: {"flat_radius": b, "edge_radius": few(b * b / h)},
}
WINDOWS = {
    "truncated_cone": [1.55, 4.6, 6.0],
    "truncated_paraboloid": [2.3, 7.0, 12.0],
    "rounded_cone": [1.22, 3.7, 3.8],
}
"""Reduced adhesions at which there are two branches, the first under dead load and the others under fixed grips."""


def simple_cases(shape: str, draw: Draw) -> list[Case]:
    """Shapes with at most one form, stretched."""
    form = FORMS[shape]
    aspect = (1.0, 1.0) if shape == "sphere" else ASPECT
    # A cone and a paraboloid have no size of their own: there omega only keeps the radii within reason.
    span = (0.03, 30.0) if shape in {"cone", "paraboloid"} else OMEGA
    omegas = [*draw.spread(7, *span), *WINDOWS.get(shape, [])]
    return [adhesive(draw, shape, omega, form, aspect) for omega in omegas] + [
        bare(draw, shape, form, aspect) for _ in range(3)
    ]


def power_law_cases(shape: str, draw: Draw) -> list[Case]:
    """Exponents from just above 1/2, where the natural scale runs away, to nearly a flat punch."""

    def form(n: float) -> Callable[[float, float], Parameters]:
        return lambda width, rise: {"exponent": n, "width": width, "rise": rise}

    cases = []
    exponents = (0.51, 0.6, 0.75, 1.3, 2.0, 3.7, 8.0, 40.0, 200.0)
    for n, part in zip(exponents, draw.spread(len(exponents)), strict=True):
        # a0/width = omega^(1/(n - 1/2)), kept within six decades.
        omega = few(part ** min(1.0, 1.5 * (n - 0.5)))
        cases.append(adhesive(draw, shape, omega, form(n), ASPECT))
    return cases + [bare(draw, shape, form(n), ASPECT) for n in (0.51, 1.5, 4.0, 200.0)]


def power_series_cases(shape: str, draw: Draw) -> list[Case]:
    """Sums of two and three powers, alike in size somewhere near the width."""

    def form(exponents: tuple[float, ...]) -> Callable[[float, float], Parameters]:
        def make(width: float, rise: float) -> Parameters:
            return {"terms": {repr(n): few(rise * draw.among(0.1, 10.0) * width**-n) for n in exponents}}

        return make

    families = [(2.0, 4.0), (1.0, 2.0), (0.75, 1.5, 3.0), (0.6, 6.0), (2.0, 4.0, 6.0), (1.0, 1.25), (2.0, 20.0)]
    pairs = zip(families, draw.spread(len(families)), strict=True)
    return [adhesive(draw, shape, omega, form(family), ASPECT) for family, omega in pairs] + [
        bare(draw, shape, form(family), ASPECT) for family in families[:3]
    ]


def capped_cases(shape: str, draw: Draw) -> list[Case]:
    """Ratios of the outer to the cap's radius up to 1, where there is no kink left."""

    def form(ratio: float) -> Callable[[float, float], Parameters]:
        def make(width: float, rise: float) -> Parameters:
            radius = few(width * width / rise)
            return {
                "radius": radius,
                "cap_radius": max(radius, few(radius / ratio)),
                "blend_radius": width,
            }

        return make

    ratios = (0.5, 0.01, 1.0, 0.01, 0.99, 0.1, 0.01)
    cases = [
        adhesive(draw, shape, omega, form(ratio), ASPECT) for ratio, omega in zip(ratios, draw.spread(7), strict=True)
    ]
    cases += [adhesive(draw, shape, omega, form(ratio), ASPECT) for ratio, omega in CAPPED_WINDOWS]
    return cases + [bare(draw, shape, form(ratio), ASPECT) for ratio in (0.01, 0.5, 0.99, 1.0)]


CAPPED_WINDOWS = [(0.01, 2.3), (0.5, 2.05), (0.01, 6.9), (0.01, 9.0), (0.01, 12.0), (0.5, 4.0), (0.99, 2.0)]
"""Ratio and reduced adhesion: corner folds, smooth ones not far from them, and both at once."""


def tabulated_cases(shape: str, draw: Draw) -> list[Case]:
    """Three tables, each stretched to several sizes."""
    uneven = np.array([0.0, 0.11, 0.2, 0.37, 0.45, 0.7, 0.81, 1.0, 1.3, 1.45, 1.8, 2.4])
    rounded = np.where(uneven < 0.5, uneven**2, uneven - 0.25)  # a rounded cone, and a little of a fourth power
    flat = np.array([0.0, 0.3, 0.62, 1.0, 1.2, 1.5, 1.9, 2.3, 3.0])
    tables = [
        (uneven, rounded + 0.1 * uneven**4),
        (flat, 0.5 * np.maximum(flat - 1.0, 0.0) ** 2),
        (np.array([0.0, 0.6, 1.5]), np.array([0.0, 0.25, 1.2])),
    ]

    def form(table: tuple[Floats, Floats]) -> Callable[[float, float], Parameters]:
        return lambda width, rise: {
            "r": [few(width * x) for x in table[0].tolist()],
            "f": [few(rise * y) for y in table[1].tolist()],
        }

    cases = [adhesive(draw, shape, omega, form(table), ASPECT) for table in tables for omega in draw.spread(3)] + [
        bare(draw, shape, form(table), ASPECT) for table in tables
    ]
    return [Case(**{**vars(case), "slopes": knot_slopes(case.parameters["r"], case.parameters["f"])}) for case in cases]


CASES: dict[str, Callable[[str, Draw], list[Case]]] = {
    **dict.fromkeys(FORMS, simple_cases),
    "power_law": power_law_cases,
    "power_series": power_series_cases,
    "capped_paraboloid": capped_cases,
    "tabulated": tabulated_cases,
}
