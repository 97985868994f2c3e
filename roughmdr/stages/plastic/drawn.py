"""Asperities of an ensemble that yield."""

import math
from collections.abc import Iterator
from functools import cached_property, partial

import numpy as np

from roughmdr.aggregate.compute import law_of_totals, rows_for
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import AREA, COUNT, FORCE
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, locate, prepare as prepare_pull_off, unloadings
from roughmdr.model_error.parts import Yielding
from roughmdr.numerics.arguments import Floats
from roughmdr.stages.plastic.body import LIMIT, Body, check_depth, range_warnings
from roughmdr.stages.plastic.models import compare, kernels_of
from roughmdr.stages.plastic.total import Sum, add_up, partings, rows_of

_MOST_TOLD = 1000
"""Most asperities by which models are compared: more would change their differences by some percent."""

_MOST_PULLED = 100
"""Number of the highest asperities whose dents are looked at: they are the largest."""


class DrawnAsperities:
    """Asperities of an ensemble that yield by a model."""

    order = 1
    """Without a rule over the radii there is nothing to refine."""

    def __init__(self, problem: Problem, model: str, body: Body) -> None:
        self._problem, self._model, self._body = problem, model, body
        self._kernels, self._height = kernels_of(model, body, problem.ensemble.shape), problem.ensemble.height
        self.nominal_area, none = problem.ensemble.nominal_area, self._height.size == 0
        self.depth = 0.0 if none else problem.depth
        """A usual indentation [m]; 0 without asperities."""
        self.first_touch = 0.0 if none else problem.clear
        """Separation [m] of the first touch; a little above it where contacts adhere."""

    @cached_property
    def _rows(self) -> Floats:
        return rows_of(self._kernels, self._problem.ensemble.parameters[self._kernels.parameter], self._body)

    def _along(self, separation: Floats, rows: set[int]) -> Sum:
        return add_up(self._kernels, self._height, self._rows, separation, self._body, rows)

    def totals(self, separation: Floats, rows: set[int]) -> Floats:
        """Return totals [row, step] along separations [m]; OutOfRange where one is not representable."""
        return self._along(separation, rows).total

    def bearing(self, above: float, below: float) -> tuple[float, float]:
        """Return the force [N] at a separation on first loading, and a bound of it from another separation on.

        Each contact pulls when it is made, and its force rises as the flat comes down, up to a radius of 0.84 R. So the
        bound is the force at ``below`` [m] without the tension of those that have not touched at ``above`` [m].
        """
        found = self._along(np.array([below]), {FORCE})
        force, pull = float(found.total[FORCE, 0]), np.minimum(found.closest[1], 0.0)
        return force, force - float(pull.sum(where=self._height < above))

    def parting(self, lowest: float) -> float:
        """Return the separation [m] at which the last contact is lost after the flat has been at ``lowest`` [m]."""
        return float(self._lost(np.array([lowest])).max(initial=lowest))

    def law(self, path: LoadingPath, names: list[str]) -> LoadSeparation:
        """Return the law along a path of the flat; OutOfRange as ``totals``, TooMuchContact as ``check_depth``."""
        problem, separation = self._problem, path.separation
        problem.check_asked(names)
        closest = float(separation.min())
        check_depth(self._kernels, self._height - closest, self._rows)
        found = self._along(separation, rows_for(problem, names))

        def radius_at(separation: float) -> Floats:
            return np.asarray(self._along(np.array([separation]), {AREA}).closest[0])

        yielding = self.compared(separation)
        law = law_of_totals(problem, path, names, found.total, found.closest, radius_at, yielding=yielding)
        pull_off = self._pull_off(separation, found.total[FORCE])
        visits = int(np.searchsorted(-self._height, -np.minimum.accumulate(separation)).sum())
        wide = range_warnings(self._kernels, found.closest[0], self._rows)
        warnings = (*law.warnings, *wide, *self._flowing(closest))
        law = law._replace(visits=visits, pull_off=pull_off, warnings=warnings)
        return law._replace(yielding=lambda: self.shares(closest))

    def _flowing(self, closest: float) -> Iterator[str]:
        """Yield a warning where dents are pulled harder than their body bears before they are lost."""
        tension, body = 0.0, self._body
        for height, asperity in zip(self._height[:_MOST_PULLED], self._rows, strict=False):
            if self._kernels.adhesive and height - closest > asperity[LIMIT]:
                mark = self._kernels.mark(height - closest, asperity, body)
                _, lost = self._kernels.ends(height - closest, mark, asperity, body)
                contact = self._kernels.state(height - closest - lost, lost, mark, asperity, body)
                tension = max(tension, -contact.force / (math.pi * contact.radius * contact.radius))
        if tension > body.yield_strength:
            yield "dents are pulled harder than the yield strength before they are lost: they would neck"

    def compared(self, separation: Floats) -> Yielding:
        """Return how much the models differ along separations [m].

        Of many asperities some tell it, each of so many in the order of their heights.
        """
        touched = np.flatnonzero(self._height > separation.min())
        each = -(-max(touched.size, 1) // _MOST_TOLD)
        some = touched[each // 2 :: each]
        ensemble = self._problem.ensemble
        parameter = ensemble.parameters[self._kernels.parameter][some]
        return compare(self._model, self._body, ensemble.shape, self._height[some], parameter, separation)

    def shares(self, closest: float) -> dict[str, float]:
        """Return the shares of the contacts, and of the load of pushing ones, that have yielded at a separation [m]."""
        radius, force = self._along(np.array([closest]), {FORCE}).closest
        yielded = self._height - closest > self._rows[:, LIMIT]
        touching, pushing = radius > 0.0, float(force.sum(where=force > 0.0))
        contacts = float(yielded[touching].mean()) if touching.any() else 0.0
        load = float(force[yielded].sum()) / pushing if pushing > 0.0 else 0.0
        return {"plastic_contact_fraction": contacts, "plastic_load_fraction": load}

    def _lost(self, separation: Floats) -> Floats:
        """Return the separation [m] at which each contact is lost after the flat has been as low as on a path."""
        return partings(self._kernels, self._height, self._rows, float(separation.min()), self._body)

    def _left(self, row: int, lost: Floats, first: int, path: LoadingPath) -> Floats:
        """Return a total along a path of the contacts that are lost [m] above its step ``first``, as it rises on."""
        left = lost >= path.separation[first]
        found = add_up(self._kernels, self._height[left], self._rows[left], path.separation, self._body, {row})
        return np.asarray(found.total[row])

    def _pull_off(self, separation: Floats, force: Floats) -> PullOff:
        """Return the pull-off along separations [m], given the force [N]; NaN where contacts remain at the end."""
        rises = unloadings(separation, force)
        if not any(rise.force[-1] == 0.0 for rise in rises):
            return PullOff()
        found = None
        for rise in rises if self._kernels.adhesive else []:
            lost = self._lost(rise.turns)
            largest = locate([rise], partial(self._left, FORCE, lost, rise.turns.size), np.sort(lost))
            found = largest if found is None or (largest and largest.force < found.force) else found
        if found is None:
            return WITHOUT_TENSION
        lost = self._lost(found.path.separation)
        count, area = (float(self._left(row, lost, -1, found.path)[-1]) for row in (COUNT, AREA))
        return PullOff(found.force, float(found.path.separation[-1]), count, area)


def prepare(model: str, body: Body, shape: str) -> None:
    """Compile what the law of a model needs, before several threads or a clock need it."""
    kernels, height, ones = kernels_of(model, body, shape), np.zeros(1), np.ones(1)
    rows = rows_of(kernels, ones, body)
    add_up(kernels, height, rows, height, body, {FORCE})
    if kernels.adhesive:
        partings(kernels, height, rows, 0.0, body)
        prepare_pull_off()
    compare(model, body, shape, height, ones, height)
