"""A spline's MDR profile made into the pieces that ``table`` looks up."""

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.shapes.tabulated.lookup import DEGREE, HEAD, PIECE, strain_between

_EXACT = 3e-15  # of the largest value on a piece: what the last coefficients may leave
_NOISE = 1e-11  # below it, what halving does not lower is rounding
_FINEST = 2.0**-20  # of the way between two knots
_OCTAVES_BEYOND = 2  # beyond the last knot, until the far field is right: 16^-14 is below rounding
_LOOKS = 8  # on each piece, for where sqrt(a) g' falls
_RIPPLE = 1e-9  # a fall of so little is rounding

_POINTS = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
_TO_POWERS = np.array(
    [np.pad(np.polynomial.chebyshev.cheb2poly([0.0] * i + [1.0]), (0, DEGREE - i)) for i in range(DEGREE + 1)]
)
_TO_CHEBYSHEV = np.linalg.inv(np.polynomial.chebyshev.chebvander(_POINTS, DEGREE))


def tabulate(knots: Floats, coefficients: Floats) -> Floats:
    """The form of f' = c0 + c1 s + c2 s^2 over s = r - knot (last piece: c0 alone, without end), as ``table`` says."""
    from roughmdr.shapes.tabulated.abel import integrals  # it alone needs the compiler

    ends = np.append(knots[1:], knots[-1] * 2.0 ** np.arange(1, _OCTAVES_BEYOND + 1))
    bases = np.append(knots[:-1], np.full(_OCTAVES_BEYOND, knots[-1]))
    begins = np.append(knots[:-1], knots[-1] * 2.0 ** np.arange(_OCTAVES_BEYOND))
    reach = np.sqrt((ends - bases) * (ends + bases))
    low = np.sqrt((begins - bases) * (begins + bases)) / reach
    waiting = [(base, length, start, 1.0, np.inf) for base, length, start in zip(bases, reach, low, strict=True)]
    done: list[tuple[float, Floats]] = [_tip(knots, coefficients)]
    waiting = waiting[1:]
    while waiting:
        places = np.array(waiting)
        base, length, start, stop, before = places.T
        middle, half = 0.5 * (stop + start), 0.5 * (stop - start)
        q = length[:, None] * (middle[:, None] + half[:, None] * _POINTS)
        values = integrals(q.ravel(), np.repeat(base, q.shape[1]), knots, coefficients).reshape(*q.shape, 3)
        chebyshev = np.einsum("cp,spv->svc", _TO_CHEBYSHEV, values)
        largest = np.abs(values).max(axis=1)
        left = (np.abs(chebyshev[..., -2:]).sum(axis=-1) / np.where(largest > 0.0, largest, 1.0)).max(axis=1)
        fits = (left <= _EXACT) | ((left < _NOISE) & (left > 0.5 * before)) | (half < _FINEST)
        powers = chebyshev @ _TO_POWERS
        for i in np.flatnonzero(fits):
            begin = np.hypot(base[i], length[i] * start[i]) if start[i] > 0.0 else base[i]
            sizes = np.abs(powers[i, [0, 2]]).sum(axis=1)
            head = [base[i], 1.0 / (length[i] * half[i]), middle[i] / half[i], 0.0, *sizes]
            done.append((float(begin), np.concatenate([head, powers[i].ravel()])))
        waiting = [
            part
            for i in np.flatnonzero(~fits)
            for part in (
                (base[i], length[i], start[i], middle[i], left[i]),
                (base[i], length[i], middle[i], stop[i], left[i]),
            )
        ]
    done.sort(key=lambda piece: piece[0])
    begins = np.array([begin for begin, _ in done] + [ends[-1]])
    dips = _dips(begins, knots, coefficients)
    parts = [piece for _, piece in done]
    far = _far(begins[-1], knots, coefficients)
    spline = np.column_stack([knots, _heights(knots, coefficients), coefficients])
    params = np.concatenate(
        [[len(dips)], np.ravel(dips), [len(done)], begins, *parts, far, [knots.size], spline.ravel()]
    )
    _add_strains(params)
    return params


def _heights(knots: Floats, coefficients: Floats) -> Floats:
    """f at the knots."""
    h = np.diff(knots)
    c0, c1, c2 = coefficients[:-1].T
    return np.concatenate([[0.0], np.cumsum(h * (c0 + h * (c1 / 2.0 + h * c2 / 3.0)))])


