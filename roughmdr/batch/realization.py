"""One realisation of a cell: its asperities are drawn, or their density taken, and their law is computed."""

from typing import Any

from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.ensemble import Ensemble
from roughmdr.loading.machine import MachinePath
from roughmdr.scene import Scene
from roughmdr.variables import REFERENCE_VARIABLES


def simulate_ensemble(
    scene: Scene, path: LoadingPath | MachinePath, ensemble: Ensemble, variables: list[str]
) -> LoadSeparation:
    """Return the load-separation curve of an ensemble with the material, adhesion and interaction of a scene."""
    return simulate(
        ensemble,
        path,
        effective_modulus=scene.effective_modulus,
        adhesion=scene.adhesion_model,
        interaction=scene.interaction_model,
        variables=variables,
    )


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
        "variables": variables,
    }
    if scene.nominal is not None:
        from roughmdr.layer import curved

        assert isinstance(path, LoadingPath)  # as ``Scene`` validates
        layer = curved.Layer(scene.asperities, scene.effective_modulus, scene.adhesion_model)
        return curved.compute(layer, scene.nominal.body, path, error=scene.nominal.error, variables=variables)
    if isinstance(path, MachinePath):
        return compute_under_machine(scene.asperities, path, **given)
    return expected.compute(scene.asperities, path, **given)
