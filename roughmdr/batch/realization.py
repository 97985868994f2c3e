"""One realisation of a cell: its asperities are drawn, or their density taken, and their law is computed."""

from collections.abc import Callable
from typing import Any

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.ensemble import Ensemble
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.variables import REFERENCE_VARIABLES

_NEGLIGIBLE = 1e-16  # mean number of asperities above the highest summit of an expected law


def simulate_ensemble(
    scene: Scene, path: LoadingPath | MachinePath, ensemble: Ensemble, variables: list[str]
) -> LoadSeparation:
    """Return the load-separation curve of an ensemble with the material, adhesion and interaction of a scene."""

    def along(path: LoadingPath | MachinePath, variables: list[str]) -> LoadSeparation:
        return simulate(
            ensemble,
            path,
            effective_modulus=scene.effective_modulus,
            adhesion=scene.adhesion_model,
            interaction=scene.interaction_model,
            variables=variables,
        )

    if scene.viscoelastic is None:
        return along(path, variables)
    highest = float(ensemble.height.max(initial=-np.inf))
    return _viscoelastic(scene, path, variables, along, highest, ensemble.nominal_area)


def simulate_realization(
    scene: Scene, path: LoadingPath | MachinePath, realization: int, variables: list[str], estimator: str
) -> LoadSeparation:
    """Return the load-separation curve of one realisation of a scene without a sweep, by an estimator."""
    if estimator == "expected":
        return _expected(scene, path, variables)
    placed = scene.needs_positions or scene.reference is not None
    ensemble = scene.asperities.ensemble(
        scene.seed, realization, stratified=estimator == "stratified", with_positions=placed
    )
    if scene.reference is None:
        return simulate_ensemble(scene, path, ensemble, variables)
    from roughmdr.batch.reference import with_reference

    assert isinstance(path, LoadingPath)  # as ``Scene`` validates
    asked = [name for name in variables if name not in REFERENCE_VARIABLES]
    law = simulate_ensemble(scene, path, ensemble, asked)
    return with_reference(law, scene, path.separation, realization, ensemble).only(variables)


def _expected(scene: Scene, path: LoadingPath | MachinePath, variables: list[str]) -> LoadSeparation:
    """Return the expected law of a scene without a sweep."""
    from roughmdr import expected
    from roughmdr.expected.under_machine import compute_under_machine

    given: dict[str, Any] = {
        "effective_modulus": scene.effective_modulus,
        "adhesion": scene.adhesion_model,
        "interaction": scene.interaction_model,
    }
    if isinstance(path, MachinePath):
        return compute_under_machine(scene.asperities, path, **given, variables=variables)

    def along(path: LoadingPath, variables: list[str]) -> LoadSeparation:
        return expected.compute(scene.asperities, path, **given, variables=variables)

    if scene.viscoelastic is None:
        return along(path, variables)
    source = scene.asperities
    highest = source.extremes(_NEGLIGIBLE / max(source.expected_count, 1.0)).height.max()
    return _viscoelastic(scene, path, variables, along, float(highest), source.nominal_area)


def _viscoelastic(
    scene: Scene,
    path: LoadingPath | MachinePath,
    variables: list[str],
    along: Callable[[LoadingPath, list[str]], LoadSeparation],
    highest: float,
    area: float | None,
) -> LoadSeparation:
    """Return the viscoelastic law of asperities whose elastic law is that ``along`` a path."""
    from roughmdr.batch.viscoelastic import law_of

    assert isinstance(path, LoadingPath)  # as ``Scene`` validates

    def elastic(separation: Floats, names: list[str]) -> LoadSeparation:
        return along(LoadingPath.along(separation, unload=False, adhesive=False), names)

    return law_of(scene, path.separation, variables, elastic, highest, area)
