"""Common to all tests: which are long forms, what a run has compiled, and batches to be disturbed."""

import random
import re
import signal
import time
from collections import defaultdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numba
import pytest
import xarray as xr
from batches import CURVES, STATISTICS, write_scene
from forms import COMPILED
from numba.core.event import Listener, register

import roughmdr as rm
from roughmdr.shapes import SHAPES, Shape

COMPILING = (
    "aggregate",
    "asperity",
    "batch",
    "expected",
    "interaction",
    "kernels",
    "model_error",
    "shapes",
    "springs",
    "stages",
)
"""Folders whose tests compile functions of the shapes that they name."""
_PARTS = re.compile("|".join(sorted(SHAPES, key=len, reverse=True)))


class _Meter(Listener):
    """Counts the seconds in which this process compiles; on the controller of a run also those of its workers."""

    seconds, _depth, _begun = 0.0, 0, 0.0

    def on_start(self, event: object) -> None:
        if self._depth == 0:
            self._begun = time.perf_counter()
        self._depth += 1

    def on_end(self, event: object) -> None:
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.perf_counter() - self._begun


_METER = _Meter()


def pytest_configure(config: pytest.Config) -> None:
    """Let tests interrupt what they start, also where they run in the background of a shell, which ignores SIGINT."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    register("numba:compile", _METER)
    if numba.config.DISABLE_JIT:  # numpy warns of inf and NaN, which compiled code goes on with
        config.addinivalue_line("filterwarnings", "ignore:.* encountered in scalar:RuntimeWarning")


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Tell the controller, where this is a worker, how long the worker has compiled."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["compiling"] = _METER.seconds


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Add what a worker has told."""
    _METER.seconds += getattr(node, "workeroutput", {}).get("compiling", 0.0)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    terminalreporter.write_line(f"compiling took {_METER.seconds:.0f} s in all processes of the tests")


def _shapes_in(value: Any) -> set[str]:
    """Return the names of the shapes that a parameter of a test is, names or holds."""
    match value:
        case str():
            return set(_PARTS.findall(value))
        case Shape():
            return {value.name}
        case dict():
            return _shapes_in([*value, *value.values()])
        case tuple() | list():
            return set().union(*map(_shapes_in, value))
    return set()


def _all_but_few(cases: list[pytest.Item], count: int, draw: random.Random) -> list[pytest.Item]:
    """Return all cases but one drawn from each of so many equal parts."""
    ends = [len(cases) * i // count for i in range(count + 1)]
    stay = {draw.randrange(begin, end) for begin, end in pairwise(ends) if begin < end}
    return [item for i, item in enumerate(cases) if i not in stay]


def _is_run_elsewhere(item: pytest.Function) -> bool:
    """Return whether a case that names shapes is run compiled, where this run is not, or uncompiled, where this is."""
    folder = item.path.relative_to(Path(__file__).parent).parts[0]
    uncompiled = bool(numba.config.DISABLE_JIT)
    if folder not in COMPILING or (uncompiled and any(map(item.get_closest_marker, ("uncompiled", "skipif")))):
        return False
    given = item.callspec.params.values() if hasattr(item, "callspec") else ()
    named = [item.path.stem, item.name, *given]
    shapes = _shapes_in(named)
    if not shapes:
        return False
    compiled = shapes <= COMPILED
    if compiled and shapes != {"paraboloid"}:
        compiled = folder != "interaction" and not re.search("dugdale|cohesive", str(named))
    return compiled == uncompiled


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark long forms: most cases of a test marked ``few(count)``, and those that the other of both runs has.

    Shapes that are compiled at once are run compiled, the others uncompiled, and what names none is run in both.
    """
    tests = defaultdict(list)
    for item in items:
        if item.get_closest_marker("few") and not item.get_closest_marker("large"):
            tests[item.nodeid.partition("[")[0]].append(item)
    for name, cases in tests.items():
        for item in _all_but_few(cases, cases[0].get_closest_marker("few").args[0], random.Random(name)):
            item.add_marker("large")
    for item in items:
        if isinstance(item, pytest.Function) and not item.get_closest_marker("large"):
            left_out = not numba.config.DISABLE_JIT and item.get_closest_marker("uncompiled")
            if left_out or _is_run_elsewhere(item):
                item.add_marker("large")
                item.add_marker("elsewhere")


@pytest.fixture(scope="module")
def curves() -> xr.Dataset:
    return rm.run(CURVES)


@pytest.fixture(scope="module")
def statistics() -> xr.Dataset:
    return rm.run(STATISTICS)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_scene(tmp_path / "batch", CURVES)
    return tmp_path / "batch"
