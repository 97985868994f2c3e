"""The size of a result, on disk and in memory, before there is one."""

from roughmdr.batch.plan import Plan

_NUMBER = 8  # bytes
# A step of the path itself: the name of its branch in memory; on disk that and the separation.
_BRANCH, _WAY = 36, 68  # bytes


def file_bytes(plan: Plan, runs: int) -> int:
    """About what a result of so many runs in all takes on disk."""
    return _WAY * _steps(plan) + _values(plan, runs)


def held_bytes(plan: Plan, runs: int) -> int:
    """The bytes that are held while the result is put together: runs as they came, and in their places."""
    return _BRANCH * _steps(plan) + 2 * _values(plan, runs)


def _steps(plan: Plan) -> int:
    return int(plan.cells[0].path.separation.size)


def _values(plan: Plan, runs: int) -> int:
    """Bytes of the variables: the curves of all runs or, of each cell, four statistics."""
    output = plan.scene.output
    each = _NUMBER * _steps(plan) * len(output.variables)
    return each * runs if output.keep == "curves" else 4 * each * len(plan.cells)
