"""Plain functions with other names in their globals."""

import dis
from collections.abc import Callable
from types import FunctionType
from typing import Any


def rebuilt(function: Any, names: dict[str, object], remake: Callable[[Any], Any]) -> FunctionType:
    """A copy of a plain function, with other ``names`` in its globals and each plain function there remade."""
    used = {step.argval for step in dis.get_instructions(function.__code__) if step.opname == "LOAD_GLOBAL"}
    parts = {name: function.__globals__[name] for name in used if name in function.__globals__}
    called = {name: remake(value) for name, value in parts.items() if isinstance(value, FunctionType)}
    copy = FunctionType(function.__code__, {**function.__globals__, **called, **names}, function.__name__)
    copy.__qualname__, copy.__module__ = function.__qualname__, function.__module__
    return copy
