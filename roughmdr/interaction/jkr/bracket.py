"""A root between two points, narrowed down one value at a time (Illinois form of regula falsi)."""

Point = tuple[float, float]


class Bracket:
    """Two points with values of opposite sign; for values that cost too much to be computed again at the ends."""

    def __init__(self, first: Point, second: Point) -> None:
        self._ends = [first, second]
        self._kept = -1

    @property
    def next(self) -> float:
        """The point at which to find the next value."""
        (low, below), (high, above) = self._ends
        return low + below / (below - above) * (high - low)

    @property
    def scale(self) -> float:
        """The larger of the values at both ends."""
        return max(abs(value) for _, value in self._ends)

    def narrow(self, point: float, value: float) -> None:
        """Put a point with its value in the place of that end whose value has the same sign."""
        end = 0 if (value > 0.0) == (self._ends[0][1] > 0.0) else 1
        other = 1 - end
        self._ends[end] = point, value
        if self._kept == other:  # twice in turn
            self._ends[other] = self._ends[other][0], 0.5 * self._ends[other][1]
        self._kept = other
