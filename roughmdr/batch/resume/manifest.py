"""The manifest of OUT.nc.parts: a line of JSON for the batch, and one for each stored task result and failed run."""

import json
import re
from collections.abc import Iterator
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


def manifest_lines(content: bytes) -> Iterator[dict[str, Any]]:
    """Yield the whole lines of a manifest: that of the batch, and those of its task results and failed runs."""
    for text in content[: content.rfind(b"\n") + 1].splitlines():
        with suppress(ValueError, RecursionError):
            line = json.loads(text)
            if isinstance(line, dict) and _FILE_NAME.fullmatch(str(line.get("file", FILE.format(0)))):
                yield line


def runs_of(line: dict[str, Any]) -> list[Runs] | None:
    """Return the runs that are stored, or have failed; None where an earlier version has not noted them."""
    match line:
        case {"failed": [*pairs]}:
            given = [[*pair, pair[-1] + 1] for pair in pairs if _is_range(pair)]
        case {"runs": [*given]} if given:
            pass
        case _:
            return None
    return [Runs(*each) for each in given] if all(_is_range(each) and len(each) == 3 for each in given) else None


def _is_range(given: object) -> bool:
    match given:
        case [str(), int(first), *more]:
            return first >= 0 and all(isinstance(last, int) and last > first for last in more) and len(more) < 2
    return False


class ManifestTail:
    """Lines of a manifest in the order in which processes append them, each read once."""

    def __init__(self, folder: Path) -> None:
        self._path, self._offset = folder / MANIFEST, 0

    @property
    def is_there(self) -> bool:
        """Whether there is a manifest: who writes the result removes it."""
        return self._path.exists()

    def new_lines(self) -> list[dict[str, Any]]:
        """Return the lines that were finished since the last call; none where there is no manifest."""
        content = b""
        with suppress(FileNotFoundError), self._path.open("rb") as file:
            file.seek(self._offset)
            content = file.read()
        whole = content[: content.rfind(b"\n") + 1]
        self._offset += len(whole)
        return list(manifest_lines(whole))
