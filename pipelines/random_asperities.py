"""Asperities drawn at random over all that a user may come with, each at a place of its stable branches."""

import math
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from exact_contact import Exact, Pinned
from twins import Real, mp

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Kernels, Material
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP
from roughmdr.loading.staircase import staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, Shape

NEAREST = 1e-12
"""To a fold, over its depth: nearer ones are not asked for."""
_PRESSED = 1e3  # depths beyond first touch, before some are drawn back
_LEAST = 1e-290
_TRIES = 50


class Asperity(NamedTuple):
    """One asperity on a path of the flat that comes down to it."""

    shape: Shape
    effective_modulus: float
    work: float
    height: float
    path: tuple[float, ...]
    """Separations [m]; the error is that at the last."""


class Found(NamedTuple):
    """The force [N] of one asperity at the end of its path."""

    error: float
    """True, of the sum over it alone."""
    stated: float
    force: float
    distance: float
    """Of the indentation to the nearer end of the branch, over the depth; inf without adhesion."""

    @property
    def excess(self) -> float:
        """Above 1 the bound is none."""
        return self.error / self.stated if self.stated > 0.0 else (math.inf if self.error > 0.0 else 0.0)


def _power(rng: np.random.Generator, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


def _length(rng: np.random.Generator) -> float:
    return _power(rng, -10.0, 0.0)


def _slope(rng: np.random.Generator) -> float:
    return _power(rng, -4.0, 2.0)


def _exponent(rng: np.random.Generator) -> float:
    """Of which half is near 1/2, where contacts are least well known."""
    return 0.5 + _power(rng, -2.0, 0.0 if rng.random() < 0.5 else 2.0)


def _series(rng: np.random.Generator) -> Shape:
    """Terms that are as large as each other within some decades of one width."""
    width, count = np.float64(_power(rng, -8.0, -1.0)), int(rng.integers(1, 6))
    exponents = sorted({round(_exponent(rng), 6) if rng.random() < 0.7 else _exponent(rng) for _ in range(count)})
    rise = width * _slope(rng)
    return rm.PowerSeries({n: float(rise * _power(rng, -3.0, 3.0) / width**n) for n in exponents})


def _table(rng: np.random.Generator) -> Shape:
    """Powers, some with a flat tip, a wear flat or unevenly spread points."""
    r = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-1.5, 0.0, int(rng.integers(3, 12))))])
    f = (r / r[-1]) ** rng.uniform(1.0, 6.0) + (rng.random() < 0.3) * rng.random() * r / r[-1]
    if rng.random() < 0.2:
        f[: int(rng.integers(2, r.size))] = 0.0
    length = _length(rng)
    return rm.Tabulated(r * length / r[-1], f * length * _power(rng, -4.0, 0.0))


def _capped(rng: np.random.Generator) -> Shape:
    radius = _length(rng)
    return rm.CappedParaboloid(radius, radius * _power(rng, 0.0, 4.0), _length(rng))


DRAW: dict[str, Callable[[np.random.Generator], Shape]] = {
    "paraboloid": lambda rng: rm.Paraboloid(_length(rng)),
    "cone": lambda rng: rm.Cone(_slope(rng)),
    "power_law": lambda rng: rm.PowerLaw(_exponent(rng), width=_length(rng), rise=_length(rng)),
    "flat_punch": lambda rng: rm.FlatPunch(_length(rng)),
    "sphere": lambda rng: rm.Sphere(_length(rng)),
    "truncated_cone": lambda rng: rm.TruncatedCone(_slope(rng), _length(rng)),
    "truncated_paraboloid": lambda rng: rm.TruncatedParaboloid(_length(rng), _length(rng)),
    "rounded_cone": lambda rng: rm.RoundedCone(_slope(rng), _length(rng)),
    "capped_paraboloid": _capped,
    "rounded_punch": lambda rng: rm.RoundedPunch(_length(rng), _length(rng)),
    "power_series": _series,
    "tabulated": _table,
}


def found(kind: str, adhesive: bool, seed: int) -> tuple[Asperity, Found]:
    """One asperity of a kind, at random, with JKR's adhesion or without; what floats do not hold is passed over."""
    rng = np.random.default_rng([list(SHAPES).index(kind), adhesive, seed])
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", rm.LimitWarning)
        for _ in range(_TRIES):
            try:
                drawn = _drawn(rng, kind, adhesive)
            except rm.RoughmdrError:
                continue
            if drawn is not None:
                return drawn
    raise ArithmeticError(f"no {kind} of {_TRIES} that floats hold")


