"""One realisation of a cell: its asperities are drawn, or their density taken, and their law is computed."""

from roughmdr.aggregate import LoadingPath, LoadSeparation, compute
from roughmdr.ensemble import Ensemble
from roughmdr.scene import Scene


def simulate_ensemble(scene: Scene, path: LoadingPath, ensemble: Ensemble, variables: list[str]) -> LoadSeparation:
    """Return the load-separation curve of an ensemble with the material and the adhesion of a scene."""
    effective_modulus, adhesion = scene.effective_modulus, scene.adhesion_model
    return compute(ensemble, path, effective_modulus=effective_modulus, adhesion=adhesion, variables=variables)


def simulate_realization(
    scene: Scene, path: LoadingPath, realization: int, variables: list[str], estimator: str
) -> LoadSeparation:
    """Return the load-separation curve of one realisation of a scene without a sweep, by an estimator."""
    if estimator == "expected":
        from roughmdr import expected

        modulus, adhesion = scene.effective_modulus, scene.adhesion_model
        return expected.compute(
            scene.asperities, path, effective_modulus=modulus, adhesion=adhesion, variables=variables
        )
    ensemble = scene.asperities.ensemble(scene.seed, realization, stratified=estimator == "stratified")
    return simulate_ensemble(scene, path, ensemble, variables)
