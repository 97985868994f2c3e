"""One realisation of a cell: its asperities are drawn, or their density taken, and their law is computed."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation, Problem, simulate
from roughmdr.aggregate.yielding import yielding
from roughmdr.ensemble import Ensemble
from roughmdr.loading.lateral import LateralPath, Path
from roughmdr.loading.machine import MachinePath
from roughmdr.scene import Scene
from roughmdr.stages.stage import Contacts

_NEGLIGIBLE = 1e-16  # mean number of asperities above the highest summit of an expected law
_MOST_DRAWN = 100_000  # number of asperities that are drawn evenly to tell which contacts of an expected law yield


def simulate_ensemble(
    scene: Scene, path: Path, ensemble: Ensemble, variables: list[str], realization: int | None = None
) -> LoadSeparation:
    """Return the law of an ensemble with the material, adhesion, interaction and stages of a scene.

    ``realization`` is the number of a whole realisation, and None of a part of one, beside which nothing is computed.
    """
    return simulate_problem(scene, path, problem_of(scene, ensemble), variables, realization)


def problem_of(scene: Scene, ensemble: Ensemble) -> Problem:
    """Return an ensemble with the material, adhesion and interaction of a scene, under its body."""
    return Problem(scene.pressed(ensemble), scene.effective_modulus, scene.adhesion_model, scene.interaction)


def simulate_problem(
    scene: Scene, path: Path, problem: Problem, variables: list[str], realization: int | None = None
) -> LoadSeparation:
    """Return the law of a problem with the stages of a scene, ``realization`` as ``simulate_ensemble``."""
    ensemble = problem.ensemble

    def law(path: Path, names: list[str]) -> LoadSeparation:
        assert not isinstance(path, LateralPath)  # which a stage resolves
        return simulate(problem, path, names)

    def highest() -> float:
        return float(ensemble.height.max(initial=-np.inf))

    contacts = Contacts(law, highest, ensemble.nominal_area, problem, realization)
    return _staged(scene, path, variables, contacts, lambda: problem)


def simulate_realization(
    scene: Scene, path: Path, realization: int, variables: list[str], estimator: str
) -> LoadSeparation:
    """Return the load-separation curve of one realisation of a scene without a sweep, by an estimator."""
    if estimator == "expected":
        return _expected(scene, path, variables)
    ensemble = scene.asperities.ensemble(
        scene.seed, realization, stratified=estimator == "stratified", with_positions=scene.placed
    )
    return simulate_ensemble(scene, path, ensemble, variables, realization)


def _expected(scene: Scene, path: Path, variables: list[str]) -> LoadSeparation:
    """Return the expected law of a scene without a sweep."""
    from roughmdr import expected
    from roughmdr.expected.under_machine import compute_under_machine

    source = scene.asperities
    given: dict[str, Any] = {
        "effective_modulus": scene.effective_modulus,
        "adhesion": scene.adhesion_model,
        "interaction": scene.interaction,
    }

    def law(path: Path, names: list[str]) -> LoadSeparation:
        assert not isinstance(path, LateralPath)  # which a stage resolves
        if isinstance(path, MachinePath):
            return compute_under_machine(source, path, **given, variables=names)
        return expected.compute(source, path, **given, variables=names)

    def highest() -> float:
        return float(source.extremes(_NEGLIGIBLE / max(source.expected_count, 1.0)).height.max())

    def drawn() -> Problem:
        alone = scene.interaction is not None and scene.interaction.boundary == "free"  # a smaller patch sinks less
        part = source if alone else source.limited_to(_MOST_DRAWN)
        return Problem(part.ensemble(scene.seed, 0, stratified=True), *given.values())

    return _staged(scene, path, variables, Contacts(law, highest, source.nominal_area), drawn)


def _staged(
    scene: Scene, path: Path, variables: list[str], contacts: Contacts, drawn: Callable[[], Problem]
) -> LoadSeparation:
    """Return the law that the stages of a scene make of that of its contacts, which are, or are like, those ``drawn``.

    With a hardness it tells which of these yield, once it is asked.
    """
    for stage in scene.stages:
        contacts = contacts._replace(law=stage.law(scene, contacts))
    law, hardness = contacts.law(path, variables).only(variables), scene.material.hardness
    if hardness is None:
        return law

    @cache
    def found() -> dict[str, float]:
        separation = path.separation if isinstance(path, LoadingPath) else law.variables["separation"]
        solved = separation[~np.isnan(next(iter(law.variables.values())))]  # NaN where there is no equilibrium
        return yielding(drawn(), hardness, float(solved.min(initial=np.inf)))

    return law._replace(yielding=found)
