"""A measured radial profile."""

from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.array_shapes import SharedProfile, equal_rows, power_of_two
from roughmdr.shapes.base import check_radii
from roughmdr.shapes.tabulated import lookup

_MIN_POINTS = 3
_MIN_SPACING = 1e-6  # least spacing, over the last radius: nearer points leave no digits to the spline
_MAX_LENGTH = 1e100  # [m], so that the squares of radii and heights are floats
_RTOL_CHORD = 4 * np.finfo(float).eps  # relative error of a chord's slope by the rounding of the points
_NOISE = 1e-9  # negative slope of g, over its largest slope, that is rounding


class Tabulated(SharedProfile):
    """f [m] at radii r [m], both from 0 on: between them a monotone cubic spline, beyond them a cone.

    The spline is the not-a-knot cubic, its slopes at the points kept between 0 and three times the lesser slope of the
    chords, and so that it is convex where the chords are (R. L. Dougherty, A. Edelman, J. M. Hyman, Math. Comp. 52
    (1989) 471). ShapeError unless there are at least 3 points, r rises, f does not fall, and both begin at 0.
    OutOfRange where the profile is so concave that the contact would not be a disc.
    """

    name = "tabulated"
    units: ClassVar[dict[str, str]] = {"r": "m", "f": "m"}
    dimension = "point"
    profile = lookup.PROFILE

    def __init__(self, r: ArrayLike, f: ArrayLike) -> None:
        self.radii, self.heights = equal_rows(self.name, _MIN_POINTS, r=r, f=f)
        _check(self.radii, self.heights)
        self.knot_slopes = _monotone_slopes(self.radii, self.heights)
        self._check_disc()

    def __repr__(self) -> str:
        return f"Tabulated({self.radii.size} points to r={self.radii[-1]:g}, f={self.heights[-1]:g})"

    @classmethod
    def example(cls) -> dict[str, Any]:
        return {"r": [0.0, 1.0, 2.0], "f": [0.0, 1.0, 4.0]}

    @property
    def parameters(self) -> dict[str, Any]:
        return {"r": self.radii, "f": self.heights}

    @property
    def end(self) -> float:
        return float(self.radii[-1])

    @cached_property
    def _units(self) -> tuple[float, float]:
        """The width and rise: powers of two next to the last r and f."""
        return float(power_of_two(self.radii[-1])), float(power_of_two(self.heights[-1]))

    def _exact_pieces(self) -> list[tuple[Fraction, ...]]:
        """Return the knot and the coefficients of f' in r - knot of each piece, the last without end; in ``_units``.

        Floats lose digits in the differences of nearly equal slopes where points lie close.
        """
        width, rise = self._units
        columns = self.radii / width, self.heights / rise, self.knot_slopes * (width / rise)
        points = list(zip(*([Fraction(value) for value in column.tolist()] for column in columns), strict=True))
        pieces = []
        for (begin, f_begin, left), (end, f_end, right) in pairwise(points):
            h, chord = end - begin, (f_end - f_begin) / (end - begin)
            pieces.append((begin, left, 2 * (3 * chord - 2 * left - right) / h, 3 * (left + right - 2 * chord) / h**2))
        return [*pieces, (points[-1][0], points[-1][2], Fraction(0), Fraction(0))]

    @cached_property
    def _pieces(self) -> tuple[Floats, Floats]:
        """The knots, and the coefficients, as floats."""
        pieces = np.array(self._exact_pieces(), dtype=np.float64)
        return np.ascontiguousarray(pieces[:, 0]), np.ascontiguousarray(pieces[:, 1:])

    # From the given heights: those in the params are sums, whose roundings add up.
    def f(self, r: ArrayLike) -> Floats:
        s, (c0, c1, c2), piece = self._locate(r)
        return np.asarray(self.heights[piece] + self._units[1] * s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)))

    def df(self, r: ArrayLike) -> Floats:
        s, (c0, c1, c2), _ = self._locate(r)
        return np.asarray(self._units[1] / self._units[0] * (c0 + s * (c1 + s * c2)))

    def _locate(self, r: ArrayLike) -> tuple[Floats, Floats, NDArray[np.intp]]:
        """Return r - knot, the coefficients and the index of the piece that each r lies on."""
        knots, coefficients = self._pieces
        r = check_radii("r", r) / self._units[0]
        piece = np.searchsorted(knots[1:], r, side="right")
        return r - knots[piece], coefficients[piece].T.reshape(3, *r.shape), piece

    @cached_property
    def _params(self) -> Floats:
        from roughmdr.shapes.tabulated.build import tabulate

        return tabulate(*self._pieces)

    def nondimensional(self) -> tuple[float, float, Any]:
        """Return powers of two next to the last r and f as width and rise, and the pieces."""
        return *self._units, self._params

    def _check_disc(self) -> None:
        """Raise OutOfRange where g falls: pressed without adhesion, the contact would have a gap inside."""
        from roughmdr.shapes.tabulated.build import sample_slope

        width, _ = self._units
        knots, coefficients = self._pieces
        x, slope = sample_slope(knots, knots, coefficients)
        falls = slope < -_NOISE * slope.max()
        if falls.any():
            raise OutOfRange(
                f"tabulated: the profile is so concave near r = {width * x[falls][0]:.3g} m that the contact would not "
                "be a disc there; a table that ends before that can be used"
            )

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        """Return a, g and a g - G as ``ProfileShape`` does, here from the antiderivatives of each piece."""
        from mpmath import mp

        with mp.workdps(40):
            a, g, load, begin = mp.mpf(t), mp.mpf(0), mp.mpf(0), mp.mpf(0)
            pieces = [[mp.mpf(v.numerator) / v.denominator for v in piece] for piece in self._exact_pieces()]
            for (knot, c0, c1, c2), (following, *_) in zip(pieces, [*pieces[1:], [mp.inf]], strict=True):
                if knot >= a:
                    break
                end = mp.pi / 2 if following >= a else mp.asin(following / a)
                powers = (c0 - c1 * knot + c2 * knot**2, (c1 - 2 * c2 * knot) * a, c2 * a**2)
                sines = [_sine_integral(m, end) - _sine_integral(m, begin) for m in range(5)]
                g += a * sum(c * sines[m] for m, c in enumerate(powers))
                load += a**2 * sum(c * sines[m + 2] for m, c in enumerate(powers))
                begin = end
            width, rise = self._units
            return width * a, rise * g, width * rise * load


