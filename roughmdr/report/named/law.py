"""A named law, as it is put beside a result."""

from collections.abc import Callable
from typing import NamedTuple, get_args

from roughmdr.batch.plan import Cell
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.theory.equal_summits import Variable


class TheoryCurve(NamedTuple):
    """What a law says of a scene, and of which variables."""

    over: Callable[[Cell, Variable], Floats]
    """A variable at each step of a cell, NaN where the law says nothing.

    RoughmdrError, with the reason, where it does not apply.
    """
    variables: tuple[Variable, ...] = get_args(Variable)
    note: str = ""
    """In what it differs from what the scene asks for."""


def check_no_adhesion(scene: Scene) -> None:
    """RoughmdrError where the scene has adhesion."""
    if scene.work > 0.0:
        raise RoughmdrError("the scene has adhesion")
