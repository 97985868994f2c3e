"""A share of a batch, which one of several machines computes: which runs it has, and where it keeps their results."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, Self

from roughmdr.batch.resume.store import store_folder
from roughmdr.batch.tasks import RunRange
from roughmdr.errors import RoughmdrError
from roughmdr.storage.files import convert_os_errors

_NUMBER = "([1-9][0-9]{0,4})"
_TEXT = re.compile(f"{_NUMBER}/{_NUMBER}")
_NAME = re.compile(rf"(.+)\.{_NUMBER}-of-{_NUMBER}")


class Share(NamedTuple):
    """One of ``total`` shares of a batch; which runs are in it follows from their order alone."""

    number: int
    """From 1 on."""
    total: int

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read a share such as 7/100; RoughmdrError where it is none."""
        match = _TEXT.fullmatch(text)
        share = cls(*map(int, match.groups())) if match else None
        if share is None or share.number > share.total:
            told = "it must be a number from 1 on, and how many parts there are, no fewer, as in 7/100"
            raise RoughmdrError(f"part is {text!r}; {told}")
        return share

    @classmethod
    def split_name(cls, target: Path) -> tuple[Path, Self | None]:
        """Return the output that a share's own target stands beside, and the share; the target where it is of none."""
        match = _NAME.fullmatch(target.name)
        if match is None or int(match[2]) > int(match[3]):
            return target, None
        return target.with_name(match[1]), cls(int(match[2]), int(match[3]))

    @classmethod
    def all_beside(cls, target: Path) -> list[Self]:
        """Return the shares whose results are kept beside an output, in order."""
        if not target.parent.is_dir():
            return []
        with convert_os_errors(target.parent):
            folders = [path for path in target.parent.iterdir() if path.name.endswith(".parts") and path.is_dir()]
        named = (cls.split_name(path.with_suffix("")) for path in folders)
        return sorted(share for output, share in named if share is not None and output.name == target.name)

    def beside(self, target: Path) -> Path:
        """Return the target of the share alone: its results are kept in the folder that belongs to that."""
        return target.with_name(f"{target.name}.{self.number}-of-{self.total}")

    def folder(self, target: Path) -> Path:
        """Return the folder of the share's results."""
        return store_folder(self.beside(target))

    def of(self, ranges: Sequence[RunRange]) -> list[RunRange]:
        """Return the runs of this share: of each cell its part, and one more of some cells, in turn with the others."""
        found, passed = list[RunRange](), 0
        for runs in ranges:
            each, more = divmod(runs.last - runs.first, self.total)
            block = (self.number - 1 - passed) % self.total
            first = runs.first + each * block + min(block, more)
            last = first + each + (block < more)
            if last > first:
                found.append(runs._replace(first=first, last=last))
            passed += more
        return found
