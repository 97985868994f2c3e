"""A measured radial profile."""

from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.base import SharedProfile, radii
from roughmdr.shapes.profile import Profile
from roughmdr.shapes.tabulated import lookup

_LEAST_POINTS = 3
_CLOSEST = 1e-6  # of the last radius: nearer points leave no digits to the spline between them
_LARGEST = 1e100  # the squares of radii and heights are floats
_ROUNDING = 4 * np.finfo(float).eps  # of a chord's slope, from the rounding of the points
_NOISE = 1e-9  # a slope of g that is below 0 by as little of the largest is rounding


class Tabulated(SharedProfile):
    """f [m] at radii r [m], both from 0 on: between them a monotone cubic spline, beyond them a cone.

    The spline is the not-a-knot cubic, its slopes at the points kept between 0 and three times the lesser slope of the
    chords, and so that it is convex where the chords are (R. L. Dougherty, A. Edelman, J. M. Hyman, Math. Comp. 52
    (1989) 471). ShapeError unless there are at least 3
    points, r rises, f does not fall, and both begin at 0. OutOfRange where the profile is so concave that the contact
    would not be a disc.
    """

    name: ClassVar[str] = "tabulated"
    units: ClassVar[dict[str, str]] = {"r": "m", "f": "m"}
    along: ClassVar[str] = "point"
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("r", "f"),)
    profile: ClassVar[Profile] = lookup.PROFILE

    def __init__(self, r: ArrayLike, f: ArrayLike) -> None:
        self.radii, self.heights = _column("r", r), _column("f", f)
        _check(self.radii, self.heights)
        self.knot_slopes = _monotone_slopes(self.radii, self.heights)
        self._check_disc()

    def __repr__(self) -> str:
        return f"Tabulated({self.radii.size} points to r={self.radii[-1]:g}, f={self.heights[-1]:g})"

    @classmethod
    def example(cls) -> dict[str, Any]:
        return {"r": [0.0, 1.0, 2.0], "f": [0.0, 1.0, 4.0]}

    @property
    def columns(self) -> dict[str, Floats]:
        return self.parameters

    @classmethod
    def of_columns(cls, columns: dict[str, Floats]) -> "Tabulated":
        return cls(**columns)

    @property
    def parameters(self) -> dict[str, Any]:
        return {"r": self.radii, "f": self.heights}

    @property
    def end(self) -> float:
        return float(self.radii[-1])

    @cached_property
    def _units(self) -> tuple[float, float]:
        """The powers of two next to the last r and f: dividing by them changes no bit."""
        return float(2.0 ** np.frexp(self.radii[-1])[1]), float(2.0 ** np.frexp(self.heights[-1])[1])

    @cached_property
    def _pieces(self) -> tuple[Floats, Floats]:
        """Knots, and the coefficients of f' over r - knot for each piece, the last one without end; in ``_units``."""
        width, rise = self._units
        r, f, d = self.radii / width, self.heights / rise, self.knot_slopes * (width / rise)
        exact = [[Fraction(value) for value in column.tolist()] for column in (r, f, d)]
        coefficients = np.zeros((r.size, 3))
        coefficients[:, 0] = d
        # Differences of slopes that are nearly alike: in floats they lose as many digits as the points lie close.
        for i, (begin, end) in enumerate(pairwise(zip(*exact, strict=True))):
            h, left, right = end[0] - begin[0], begin[2], end[2]
            chord = (end[1] - begin[1]) / h
            coefficients[i, 1:] = 2 * (3 * chord - 2 * left - right) / h, 3 * (left + right - 2 * chord) / h**2
        return r, coefficients

    def f(self, r: ArrayLike) -> Floats:
        s, (c0, c1, c2), piece = self._at(r)
        return np.asarray(self.heights[piece] + self._units[1] * s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)))

    def df(self, r: ArrayLike) -> Floats:
        s, (c0, c1, c2), _ = self._at(r)
        return np.asarray(self._units[1] / self._units[0] * (c0 + s * (c1 + s * c2)))

    def _at(self, r: ArrayLike) -> tuple[Floats, Floats, NDArray[np.intp]]:
        """r - knot and the coefficients of the piece that each r lies on, and its number."""
        knots, coefficients = self._pieces
        r = radii("r", r) / self._units[0]
        piece = np.searchsorted(knots[1:], r, side="right")
        return r - knots[piece], coefficients[piece].T.reshape(3, *r.shape), piece

    @cached_property
    def _form(self) -> Floats:
        from roughmdr.shapes.tabulated.build import tabulate

        return tabulate(*self._pieces)

    def nondimensional(self) -> tuple[float, float, Any]:
        """About the last r and f, and the pieces in these units."""
        return *self._units, self._form

    def _check_disc(self) -> None:
        """OutOfRange where g falls: pressed without adhesion, the contact would gape inside."""
        from roughmdr.shapes.tabulated.build import steepness

        width, _ = self._units
        knots, coefficients = self._pieces
        x, slope = steepness(knots, knots, coefficients)
        falls = slope < -_NOISE * slope.max()
        if falls.any():
            raise OutOfRange(
                f"tabulated: the profile is so concave near r = {width * x[falls][0]:.3g} m that the contact would not "
                f"be a disc there; a table that ends before that can be used"
            )

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        """As for every shape, from the antiderivatives of each piece with 40 digits."""
        from mpmath import mp

        with mp.workdps(40):
            a = mp.mpf(self._units[0]) * mp.mpf(t)
            r, f, d = ([mp.mpf(float(v)) for v in column] for column in (self.radii, self.heights, self.knot_slopes))
            g = push = begin = mp.mpf(0)
            for k, knot in enumerate(r):
                if knot >= a:
                    break
                last = k + 1 == len(r)
                end = mp.pi / 2 if last or r[k + 1] >= a else mp.asin(r[k + 1] / a)
                bend = twist = mp.mpf(0)
                if not last:
                    h = r[k + 1] - knot
                    chord = (f[k + 1] - f[k]) / h
                    bend = 2 * (3 * chord - 2 * d[k] - d[k + 1]) / h
                    twist = 3 * (d[k] + d[k + 1] - 2 * chord) / h**2
                powers = (d[k] - bend * knot + twist * knot**2, (bend - 2 * twist * knot) * a, twist * a**2)
                sines = [_sine_integral(m, end) - _sine_integral(m, begin) for m in range(5)]
                g += a * sum(c * sines[m] for m, c in enumerate(powers))
                push += a**2 * sum(c * sines[m + 2] for m, c in enumerate(powers))
                begin = end
            return a, g, push


