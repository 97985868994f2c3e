"""OUT.nc.parts: the finished task results of a batch that is not over, in one SQLite file, safe against any end of it.

A task result is a row with the hash of its content, and a transaction of its own: it is there wholly or not at all. The
journal is the one that rolls back, since disks that machines share cannot have the other. OUT.nc.parts-lock, a lock
that the system releases when its process dies, keeps other runs out, while SQLite's own locks let ``info`` read.
"""

import errno
import hashlib
import json
import os
import sqlite3
import stat
import zipfile
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing, contextmanager, suppress
from datetime import UTC, datetime
from functools import partial
from itertools import product
from pathlib import Path

from roughmdr.batch.resume.keys import versions
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.files import convert_os_errors, replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.lock import locked
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.variables import FAILED

JOURNAL, LOCK, UNFINISHED = "-journal", "-lock", "-result"
"""Endings of what stands beside OUT.nc.parts: SQLite's journal, the lock, and a file that is not yet written whole."""
_MAX_NAME = 255  # bytes of a file's name
_MAX_PENDING = 16  # task results that may wait to be written before the batch waits
_PATIENCE = 60.0  # how long [s] a transaction waits for those who read, which takes milliseconds
_KIND = 0x724D4452  # the application_id of these files, "rMDR"
_TABLES = (
    "CREATE TABLE batch (number INTEGER PRIMARY KEY, scene, versions, replaces, command, began)",
    "CREATE TABLE results (number INTEGER PRIMARY KEY, cells, sha256, content)",
    "CREATE TABLE failed (number INTEGER PRIMARY KEY, cell, realization, remark, UNIQUE (cell, realization))",
)
"""``cells`` of a result is JSON: the number of realisations by the key of the cell."""


def store_path(target: Path) -> Path:
    """Return the file of the task results that belong to a result."""
    return target.with_name(f"{target.name}.parts")


def beside(path: Path, ending: str) -> Path:
    """Return what stands beside such a file."""
    return path.with_name(path.name + ending)


def check_kind(path: Path) -> None:
    """StoreError, saying what to do, if what is at ``path`` can be no such file."""
    if path.is_dir():
        raise StoreError(f"{path}: is a folder, in which earlier versions kept runs: finish it with them, or remove it")
    if os.path.lexists(path) and not stat.S_ISREG(path.lstat().st_mode):
        raise StoreError(f"{path}: is no ordinary file; remove it")


def connect(path: Path, mode: str, *, locks: bool = True, patience: float = _PATIENCE) -> sqlite3.Connection:
    """Open a file in a mode of SQLite's URIs, without ``locks`` where the disk has none; ``patience`` [s] with others.

    What is executed is a transaction of its own unless one was begun.
    """
    uri = f"{path.absolute().as_uri()}?mode={mode}" + ("" if locks else "&vfs=unix-none")
    database = sqlite3.connect(uri, patience, isolation_level=None, check_same_thread=False, uri=True)
    database.text_factory = partial(str, encoding="utf-8", errors="replace")
    return database


def texts(row: Sequence[object]) -> list[str]:
    """Return the texts of a row, empty where something else stands, in a file that was damaged."""
    return [each if isinstance(each, str) else "" for each in row]


@contextmanager
def _convert_errors(path: Path) -> Iterator[None]:
    """Convert errors of SQLite and of the system to a StoreError that names ``path``."""
    with convert_os_errors(path):
        try:
            yield
        except (sqlite3.Error, UnicodeError) as error:  # a message may hold what a damaged file has for a name
            full = getattr(error, "sqlite_errorname", "") == "SQLITE_FULL"
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) if full else OSError(str(error)) from None


