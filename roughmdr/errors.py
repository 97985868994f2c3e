"""Errors and warnings that roughmdr raises on purpose. Messages name the argument, its value and what is allowed."""

import sys
import warnings
from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Fault(NamedTuple):
    """One thing that is wrong with a scene; printed as "location: key = value: message"."""

    key: str  # dotted; empty if no single key is at fault
    value: str  # as it stands in the scene; empty if there is none to show
    message: str  # the fault, and what is allowed
    location: str = ""  # file and line, or "--set"; empty if there is none

    def __str__(self) -> str:
        subject = f"{self.key} = {self.value}" if self.value else self.key
        return ": ".join(part for part in (self.location, subject, self.message) if part)


class RoughmdrError(ValueError):
    """Base class of all errors that roughmdr raises on purpose; catching it catches them all."""


class SceneError(RoughmdrError):
    """A scene or an ensemble cannot be computed as it was given.

    It is raised before anything is computed. The message of a scene has one line for each fault.
    """

    faults: tuple[Fault, ...] = ()
    """Faults of the scene one by one; empty if the message is not about single keys."""

    @classmethod
    def of(cls, faults: Sequence[Fault]) -> "SceneError":
        """Return the error that lists ``faults``, each once."""
        unique = tuple(dict.fromkeys(faults))
        error = cls("\n".join(dict.fromkeys(map(str, unique))))
        error.faults = unique
        return error


class ShapeError(RoughmdrError):
    """A shape parameter is not allowed, or a shape cannot be used in the way it was asked to be."""


class OutOfRange(RoughmdrError):  # noqa: N818 - the name is part of the contract
    """A number lies outside the range in which there is a right answer, or the answer is not representable."""


class TooMuchContact(OutOfRange):
    """The summed contact area is larger than the nominal area: independent asperities have no such contact."""


def level_outside() -> int:
    """Return the ``stacklevel`` by which a warning is that of the first frame outside the package."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "roughmdr":
        frame, level = frame.f_back, level + 1
    return level


def warn_limits(texts: Iterable[str]) -> dict[str, str]:
    """Issue each text as a LimitWarning to the caller of a public function; return them as an attribute of a result."""
    texts = list(texts)
    for text in texts:
        warnings.warn(text, LimitWarning, stacklevel=level_outside())
    return {"warnings": "\n".join(texts)} if texts else {}


class StoreError(RoughmdrError):
    """A file cannot be read or written, is of the wrong kind, or must not be replaced."""


class Unfinished(StoreError):  # noqa: N818 - not an error of the caller
    """A batch had to stop; the finished runs are kept, and the same call continues from there."""


class LimitWarning(UserWarning):
    """A result lies where the theory behind it is doubtful, for example beyond small slopes."""


class FailedRuns(UserWarning):
    """Some runs of a batch could not be computed; ``status`` and ``remark`` of the result tell which and why."""
