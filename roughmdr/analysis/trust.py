"""How far the force of each cell of a result can be trusted."""

from typing import TYPE_CHECKING

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PARTS
from roughmdr.result.curves import check_result
from roughmdr.result.trust import trust_of_result
from roughmdr.schema.wording import format_table
from roughmdr.storage.labelled import Labelled

if TYPE_CHECKING:
    import xarray as xr

_NAMES = ("model_error", *PARTS, "largest_contact_fraction", "trusted_separation")
_TEXT_TAKES = (
    *_NAMES,
    "overlap_fraction",
    "grid_points",
    *(f"pull_off_contact_fraction{statistic}" for statistic in ("", "_min", "_max")),
)


def trust(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the error of the model and its parts over the swept keys, the worst over the realisations."""
    check_result(dataset)
    if missing := [name for name in _NAMES if name not in dataset]:
        raise StoreError(f"trust needs the variables {', '.join(missing)}, which this result does not hold")
    found = dataset[list(_NAMES)]
    if "realization" in found.dims:
        found = found.max("realization", keep_attrs=True)
    found.attrs = {"trust": format_table(trust_lines(dataset))}
    return found


def trust_lines(dataset: "xr.Dataset") -> list[tuple[str, str]]:
    """Return the lines of ``roughmdr info`` on the error of the model."""
    names = [name for name in _TEXT_TAKES if name in dataset]
    return list(trust_of_result(Labelled.of(dataset[names].reset_coords(drop=True))._replace(attrs=dataset.attrs)))
