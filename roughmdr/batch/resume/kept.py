"""Tells what is in OUT.nc.parts, and the mean law so far, without disturbing the run at work there: takes no lock, and
changes nothing.
"""

import math
import os
import platform
import re
import shlex
from collections import Counter
from contextlib import suppress
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.batch.moments import Moments
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.locks import LOCK
from roughmdr.batch.resume.manifest import MANIFEST, Manifest, Runs, StoredFile
from roughmdr.batch.resume.share import Share
from roughmdr.batch.resume.store import read_task_result
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Ints
from roughmdr.scene import Scene, read
from roughmdr.schema.toml_text import parse_toml

_HOLDER = re.compile(r"process (\d+) on (.*)")
_HOLDERS = 4000  # bytes of a lock that are read, which name some hundred runs
_LOCKS = Path("/proc/locks")
"""Linux lists there who holds which lock: class, kind, access, process and DEVICE:DEVICE:INODE."""
_STEPS = 6  # steps told, of which one is the closest approach, also where unloading follows
_FILES = 2000  # most task results read at one look, which takes seconds; more follow at the next
_AT_ONCE = 2**30  # most bytes of curves read at one look, likewise


class Holder(NamedTuple):
    """The run that holds the lock of a folder."""

    process: int
    host: str
    since: str  # ISO 8601, UTC


class Kept(Manifest):
    """Finished runs that a folder keeps."""

    def __init__(self, folder: Path) -> None:
        """Read the folder; StoreError where it is no folder of parts, or cannot be read."""
        super().__init__(folder)
        self.last = ""
        """When something was kept last: ISO 8601, UTC; empty where it is not known."""
        try:
            self.files = self.new_files()
            with suppress(FileNotFoundError):  # a run has just begun, or has just ended
                self.last = _utc((folder / MANIFEST).stat().st_mtime)
        except OSError as error:
            raise StoreError(f"{folder}: cannot be read: {error.strerror}") from None
        self.holder, self.holder_known = _holder(folder)
        """The run at work, None where there is none, and whether that can be told on this system."""
        if not self.last and not (folder / LOCK).exists():
            raise StoreError(f"{folder}: holds no runs; if a batch was at work here it has ended, see {folder.stem}")
        stored = dict[str, list[Runs]]()
        for runs in (runs for file in self.files for runs in file.runs):
            stored.setdefault(runs.key, []).append(runs)
        self.by_key = Counter({key: _count(ranges) for key, ranges in stored.items()})
        """Runs by the keys of their cells; fewer than ``runs`` where an earlier version has not noted them."""
        noted = all(file.runs for file in self.files)
        self.runs = self.by_key.total() if noted else sum(file.realizations for file in self.files)
        self.output, self.share = Share.split_name(folder.with_name(folder.name.removesuffix(".parts")))
        """The result that the runs belong to, and the share of the batch that is computed here; None for all of it."""

    @property
    def continued_by(self) -> str:
        """The command that goes on from here; --fresh would throw away what is kept."""
        if not self.command:
            return f"roughmdr run SCENE -o {shlex.quote(str(self.output))}"
        try:
            return shlex.join(word for word in shlex.split(self.command) if word != "--fresh")
        except ValueError:  # the file is not as it was written
            return self.command


class Progress(NamedTuple):
    """How far a batch is."""

    scene: Scene | None  # None where it cannot be read here, for lack of a file for example
    plan: Plan | None  # None likewise, or where other versions began the batch
    realizations: int | None  # realisations a cell, with [accuracy] in its first round; None for a share
    keys: list[set[str]]  # keys that each cell of the plan may have
    done: list[int]  # number of runs of each cell
    failed: list[int]
    total: int | None  # runs to be computed; None where that is not known, as with [accuracy]


def _count(stored: list[Runs]) -> int:
    """Return the number of runs of a cell; two processes may have stored the same."""
    count = end = 0
    for _, first, last in sorted(stored):
        count, end = count + max(0, last - max(first, end)), max(end, last)
    return count


