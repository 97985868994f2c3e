"""Tells what is in OUT.nc.parts without disturbing the run at work there: it changes nothing."""

import shlex
import shutil
import sqlite3
from collections import Counter
from contextlib import closing, suppress
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.store import JOURNAL, LOCK, beside, check_kind, connect, texts
from roughmdr.batch.rounds import Rounds
from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.scene import Scene, read
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.lock import Holder, holder_of

_ENDING = ".parts"
_PATIENCE = 2.0  # how long [s] a transaction of the run at work is waited for
_BATCH = "SELECT scene, versions, command, began FROM batch"
_BY_KEY = "SELECT key, sum(value) FROM results, json_each(results.cells) GROUP BY key"
_FAILED = "SELECT cell, realization, remark FROM failed ORDER BY number"


class Kept(NamedTuple):
    """Finished runs that a file keeps."""

    path: Path
    scene: str  # TOML; empty where nothing is kept yet
    versions: str
    command: str  # that began the batch; empty where it is not known
    began: str  # ISO 8601, UTC; empty where it is not known
    last: str  # when something was kept last, likewise
    by_key: Counter[str]  # runs by the keys of their cells
    failed: frozenset[tuple[str, int]]  # key and realisation; the next run repeats them
    remark: str  # why the first of them failed
    holder: Holder | None  # None where no run is at work
    holder_known: bool  # whether that can be told on this system

    @property
    def runs(self) -> int:
        """How many runs are kept."""
        return self.by_key.total()

    @property
    def output(self) -> Path:
        """The result that the runs belong to."""
        return self.path.with_name(self.path.name.removesuffix(_ENDING))

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
    realizations: int | None  # of a cell; with [accuracy] those of its first round
    done: list[int]  # of each cell of the plan
    failed: list[int]
    total: int | None  # runs to be computed; None where that is not known, as with [accuracy]


def read_kept(path: Path) -> Kept:
    """Read the file; StoreError where it keeps no runs, or cannot be read."""
    check_kind(path)
    holder, known = holder_of(beside(path, LOCK))
    tables, last = None, ""
    try:
        if path.stat().st_size:
            last = datetime.fromtimestamp(path.stat().st_mtime, UTC).isoformat(timespec="seconds")
            tables = rows_of(path, _BATCH, _BY_KEY, _FAILED)
    except FileNotFoundError:  # the batch has just ended
        pass
    except OSError as error:
        raise StoreError(f"{path}: cannot be read: {error.strerror}") from None
    except (sqlite3.Error, UnicodeError) as error:
        remedy = "the next run uses what can be read of it, or says what to do"
        raise StoreError(f"{path}: cannot be read: {error}; {remedy}") from None
    if tables is None and not beside(path, LOCK).exists():
        raise StoreError(f"{path}: holds no runs; if a batch was at work here it has ended, see {path.stem}")
    batch, by_key, failed = tables or ([], [], [])
    scene, made_with, command, began = texts(batch[0] if batch else [""] * 4)
    runs, remark = frozenset(each[:2] for each in failed), texts(failed[0])[2] if failed else ""
    return Kept(path, scene, made_with, command, began, last, Counter(dict(by_key)), runs, remark, holder, known)


def rows_of(path: Path, *queries: str) -> list[list[Any]]:
    """Return the rows of queries, of one moment; sqlite3.Error, UnicodeError or OSError where it cannot be read.

    A copy is asked where the run was killed, or stands still, while it wrote, and where the disk has no locks.
    """
    try:
        return _read(path, "ro", queries)
    except sqlite3.OperationalError:
        with TemporaryDirectory() as folder:
            shutil.copyfile(path, Path(folder) / path.name)
            with suppress(FileNotFoundError):
                shutil.copyfile(beside(path, JOURNAL), Path(folder) / beside(path, JOURNAL).name)
            return _read(Path(folder) / path.name, "rw", queries, locks=False)


def _read(path: Path, mode: str, queries: tuple[str, ...], *, locks: bool = True) -> list[list[Any]]:
    with closing(connect(path, mode, locks=locks, patience=_PATIENCE)) as database:
        database.execute("BEGIN")
        return [database.execute(each).fetchall() for each in queries]


def progress_of(kept: Kept) -> Progress:
    """Return how far the batch is, as far as its scene can be read and planned here."""
    scene: Scene | None = None
    plan: Plan | None = None
    with suppress(RoughmdrError, ValueError):
        scene = read(parse_toml(kept.scene))
        if kept.versions == versions():  # else no key is the same
            plan = make_plan(scene)
    if scene is None:
        return Progress(None, None, None, [], [], None)
    realizations = 1 if scene.batch.estimator == "expected" else scene.batch.realizations
    if plan is None:
        total = None if scene.accuracy else realizations * len(scene.cells)
        return Progress(scene, None, realizations, [], [], total)
    keys = Rounds(plan).keys
    failures = Counter(key for key, _ in kept.failed)
    done = [sum(kept.by_key[key] for key in of_cell) for of_cell in keys]
    failed = [sum(failures[key] for key in of_cell) for of_cell in keys]
    if scene.accuracy is not None:
        return Progress(scene, plan, realizations, done, failed, None)
    failed = [min(some, realizations - count) for some, count in zip(failed, done, strict=True)]
    distinct = len({frozenset(of_cell) for of_cell in keys})  # equal cells are computed once
    return Progress(scene, plan, realizations, done, failed, realizations * distinct)
