"""The errors that roughmdr raises on purpose. Each message names the argument, its value and what is allowed."""

import warnings
from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Fault(NamedTuple):
    """One thing that is wrong with a scene."""

    key: str
    """Dotted key; empty where no key is at fault."""
    value: str
    """Value as in the scene; empty where there is none to show."""
    message: str
    place: str = ""
    """File and line; empty where there is none."""

    def __str__(self) -> str:
        shown = f"{self.key} = {self.value}" if self.value else self.key
        return ": ".join(part for part in (self.place, shown, self.message) if part)


class RoughmdrError(ValueError):
    """Base of all errors that roughmdr raises on purpose."""


class SceneError(RoughmdrError):
    """A scene, or an ensemble, cannot be computed as it stands."""

    faults: tuple[Fault, ...] = ()
    """All faults of the scene; empty where the message alone tells."""

    @classmethod
    def of(cls, faults: Sequence[Fault]) -> "SceneError":
        """Return the error that names all of ``faults``, each once."""
        error = cls("\n".join(dict.fromkeys(map(str, faults))))
        error.faults = tuple(dict.fromkeys(faults))
        return error


class ShapeError(RoughmdrError):
    """A shape parameter is out of its range, or a shape is used where it cannot be."""


class OutOfRange(RoughmdrError):  # noqa: N818 - the name is part of the contract
    """A number is outside the range in which there is a right answer."""


class LimitWarning(UserWarning):
    """A result lies beyond the limits of its theory."""


def warn_limits(texts: Iterable[str], stacklevel: int = 3) -> dict[str, str]:
    """Issue each text as a LimitWarning to the caller of the caller; return them as an attribute of a result."""
    texts = list(texts)
    for text in texts:
        warnings.warn(text, LimitWarning, stacklevel=stacklevel)
    return {"warnings": "\n".join(texts)} if texts else {}


class StoreError(RoughmdrError):
    """A file cannot be read or written."""


class Unfinished(StoreError):  # noqa: N818 - it is no error of whoever asked
    """A batch could not go on; what it finished is kept."""


class FailedRuns(UserWarning):
    """Some runs of a batch could not be computed."""
