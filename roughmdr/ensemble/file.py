"""source = "file": an ensemble that was saved, by ``roughmdr generate`` or by the user."""

from typing import Literal

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FromFile
from roughmdr.errors import SceneError


class FileAsperities(FromFile):
    """[asperities] with source = "file": ``file`` is a netCDF dataset over ``asperity``."""

    source: Literal["file"]

    def read(self) -> Ensemble:
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
