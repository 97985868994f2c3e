"""A Problem finds all that follows from an ensemble and its material once, whatever is asked of it."""

from collections import Counter
from typing import Any

import numpy as np
import pytest
from scenes import ASPERITIES

import roughmdr as rm
from roughmdr.aggregate import LoadingPath, Problem, problem, simulate
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import MachinePath

E, W = 4e6, 0.05
ADHESIONS = {
    "none": Adhesion(),
    "jkr": Adhesion(W),
    "jkr of a known range": Adhesion(W, "jkr", 1e8),
    "dugdale": Adhesion(W, "dugdale", 1e8),
    "auto": Adhesion(W, "auto", 1e8, 0.01),
}
VARIABLES = ["force", "dissipated_energy", "machine_dissipated_energy"]


def paths(adhesive: bool) -> list[LoadingPath | MachinePath]:
    """Separations there and back, a dead load that pulls the flat off, and a spring."""
    force, remote = np.array([0.0, 1e-4, -1e-3]), np.array([4e-6, 0.0, 4e-6])
    return [
        LoadingPath.along(np.array([4e-6, 1e-6, 0.0, 1e-6, 9e-6]), unload=False, adhesive=adhesive),
        MachinePath.along("force", force, adhesive=adhesive),
        MachinePath.along("remote", remote, machine_stiffness=1e3, adhesive=adhesive),
    ]


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often each thing was found for all asperities."""
    counts = Counter[str]()
    detachments, validity, columns = problem.detachments, problem.jkr_validity, Ensemble.columns.func

    def of_ensemble(self: Ensemble) -> Any:
        counts["columns"] += 1
        return columns(self)

    def of_kernels(kernels: Any, columns: Any, *given: Any) -> Any:
        counts[f"detachments by {kernels.name}"] += columns.width.size == 50
        return detachments(kernels, columns, *given)

    def of_adhesion(*given: Any) -> Any:
        counts["validity"] += 1
        return validity(*given)

    monkeypatch.setattr(Ensemble.columns, "func", of_ensemble)
    monkeypatch.setattr(problem, "detachments", of_kernels)
    monkeypatch.setattr(problem, "jkr_validity", of_adhesion)
    return counts


@pytest.mark.parametrize(
    "adhesion",
    [pytest.param(each, marks=[pytest.mark.large] * (name == "dugdale"), id=name) for name, each in ADHESIONS.items()],
)
def test_all_is_found_once(adhesion: Adhesion, counted: Counter[str]) -> None:
    data = rm.generate({**ASPERITIES, "count": 50}, seed=3)
    one = Problem(Ensemble.from_dataset(data), E, adhesion)
    counted.clear()
    laws = [simulate(one, path, VARIABLES) for path in paths(adhesion.work > 0.0)]
    assert set(counted.values()) <= {0, 1}, counted
    assert counted["columns"] == counted["validity"] == 1
    fresh = [
        simulate(Problem(Ensemble.from_dataset(data), E, adhesion), path, VARIABLES)
        for path in paths(adhesion.work > 0.0)
    ]
    for law, alone in zip(laws, fresh, strict=True):
        for name in VARIABLES:
            np.testing.assert_array_equal(law.variables[name], alone.variables[name])
        assert law.pull_off == alone.pull_off or np.isnan(law.pull_off.force)