class CheckpointStore:
    """The store of one output, for this process alone until the ``stack`` is closed; a thread of its own writes to it.

    Nothing is kept without a ``target``, or if the name of the file would be too long. StoreError where another process
    holds the lock. A file that holds no task results is removed at the end.
    """

    def __init__(self, target: Path | None, stack: ExitStack) -> None:
        self.target, self._stack = target, stack
        self.scene = self.versions = self._replaces = ""
        """TOML text of the batch that began the file, its versions, and the stamp of the file that it may replace."""
        self.empty = True
        """Whether no task result is stored."""
        self._path: Path | None = None
        self._database: sqlite3.Connection | None = None
        self._locks = self._cleared = False
        self._thread: ThreadPoolExecutor | None = None
        self._pending: deque[Future[None]] = deque()
        if target is not None and len(os.fsencode(beside(store_path(target), JOURNAL).name)) <= _MAX_NAME:
            self._path = path = store_path(target)
            check_kind(path)
            with _convert_errors(path):
                self._locks = stack.enter_context(locked(beside(path, LOCK), target))
                beside(path, UNFINISHED).unlink(missing_ok=True)
                if path.exists():
                    self._read(path)
            stack.callback(self._end)

    def _read(self, path: Path) -> None:
        """Read what an earlier run left; what is damaged is first replaced by what can be read of it."""
        kind, sound = 0, False
        with closing(self._connect("rw")) as database:
            database.execute("PRAGMA writable_schema = ON")  # opens a file that was cut off, too
            try:
                (kind,) = database.execute("PRAGMA application_id").fetchone()  # undoes what a kill cut off
                tables = database.execute("SELECT sql FROM sqlite_master WHERE type = 'table'").fetchall()
                sound = tables == [*zip(_TABLES)] and database.execute("PRAGMA quick_check").fetchall() == [("ok",)]
            except (sqlite3.DatabaseError, UnicodeError) as error:
                if isinstance(error, sqlite3.OperationalError) and error.sqlite_errorname != "SQLITE_ERROR":
                    raise  # the file is not damaged, but cannot be read
            if path.stat().st_size == 0:
                return
            if kind != _KIND:
                raise StoreError(f"{path}: holds no runs that can be read; remove it, or move it away")
            if not sound:
                with replace_atomically(path, beside(path, UNFINISHED)) as copy:
                    _salvage(database, copy)
        self._database = self._connect("rw")
        self.empty = self._database.execute("SELECT 1 FROM results").fetchone() is None
        batch = self._database.execute("SELECT scene, versions, replaces FROM batch").fetchone()
        self.scene, self.versions, self._replaces = texts(batch or ("", "", ""))

    def _connect(self, mode: str) -> sqlite3.Connection:
        assert self._path is not None
        return connect(self._path, mode, locks=self._locks)

    def clear(self, *, fresh: bool = False) -> None:
        """Remove what is stored; a ``fresh`` batch may replace the file that is at the output now."""
        self._cleared, self._replaces = fresh, _stamp(self.target) if fresh else ""
        self.scene, self.empty = "", True
        self._close()
        if self._path is not None:
            with _convert_errors(self._path):
                self._path.unlink(missing_ok=True)  # first: a journal without a file counts for nothing
                beside(self._path, JOURNAL).unlink(missing_ok=True)

    def _close(self) -> None:
        if self._database is not None:
            with suppress(sqlite3.Error):
                self._database.execute("PRAGMA journal_mode = DELETE")  # removes the journal, which is empty
            self._database.close()
            self._database = None

    def _end(self) -> None:
        """Close the file, and remove it if nothing is stored in it."""
        self._close()
        if self.empty:
            with suppress(StoreError):
                self.clear()

    def begin(self, scene: str, command: str) -> None:
        """Write checkpoints of this scene from now on; StoreError where no file can have them.

        ``command`` is what continues the batch, but for --fresh.
        """
        if self._thread is not None or self.target is None:
            return
        if self._path is None:
            raise StoreError(f"{self.target}: the name is too long for a file of parts; give a shorter one")
        with _convert_errors(self._path):
            is_new = self._database is None
            self._database = database = self._database or self._connect("rwc")
            database.execute("PRAGMA journal_mode = TRUNCATE")  # a new journal would cost as much as the rest
            database.execute("PRAGMA synchronous = FULL")
            with database:
                database.execute("BEGIN")
                if is_new:
                    _make_tables(database)
                if not self.scene:
                    self.scene, self.versions = scene, versions()
                    batch = scene, versions(), self._replaces, command, datetime.now(UTC).isoformat(timespec="seconds")
                    database.execute("INSERT OR REPLACE INTO batch VALUES (1, ?, ?, ?, ?, ?)", batch)
        self._thread = self._stack.enter_context(ThreadPoolExecutor(1, "roughmdr-writer"))

    @property
    def begun(self) -> bool:
        """Whether checkpoints are written."""
        return self._thread is not None

    def may_replace(self, scene: str) -> bool:
        """Return whether this resumes a batch of this scene that was allowed to replace the file at the output."""
        return self.scene == scene and self._replaces == _stamp(self.target) != ""

    def readers(self) -> Iterator[Callable[[], TaskResult | None]]:
        """Yield a function for each task result that reads it; it returns None for one that is damaged."""
        if self._database is not None:
            for (number,) in self._database.execute("SELECT number FROM results ORDER BY number").fetchall():
                yield partial(self._read_result, number)

    def _read_result(self, number: int) -> TaskResult | None:
        assert self._database is not None
        with suppress(sqlite3.Error, OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
            row = self._database.execute("SELECT sha256, content FROM results WHERE number = ?", (number,))
            sha256, content = row.fetchone()
            if hashlib.sha256(content).hexdigest() == sha256:
                return TaskResult.from_bytes(content)
        return None

    def put(self, result: TaskResult) -> None:
        """Write a task result, and note its failed runs, if checkpoints are written; StoreError where that fails."""
        if self._thread is not None:
            self._pending.append(self._thread.submit(self._write, result))
            while self._pending and (self._pending[0].done() or len(self._pending) > _MAX_PENDING):
                self._pending.popleft().result()

    def _write(self, result: TaskResult) -> None:
        """Store a task result for good, in one transaction; the next batch repeats its failed runs."""
        assert self._database is not None
        assert self._path is not None
        fails = result.diagnostics["status"] == FAILED
        rows, done = fails.nonzero()[0], result.select_rows((~fails).nonzero()[0])
        failed = [
            (result.keys[result.cell[row]], int(result.first[row]), str(result.diagnostics["remark"][row]))
            for row in rows
        ]
        with _convert_errors(self._path):
            self._path.stat()  # SQLite would go on with a file that was removed
            with self._database as database:
                database.execute("BEGIN")
                note = "INSERT OR IGNORE INTO failed (cell, realization, remark) VALUES (?, ?, ?)"
                database.executemany(note, failed)
                if not fails.all():
                    content = done.to_bytes()
                    cells = {key: int(done.size[done.cell == i].sum()) for i, key in enumerate(done.keys)}
                    row = json.dumps(cells), hashlib.sha256(content).hexdigest(), content
                    database.execute("INSERT INTO results (cells, sha256, content) VALUES (?, ?, ?)", row)
        self.empty &= bool(fails.all())

    def flush(self) -> None:
        """Wait until all task results are on the disk."""
        while self._pending:
            self._pending.popleft().result()

    def finish(self, result: Labelled, *, complete: bool) -> None:
        """Write the result; remove the checkpoints if it is ``complete``: no run failed, and all of them are in it."""
        if self.target is None:
            return
        self.flush()
        write_netcdf(result, self.target, self._path and beside(self._path, UNFINISHED))
        if complete:
            self.clear()

    @property
    def saved_message(self) -> str:
        """Message that tells which runs are kept, and where; empty if none are."""
        if self._path is None or self.empty or not self._path.exists():
            return ""
        again = "the same command without --fresh" if self._cleared else "the same command"
        return f"what is finished is kept in {self._path}; {again} goes on from there"


def _make_tables(database: sqlite3.Connection) -> None:
    database.execute(f"PRAGMA application_id = {_KIND}")
    for table in _TABLES:
        database.execute(table)


def _salvage(damaged: sqlite3.Connection, copy: Path) -> None:
    """Copy the rows that can be read: from the first on, and from the last back, to where they are damaged."""
    with closing(sqlite3.connect(copy)) as sound:
        _make_tables(sound)
        for table, order in product(("batch", "results", "failed"), ("ASC", "DESC")):
            with suppress(sqlite3.DatabaseError, UnicodeError):
                for row in damaged.execute(f"SELECT * FROM {table} ORDER BY number {order}"):
                    sound.execute(f"INSERT OR IGNORE INTO {table} VALUES ({', '.join('?' * len(row))})", row)
        sound.commit()


def _stamp(path: Path | None) -> str:
    """Return length [byte] and time [ns] of a file, which tell it from one that replaces it; empty where none is."""
    status = path.stat() if path is not None and path.exists() else None
    return f"{status.st_size} {status.st_mtime_ns}" if status else ""
