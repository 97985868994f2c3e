"""The force alone is that of the whole law, also by a rule that was found for parameters nearby."""

from typing import Any

import numpy as np
import pytest

import roughmdr as rm
from roughmdr.aggregate import LoadingPath
from roughmdr.expected import expected_force
from roughmdr.scene import read

LOOP = np.concatenate([np.linspace(3.0, -0.5, 9), np.linspace(-0.4, 3.5, 9)])
NEARBY = 1e-4  # relative change of the parameters


def scene(sigma: float, modulus: float, radius: Any, work: float) -> dict[str, Any]:
    """Adhesion is in terms of modulus and the spread of heights."""
    adhesion = {"adhesion": {"model": "jkr", "work": work * modulus * sigma}} if work else {}
    return adhesion | {
        "title": "Rough",
        "material": {"effective_modulus": modulus},
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": 40, "patch": 1e3 * sigma, "radius": radius,
            "height": {"distribution": "normal", "std": sigma},
        },
    }  # fmt: skip


@pytest.mark.parametrize(("sigma", "modulus"), [(1e-8, 1e11), (1e-3, 1e5)])
@pytest.mark.parametrize(("spread", "work"), [(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.3, 0.3)])
def test_it_is_that_of_the_whole_law(sigma: float, modulus: float, spread: float, work: float) -> None:
    drawn = {"distribution": "lognormal", "mean": 30.0 * sigma, "std": 30.0 * spread * sigma}
    table = scene(sigma, modulus, drawn if spread else 30.0 * sigma, work)
    path = {"path": {"separation": (sigma * LOOP).tolist()}, "batch": {"estimator": "expected"}}
    whole = rm.run(table | path).force.to_numpy().ravel()
    own, along = read(table | path), LoadingPath.along(sigma * LOOP, unload=False, adhesive=work > 0.0)
    force = expected_force(own.asperities, along, own.effective_modulus, own.adhesion_model)
    assert force.force == pytest.approx(whole, rel=1e-11, abs=1e-11 * np.abs(whole).max())
    assert 0.0 < force.error < 1e-6
    near = read(table | path, {"asperities.height.std": (1.0 + NEARBY) * sigma})
    given = near.asperities, along, (1.0 + NEARBY) * near.effective_modulus, near.adhesion_model
    fresh, held = expected_force(*given), expected_force(*given, force.rule)
    assert held.force == pytest.approx(fresh.force, abs=1e-9 * np.abs(whole).max())
    assert not np.array_equal(held.force, force.force)
