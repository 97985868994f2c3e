"""The numba policy, in one place: no fastmath, no GIL, and a disk cache named after the sources, so that a
change begins a new one.

Kernels are compiled with ``njit`` from here. A loop that is to be handed its kernels is compiled with ``specialise``.
"""

import ast
import inspect
import os
import re
import shutil
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numba

from roughmdr.numerics.compiling import let_collector_rest
from roughmdr.numerics.fingerprint import COMPILED, fingerprint
from roughmdr.numerics.rebind import rebuilt

let_collector_rest()
_config: Any = numba.config
_Function = TypeVar("_Function", bound=Callable[..., Any])


_CONFIG = threading.Lock()
"""For the setting of numba's folder, which is that of the process: a function that is compiled by one thread while
another one puts the setting back would be kept in the current folder."""

_FOLDER = re.compile(r"[0-9a-f]{16}-[0-9.]+\w*")  # the name of a cache folder
_UNUSED = 30.0 * 86400.0
"""Seconds after which the folder of other sources is removed."""


@cache
def _cache_folder() -> str | None:
    """Return the folder for code compiled from these sources; None where no folder can be written.

    numba compares only the file of the outer function, so that a kernel inlined from another file would stay in the
    cache after a change. A folder named after all the sources cannot be stale.
    """
    import platformdirs

    for base in (platformdirs.user_cache_dir("roughmdr"), _config.CACHE_DIR):  # the second is NUMBA_CACHE_DIR
        folder = Path(base) / f"{fingerprint(COMPILED)}-{numba.__version__}"
        with suppress(OSError):
            if base:
                if not folder.exists():
                    folder.mkdir(parents=True, exist_ok=True)
                    _remove_unused(folder.parent)
                if os.access(folder, os.W_OK):
                    os.utime(folder)
                    return str(folder)
    return None


def _remove_unused(base: Path) -> None:
    """Remove the folders of sources that no program has used for a month."""
    for folder in base.iterdir():
        with suppress(OSError):
            if _FOLDER.fullmatch(folder.name) and folder.stat().st_mtime < time.time() - _UNUSED:
                shutil.rmtree(folder)


def njit(function: _Function, *, inline: bool = False, small: bool = False) -> _Function:
    """Compile ``function``: IEEE arithmetic as written (0/0 is NaN, nothing reordered), no GIL, cached on disk.

    ``inline`` puts its source into every caller: for parts of a loop that are called too often. ``small`` puts its
    machine code there: for parts of loops that become vector code. A form to be called from C is left out, which would
    take a tenth of the time to compile: ``as_argument`` makes it where it is needed.
    """
    options = {"inline": "always" if inline else "never", "forceinline": small, "no_cfunc_wrapper": True}
    return cast(_Function, _kept_on_disk(partial(numba.njit, nogil=True, **options), function))


def _kept_on_disk(decorator: Callable[..., Any], function: Callable[..., Any]) -> Any:
    """Return a function compiled by a decorator of numba, with the options that all have."""
    folder = _cache_folder()
    with _CONFIG:
        before = _config.CACHE_DIR
        if folder is not None:
            _config.CACHE_DIR = folder
        try:
            return decorator(error_model="numpy", cache=folder is not None)(function)
        finally:
            _config.CACHE_DIR = before


@cache
def compiled(function: Callable[..., Any], *, small: bool = False) -> Callable[..., Any]:
    """Compile a plain function and the plain functions of roughmdr that it calls; ``small`` as in ``njit``."""
    copy = rebuilt(function, {}, partial(compiled, small=small))
    copy.__qualname__ += "_small" if small else ""  # so that the cache on disk tells them apart
    return njit(copy, small=small)


class _Literals(ast.NodeTransformer):
    """Puts the numbers of a module, ``law.name``, into a syntax tree."""

    def __init__(self, law: ModuleType) -> None:
        self.law = law

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "law":
            value = getattr(self.law, node.attr, None)
            if isinstance(value, bool | int | float):
                return ast.copy_location(ast.Constant(value), node)
        return node


def _with_literals(function: FunctionType, law: ModuleType) -> CodeType:
    """Return the code of a function in which the numbers of ``law`` are literals, with its file and lines."""
    lines, first = inspect.getsourcelines(function)
    tree = _Literals(law).visit(ast.parse("".join(lines)))
    module = compile(ast.increment_lineno(tree, first - 1), function.__code__.co_filename, "exec")
    return next(code for code in module.co_consts if isinstance(code, CodeType) and code.co_name == function.__name__)


def specialise(
    loop: Callable[..., Any], law: ModuleType, *, inline: bool = False, small: bool = False
) -> Callable[..., Any]:
    """Return a compiled copy of ``loop`` in which the global name ``law`` stands for the given module of kernels.

    numba cannot cache a loop that gets its kernels as arguments or from a closure; a copy with globals of its own
    can be. The name of the module tells the copies of one loop apart: numba finds them in its cache by it. Numbers of
    the module are put in as literals, so that branches on them that are not taken are not compiled either.
    """
    return njit(_with_law(loop, law), inline=inline, small=small)


def _with_law(loop: Callable[..., Any], law: ModuleType) -> FunctionType:
    """Return a copy of ``loop`` in which ``law`` stands for a module of kernels."""
    plain = cast(FunctionType, loop)
    copy = FunctionType(_with_literals(plain, law), {**plain.__globals__, "law": law}, loop.__name__)
    copy.__qualname__ = f"{loop.__qualname__}_{law.__name__}"
    copy.__module__ = loop.__module__
    return copy


def as_argument(loop: Callable[..., Any], law: ModuleType, result: object, *arguments: object) -> Callable[..., Any]:
    """Return a specialised copy of ``loop``, as ``specialise`` does, for compiled code to take as an argument.

    Code that takes it is compiled once for all laws. ``result`` and ``arguments`` are examples that give the types.
    """
    typeof: Callable[[object], Any] = numba.typeof
    return _as_argument(loop, law, typeof(result)(*map(typeof, arguments)))


@cache
def _as_argument(loop: Callable[..., Any], law: ModuleType, signature: Any) -> Callable[..., Any]:
    """Return the copy for a signature of numba."""
    plain = _with_law(loop, law)
    return plain if _config.DISABLE_JIT else cast(FunctionType, _kept_on_disk(partial(numba.cfunc, signature), plain))