def _add_strains(params: Floats) -> None:
    """Fill in the strain at the begin of each piece and of the far field."""
    from roughmdr.numerics.jit import compiled

    panel = compiled(strain_between)
    first = 2 + 2 * int(params[0])
    count = int(params[first - 1])
    begins, total = params[first : first + count + 1], 0.0
    for i in range(count):
        at = first + count + 1 + PIECE * i
        params[at + 3] = total
        # Just inside, where the piece itself is looked up.
        total += panel(begins[i], np.nextafter(begins[i + 1], 0.0), params)
    params[first + count + 1 + PIECE * count + 2] = total


def _tip(knots: Floats, coefficients: Floats) -> tuple[float, Floats]:
    """The first piece, in powers of a itself, so that it is right however near the tip."""
    c0, c1, c2 = coefficients[0] * np.array([0.5 * np.pi, 1.0, 0.25 * np.pi])
    g, slope, push = (np.zeros(DEGREE + 1) for _ in range(3))
    g[1:4] = c0, c1, c2
    slope[:3] = c0, 2.0 * c1, 3.0 * c2
    push[2:5] = 0.5 * c0, 2.0 / 3.0 * c1, 0.75 * c2
    return 0.0, np.concatenate([[0.0, 1.0, *np.zeros(HEAD - 2)], g, slope, push])


def _far(end: float, knots: Floats, coefficients: Floats) -> Floats:
    """g beyond the end, slope S: a pi S/2 + sum over k of binomial(2k, k) (2a)^(-2k) ∫ (f' - S) r^(2k) dr."""
    from scipy.special import binom

    from roughmdr.shapes.tabulated.abel import integrals

    nodes, weights = unit_gauss(DEGREE + 3)
    h = np.diff(knots)[:, None]
    s = h * nodes
    c0, c1, c2 = coefficients[:-1].T[:, :, None]
    excess = h * weights * (c0 + s * (c1 + s * c2) - coefficients[-1, 0])
    r = knots[:-1, None] + s
    k = np.arange(DEGREE + 1)
    terms = np.array([binom(2 * i, i) / 4.0**i * np.sum(excess * r ** (2 * i)) for i in k])
    steepness = 0.5 * np.pi * coefficients[-1, 0]
    far = end * np.sum(2.0 * k / (2.0 * k - 1.0) * terms * end ** (-2.0 * k))
    constant = integrals(np.array([end]), np.zeros(1), knots, coefficients)[0, 2] - 0.5 * steepness * end**2 - far
    return np.concatenate([[steepness, constant, 0.0], terms])


def steepness(begins: Floats, knots: Floats, coefficients: Floats) -> tuple[Floats, Floats]:
    """Contact radii all along the pieces, and g' there."""
    from roughmdr.shapes.tabulated.abel import integrals

    x = (begins[:-1, None] + np.diff(begins)[:, None] * (np.arange(_LOOKS) + 0.5) / _LOOKS).ravel()
    return x, integrals(x, np.zeros_like(x), knots, coefficients)[:, 1]


def _dips(begins: Floats, knots: Floats, coefficients: Floats) -> list[tuple[float, float]]:
    """Where sqrt(a) g'(a) falls: from where and to where."""
    from scipy.optimize import minimize_scalar

    from roughmdr.shapes.tabulated.abel import integrals

    def steep(x: float) -> float:
        return float(np.sqrt(x) * integrals(np.array([x]), np.zeros(1), knots, coefficients)[0, 1])

    x, slope = steepness(begins, knots, coefficients)
    m = np.sqrt(x) * slope
    turns: list[tuple[int, int]] = []
    top = 0
    bottom: int | None = None
    for i in range(1, x.size):  # a fall counts when it is deeper than rounding
        if bottom is None:
            if m[i] >= m[top]:
                top = i
            elif m[i] < m[top] * (1.0 - _RIPPLE):
                bottom = i
        elif m[i] < m[bottom]:
            bottom = i
        elif m[i] > m[bottom] * (1.0 + _RIPPLE):
            turns.append((top, bottom))
            top, bottom = i, None
    found = []
    for peak, dip in turns:
        high = minimize_scalar(lambda a: -steep(a), bounds=(x[max(peak - 1, 0)], x[peak + 1]), method="bounded")
        low = minimize_scalar(steep, bounds=(x[dip - 1], x[dip + 1]), method="bounded")
        found.append((float(high.x), float(low.x)))
    return found
