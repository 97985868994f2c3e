"""What the sources that read their asperities from a file have in common."""

import hashlib
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.source import Source
from roughmdr.errors import SceneError
from roughmdr.storage.file_checks import check_regular_file


def _is_file(value: str) -> str:
    """The name of a file that is there; RoughmdrError where it is not, or is no ordinary one."""
    check_regular_file(Path(value))
    return value


class FromFile(Source):
    """A source whose asperities are those of a ``file``: always the same ones."""

    drawn: ClassVar[bool] = False

    file: Annotated[str, AfterValidator(_is_file)]

    def read(self) -> Ensemble:
        """The asperities of the file; SceneError where it cannot be read or holds none that are right."""
        raise NotImplementedError

    @cached_property
    def _read_once(self) -> tuple[str, Ensemble]:
        before = self._hash()
        found = self.read()
        if self._hash() != before:
            raise SceneError(f"{self.file}: changed while it was read")
        return before, found

    def _hash(self) -> str:
        try:
            with open(self.file, "rb") as file:
                return hashlib.file_digest(file, "sha256").hexdigest()
        except OSError as error:
            raise SceneError(f"{self.file}: cannot be read: {error.strerror}") from None

    @property
    def held(self) -> Ensemble:
        """The asperities of the file; SceneError where it cannot be read or holds none that are right."""
        return self._read_once[1]

    @property
    def content(self) -> str:
        """A hash of the file as it was when the asperities were read."""
        return self._read_once[0]

    @property
    def shape_name(self) -> str:
        """The shape of the asperities."""
        return self.held.shape

    @property
    def expected_count(self) -> float:
        """How many asperities there are."""
        return float(self.held.height.size)

    @property
    def nominal_area(self) -> float | None:
        """[m2]; None where the file does not tell."""
        return self.held.nominal_area

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that the asperities are read from."""
        return (Path(self.file),)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        return float(np.std(self.held.height))

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of the file."""
        return replace(self.held, attrs={**self.held.attrs, "seed": seed})
