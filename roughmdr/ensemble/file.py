"""source = "file": an ensemble that was saved, by ``roughmdr generate`` or by the user."""

from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.source import Source
from roughmdr.errors import RoughmdrError, SceneError


def check_is_file(value: str) -> str:
    """The name of a file that is there; RoughmdrError where it is not."""
    try:
        there, folder = Path(value).is_file(), Path(value).is_dir()
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    if not there:
        raise RoughmdrError("is a folder; expected a file" if folder else "no such file")
    return value


class FileAsperities(Source):
    """[asperities] with source = "file": ``file`` is a netCDF dataset over ``asperity``."""

    drawn: ClassVar[bool] = False

    source: Literal["file"]
    file: Annotated[str, AfterValidator(check_is_file)]

    @cached_property
    def saved(self) -> Ensemble:
        """The asperities of the file; SceneError where it cannot be read or holds none that are right."""
        import xarray as xr

        try:
            with xr.open_dataset(self.file) as dataset:
                dataset.load()
        except Exception as error:
            raise SceneError(f"{self.file}: not a netCDF file that can be read ({type(error).__name__})") from error
        try:
            return Ensemble.from_dataset(dataset)
        except SceneError as error:
            raise SceneError(f"{self.file}: {error}") from None

    @property
    def shape_name(self) -> str:
        """The shape of the asperities."""
        return self.saved.shape

    @property
    def expected_count(self) -> float:
        """How many asperities there are."""
        return float(self.saved.height.size)

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that the asperities are read from."""
        return (Path(self.file),)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        return float(np.std(self.saved.height))

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of the file: always the same ones."""
        return replace(self.saved, attrs={**self.saved.attrs, "seed": seed})
