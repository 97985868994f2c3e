"""A study that a test carries out in its short form, with what it wrote."""

import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

import xarray as xr
from studies import study as frame
from studies.study import Study


class CarriedOut(NamedTuple):
    """A finished study: the text that it printed, the folder that it wrote into, and its numbers."""

    text: str
    folder: Path
    result: xr.Dataset


@contextmanager
def carried_out(study: Study, folder: Path) -> Iterator[CarriedOut]:
    """Carry out the short form of a study, in this process also where the study has some of its own."""
    pool = "ProcessPoolExecutor"
    with ExitStack() as patches:
        for module in (frame, sys.modules[study.measure.__module__]):
            if hasattr(module, pool):
                patches.enter_context(patch.object(module, pool, lambda *_, **__: ThreadPoolExecutor(1)))
        text = study.carry_out(folder, quick=True)
    with xr.open_dataset(folder / f"{study.name}.nc") as result:
        yield CarriedOut(text, folder, result)
