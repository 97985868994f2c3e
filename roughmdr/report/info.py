"""The text of ``roughmdr info``."""

from pathlib import Path
from typing import TYPE_CHECKING

from roughmdr.fitting.stored import given_fit
from roughmdr.fitting.words import describe_fit
from roughmdr.report.summary import describe_cells, describe_origin, describe_result
from roughmdr.result.given import given_result
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import named_keywords

if TYPE_CHECKING:
    import xarray as xr


@named_keywords
def info(result: "str | Path | xr.Dataset", *, cells: bool = False) -> str:
    """Return the text that ``roughmdr info`` prints of a result; nothing is printed.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned; of a fit, what ``fit`` did.
    cells : bool, optional
        Whether to list the cells of the sweep instead: status, time, errors and remarks.

    Returns
    -------
    str
        Lines with sizes, forces, errors, run time, seed, versions and the scene; of a fit its parameters.

    Raises
    ------
    StoreError
        Where there is no such file, or no result in it.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "One patch", "material": {"effective_modulus": "1 GPa"}, "path": {"separation": ["3 um", "2 um"]},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... })
    >>> print(rm.info(result).splitlines()[0])
    computed     One patch: 1 realisation x 2 steps
    """
    fit = given_fit(result)
    return describe_fit(fit) if fit is not None else describe(*given_result(result), cells=cells)


def describe(result: ResultView, file: Path | None, *, cells: bool) -> str:
    """Return that text of a result that was read, from ``file`` unless that is None."""
    if cells:
        return describe_cells(result)
    return f"{describe_result(result)}\n{describe_origin(result, None if file is None else file.stat().st_size)}"
