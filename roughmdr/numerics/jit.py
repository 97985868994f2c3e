"""The numba policy, in one place: no fastmath, no GIL, and compiled code kept on disk.

Kernels are compiled with ``njit`` from here. A loop that is to be handed its kernels is compiled with ``specialise``.
"""

import ast
import inspect
from collections.abc import Callable
from functools import partial, wraps
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numba

from roughmdr.numerics import numba_parts
from roughmdr.numerics.cache import keep_on_disk
from roughmdr.numerics.compiling import let_collector_rest
from roughmdr.numerics.rebind import rebuilt

let_collector_rest()
_config: Any = numba.config
UNCOMPILED = bool(_config.DISABLE_JIT)
"""Whether functions are not compiled, by NUMBA_DISABLE_JIT."""
_Made = TypeVar("_Made")
_Function = TypeVar("_Function", bound=Callable[..., Any])


def once(make: Callable[..., _Made]) -> Callable[..., _Made]:
    """Keep the results of a function by its arguments, so that each is made once in a process, whichever threads ask.

    Threads wait on the lock under which numba compiles. With a lock of its own, a thread that compiles and another that
    makes something could wait for each other; and Python's parser of syntax trees fails where two threads are in it.
    """
    made: dict[Any, _Made] = {}

    @wraps(make)
    def kept(*arguments: Any, **named: Any) -> _Made:
        key = arguments, tuple(sorted(named.items()))
        if key not in made:
            with numba_parts.lock:
                if key not in made:
                    made[key] = make(*arguments, **named)
        return made[key]

    return kept


def njit(function: _Function, *, inline: bool = False, small: bool = False) -> _Function:
    """Compile ``function``: IEEE arithmetic as written (0/0 is NaN, nothing reordered), no GIL, cached on disk.

    ``inline`` puts its source into every caller: for parts of a loop that are called too often. ``small`` puts its
    machine code there: for parts of loops that become vector code. A form to be called from C is left out, which would
    take a tenth of the time to compile: ``as_argument`` makes it where it is needed.
    """
    options = {"inline": "always" if inline else "never", "forceinline": small, "no_cfunc_wrapper": True}
    decorator = partial(numba.njit, nogil=True, **options)
    whole: Any = _kept_on_disk(decorator, function)
    if not _config.DISABLE_JIT and not inline:
        numba_parts.let_compiled_code_call(whole, _bare_form(whole, decorator))
    return cast(_Function, whole)


def _bare_form(whole: Any, decorator: Callable[..., Any]) -> Callable[[], Any]:
    """Return a function that makes the form for calls from compiled code.

    It lacks the wrapper for calls from Python, which would take a tenth of the time to compile and which most kernels
    never need.
    """
    return once(lambda: _kept_on_disk(partial(decorator, no_cpython_wrapper=True), _renamed(whole.py_func, "_bare")))


def _renamed(function: FunctionType, suffix: str) -> FunctionType:
    """Return a copy of a function under another name, since the cache on disk distinguishes functions by name."""
    copy = FunctionType(
        function.__code__, function.__globals__, function.__name__, function.__defaults__, function.__closure__
    )
    copy.__module__, copy.__qualname__ = function.__module__, function.__qualname__ + suffix
    return copy


def _kept_on_disk(decorator: Callable[..., Any], function: Callable[..., Any]) -> Any:
    """Return a function compiled by a decorator of numba, with the options that all have."""
    whole = decorator(error_model="numpy")(function)
    if not _config.DISABLE_JIT:
        keep_on_disk(whole)
    return whole


@once
def compiled(function: Callable[..., Any], *, small: bool = False) -> Callable[..., Any]:
    """Compile a plain function, ``small`` or not, and the plain functions of roughmdr that it calls, as small ones."""
    copy = rebuilt(function, {}, partial(compiled, small=True))
    copy.__qualname__ += "_small" if small else ""  # the cache on disk distinguishes them by name
    return njit(copy, small=small)


class _Literals(ast.NodeTransformer):
    """Puts the numbers of a module, ``kernel.name``, into a syntax tree."""

    def __init__(self, kernels: ModuleType) -> None:
        self.kernels = kernels

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "kernel":
            value = getattr(self.kernels, node.attr, None)
            if isinstance(value, bool | int | float):
                return ast.copy_location(ast.Constant(value), node)
        return node


def _with_literals(function: FunctionType, kernels: ModuleType) -> CodeType:
    """Return the code of a function in which the numbers of the kernels are literals, with its file and lines."""
    lines, first = inspect.getsourcelines(function)
    tree = _Literals(kernels).visit(ast.parse("".join(lines)))
    module = compile(ast.increment_lineno(tree, first - 1), function.__code__.co_filename, "exec")
    return next(code for code in module.co_consts if isinstance(code, CodeType) and code.co_name == function.__name__)


def specialise(
    loop: Callable[..., Any], kernels: ModuleType, *, inline: bool = False, small: bool = False
) -> Callable[..., Any]:
    """Return a compiled copy of ``loop`` in which the global name ``kernel`` stands for the given module of kernels.

    numba cannot cache a loop that gets its kernels as arguments or from a closure; a copy with globals of its own
    can be. The name of the module distinguishes the copies of one loop in numba's cache. Numbers of
    the module are put in as literals, so that branches on them that are not taken are not compiled either.
    """
    plain = cast(FunctionType, loop)
    with numba_parts.lock:
        code = _with_literals(plain, kernels)
    copy = FunctionType(code, {**plain.__globals__, "kernel": kernels}, loop.__name__)
    copy.__module__, copy.__qualname__ = loop.__module__, f"{loop.__qualname__}_{kernels.__name__}"
    return njit(copy, inline=inline, small=small)


_ARGUMENTS: dict[tuple[Any, bytes], Any] = {}
"""Results of ``as_argument``, by function and types of its arguments."""


def as_argument(function: Callable[..., Any], *arguments: object) -> Callable[..., Any]:
    """Return a compiled function that compiled code takes as an argument; ``arguments`` are examples of its own ones.

    Code that takes it is compiled once for all functions of the same types, and does not hold their machine code.
    """
    if _config.DISABLE_JIT:
        return function
    key = function, numba_parts.types_of(arguments)  # types_of is faster than numba's ``typeof``
    with numba_parts.lock:
        if key not in _ARGUMENTS:
            plain = cast(Any, function).py_func
            called = _kept_on_disk(partial(numba.njit, no_cpython_wrapper=True), _renamed(plain, "_argument"))
            types = tuple(map(cast(Any, numba.typeof), arguments))
            called.compile(types)
            _ARGUMENTS[key] = numba_parts.Addressed(called.overloads[types])
    return cast(Callable[..., Any], _ARGUMENTS[key])
