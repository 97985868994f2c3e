"""Several functions of one variable as Chebyshev series on pieces that are halved until each series is right."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import chebyshev_nodes

ORDER = 16
"""Coefficients of each series."""
_MAX_HALVINGS = 400  # most halvings of a piece: the heaviest tail needs as many
_MAX_PIECES_AT_ONCE = 2**12  # a function that no polynomial fits would make more and more of them
_NOISE, _BETTER = (
    1e-8,
    0.25,
)  # below _NOISE, last coefficients that halving leaves above _BETTER of the former are roundings
_NEGLIGIBLE = 1e-16  # coefficients, over the largest value, that are roundings and cost time
_LAST = 2  # number of last coefficients that tell how far the series is off

_NODES, _TO_COEFFICIENTS = chebyshev_nodes(ORDER)
_ENDS = np.array([-1.0, 1.0]) * (1.0 - 2.0**-26)  # just inside the ends, beyond the outermost nodes
_AT_ENDS = np.polynomial.chebyshev.chebvander(_ENDS, ORDER - 1)
_POINTS = np.concatenate([_NODES, _ENDS])


class AdaptiveTable(NamedTuple):
    """Consecutive pieces from low to high, each with the Chebyshev coefficients of all functions (rows)."""

    low: Floats
    """[piece]"""
    high: Floats
    """[piece]"""
    coefficients: Floats
    """[piece, row, order]"""
    error_bound: Floats
    """How far the series may be off: [piece, row]."""

    @classmethod
    def of(
        cls,
        function: Callable[[Floats], Floats],
        edges: Floats,
        tolerance: Floats,
        min_width: Callable[[Floats, Floats], Floats],
        weight: Callable[[Floats, Floats, Floats], Floats],
        max_ratio: float = np.inf,
        rounding: float = 0.0,
    ) -> "AdaptiveTable":
        """Tabulate ``function``, points -> [row, point], between ``edges``.

        The error of a piece is taken from its last coefficients and from its deviation at the ends. A piece is accepted
        where ``weight(low, high, largest value of row 0)`` times its error is below ``tolerance`` [row] times its
        largest value, or where the error is rounding, and where row 0 does not vary by more than ``max_ratio``; or
        where it is not wider than ``min_width(low, high)``. The arguments of the function have a relative error of
        ``rounding``.
        """
        low, high = edges[:-1], edges[1:]
        accepted: list[tuple[Floats, ...]] = []
        error_before = np.full((low.size, tolerance.size), np.inf)
        for halvings in range(_MAX_HALVINGS + 1):
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            values = function((middle[:, None] + half[:, None] * _POINTS).ravel())
            values = values.reshape(values.shape[0], -1, _POINTS.size).swapaxes(0, 1)
            values, at_ends = values[..., :ORDER], values[..., ORDER:]
            coefficients = values @ _TO_COEFFICIENTS.T
            error = np.abs(coefficients[..., -_LAST:]).max(axis=-1)
            error = np.maximum(error, np.abs(coefficients @ _AT_ENDS.T - at_ends).max(axis=-1))
            largest = np.abs(values).max(axis=-1)
            coefficients[np.abs(coefficients) < _NEGLIGIBLE * largest[..., None]] = 0.0
            is_rounding = (error <= _NOISE * largest) & (error > _BETTER * error_before)
            is_rounding |= error <= (rounding * np.maximum(np.abs(low), np.abs(high)) / half)[:, None] * largest
            is_small = weight(low, high, largest[:, 0])[:, None] * error <= tolerance * largest
            is_even = largest[:, 0] / max_ratio <= np.abs(values[:, 0]).min(axis=-1)
            done = (is_small | is_rounding).all(axis=-1) & is_even
            done |= (half <= 0.5 * min_width(low, high)) | (middle <= low) | (middle >= high)
            done |= (low.size > _MAX_PIECES_AT_ONCE) | (halvings == _MAX_HALVINGS)
            accepted.append((low[done], high[done], coefficients[done], error[done]))
            low, middle, high, error = low[~done], middle[~done], high[~done], error[~done]
            if low.size == 0:
                break
            low, high, error_before = (np.concatenate(pair) for pair in ((low, middle), (middle, high), (error, error)))
        low, high, coefficients, error = (np.concatenate(parts) for parts in zip(*accepted, strict=True))
        order = np.argsort(low, kind="stable")
        return cls(low[order], high[order], np.ascontiguousarray(coefficients[order]), error[order])
