"""Keyword arguments of public functions: one that a function does not know is named, with that which may be meant."""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import fields
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

from roughmdr.schema.wording import suggestion

_P = ParamSpec("_P")
_R = TypeVar("_R")


def named_keywords(function: Callable[_P, _R], options: type | None = None) -> Callable[_P, _R]:
    """Return a function that raises TypeError for an unknown keyword before anything else, and says which may be meant.

    ``**given`` may hold the keys of its annotation, ``Unpack`` of a TypedDict, or the fields of the dataclass
    ``options``.
    """

    @wraps(function)
    def checked(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        check_keywords(function.__qualname__, kwargs, _keywords(function, options))
        return function(*args, **kwargs)

    return checked


def with_options(options: type) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Return ``named_keywords`` of functions whose further keywords are the fields of a dataclass."""
    return lambda function: named_keywords(function, options)


def check_keywords(owner: str, given: Iterable[str], allowed: Iterable[str]) -> None:
    """Raise TypeError where ``given`` has a keyword that is not allowed."""
    names = list(allowed)
    for name in given:
        if name not in names:
            raise TypeError(f"{owner}() got an unexpected keyword argument {name!r}{suggestion(name, names)}")


@cache
def _keywords(function: Callable[..., Any], options: type | None) -> tuple[str, ...]:
    """Return all keywords of a function."""
    names: list[str] = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind == parameter.VAR_KEYWORD and options is not None:
            names += [each.name for each in fields(options) if each.name not in names]
        elif parameter.kind == parameter.VAR_KEYWORD:
            table = parameter.annotation  # a string in modules that import annotations
            table = eval(table, function.__globals__) if isinstance(table, str) else table
            names += table.__args__[0].__annotations__
        elif parameter.kind != parameter.POSITIONAL_ONLY and parameter.name not in ("self", "cls"):
            names.append(parameter.name)
    return tuple(names)
