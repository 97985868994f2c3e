"""A function as a row of polynomials, on pieces that are halved until each holds it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

ORDER = 16
"""Coefficients of each polynomial."""
_MOST_HALVINGS = 400  # as many as a tail as heavy as any needs
_MOST_AT_ONCE = 2**12  # pieces: of a function that no polynomial fits, halving would make more and more
_NOISE, _BETTER = 1e-8, 0.25  # tails so small that halving does not lessen are the function's own roundings
_NOTHING = 1e-16  # of the greatest value: such coefficients are roundings, and cost time

_ANGLES = np.pi * (np.arange(ORDER) + 0.5) / ORDER
_NODES = np.cos(_ANGLES)
_TO_COEFFICIENTS = 2.0 / ORDER * np.cos(np.outer(np.arange(ORDER), _ANGLES))
_TO_COEFFICIENTS[0] *= 0.5
_ENDS = np.array([-1.0, 1.0]) * (1.0 - 2.0**-26)  # just inside: what a function does there alone, no node sees
_AT_ENDS = np.polynomial.chebyshev.chebvander(_ENDS, ORDER - 1)
_POINTS = np.concatenate([_NODES, _ENDS])
_TAIL = 2  # of the last coefficients, which tell how far the polynomial is off


class Table(NamedTuple):
    """Pieces from low to high, one after the other, each with Chebyshev coefficients of all rows."""

    low: Floats
    """[piece]"""
    high: Floats
    """[piece]"""
    coefficients: Floats
    """[piece, row, order]"""
    slack: Floats
    """How far the polynomials may be off: [piece, row]."""

    @classmethod
    def of(
        cls,
        function: Callable[[Floats], Floats],
        edges: Floats,
        tolerance: Floats,
        narrow: Callable[[Floats, Floats], Floats],
        weight: Callable[[Floats, Floats, Floats], Floats],
        ratio: float = np.inf,
        rounding: float = 0.0,
    ) -> "Table":
        """The table of ``function``, points -> [row, point], between ``edges``.

        A piece is held where its last coefficients and what it is off at its ends, times the ``weight`` of the piece
        (its ends, the greatest value of the first row -> weight), are below ``tolerance`` [row] of the greatest value
        on it, or are roundings, and the first row's values do not vary by more than ``ratio``; or where it is
        ``narrow`` (its ends -> how narrow). The function may be off as if its points were, by ``rounding`` relative to
        themselves.
        """
        low, high = edges[:-1], edges[1:]
        held: list[tuple[Floats, ...]] = []
        before = np.full((low.size, tolerance.size), np.inf)
        for halvings in range(_MOST_HALVINGS + 1):
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            values = function((middle[:, None] + half[:, None] * _POINTS).ravel())
            values = values.reshape(values.shape[0], -1, _POINTS.size).swapaxes(0, 1)
            values, ends = values[..., :ORDER], values[..., ORDER:]
            coefficients = values @ _TO_COEFFICIENTS.T
            tail = np.abs(coefficients[..., -_TAIL:]).max(axis=-1)
            tail = np.maximum(tail, np.abs(coefficients @ _AT_ENDS.T - ends).max(axis=-1))
            greatest = np.abs(values).max(axis=-1)
            coefficients[np.abs(coefficients) < _NOTHING * greatest[..., None]] = 0.0
            least = np.abs(values[:, 0]).min(axis=-1)
            noise = (tail <= _NOISE * greatest) & (tail > _BETTER * before)
            noise |= tail <= (rounding * np.maximum(np.abs(low), np.abs(high)) / half)[:, None] * greatest
            small = weight(low, high, greatest[:, 0])[:, None] * tail <= tolerance * greatest
            fine = (small | noise).all(axis=-1) & (greatest[:, 0] / ratio <= least)
            done = fine | (half <= 0.5 * narrow(low, high)) | (middle <= low) | (middle >= high)
            done |= (low.size > _MOST_AT_ONCE) | (halvings == _MOST_HALVINGS)
            held.append((low[done], high[done], coefficients[done], tail[done]))
            low, middle, high, tail = low[~done], middle[~done], high[~done], tail[~done]
            if low.size == 0:
                break
            low, high, before = (np.concatenate(pair) for pair in ((low, middle), (middle, high), (tail, tail)))
        low, high, coefficients, slack = (np.concatenate(parts) for parts in zip(*held, strict=True))
        order = np.argsort(low, kind="stable")
        return cls(low[order], high[order], np.ascontiguousarray(coefficients[order]), slack[order])
