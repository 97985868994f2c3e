"""Private parts of numba, which a new version can break; others are in ``cache`` and ``compiling``.

Functions of one type behind one name: compiled code calls them by addresses, to which its last argument leads, and is
compiled once for all of them. A row of numbers, or the first of several, holds the address of a table of addresses. A
call takes some nanoseconds and keeps a loop from vector code: so a function that is called often is a loop itself. An
address is valid in this process alone, and so are rows.
"""

import inspect
from collections.abc import Callable, Container, Mapping
from typing import Any, cast

import numba
import numpy as np
from numba._dispatcher import compute_fingerprint
from numba.core import cgutils, sigutils, types
from numba.core.compiler_lock import global_compiler_lock

lock: Any = global_compiler_lock
"""The lock under which numba compiles."""
_unliteral: Callable[[Any], Any] = types.unliteral
_parsed: Callable[[str], tuple[tuple[Any, ...], Any]] = sigutils.normalize_signature
_unpacked: Callable[..., Any] = cgutils.unpack_tuple
_if_unlikely: Callable[..., Any] = cgutils.if_unlikely


def types_of(arguments: tuple[object, ...]) -> bytes:
    """Return a key for the types of arguments, faster than by ``numba.typeof``."""
    return compute_fingerprint(cast(Any, arguments))


def let_compiled_code_call(whole: Any, bare: Callable[[], Any]) -> None:
    """Let compiled code call the form of a function that ``bare`` returns, which is made when it is first needed."""

    def call_template(taken: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
        return bare().get_call_template(tuple(map(_unliteral, taken)), keywords)  # not one more form for f(0)

    whole.get_call_template = call_template
    whole.get_overload = lambda signature: bare().get_overload(signature)
    whole.bare = bare


class Addressed:
    """A compiled function by its address; numba finds its type sooner than that of its own ``CompileResultWAP``."""

    def __init__(self, compiled: Any) -> None:
        self._numba_type_ = types.FunctionType(compiled.signature)
        self._address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)
        self._compiled = compiled  # keeps the code in memory

    def __wrapper_address__(self) -> int:
        return int(self._address)


def address_of(function: Callable[..., Any], signature: str) -> int:
    """Return the address of a function of ``njit`` for compiled code to call; TypeError unless it is of that type."""
    (taken, returned), bare = _parsed(signature), cast(Any, function).bare()
    bare.compile(taken)
    compiled = bare.overloads[taken]
    if _unliteral(compiled.signature.return_type) != returned:
        raise TypeError(f"{bare.py_func.__qualname__} returns {compiled.signature.return_type}; it must be {returned}")
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))


def through_row(place: int, at: int, signature: str) -> Callable[..., Any]:
    """Return a function that calls the one with index ``place`` in the table whose address is in a row, ``at`` an index
    from its end.

    ``signature`` is that of all such functions, as numba writes types; the last argument is the row, or the rows.
    """
    taken, returned = _parsed(signature)

    def call(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        rows = context.make_array(taken[-1])(context, builder, arguments[-1])
        word = context.get_value_type(numba.int64)
        size = _unpacked(builder, rows.shape)[-1]
        held = builder.load(builder.gep(rows.data, [builder.add(size, word(at))]))
        table = builder.inttoptr(builder.fptosi(held, word), word.as_pointer())
        form = context.call_conv.get_function_type(returned, taken)
        function = builder.inttoptr(builder.load(builder.gep(table, [word(place)])), form.as_pointer())
        status, result = context.call_conv.call_function(builder, function, returned, taken, arguments)
        with _if_unlikely(builder, status.is_error):  # else an exception would be lost
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value() if returned == numba.none else result

    def typed(context: Any, *_: Any) -> Any:
        return returned(*taken), call

    names = ["context", *(f"argument{i}" for i in range(len(taken)))]
    parameters = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in names]
    vars(typed)["__signature__"] = inspect.Signature(parameters)
    found: Callable[..., Any] = numba.extending.intrinsic(typed)
    return found


class Table:
    """The addresses of functions by name, each compiled when it is first asked for."""

    def __init__(self, functions: Callable[[str], Callable[..., Any]], signatures: Mapping[str, str]) -> None:
        """Take a function that returns functions by name, and the types of all in the order of the table."""
        self._functions, self._signatures = functions, dict(signatures)
        self._kept = dict[str, Callable[..., Any]]()  # keeps their code in memory
        self._addresses = np.zeros(len(signatures), dtype=np.int64)

    def address(self, names: Container[str]) -> float:
        """Return the address of the table, once these functions are in it."""
        with lock:
            for place, (name, signature) in enumerate(self._signatures.items()):
                if name in names and name not in self._kept:
                    function = self._functions(name)
                    self._addresses[place] = address_of(function, signature)
                    self._kept[name] = function
        return float(self._addresses.ctypes.data)
