"""The result that a public function is given: the path of a file, or a Dataset."""

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from roughmdr.errors import StoreError, level_outside
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import short_repr
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import read_result
from roughmdr.storage.result_validation import as_result

if TYPE_CHECKING:
    import xarray as xr


def given_result(result: "str | Path | xr.Dataset") -> tuple[ResultView, Path | None]:
    """Return a result, and its file if it is in one; StoreError where it is none.

    A UserWarning tells the caller of a public function where the numbers in a file cannot be trusted.
    """
    if isinstance(result, str | os.PathLike):
        view = ResultView(read_result(Path(result)))
        if view.doubt:
            warnings.warn(f"{result}: {view.doubt}", UserWarning, stacklevel=level_outside())
        return view, Path(result)
    if hasattr(result, "data_vars"):
        return ResultView(as_result(Labelled.of(result))), None
    raise StoreError(f"result is {short_repr(result)}; it must be a path or a Dataset as roughmdr.run returns it")