def progress_of(kept: Kept) -> Progress:
    """Return how far the batch is, as far as its scene can be read and planned here."""
    scene, plan = None, None
    with suppress(RoughmdrError, ValueError):
        scene = read(parse_toml(kept.scene))
        if kept.versions == versions():  # else no key is the same
            plan = make_plan(scene)
    if scene is None:
        return Progress(None, None, None, [], [], [], None)
    realizations = 1 if scene.batch.estimator == "expected" else scene.batch.realizations
    if plan is None:
        total = None if scene.accuracy or kept.share else realizations * len(scene.cells)
        return Progress(scene, None, realizations, [], [], [], total)
    rounds = Rounds(plan)
    keys = rounds.keys
    failures = Counter(key for key, _ in kept.failed)
    done = [sum(kept.by_key[key] for key in of_cell) for of_cell in keys]
    failed = [sum(failures[key] for key in of_cell) for of_cell in keys]
    if scene.accuracy is not None:
        return Progress(scene, plan, realizations, keys, done, failed, None)
    if kept.share is not None:
        total = sum(runs.last - runs.first for runs in kept.share.of(rounds.begin()))
        return Progress(scene, plan, None, keys, done, failed, total)
    failed = [min(some, realizations - count) for some, count in zip(failed, done, strict=True)]
    distinct = len({frozenset(of_cell) for of_cell in keys})  # equal cells are computed once
    return Progress(scene, plan, realizations, keys, done, failed, realizations * distinct)


def _holder(folder: Path) -> tuple[Holder | None, bool]:
    """Return the run at work in a folder, if there is one, and whether that can be told."""
    try:
        with (folder / LOCK).open("rb") as file:
            status, text = os.fstat(file.fileno()), file.read(_HOLDERS).decode(errors="replace")
    except OSError:
        return None, True
    named = [match for line in text.splitlines() if (match := _HOLDER.fullmatch(line.strip()))]
    holders = [Holder(int(match[1]), match[2], _utc(status.st_mtime)) for match in named]
    here = [holder for holder in holders if holder.host == platform.node()]
    for holder in here:
        if _is_locked(status.st_ino, holder.process):
            return holder, True
    elsewhere = [holder for holder in holders if holder not in here]
    return (elsewhere[0], False) if elsewhere else (None, True)


def _is_locked(inode: int, process: int) -> bool:
    """Return whether a process of this machine holds the lock of a file; where none are listed, whether it lives."""
    try:
        words = [line.split() for line in _LOCKS.read_text().splitlines()]
    except OSError:
        try:
            os.kill(process, 0)
        except OSError as error:
            return isinstance(error, PermissionError)
        return True
    return any(len(word) > 5 and word[4] == str(process) and word[5].endswith(f":{inode}") for word in words)


def _utc(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="seconds")


class LawSoFar(NamedTuple):
    """The law of a cell at some steps, over the runs that are kept."""

    cell: int
    variable: str
    steps: Ints
    moments: Moments  # [step]
    kept: int  # runs of the cell that are kept, of which some may not be read yet


class SoFar:
    """Moments of the force, or of what else is asked for, by the keys of the cells."""

    def __init__(self, progress: Progress) -> None:
        """Take the steps and the cells of a batch; where it cannot be planned here nothing is read."""
        self.progress, self._read, self._moments = progress, set[StoredFile](), dict[str, Moments]()
        self._runs = set[tuple[str, int]]()
        plan = progress.plan
        if plan is not None:
            self._variable = plan.watched if plan.watched in plan.variables else plan.variables[0]
            self._steps = np.unique([math.ceil(plan.steps * part / _STEPS) - 1 for part in range(1, _STEPS + 1)])

    def law(self, kept: Kept) -> LawSoFar | None:
        """Return the law of the first cell of which runs are kept, None for no run; damaged files do not count."""
        if self.progress.plan is None:
            return None
        numbered = enumerate(self.progress.keys)
        cell = next((number for number, keys in numbered if not keys.isdisjoint(kept.by_key)), None)
        if cell is None:
            return None
        told = self.progress.keys[cell]
        of_cell = (each for each in kept.files if any(runs.key in told for runs in each.runs))
        unread = (each for each in of_cell if each not in self._read)
        room = _AT_ONCE
        for file in islice(unread, _FILES):
            self._read.add(file)
            result = read_task_result(kept.folder, file.name, file.sha256)
            if result is not None:
                self._add(result)
                room -= sum(each.nbytes for each in result.moments)
            if room < 0:
                break
        if not (known := [self._moments[key] for key in sorted(told) if key in self._moments]):
            return None
        there = sum(kept.by_key[key] for key in told)
        return LawSoFar(cell, self._variable, self._steps, max(known, key=lambda each: each.size), there)

    def _add(self, result: TaskResult) -> None:
        if self._variable not in result.variables or result.moments[0].shape[-1] <= self._steps[-1]:
            return
        variable = result.variables.index(self._variable)
        for row, (cell, first) in enumerate(zip(result.cell.tolist(), result.first.tolist(), strict=True)):
            key = result.keys[cell]
            if (key, first) not in self._runs:  # another output may have had runs computed again
                self._runs.add((key, first))
                new = result.moments_of(row).select(variable).select(self._steps)
                self._moments[key] = self._moments[key].merged(new) if key in self._moments else new
