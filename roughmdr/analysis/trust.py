"""The trust in the force of each cell of a result."""

from typing import TYPE_CHECKING

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PARTS, PLASTIC
from roughmdr.report.contacts import sample_of_result
from roughmdr.result.curves import result_of
from roughmdr.result.trust import trust_of_result
from roughmdr.schema.wording import format_table, under

if TYPE_CHECKING:
    import xarray as xr

_NAMES = ("model_error", *PARTS, "largest_contact_fraction", "trusted_separation")


def trust(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return errors of the model and of the sample over the swept keys, the worst over the realisations."""
    result = result_of(dataset)
    if missing := [name for name in _NAMES if name not in dataset]:
        raise StoreError(f"trust needs the variables {', '.join(missing)}, which this result does not hold")
    found = dataset[[name for name in (*_NAMES, PLASTIC, "sampling_error", "area_sampling_error") if name in dataset]]
    if "realization" in found.dims:
        found = found.max("realization", keep_attrs=True)
    lines = [*trust_of_result(result), *under("sample", sample_of_result(result).splitlines())]
    found.attrs = {"trust": format_table(lines)}
    return found
