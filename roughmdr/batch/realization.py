"""One realisation of a cell: its asperities are drawn, or their density taken, and their law is computed."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.ensemble import Ensemble
from roughmdr.layer.conductance import of_contacts, with_conductances
from roughmdr.layer.tangential import NormalLaw, Path, with_tangential
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.variables import REFERENCE_VARIABLES

_NEGLIGIBLE = 1e-16  # mean number of asperities above the highest summit of an expected law


class _Contacts(NamedTuple):
    """The elastic contacts of a rough layer."""

    law: NormalLaw
    highest: Callable[[], float]
    """The height of the highest summit [m]; -inf where there is none."""


def simulate_ensemble(scene: Scene, path: Path, ensemble: Ensemble, variables: list[str]) -> LoadSeparation:
    """Return the load-separation curve of an ensemble with the material, adhesion and interaction of a scene."""

    def law(path: LoadingPath | MachinePath, variables: list[str]) -> LoadSeparation:
        return simulate(
            ensemble,
            path,
            effective_modulus=scene.effective_modulus,
            adhesion=scene.adhesion_model,
            interaction=scene.interaction_model,
            variables=variables,
        )

    contacts = _Contacts(law, lambda: float(ensemble.height.max(initial=-np.inf)))
    return _layered(scene, path, variables, contacts, ensemble.nominal_area)


def simulate_realization(
    scene: Scene, path: Path, realization: int, variables: list[str], estimator: str
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


def _expected(scene: Scene, path: Path, variables: list[str]) -> LoadSeparation:
    """Return the expected law of a scene without a sweep."""
    from roughmdr import expected
    from roughmdr.expected.under_machine import compute_under_machine

    source = scene.asperities
    if scene.nominal is not None:
        from roughmdr.layer import curved

        assert isinstance(path, LoadingPath)  # as ``Scene`` validates
        layer = curved.Layer(source, scene.effective_modulus, scene.adhesion_model)
        return curved.compute(layer, scene.nominal.body, path, error=scene.nominal.error, variables=variables)
    given: dict[str, Any] = {
        "effective_modulus": scene.effective_modulus,
        "adhesion": scene.adhesion_model,
        "interaction": scene.interaction_model,
    }

    def law(path: LoadingPath | MachinePath, variables: list[str]) -> LoadSeparation:
        if isinstance(path, MachinePath):
            return compute_under_machine(source, path, **given, variables=variables)
        return expected.compute(source, path, **given, variables=variables)

    def highest() -> float:
        return float(source.extremes(_NEGLIGIBLE / max(source.expected_count, 1.0)).height.max())

    return _layered(scene, path, variables, _Contacts(law, highest), source.nominal_area)


def _layered(scene: Scene, path: Path, variables: list[str], contacts: _Contacts, area: float | None) -> LoadSeparation:
    """Return the law of a scene from that of its elastic contacts, on a nominal area [m2]."""
    asked = of_contacts(variables)
    if scene.viscoelastic is None:
        law = with_tangential(scene, contacts.law, path, asked)
    else:
        from roughmdr.batch.viscoelastic import law_of

        assert isinstance(path, LoadingPath)  # as ``Scene`` validates

        def elastic(separation: Floats, names: list[str]) -> LoadSeparation:
            return contacts.law(LoadingPath.along(separation, unload=False, adhesive=False), names)

        law = law_of(scene, path.separation, asked, elastic, contacts.highest(), area)
    return with_conductances(law, scene.conductance_factors).only(variables)