def _sine_integral(power: int, angle: Any) -> Any:
    """∫_0^angle sin^power, for power 0 to 4, of an mpmath number."""
    from mpmath import mp

    sine, cosine = mp.sin(angle), mp.cos(angle)
    if power < 2:
        return angle if power == 0 else 1 - cosine
    return ((power - 1) * _sine_integral(power - 2, angle) - cosine * sine ** (power - 1)) / power


def _column(name: str, values: ArrayLike) -> Floats:
    try:
        column = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ShapeError(f"tabulated: {name} is {values!r}; it must be a list of numbers") from None
    if column.ndim != 1 or column.size < _LEAST_POINTS:
        raise ShapeError(f"tabulated: {name} has the shape {column.shape}; it must hold at least 3 numbers in a row")
    if not np.isfinite(column).all():
        where = int(np.argmin(np.isfinite(column)))
        raise ShapeError(f"tabulated: {name}[{where}] is {column[where]}; it must be finite")
    if column[0] != 0.0:
        raise ShapeError(f"tabulated: {name}[0] is {column[0]:g} m; the table must begin at the tip, with 0")
    column.setflags(write=False)
    return column


def _check(r: Floats, f: Floats) -> None:
    if r.size != f.size:
        raise ShapeError(f"tabulated: r holds {r.size} numbers and f {f.size}; they must be equally many")
    for name, column, falls in (("r", r, np.diff(r) <= 0.0), ("f", f, np.diff(f) < 0.0)):
        if falls.any():
            k = int(np.argmax(falls))
            must = "rise from point to point" if name == "r" else "not fall: the tip is the lowest point"
            step = f"{name}[{k + 1}] is {column[k + 1]:g} m after {column[k]:g} m"
            raise ShapeError(f"tabulated: {step}; {name} must {must}")
    if f[-1] == 0.0:
        raise ShapeError("tabulated: f is 0 everywhere; that is a FlatPunch")
    for name, column in (("r", r), ("f", f)):
        if not 1.0 / _LARGEST < column[-1] < _LARGEST:
            raise ShapeError(f"tabulated: {name} ends at {column[-1]:g} m; it must end between 1e-100 and 1e100 m")
    nearest = int(np.argmin(np.diff(r)))
    if not np.diff(r)[nearest] > _CLOSEST * r[-1]:
        raise ShapeError(
            f"tabulated: r[{nearest + 1}] is {r[nearest + 1]:g} m, nearer to the point before than {_CLOSEST:g} of the "
            "length of the table; its points must lie further apart"
        )


def _monotone_slopes(r: Floats, f: Floats) -> Floats:
    """f' at the points: the not-a-knot cubic's, so limited that f never falls and is convex where the chords are."""
    from scipy.interpolate import CubicSpline

    # By powers of two, so that no bit changes.
    r_unit, f_unit = (2.0 ** np.frexp(column[-1])[1] for column in (r, f))
    r, f = r / r_unit, f / f_unit
    chords = np.diff(f) / np.diff(r)
    before, after = np.append(-np.inf, chords[:-1]), np.append(chords[1:], np.inf)
    steepest = 3.0 * np.minimum(np.append(chords, np.inf), np.insert(chords, 0, np.inf))
    slopes = np.clip(np.asarray(CubicSpline(r, f, bc_type="not-a-knot")(r, 1)), 0.0, steepest)
    rounding = _ROUNDING * (np.abs(f[1:]) + chords * r[1:]) / np.diff(r)
    slack = rounding + np.maximum(np.append(0.0, rounding[:-1]), np.append(rounding[1:], 0.0))
    convex = (before <= chords + slack) & (chords <= after + slack)
    if convex[0]:
        slopes[0] = min(slopes[0], chords[0])
    for i in np.flatnonzero(convex):
        # f'' >= 0 at both ends of the piece: 2 d_i + d_(i+1) <= 3 chord <= d_i + 2 d_(i+1).
        most = min(3.0 * chords[i] - 2.0 * slopes[i], after[i])
        least = max(0.5 * (3.0 * chords[i] - slopes[i]), chords[i])
        slopes[i + 1] = np.clip(slopes[i + 1], min(least, most), most)
    slopes *= f_unit / r_unit
    return slopes
