"""Sources that read their asperities from a file; among them source = "file", an ensemble saved before."""

import hashlib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.source import Source
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.storage.files import check_regular_file

if TYPE_CHECKING:
    import xarray as xr


@contextmanager
def open_dataset(path: Path) -> "Iterator[xr.Dataset]":
    """Open a netCDF file as xarray reads it, its arrays only when used; RoughmdrError where that fails."""
    import xarray as xr

    try:
        with warnings.catch_warnings(action="ignore"), xr.open_dataset(path, decode_times=False) as dataset:
            yield dataset
    except RoughmdrError:
        raise
    except Exception as error:  # xarray and its backends raise anything on files of other origin
        raise RoughmdrError(f"not a netCDF file that can be read ({type(error).__name__})") from error


def _check_file(name: str) -> str:
    check_regular_file(Path(name))
    return name


class FromFile(Source):
    """A source with the asperities of ``file``, the same in every realisation."""

    is_random: ClassVar[bool] = False

    file: Annotated[str, AfterValidator(_check_file), Field(examples=['"map.nc"'])]
    """File of the map or of the ensemble, relative to the scene."""

    def read(self) -> Ensemble:
        """Read the asperities of the file; RoughmdrError where it cannot be read or describes no valid asperities."""
        raise NotImplementedError

    @cached_property
    def _hash_and_asperities(self) -> tuple[str, Ensemble]:
        """The asperities, read once, and a hash of the file as it was then."""

        def current_hash() -> str:
            try:
                with open(self.file, "rb") as file:
                    return hashlib.file_digest(file, "sha256").hexdigest()
            except OSError as error:
                raise SceneError(f"{self.file}: cannot be read: {error.strerror}") from None

        before = current_hash()
        try:
            asperities = self.read()
        except RoughmdrError as error:
            raise SceneError(f"{self.file}: {error}") from error
        if current_hash() != before:
            raise SceneError(f"{self.file}: changed while it was read")
        return before, asperities

    @property
    def content_hash(self) -> str:
        return self._hash_and_asperities[0]

    @property
    def asperities(self) -> Ensemble:
        """The asperities of the file, read once."""
        return self._hash_and_asperities[1]

    @property
    def shape_name(self) -> str:
        return self.asperities.shape

    @property
    def expected_count(self) -> float:
        return float(self.asperities.height.size)

    @property
    def nominal_area(self) -> float | None:
        return self.asperities.nominal_area

    @property
    def inputs(self) -> tuple[Path, ...]:
        return (Path(self.file),)

    @property
    def sigma(self) -> float:
        return self.asperities.spread

    def extremes(self, chance: float) -> Ensemble:
        return self.asperities

    def ensemble(
        self, seed: int, realization: int, *, stratified: bool = False, with_positions: bool = False
    ) -> Ensemble:
        return replace(self.asperities, attrs={**self.asperities.attrs, "seed": seed})


class FileAsperities(FromFile):
    """[asperities] with source = "file": a netCDF dataset over ``asperity``, saved by ``generate`` or by the user."""

    source: Literal["file"]

    def read(self) -> Ensemble:
        with open_dataset(Path(self.file)) as dataset:
            dataset.load()
        return Ensemble.from_dataset(dataset)
