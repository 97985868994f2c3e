"""The error of the conductance of a result, in words."""

from collections.abc import Iterator

import numpy as np

from roughmdr.storage.labelled import Labelled

_NAME = "conductance_error"


def conduction_lines(result: Labelled) -> Iterator[tuple[str, str]]:
    """Yield within which error the conductance holds at given separation, where a result has one."""
    if _NAME not in result.variables:
        return
    values = result.variables[_NAME].values
    known = values[np.isfinite(values)]
    if known.size:
        yield "conductance", f"at given separation within about {100.0 * known.max():.2g} %"
    else:
        yield "conductance", "its error is not known: the asperities have no nominal area"
