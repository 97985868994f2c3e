"""Functions of one type behind one name: compiled code calls them by addresses, to which its last argument leads.

Code that calls them is compiled once for all of them. A row of numbers, or the first of several, holds the address of
a table of addresses. A call takes some nanoseconds and keeps a loop from vector code: what is called often is a loop
itself. An address is one of this process: rows must not leave it.
"""

import inspect
from collections.abc import Callable, Container, Mapping
from typing import Any

import numpy as np
from numba.core import cgutils
from numba.core.sigutils import normalize_signature
from numba.core.types import int64, none
from numba.extending import intrinsic

from roughmdr.numerics.jit import address_of


def through_row(place: int, at: int, signature: str) -> Callable[..., Any]:
    """Return a function that calls the one at a ``place`` of the table whose address stands in a row, ``at`` an index
    from its end.

    ``signature`` is that of all such functions, as numba writes types; the last argument is the row, or the rows.
    """
    taken, returned = normalize_signature(signature)

    def call(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        rows = context.make_array(taken[-1])(context, builder, arguments[-1])
        word = context.get_value_type(int64)
        size = cgutils.unpack_tuple(builder, rows.shape)[-1]
        held = builder.load(builder.gep(rows.data, [builder.add(size, word(at))]))
        table = builder.inttoptr(builder.fptosi(held, word), word.as_pointer())
        form = context.call_conv.get_function_type(returned, taken)
        function = builder.inttoptr(builder.load(builder.gep(table, [word(place)])), form.as_pointer())
        status, result = context.call_conv.call_function(builder, function, returned, taken, arguments)
        with cgutils.if_unlikely(builder, status.is_error):  # else an exception would be lost
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value() if returned == none else result

    def typed(context: Any, *_: Any) -> Any:
        return returned(*taken), call

    names = ["context", *(f"argument{i}" for i in range(len(taken)))]
    parameters = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in names]
    vars(typed)["__signature__"] = inspect.Signature(parameters)
    found: Callable[..., Any] = intrinsic(typed)
    return found


class Table:
    """The addresses of functions by name, each compiled when it is first asked for."""

    def __init__(self, functions: Callable[[str], Callable[..., Any]], signatures: Mapping[str, str]) -> None:
        """Take what returns a function by its name, and the types of all in the order of their places."""
        self._functions, self._types = functions, dict(signatures)
        self._addresses = np.zeros(len(signatures), dtype=np.int64)

    def address(self, names: Container[str]) -> float:
        """Return where the table begins, once these functions are in it."""
        for place, (name, types) in enumerate(self._types.items()):
            if name in names and not self._addresses[place]:
                self._addresses[place] = address_of(self._functions(name), *normalize_signature(types))
        return float(self._addresses.ctypes.data)
