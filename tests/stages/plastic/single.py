"""One contact that yields, by the kernels of its shape and model."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.stages.plastic.body import Body, Mark
from roughmdr.stages.plastic.total import rows_of


class Single:
    """An asperity with the first row ``own`` on a body: its contact at a deepest indentation, and a rise since [m]."""

    def __init__(self, kernels: Any, own: float, body: Body) -> None:
        self.kernels, self.body = kernels, body
        self.rows: NDArray[np.float64] = rows_of(kernels, np.array([own]), body)
        self.row = self.rows[0]

    def mark(self, deepest: float) -> Mark:
        return self.kernels.mark(deepest, self.row, self.body)

    def ends(self, deepest: float) -> tuple[float, float]:
        return self.kernels.ends(deepest, self.mark(deepest), self.row, self.body)

    def state(self, deepest: float, rise: float = 0.0) -> Any:
        return self.kernels.state(deepest - rise, rise, self.mark(deepest), self.row, self.body)

    def lost(self, deepest: float) -> float:
        return self.kernels.lost(deepest, self.mark(deepest), self.row, self.body)
