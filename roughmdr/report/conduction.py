"""The errors of the conductance and of the tangential stiffness of a result, in words."""

from collections.abc import Iterator

from roughmdr.result.view import ResultView

_ERRORS = {"conductance": "conductance_error", "sticking": "tangential_error"}


def conduction_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield within which errors these hold at given separation, where a result has them."""
    for label, name in _ERRORS.items():
        if name in result.variables:
            known = result.known(name).size
            within = f"at given separation within about {100.0 * result.largest(name):.2g} %" if known else ""
            yield label, within or "its error is not known: the asperities have no nominal area"
