"""A study that a test carries out in its short form, with what it wrote."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import xarray as xr
from studies.study import Study


class CarriedOut(NamedTuple):
    """What a study printed, the folder that it wrote into, and its numbers."""

    text: str
    folder: Path
    result: xr.Dataset


@contextmanager
def carried_out(study: Study, folder: Path) -> Iterator[CarriedOut]:
    """Carry out the short form of a study."""
    text = study.carry_out(folder, quick=True)
    with xr.open_dataset(folder / f"{study.name}.nc") as result:
        yield CarriedOut(text, folder, result)
