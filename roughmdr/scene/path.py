"""[path]: the separations of the rigid flat."""

import math
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, StrictBool, Tag

from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.separation import CLEAR, Separation, SeparationReader, Target
from roughmdr.schema.quantities import Section, WholeNumber

_START = SeparationReader(clear=True, other=f', or "{CLEAR}"')
_STOP = SeparationReader(other=', or a target such as { contact_fraction = 0.02 } or { pressure = "1 MPa" }')
_Separation = Annotated[Separation, BeforeValidator(SeparationReader())]


class Range(Section):
    """``steps`` separations from ``start`` to ``stop``, both included; ``start`` is None for "clear"."""

    start: Annotated[Separation | None, BeforeValidator(_START)] = None
    stop: Annotated[
        Annotated[Target, Tag("target")] | Annotated[Separation, BeforeValidator(_STOP), Tag("distance")],
        Discriminator(lambda value: "target" if isinstance(value, dict | Target) else "distance"),
    ]
    steps: Annotated[int, BeforeValidator(WholeNumber(2, 10_000_000))]


class FlatPath(Section):
    """[path]: a range or a list of separations; ``unload`` appends the same separations in reverse."""

    separation: Annotated[
        Annotated[Range, Tag("range")] | Annotated[list[_Separation], Field(min_length=1), Tag("list")],
        Discriminator(
            lambda value: {dict: "range", Range: "range", list: "list"}.get(type(value)),
            custom_error_type="neither",
            custom_error_message="must be a table with start, stop and steps, or a list",
        ),
    ]
    unload: StrictBool = False

    @property
    def _ends(self) -> list[Separation | Target | None]:
        path = self.separation
        return [path.start, path.stop] if isinstance(path, Range) else [*path]

    @property
    def starts_clear(self) -> bool:
        """Whether it starts where no asperity touches, or attracts."""
        return self._ends[0] is None

    @property
    def target(self) -> Target | None:
        """The target that is reached where it stops; None where it stops at a separation."""
        stop = self._ends[-1]
        return stop if isinstance(stop, Target) else None

    @property
    def uses_sigma(self) -> bool:
        """Whether a separation is given in standard deviations of the heights."""
        return any(isinstance(end, Separation) and end.in_sigma for end in self._ends)

    def sigma_fault(self, sigma: float) -> str:
        """Return why separations cannot be given in sigma [m]; empty if they can, or are not."""
        if not self.uses_sigma or 0.0 < sigma < np.inf:
            return ""
        return f"cannot be given in sigma: the heights' standard deviation is {sigma:g} m"

    def given(self, sigma: float) -> list[float | None]:
        """Return the separations that are given, or both ends of the range [m]; None for "clear" and a target.

        ``sigma`` [m] is the heights' standard deviation; SceneError if the path is given in sigma and there is none.
        """
        if fault := self.sigma_fault(sigma):
            raise SceneError(f"path.separation: {fault}")
        return [end.metres(sigma) if isinstance(end, Separation) else None for end in self._ends]

    def separations(self, sigma: float, clear: float | None = None, reached: float | None = None) -> Floats:
        """Return the separations [m] without the appended unloading; sigma [m] is the heights' standard deviation.

        ``clear`` and ``reached`` [m] are the start and the stop of a range where it does not give them as separations.
        SceneError if the path is given in sigma and there is none, or if it is not finite.
        """
        given = self.given(sigma)
        if isinstance(self.separation, Range):
            pairs = zip(given, (clear, reached), strict=True)
            ends = np.array([end if found is None else found for end, found in pairs], dtype=np.float64)
            start, stop = ends.tolist()
            finite = math.isfinite(stop - start)
            path = np.linspace(start, stop, self.separation.steps) if finite else np.array([np.inf])
        else:
            path = np.array(given, dtype=np.float64)
        if not np.isfinite(path).all():
            raise SceneError("path.separation: reaches beyond the largest float")
        return path
