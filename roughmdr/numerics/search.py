"""A search among rising numbers that lie in a row of numbers, for compiled functions."""

from collections.abc import Sequence


def last_at_or_below(value: float, numbers: Sequence[float], offset: int, step: int, count: int) -> int:
    """Return the index of the last of ``count`` rising numbers, ``step`` apart, that is at most ``value``, else 0."""
    low, left = 0, count
    while left > 1:
        half = left // 2
        low, left = (low + half if value >= numbers[offset + step * (low + half)] else low), left - half
    return low
