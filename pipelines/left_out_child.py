"""What a scene of ``left_out.py`` costs with each part left out, and forced on.

    python pipelines/left_out_child.py SCENE FACTOR SECONDS

Prints one line of JSON: for each part, of the scene reduced by FACTOR, both ways

    bytes       of memory, at most, on top of what the process has when all is compiled
    seconds     of processor time, the shortest of repeats that take turns, for SECONDS in all
    work        visits; where curves are left out, the numbers that are kept
    difference  of the forces, over the largest
    stated      how far apart these may be by the errors that are stated of both
"""

import json
import sys
import time
from collections.abc import Callable
from functools import partial
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np
from left_out_cases import BATCH, SIZES, Size, Way, forced, scene_of
from studies.peak import peak

from roughmdr.batch.compile import prepare_all
from roughmdr.batch.plan import make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.run import execute
from roughmdr.variables import DEFAULT_VARIABLES

CURVES = "curves of the realisations"
_LEAST = 2  # repeats


class Done(NamedTuple):
    """What came of a scene."""

    force: Floats
    """[N], [..., step]."""
    error: float
    """The greatest that is stated of the force, over its largest magnitude."""
    work: int
    """Visits; where curves are what can be left out, the numbers that were kept."""


Action = Callable[[], Done]


class Compared(NamedTuple):
    """Left out, and forced on."""

    seconds: tuple[float, float]
    """The shortest of the repeats, which take turns."""
    bytes: tuple[int, int]
    """Of memory, at most, on top of what the process had when all was compiled."""
    work: tuple[int, int]
    difference: float
    """Of the forces, over the largest."""
    stated: float
    """How far apart the two may be, by the errors that are stated of both."""


def along(way: Way) -> Done:
    """All realisations."""
    laws = [(law.variables["force"].copy(), law.numerical_error, law.visits) for law in way.laws()]
    force, error, visits = zip(*laws, strict=True)
    return Done(np.array(force), max(error), sum(visits))


def kept(size: Size, keep: str) -> Done:
    """All realisations as a batch, with their curves kept or their statistics."""
    scene = scene_of(size, keep=keep, variables=list(DEFAULT_VARIABLES))
    plan = make_plan(scene, chunk=size.realizations // 2)  # two tasks at least, so that they go the way of many
    prepare_all(plan, Rounds(plan).begin())
    result = execute(plan, None, workers=1, quiet=True).variables
    force = result["force"].values.mean(axis=0) if keep == "curves" else result["force_mean"].values
    numbers = sum(array.values.size for name, array in result.items() if name.startswith(DEFAULT_VARIABLES))
    return Done(force, float(result["numerical_error"].values.max()), numbers)


class Pair(NamedTuple):
    """A scene with a part left out, and with it forced on."""

    left_out: Action
    forced_on: Action


def pairs_of(name: str, size: Size) -> dict[str, Pair]:
    """By the part."""
    if name == BATCH:
        return {CURVES: Pair(*(partial(kept, size, keep) for keep in ("statistics", "curves")))}
    plain = Way.of(scene_of(size))
    ways = {part: force(plain) for part, force in forced(size).items()}
    return {part: Pair(partial(along, plain), partial(along, way)) for part, way in ways.items()}


def compared(pair: Pair, seconds: float) -> dict[str, object]:
    """What both take and do, and how far apart their forces are."""
    rows = [[timed(action) for action in pair] for _ in range(_LEAST)]
    while sum(own for row in rows for own, _ in row) < seconds:
        rows.append([timed(action) for action in pair])
    left, on = (done for _, done in rows[0])
    return {
        "seconds": [min(own for own, _ in column) for column in zip(*rows, strict=True)],
        "work": [left.work, on.work],
        "difference": float(np.abs(on.force - left.force).max() / np.abs(left.force).max()),
        "stated": left.error + on.error,
    }


def timed(action: Action) -> tuple[float, Done]:
    """Processor seconds of an action, and what came of it."""
    started = time.process_time()
    done = action()
    return time.process_time() - started, done


def bytes_of(small: Action, action: Action) -> int:
    """The memory that an action takes at most, in a copy of this process where it was done for next to nothing."""
    context = get_context("fork")
    receiving, sending = context.Pipe(duplex=False)

    def measured() -> None:
        small()
        before = peak()
        action()
        sending.send(peak() - before)

    process = context.Process(target=measured)
    process.start()
    process.join()
    if process.exitcode:
        raise RuntimeError("a copy of the process failed")
    return int(receiving.recv())


def main(name: str, factor: str, seconds: str) -> None:
    """Measure and print."""
    size = SIZES[name].reduced(int(factor))
    pairs, smallest = pairs_of(name, size), pairs_of(name, size.reduced(10**9))
    for pair in smallest.values():
        for action in pair:
            action()  # compiles
    memory = {
        part: [*map(bytes_of, smallest[part], pair)] for part, pair in pairs.items()
    }  # while none is in use again
    print(json.dumps({part: {"bytes": memory[part], **compared(pair, float(seconds))} for part, pair in pairs.items()}))


if __name__ == "__main__":
    main(*sys.argv[1:])
