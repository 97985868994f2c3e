"""Compiled code on disk, in folders that can move: it is found by the content of its sources, not by their path.

A folder is named after the sources and numba, so that a change begins a new one; a file in it after the function, its
types, the processor and Python. numba's own index of the forms of a function is not used: two processes that write it
at once could leave one form under the name of another.
"""

import hashlib
import os
import pickle
import re
import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, cast

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, InTreeCacheLocator
from numba.core.registry import cpu_target
from numba.core.serialize import dumps

from roughmdr.numerics.fingerprint import COMPILED, fingerprint

VARIABLE = "ROUGHMDR_CACHE"
"""The environment variable that names folders of compiled code, as PATH does."""
_FOLDER = re.compile(r"[0-9a-f]{16}-[0-9.]+\w*")  # the name of a cache folder
_UNUSED = 30.0 * 86400.0
"""Seconds after which the folder of other sources is removed."""
USED: dict[str, Path | None] = {}
"""Functions with types that this process asked for, and the folder where each was found; None where it was compiled."""


class Folders(NamedTuple):
    """Folders in which compiled code is sought, in order, and the folder for new code, None if none can be written."""

    read: tuple[Path, ...]
    written: Path | None


@cache
def folders() -> Folders:
    """Return the folders of code compiled from these sources.

    New code goes to the first folder of ``ROUGHMDR_CACHE`` that can be written, else to the user's own or that of
    ``NUMBA_CACHE_DIR``. Only in the latter two, folders that no program has used for a month are removed.
    """
    name = f"{fingerprint(COMPILED)}-{numba.__version__}"
    named = [Path(base).absolute() / name for base in os.environ.get(VARIABLE, "").split(os.pathsep) if base]
    written = next(filter(_can_be_written, named), None)
    if written is None:
        written = next((folder for base in _own() if _can_be_written(folder := base / name, tidy=True)), None)
    read = dict.fromkeys([*named, *([] if written is None else [written])])
    return Folders(tuple(folder for folder in read if folder.is_dir()), written)


def _own() -> Iterator[Path]:
    """Yield the user's cache folder and that of ``NUMBA_CACHE_DIR``."""
    import platformdirs

    yield Path(platformdirs.user_cache_dir("roughmdr"))
    if numba_folder := cast(Any, numba.config).CACHE_DIR:
        yield Path(numba_folder)


def _can_be_written(folder: Path, *, tidy: bool = False) -> bool:
    """Return whether files can be put into a folder, made if need be, with ``tidy`` in place of unused ones."""
    with suppress(OSError):
        if not folder.exists():
            folder.mkdir(parents=True, exist_ok=True)
            if tidy:
                _remove_unused(folder.parent)
        if os.access(folder, os.W_OK):
            os.utime(folder)
            return True
    return False


def _remove_unused(base: Path) -> None:
    """Remove the folders of sources that no program has used for a month."""
    for folder in base.iterdir():
        with suppress(OSError):
            if _FOLDER.fullmatch(folder.name) and folder.stat().st_mtime < time.time() - _UNUSED:
                shutil.rmtree(folder)


def processor() -> str:
    """Return the processor that numba compiles for; that of ``NUMBA_CPU_NAME``, where it is set."""
    return str(cast(Any, cpu_target).target_context.codegen().magic_tuple()[1])


def compiles() -> bool:
    """Return whether functions are compiled: not where ``NUMBA_DISABLE_JIT`` is set."""
    return not cast(Any, numba.config).DISABLE_JIT


def keep_on_disk(function: Any) -> None:
    """Let numba look for a function on disk before it compiles it, and keep it there afterwards."""
    if folders().read:
        function._cache = _Cache(function.py_func)


@cache
def _content(file: str) -> str:
    """Return a hash of a file."""
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


class _Locator(InTreeCacheLocator):
    """Gives numba the content of the source file of a function, without its path."""

    def get_source_stamp(self) -> str:
        return _content(self._py_file)

    def get_cache_path(self) -> str:
        return str(folders().written or "")

    def ensure_cache_path(self) -> None:
        """Leave folders as they are: they are made when they are chosen."""


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012 - as in numba


class _Cache(FunctionCache):
    """numba's cache of one function, with the files below in place of its index."""

    _impl_class = _Implementation

    def __init__(self, function: Any) -> None:
        cast(Any, super()).__init__(function)
        cast(Any, self)._cache_file = _Files(f"{function.__module__}.{function.__qualname__}", self._impl)


class _Files:
    """The files of one function: one for each of its types and each processor, written whole or not at all."""

    def __init__(self, name: str, implementation: Any) -> None:
        self._name = re.sub(r"[^\w.]", "", name)[-100:]
        self._base = name, implementation.filename_base, implementation.locator.get_source_stamp()

    def _file(self, key: Any) -> str:
        """Return the name of the file for types, a processor and bytecode, which are distinct in ``repr``."""
        digest = hashlib.sha256(repr((*self._base, key)).encode()).hexdigest()
        return f"{self._name}-{digest[:24]}.nbc"

    def load(self, key: Any) -> Any:
        """Return the kept code of a function for its types, None where it is in no folder."""
        file = self._file(key)
        for folder in folders().read:
            with suppress(OSError, EOFError, pickle.UnpicklingError):
                kept = pickle.loads((folder / file).read_bytes())
                USED.setdefault(file, folder)
                return kept
        USED[file] = None
        return None

    def save(self, key: Any, kept: Any) -> None:
        """Keep a function for its types; where that fails, it is compiled again."""
        if (folder := folders().written) is None:
            return
        path = folder / self._file(key)
        temporary = path.with_suffix(f".{os.getpid()}.{time.monotonic_ns()}")
        try:
            temporary.write_bytes(cast(Any, dumps)(kept))
            os.replace(temporary, path)
        except OSError:
            with suppress(OSError):
                temporary.unlink()
