"""The manifest of OUT.nc.parts: a line of JSON for the batch, and one for each stored task result and failed run."""

import json
import re
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

MANIFEST, FILE = "manifest.jsonl", "{:06d}.npz"
_FILE_NAME = re.compile(r"[0-9]{6,}\.npz")


class Runs(NamedTuple):
    """Realisations first ... last - 1 of a cell, which has a key."""

    key: str
    first: int
    last: int


class StoredFile(NamedTuple):
    """A stored task result."""

    name: str
    sha256: str
    realizations: int
    runs: tuple[Runs, ...]
    """Empty where an earlier version has not noted them."""


def runs_of(line: dict[str, Any]) -> tuple[Runs, ...]:
    """Return the runs that are stored, or have failed; none where an earlier version has not noted them."""
    match line:
        case {"failed": [*pairs]}:
            given = [[*pair, pair[-1] + 1] for pair in pairs if _is_range(pair)]
        case {"runs": [*given]}:
            pass
        case _:
            return ()
    return tuple(Runs(*each) for each in given) if all(_is_range(each) and len(each) == 3 for each in given) else ()


def _is_range(given: object) -> bool:
    match given:
        case [str(), int(first), *more]:
            return first >= 0 and all(isinstance(last, int) and last > first for last in more) and len(more) < 2
    return False


class Manifest:
    """The manifest of a folder, to which processes append: each line is read once."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._offset = folder, 0
        self.scene = self.versions = self.replaces = self.command = self.began = ""
        """The batch that the folder is for, of a share the last that went on there: TOML, versions, stamp of the file
        that it may replace (see ``CheckpointWriter``), command and time; empty where nothing is told yet."""
        self.failed, self.remark = set[tuple[str, int]](), ""
        """Key and realisation of runs that failed, and why the first of them did; the next batch repeats them."""
        self.complete = False
        """Whether all runs of a share are kept."""

    @property
    def ended(self) -> bool:
        """Whether there is no manifest: who writes the result removes it."""
        return not (self.folder / MANIFEST).exists()

    def new_lines(self) -> list[dict[str, Any]]:
        """Return the lines that were finished since the last call; none where there is no manifest."""
        content, lines = b"", list[dict[str, Any]]()
        with suppress(FileNotFoundError), (self.folder / MANIFEST).open("rb") as file:
            file.seek(self._offset)
            content = file.read()
        whole = content[: content.rfind(b"\n") + 1]
        self._offset += len(whole)
        for text in whole.splitlines():
            with suppress(ValueError, RecursionError):
                line = json.loads(text)
                if isinstance(line, dict) and _FILE_NAME.fullmatch(str(line.get("file", FILE.format(0)))):
                    lines.append(line)
        return lines

    def new_files(self) -> list[StoredFile]:
        """Read the lines that are new; return the task results that were stored."""
        files = list[StoredFile]()
        for line in self.new_lines():
            match line:
                case {"scene": str(), "versions": str()}:
                    for name in ("scene", "versions", "replaces", "command", "began"):
                        setattr(self, name, str(line.get(name, "")))
                    self.complete = False
                case {"complete": True}:
                    self.complete, self.failed, self.remark = True, set(), ""
                case {"file": str(file), "sha256": str(digest), "realizations": int(count)}:
                    files.append(StoredFile(file, digest, count, runs_of(line)))
                case {"failed": list(), "remark": str(why)}:
                    self.failed |= {(key, run) for key, run, _ in runs_of(line)}
                    self.remark = self.remark or why
        return files
