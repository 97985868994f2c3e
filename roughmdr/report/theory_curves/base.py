"""The form of a theory curve."""

from collections.abc import Callable
from typing import NamedTuple, get_args

from roughmdr.batch.plan import Cell
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.theory.equal_summits import Variable


class TheoryCurve(NamedTuple):
    """A theory as it is drawn over a result."""

    evaluate: Callable[[Cell, Variable], Floats]
    """Return a variable at each step of a cell, NaN where the theory gives none; RoughmdrError if it does not apply."""
    variables: tuple[Variable, ...] = get_args(Variable)
    note: str = ""
    """How the theory differs from the scene."""


def check_no_adhesion(scene: Scene) -> None:
    """Raise RoughmdrError if the scene has adhesion."""
    if scene.work > 0.0:
        raise RoughmdrError("the scene has adhesion")