def _drawn(rng: np.random.Generator, kind: str, adhesive: bool) -> tuple[Asperity, Found] | None:
    shape = DRAW[kind](rng)
    effective_modulus, work = _power(rng, 3.0, 13.0), _power(rng, -9.0, 1.0) if adhesive else 0.0
    width, rise, params = shape.nondimensional()
    columns = Columns(np.array([width]), np.array([rise]), np.asarray(params, dtype=np.float64)[None])
    adhesion = Adhesion(work)
    law = choose(kind, adhesion, columns[2])
    row = law.params_of(law.prepare(Material(effective_modulus, work, math.inf), columns, 0, 1, 0.0), 0)
    if law.iterative and row[COUNT] == 0.0:
        return None
    natural = law.scales(effective_modulus, work, width, rise, row)
    exact = (
        Pinned(shape, effective_modulus, work)
        if isinstance(shape, rm.FlatPunch)
        else Exact(shape, effective_modulus, work)
    )
    ends = _ends(law, row, exact, natural) if adhesive else []
    indentation = _indentation(rng, law, row, exact, natural, ends)
    if not math.isfinite(indentation) or indentation == 0.0 or (indentation < 0.0 and not adhesive):
        return None
    height = 0.0 if rng.random() < 0.5 else float(rng.normal()) * abs(indentation) * _power(rng, 0.0, 3.0)
    way = [height, height - _PRESSED * natural[0][0]] if rng.random() < 0.3 else [height]
    path = np.array([*(way if adhesive else []), height - indentation])
    asperity = Asperity(shape, effective_modulus, work, height, tuple(path.tolist()))
    return _compared(asperity, law, row, columns, exact, natural, ends)


Ends = list[tuple[Real, Real, Real, Real]]
"""The t of the foot and of the top of each stable branch, and the indentations [m] there."""


def _ends(law: Kernels, row: Floats, exact: Exact, natural: tuple[tuple[float, float], float, float, float]) -> Ends:
    if not law.iterative:
        foot = exact.fold()
        return [(foot, mp.inf, exact.indentation(foot), mp.inf)]
    found = []
    for j in range(int(row[COUNT])):
        foot, top = mp.mpf(float(row[FOOT + j])), mp.mpf(float(row[TOP + j]))
        found.append((foot, top, exact.indentation(foot), exact.indentation(top) if top < mp.inf else mp.inf))
    return found


def _indentation(
    rng: np.random.Generator,
    law: Kernels,
    row: Floats,
    exact: Exact,
    natural: tuple[tuple[float, float], float, float, float],
    ends: Ends,
) -> float:
    """At 1e-12 to 1e3 depths from the end of a branch; without adhesion at a t of 1e-4 to 1e2."""
    if not ends:
        return float(natural[0][0] * law.reduced_control(_power(rng, -4.0, 2.0), row))
    depth = max(-foot_value for _, _, foot_value, _ in ends)
    _, _, foot_value, top_value = ends[int(rng.integers(len(ends)))]
    way = depth * _power(rng, math.log10(NEAREST), -3.0 if rng.random() < 0.5 else 3.0)
    if top_value < mp.inf and rng.random() < 0.5:
        return float(top_value - way)
    return float(foot_value + way)


def _compared(
    asperity: Asperity,
    law: Kernels,
    row: Floats,
    columns: tuple[Floats, Floats, Floats],
    exact: Exact,
    natural: tuple[tuple[float, float], float, float, float],
    ends: Ends,
) -> tuple[Asperity, Found] | None:
    """The sum over the asperity against the exact force; None where it lets go, or so near to where it would."""
    path, z = np.array(asperity.path), asperity.height
    total, _, _ = loop.add_asperities(
        law,
        np.array([z]),
        Columns(*columns),
        asperity.effective_modulus,
        Adhesion(asperity.work),
        path,
        staircase(path),
        {totals.FORCE, totals.ERROR},
    )
    depth = natural[0][0]
    x = [((z - h) + depth) * (1.0 / depth) if ends else (z - h) / depth for h in path.tolist()]
    rung = 1.0
    if law.branch is not None and law.branched:
        rung = 0.0
        for each in x:
            rung = law.branch(max(each, 0.0), rung, True, row)
    value = mp.mpf(z) - mp.mpf(asperity.path[-1])
    distance = math.inf
    low, high = mp.mpf(0), mp.mpf(10) ** 400
    if ends:
        if rung == 0.0 or not x[-1] > 0.0:
            return None
        low, top, foot_value, top_value = ends[int(rung) - 1]
        high = min(top, high)
        deepest = max(-other for _, _, other, _ in ends)
        distance = float(min(value - foot_value, top_value - value) / deepest)
        if not distance >= NEAREST:
            return None
    begin = law.state_on_branch(x[-1], rung, row) if law.state_on_branch is not None else law.state(x[-1], row)
    if not law.iterative:
        begin = natural[1] * law.radius(begin, row)
    if not 0.0 <= begin < math.inf:
        return None
    t = exact.state(value, begin, low, high)
    if t is None:
        raise ArithmeticError(f"no equilibrium at {asperity}")
    force = exact.force(t)
    if not _LEAST < abs(force) < 1 / _LEAST:  # below, floats lose digits
        return None
    error = abs(mp.mpf(float(total[totals.FORCE, -1])) - force)
    return asperity, Found(float(error), float(total[totals.ERROR, -1]), float(force), distance)
