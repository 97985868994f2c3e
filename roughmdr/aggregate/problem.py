"""Problem: an ensemble, its material and its adhesion, with numbers that follow from them, computed once and kept."""

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.aggregate.detachment import Detachments, detachments
from roughmdr.aggregate.law import PER_AREA
from roughmdr.aggregate.loop import sum_over_asperities
from roughmdr.aggregate.tabor import JkrValidity, jkr_validity
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.placed import check_placed
from roughmdr.interaction.settings import Interaction, reason_against_adhesion
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Kernels
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats

if TYPE_CHECKING:
    from roughmdr.interaction.jkr.path import Descent

_MARGIN = 1e-9  # distance from the depth of detachment, over it: there a contact still holds


class Problem:
    """An ensemble that is pressed: its material, how it adheres, and how its asperities feel each other."""

    def __init__(
        self, ensemble: Ensemble, effective_modulus: float, asked: Adhesion, interaction: Interaction | None = None
    ) -> None:
        """Take E* [Pa], and the adhesion that is ``asked`` for, whose model may be "auto"."""
        self.ensemble, self.effective_modulus = ensemble, effective_modulus
        self.asked_adhesion, self.interaction = asked, interaction
        self._depths: dict[Adhesion, Floats] = {}

    def check_asked(self, names: list[str]) -> None:
        """Raise SceneError where the ensemble lacks data that variables or the interaction need."""
        if self.ensemble.nominal_area is None and not PER_AREA.isdisjoint(names):
            raise SceneError(f"ensemble: attribute nominal_area is missing; {', '.join(sorted(PER_AREA))} need it")
        if self.interaction is not None:
            check_placed(self.ensemble, self.interaction)
            if reason := reason_against_adhesion(self.interaction, self.asked_adhesion):
                raise SceneError(f"interaction {reason}")

    @cached_property
    def descent(self) -> "Descent":
        """The flat over adhesive contacts that feel each other in pairs."""
        from roughmdr.interaction.jkr.path import Descent

        assert self.interaction is not None
        return Descent(self.ensemble, self.effective_modulus, self.asked_adhesion.work, self.interaction)

    @property
    def paired(self) -> bool:
        """Whether asperities feel each other in pairs."""
        return self.interaction is not None and self.interaction.model == "pairwise"

    @cached_property
    def validity(self) -> JkrValidity:
        """The limits of JKR for these asperities."""
        own = self.ensemble.shape, self.ensemble.spread, self.ensemble.columns, self.effective_modulus
        return jkr_validity(*own, self.asked_adhesion, lambda: self._detached(Adhesion(self.asked_adhesion.work)))

    @cached_property
    def adhesion(self) -> Adhesion:
        """The adhesion that is used: "auto" is JKR or Dugdale's."""
        return self.asked_adhesion.resolved(self.validity.jkr_error)

    @cached_property
    def kernels(self) -> Kernels:
        """The kernels of one contact."""
        return choose(self.ensemble.shape, self.adhesion, self.ensemble.columns.params)

    def depths(self, adhesion: Adhesion) -> Floats:
        """Return the depth [m] below first touch at which each contact detaches under fixed grips, found once."""
        one = _without_range(adhesion)
        return self._depths[one] if one in self._depths else self._detached(one).depth

    def _detached(self, adhesion: Adhesion) -> Detachments:
        """Return the detachment of each contact, and keep the depths."""
        columns = self.ensemble.columns
        kernels = choose(self.ensemble.shape, adhesion, columns.params)
        found = detachments(kernels, columns, self.effective_modulus, adhesion)
        self._depths[adhesion] = found.depth
        return found

    def top(self, count: int) -> tuple[Floats, Columns, Floats]:
        """Return heights, columns and depths of detachment [m] of so many of the highest asperities."""
        few = Columns(*(column[:count] for column in self.ensemble.columns))
        if (known := self._depths.get(_without_range(self.adhesion))) is None:
            known = detachments(self.kernels, few, self.effective_modulus, self.adhesion).depth
        return self.ensemble.height[:count], few, known[:count]

    @cached_property
    def clear(self) -> float:
        """A separation [m] just high enough that no asperity touches or attracts the flat, whatever the path.

        NaN where the contact of an asperity is not representable.
        """
        height = self.ensemble.height
        highest = last = float(height.max())
        if self.asked_adhesion.work == 0.0:
            return highest
        for model in self.asked_adhesion.candidates:
            one = self.asked_adhesion._replace(model=model)
            with np.errstate(all="ignore"):  # NaN stands for numbers that no float can hold
                depths = self.depths(one)
                if not ((depths > 0.0) & (depths < math.inf)).all():
                    return math.nan
                found = float(np.max(height + (1.0 + _MARGIN) * np.maximum(depths, one.range)))
            last = max(last, found) if found < math.inf else math.nan
        return math.nextafter(last, math.inf)

    @property
    def depth(self) -> float:
        """A usual indentation [m]: the spread of the heights, or the rise of the first asperity."""
        return self.ensemble.spread or float(self.ensemble.columns.rise[0])

    def sums(self, path: LoadingPath, rows: set[int]) -> tuple[Floats, Floats, int]:
        """Return the totals of independent contacts along a path, as ``sum_over_asperities``."""
        own = self.kernels, self.ensemble.height, self.ensemble.columns, self.effective_modulus, self.adhesion
        return sum_over_asperities(*own, path.separation, path.memory, rows)


def _without_range(adhesion: Adhesion) -> Adhesion:
    """Return the adhesion for detachment: JKR without the strength, on which it does not depend."""
    return adhesion if adhesion.cohesive else Adhesion(adhesion.work)
