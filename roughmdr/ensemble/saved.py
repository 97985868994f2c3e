"""source = "file": an ensemble that was saved, by ``roughmdr generate`` or by the user."""

from pathlib import Path
from typing import Literal

from roughmdr.ensemble.datasets import opened
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FromFile
from roughmdr.errors import RoughmdrError, SceneError


class FileAsperities(FromFile):
    """[asperities] with source = "file": ``file`` is a netCDF dataset over ``asperity``."""

    source: Literal["file"]

    def read(self) -> Ensemble:
        """The asperities of the file; SceneError where it cannot be read or holds none that are right."""
        try:
            with opened(Path(self.file)) as dataset:
                dataset.load()
            return Ensemble.from_dataset(dataset)
        except RoughmdrError as error:
            raise SceneError(f"{self.file}: {error}") from None
