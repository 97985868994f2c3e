"""Chooses the cheapest method for a quantity that is asked for with its whole error: ``[accuracy] of``.

Of each method that the scene leaves open, the error of the model and the scatter are foreseen from a part of the
asperities. The rest of the error that is asked for is left to the draws.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from roughmdr.batch.choice import Choice, length
from roughmdr.batch.costs import seconds
from roughmdr.batch.derivatives import check_derivatives
from roughmdr.batch.foresee import foresee_law, some_cells
from roughmdr.batch.plan import Cell, Plan, make_plan
from roughmdr.batch.stopping_rule import FEWEST
from roughmdr.batch.tasks import diagnostics_of
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.model_error.at_given import FORCES
from roughmdr.scene import Scene, read
from roughmdr.scene.asked import Asked
from roughmdr.stages.reference import OF_AREA, Reference

_NEGLIGIBLE = 1.0  # seconds of all realisations of a method, below which no other one is looked at
_DOUBT = 1.2  # factor on the error of the model that a part of the asperities foretells: other draws have more
_GRID_SHARE = 0.5  # error of the grid over the error that is asked for
_SUMMITS, _PAIRWISE = {"model": "summits"}, {"model": "pairwise"}
_ALONE, _MEAN, _PAIRS, _GRID = "independent asperities", "mean field", "pairs", "boundary elements"
_METHODS: dict[str, dict[str, dict[str, Any]]] = {
    _ALONE: {},
    _PAIRS: {"interaction": _PAIRWISE},
    "hills in pairs": {"asperities": {"model": "hills"}, "interaction": _PAIRWISE},
    _GRID: {"reference": {"model": "boundary_elements"}},
}
"""Sections of a scene that each method takes, by its name; of a surface summits, unless they say otherwise."""


class _Forecast(NamedTuple):
    """A method, and what it would take and give."""

    name: str
    plan: Plan
    choice: Choice
    model_error: float
    """The largest of the cells: relative [1], of a separation [m]."""
    scatter: float
    """The largest standard deviation of a realisation, likewise."""
    seconds: float
    """Seconds of a realisation of all cells."""

    @property
    def realizations(self) -> float:
        """About how many realisations it would take; inf where no number is enough."""
        random = self.plan.scene.asperities.is_random
        most = self.model_error * (_DOUBT if random else 1.0)
        if not most < self.choice.of.tolerance:
            return math.inf
        return max(FEWEST, math.ceil((self.scatter / self.choice.standard_error(most)) ** 2)) if random else 1.0

    @property
    def cost(self) -> float:
        """Seconds of all realisations; inf where as many as there may be are not enough."""
        accuracy = self.plan.scene.accuracy
        assert accuracy is not None
        return self.realizations * self.seconds if self.realizations <= accuracy.max_realizations else math.inf

    @property
    def rank(self) -> tuple[float, float]:
        """Key that is the least of the best method: of those that are right enough the cheapest."""
        return self.cost, math.inf if math.isnan(self.model_error) else self.model_error

    @property
    def in_words(self) -> str:
        """Its error, and the realisations that it would take."""
        if math.isnan(self.model_error):
            return f"{self.name}: error not known"
        count, within = self.realizations, f"within about {self.choice.of.error_in_words(self.model_error)}"
        taken = (
            f"about {count:.0f} realisations{', too many' * math.isinf(self.cost)}" if count > 1.0 else "one surface"
        )
        return f"{self.name}: {within}, {'too large' if math.isinf(count) else taken}"


def plan_scene(scene: Scene) -> Plan:
    """Return the plan of a scene; where it asks for a quantity, by the cheapest method that is right enough.

    SceneError as ``make_plan``.
    """
    of = None if scene.accuracy is None else scene.accuracy.of
    if of is None:
        plan = make_plan(scene)
        check_derivatives(plan)
        return plan
    forecasts, lines = list[_Forecast](), list[str]()
    for name, candidate in _candidates(scene, of):
        if min((each.cost for each in forecasts), default=math.inf) <= _NEGLIGIBLE:
            break
        try:
            forecasts.append(_forecast(name, candidate, of))
            lines.append(forecasts[-1].in_words)
        except RoughmdrError as error:
            lines.append(f"{name}: {error}")
    if not forecasts:
        raise scene.located(SceneError.of([Fault("accuracy.of", "", f"cannot be computed: {'; '.join(lines)}")]))
    best = min(forecasts, key=lambda each: each.rank)
    reason = "the cheapest" if best.cost < math.inf else "nothing is right enough; the best"
    told = (f"{of.in_words} within {of.error_in_words(of.tolerance)}: {best.name}, {reason}", *lines)
    return best.plan._replace(choice=best.choice._replace(lines=told))


def _candidates(scene: Scene, of: Asked) -> Iterator[tuple[str, Scene]]:
    """Yield the methods that a scene leaves open and goes with, by name, about in the order of their cost."""
    source, swept = scene.asperities, {axis.key.partition(".")[0] for axis in scene.sweep.axes}
    told = {key for key in ("interaction", "reference") if key in swept or getattr(scene, key) is not None}
    asked_how = "interaction" in told  # which no grid answers
    reference = scene.stage(Reference)
    of_surface = "model" in type(source).model_fields
    told |= {"asperities"} if not of_surface or "model" in source.model_fields_set else set()
    for name, sections in _METHODS.items():
        if sections.keys() & told or ("reference" in told and sections) or ("reference" in sections and asked_how):
            continue
        own = {key: dict(entries) for key, entries in sections.items()}
        if "asperities" not in told:
            own = {"asperities": dict(_SUMMITS), **own}
        if "interaction" in own and not source.repeats:
            own["interaction"]["boundary"] = "free"
        if reference is not None and "error" not in reference.model_fields_set:
            own["reference"] = {}
        if "reference" in own and not of.absolute:
            if (answer := f"reference_{of.quantity}") not in OF_AREA:
                continue
            at_force = of.given in FORCES
            own["reference"]["error"] = Reference.error_for(answer, _GRID_SHARE * of.tolerance, at_force=at_force)
        with suppress(SceneError):  # which says why they do not go together
            candidate = read(scene, amend=partial(_add, sections=own))
            yield _name(name, candidate), candidate


def _add(table: dict[str, Any], sections: dict[str, dict[str, Any]]) -> None:
    """Add entries to sections of a table."""
    for key, entries in sections.items():
        table[key] = {**table.get(key, {}), **entries}


def _forecast(name: str, scene: Scene, of: Asked) -> _Forecast:
    """Return what a method would take and give; RoughmdrError where it cannot be foreseen."""
    plan = make_plan(scene)
    cells = [plan.cells[number] for number in some_cells(plan)]
    choice = Choice(of, _answer(scene, of), of.step(cells[0].controlled.values), ())
    error, scatter = np.array([_foreseen(cell, choice) for cell in cells]).max(axis=0).tolist()
    costs = [min(seconds(cell, estimator) for estimator in cell.scene.estimators) for cell in cells]
    return _Forecast(name, plan, choice, error, scatter, float(np.mean(costs)) * len(plan.cells))


def _foreseen(cell: Cell, choice: Choice) -> tuple[float, float]:
    """Return the error of the model and the scatter of a realisation of the quantity: relative [1], or of a length [m].

    The error is that of the grid where boundary elements answer.
    """
    of, names = choice.of, cell.controlled.variables([*cell.scene.output.variables])
    law, at_force = foresee_law(cell, names), of.given in FORCES
    values = {**law.variables, of.given: cell.controlled.values}
    scale = length(values["force"][choice.step], values["stiffness"][choice.step]) if of.absolute else 1.0
    scatter = law.area_sampling_error if at_force and not of.absolute else law.sampling_error
    reference = cell.scene.stage(Reference)
    if reference is None:
        error = choice.model_error(diagnostics_of(law, cell.scene), values)
    else:
        of_grid = reference.error_of(choice.variable, cell.scene.asperities.expected_count, at_force=at_force)
        error = scale * (of_grid + law.model_error.parts["slope_error"])
    return error, float(np.nan_to_num(scale * scatter))


def _answer(scene: Scene, of: Asked) -> str:
    """Return the variable that answers; SceneError where boundary elements do not have it."""
    if scene.stage(Reference) is None:
        return of.quantity
    name = f"reference_{of.quantity}"
    if name not in OF_AREA and not of.absolute:
        raise SceneError(f"accuracy.of.{of.quantity}: [reference] does not tell it")
    return name


def _name(name: str, scene: Scene) -> str:
    """Return the name of a method, which the scene itself may tell."""
    if scene.stage(Reference) is not None:
        return _GRID
    if scene.interaction is None or name != _ALONE:
        return name
    return {"pairwise": _PAIRS, "mean_field": _MEAN}[scene.interaction.model]
