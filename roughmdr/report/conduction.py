"""The errors of the conductance and of the tangential stiffness of a result, in words."""

from collections.abc import Iterator

import numpy as np

from roughmdr.storage.labelled import Labelled

_ERRORS = {"conductance": "conductance_error", "sticking": "tangential_error"}


def conduction_lines(result: Labelled) -> Iterator[tuple[str, str]]:
    """Yield within which errors these hold at given separation, where a result has them."""
    for label, name in _ERRORS.items():
        if name in result.variables:
            values = result.variables[name].values
            known = values[np.isfinite(values)]
            within = f"at given separation within about {100.0 * known.max():.2g} %" if known.size else ""
            yield label, within or "its error is not known: the asperities have no nominal area"
