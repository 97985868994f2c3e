"""The trust in the force of each cell of a result."""

from typing import TYPE_CHECKING

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PARTS
from roughmdr.result.curves import result_of
from roughmdr.result.trust import trust_of_result
from roughmdr.schema.wording import format_table

if TYPE_CHECKING:
    import xarray as xr

_NAMES = ("model_error", *PARTS, "largest_contact_fraction", "trusted_separation")


def trust(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the error of the model and its parts over the swept keys, the worst over the realisations."""
    result = result_of(dataset)
    if missing := [name for name in _NAMES if name not in dataset]:
        raise StoreError(f"trust needs the variables {', '.join(missing)}, which this result does not hold")
    found = dataset[list(_NAMES)]
    if "realization" in found.dims:
        found = found.max("realization", keep_attrs=True)
    found.attrs = {"trust": format_table(list(trust_of_result(result)))}
    return found