def _sine_integral(power: int, angle: Any) -> Any:
    """Return ∫_0^angle sin^power for an mpmath angle and a power from 0 to 4."""
    from mpmath import mp

    sine, cosine = mp.sin(angle), mp.cos(angle)
    if power < 2:
        return angle if power == 0 else 1 - cosine
    return ((power - 1) * _sine_integral(power - 2, angle) - cosine * sine ** (power - 1)) / power


def _check(r: Floats, f: Floats) -> None:
    """Raise ShapeError where r and f are no profile."""
    for name, column in (("r", r), ("f", f)):
        if column[0] != 0.0:
            raise ShapeError(f"tabulated: {name}[0] is {column[0]:g} m; the table must begin at the tip, with 0")
    for name, column, falls, must in (
        ("r", r, np.diff(r) <= 0.0, "rise from point to point"),
        ("f", f, np.diff(f) < 0.0, "not fall: the tip is the lowest point"),
    ):
        if falls.any():
            k = int(np.argmax(falls))
            step = f"{name}[{k + 1}] is {column[k + 1]:g} m after {column[k]:g} m"
            raise ShapeError(f"tabulated: {step}; {name} must {must}")
    if f[-1] == 0.0:
        raise ShapeError("tabulated: f is 0 everywhere; that is a FlatPunch")
    for name, column in (("r", r), ("f", f)):
        if not 1.0 / _MAX_LENGTH < column[-1] < _MAX_LENGTH:
            raise ShapeError(f"tabulated: {name} ends at {column[-1]:g} m; it must end between 1e-100 and 1e100 m")
    nearest = int(np.argmin(np.diff(r)))
    if not np.diff(r)[nearest] > _MIN_SPACING * r[-1]:
        raise ShapeError(
            f"tabulated: r[{nearest + 1}] is {r[nearest + 1]:g} m, nearer to the point before than {_MIN_SPACING:g} of "
            "the length of the table; its points must lie further apart"
        )


def _monotone_slopes(r: Floats, f: Floats) -> Floats:
    """Return f' at the points, of the not-a-knot cubic, limited so that f rises, and is convex where the chords are."""
    from scipy.interpolate import CubicSpline

    r_unit, f_unit = power_of_two(r[-1]), power_of_two(f[-1])
    r, f = r / r_unit, f / f_unit
    chords = np.diff(f) / np.diff(r)
    before, after = np.append(-np.inf, chords[:-1]), np.append(chords[1:], np.inf)
    steepest = 3.0 * np.minimum(np.append(chords, np.inf), np.insert(chords, 0, np.inf))
    slopes = np.clip(np.asarray(CubicSpline(r, f, bc_type="not-a-knot")(r, 1)), 0.0, steepest)
    rounding = _RTOL_CHORD * (np.abs(f[1:]) + chords * r[1:]) / np.diff(r)
    slack = rounding + np.maximum(np.append(0.0, rounding[:-1]), np.append(rounding[1:], 0.0))
    convex = (before <= chords + slack) & (chords <= after + slack)
    if convex[0]:
        slopes[0] = min(slopes[0], chords[0])
    for i in np.flatnonzero(convex):
        # f'' >= 0 at both ends of the piece: 2 d_i + d_(i+1) <= 3 chord <= d_i + 2 d_(i+1).
        upper = min(3.0 * chords[i] - 2.0 * slopes[i], after[i])
        lower = max(0.5 * (3.0 * chords[i] - slopes[i]), chords[i])
        slopes[i + 1] = np.clip(slopes[i + 1], min(lower, upper), upper)
    slopes *= f_unit / r_unit
    return slopes
