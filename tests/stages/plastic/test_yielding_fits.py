"""A yield strength that is fitted to a measured curve of loading and unloading."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import roughmdr as rm

KEY = "plasticity.yield_strength"
SCENE: dict[str, Any] = {
    "title": "Plates",
    "material": {"modulus": "70 GPa", "poisson": 0.33},
    "asperities": {
        "source": "random", "shape": "paraboloid", "count": 1000, "patch": "1 mm", "radius": "50 um",
        "height": {"distribution": "normal", "std": "1 um"},
    },
    "path": {"separation": {"start": "3 sigma", "stop": "1.5 sigma", "steps": 30}, "unload": True},
    "batch": {"estimator": "expected"},
    "output": {"variables": ["force"]},
}  # fmt: skip


def fit(start: str) -> Any:
    law = rm.run({**SCENE, "plasticity": {"yield_strength": "300 MPa"}})
    force = law.force.to_numpy().ravel()
    noise = 0.01 * force.max() * np.random.default_rng(2).normal(size=force.size)
    measured = pd.DataFrame({"separation": law.separation.to_numpy(), "force": force + noise})
    return rm.fit(measured, {**SCENE, "plasticity": {"yield_strength": start}}, free=[KEY])


@pytest.mark.filterwarnings("ignore")
def test_the_strength_is_found_within_its_error() -> None:
    found = fit("150 MPa")
    error = float(found.plasticity_yield_strength_standard_error)
    assert error < 5e6
    assert abs(float(found.plasticity_yield_strength) - 3e8) < 3.5 * error


def test_a_search_that_begins_where_nothing_yields_says_so() -> None:
    with pytest.warns(rm.LimitWarning, match="no contact of the fitted law yields"):
        fit("30 GPa")
