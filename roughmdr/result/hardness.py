"""Words on contacts above the hardness, up to where the elastic law holds, and on those that have yielded."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from roughmdr.model_error.parts import YIELDED_SHARE
from roughmdr.schema.units import format_quantity
from roughmdr.variables import YIELDED, YIELDING


def hardness_lines(numbers: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the line "hardness", or "yielding" with [plasticity], from the diagnostics of some runs."""
    names = (*YIELDING, *YIELDED)
    known = (np.array([each for each in numbers.get(name, ()) if np.isfinite(each)]) for name in names)
    contacts, load, limit, end, index, plastic, plastic_load = known
    if plastic.size:
        beyond = f"{_percent(*plastic)} of the contacts, with {_percent(*plastic_load)} of the load, have yielded"
        yield "yielding", f"{beyond} at closest approach"
    if not load.size:
        return
    above = f"{_percent(*contacts)} of the contacts, with {_percent(*load)} of the load, have a mean pressure above it"
    yield "hardness", f"{above} at closest approach"
    if not end.size:
        yield "", "the elastic law holds along the whole path"
    else:
        up_to = (
            f"up to {format_quantity(float(limit.min()), 'Pa', to=float(limit.max()))}, " if limit.size else "down to "
        )
        until = f"{up_to}h = {format_quantity(float(end.max()), 'm', to=float(end.min()))}"
        until = until if limit.any() or not limit.size else "which they do at no load"
        yield "", f"the elastic law holds while they bear at most {_percent(YIELDED_SHARE)} of the load: {until}"
        yield (
            "",
            "beyond, contacts flow, as [plasticity] has it: they grow larger, bear less; no error above contains it",
        )
    told = "yield below the surface begins at about 0.4 of it"  # K. L. Johnson, Contact Mechanics (1985), section 6.1
    if index.size:
        psi = float(index.max())  # J. A. Greenwood, J. B. P. Williamson (1966)
        when = "at any load" if psi > 1.0 else "at extreme loads only" if psi < 0.6 else "if the load is high"
        told += f", in some contacts {when} (plasticity index {psi:.2g})"
    yield "", told


def _percent(*shares: float) -> str:
    """Return the range of shares to two digits."""
    ends = (float(f"{100.0 * share:.2g}") for share in (min(shares), max(shares)))
    return f"{' to '.join(dict.fromkeys(f'{each:g}' for each in ends))} %"
