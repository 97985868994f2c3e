"""Private parts of numba that roughmdr uses are still there, and do what they are used for."""

from typing import Any

import numba
import numpy as np
import pytest
from numba.core import callconv, codegen, dispatcher

from roughmdr.numerics import numba_parts
from roughmdr.numerics.jit import UNCOMPILED, njit

USED = [
    (dispatcher.Dispatcher, "get_call_template", "functions of njit have a form without a wrapper for Python"),
    (dispatcher.Dispatcher, "get_overload", "functions of njit have a form without a wrapper for Python"),
    (codegen.JITCodeLibrary, "get_pointer_to_function", "functions are called by address"),
    (callconv.CPUCallConv, "get_function_type", "functions are called by address"),
    (callconv.CPUCallConv, "call_function", "functions are called by address"),
    (callconv.CPUCallConv, "return_status_propagate", "an exception in a function that is called by address is raised"),
]


@pytest.mark.parametrize(("owner", "name", "use"), USED, ids=[name for _, name, _ in USED])
def test_numba_has_the_private_part(owner: type, name: str, use: str) -> None:
    assert hasattr(owner, name), (
        f"numba {numba.__version__} has no {owner.__name__}.{name} any more, by which {use}: see "
        "roughmdr/numerics/numba_parts.py"
    )


@njit
def _doubled(x: float, row: Any) -> tuple[float, float]:
    return 2.0 * x, row[0]


@njit
def _tripled(x: float, row: Any) -> tuple[float, float]:
    if x < 0.0:
        raise ValueError("x is negative")
    return 3.0 * x, row[1]


_SIGNATURE = {"times": "UniTuple(float64, 2)(float64, float64[::1])"}
_times = numba_parts.through_row(0, -1, _SIGNATURE["times"])


@njit
def _use(x: float, row: Any) -> Any:
    return _times(x, row)


def _row(function: Any) -> tuple[Any, numba_parts.Table]:
    table = numba_parts.Table(lambda name: function, _SIGNATURE)
    return np.array([10.0, 20.0, table.address(_SIGNATURE)]), table


compiled = pytest.mark.skipif(UNCOMPILED, reason="addresses are of compiled functions")


@compiled
def test_one_caller_calls_the_function_that_a_row_leads_to() -> None:
    (one, _first), (other, _second) = _row(_doubled), _row(_tripled)
    assert _use(1.5, one) == (3.0, 10.0)
    assert _use(1.5, other) == (4.5, 20.0)
    used: Any = _use
    assert len(used.overloads) == 1


@compiled
def test_an_exception_in_a_function_called_by_address_is_raised() -> None:
    row, _table = _row(_tripled)
    with pytest.raises(ValueError, match="x is negative"):
        _use(-1.0, row)


@compiled
def test_a_function_of_another_type_is_refused() -> None:
    with pytest.raises(TypeError, match=r"returns UniTuple\(float64 x 2\); it must be float64"):
        numba_parts.address_of(_doubled, "float64(float64, float64[::1])")
