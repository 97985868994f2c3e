"""A root between two points, narrowed down one value at a time by regula falsi.

An end that stays twice in turn is weighted as N. Anderson and A. Bjorck have it (BIT 13 (1973) 253). Where the values
jump, and it goes slowly, the interval is halved.
"""

Point = tuple[float, float]

_ROUNDS = 4  # number of steps in which the bracket has to halve


class Bracket:
    """Two points with values of opposite sign; for values that cost too much to be computed again at the ends."""

    def __init__(self, first: Point, second: Point) -> None:
        self._ends = [first, second]
        self._true = [first[1], second[1]]
        self._kept = -1
        self._widths = [self.width]

    @property
    def next(self) -> float:
        """The point at which to find the next value."""
        (low, below), (high, above) = self._ends
        if len(self._widths) > _ROUNDS and self._widths[-1] > 0.5 * self._widths[-1 - _ROUNDS]:
            return low + 0.5 * (high - low)
        return low + below / (below - above) * (high - low)

    @property
    def scale(self) -> float:
        """The smaller of the values at both ends."""
        return min(abs(value) for value in self._true)

    @property
    def width(self) -> float:
        """How far apart the ends are."""
        return abs(self._ends[1][0] - self._ends[0][0])

    def narrow(self, point: float, value: float) -> None:
        """Put a point with its value in the place of that end whose value has the same sign."""
        end = 0 if (value > 0.0) == (self._true[0] > 0.0) else 1
        other, before = 1 - end, self._true[end]
        self._ends[end], self._true[end] = (point, value), value
        if self._kept == other:  # twice in turn
            part = 1.0 - value / before if abs(value) < abs(before) else 0.5
            self._ends[other] = self._ends[other][0], part * self._ends[other][1]
        self._kept = other
        self._widths.append(self.width)
