"""Adhesive contacts of every shape: those far apart are those of the sum over independent ones."""

from typing import Any

import numpy as np
import pytest

import roughmdr as rm

SHAPES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": "50 um"},
    "cone": {"slope": 0.1},
    "power_law": {"exponent": 3.0, "width": "50 um", "rise": "30 um"},
    "sphere": {"radius": "50 um"},
    "flat_punch": {"radius": "2 um"},
    "truncated_cone": {"slope": 0.1, "flat_radius": "1 um"},
    "truncated_paraboloid": {"radius": "50 um", "flat_radius": "1 um"},
    "rounded_cone": {"slope": 0.1, "blend_radius": "2 um"},
    "capped_paraboloid": {"radius": "20 um", "cap_radius": "50 um", "blend_radius": "1 um"},
    "rounded_punch": {"flat_radius": "1 um", "edge_radius": "50 um"},
}
NAMES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy", "contact_radius_sum"]


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", SHAPES)
def test_contacts_far_apart_are_independent(shape: str) -> None:
    section = {
        "source": "random",
        "shape": shape,
        "count": 6,
        "patch": "1 m",
        "placement": "hard_core",
        "min_distance": "10 cm",
        "height": {"distribution": "normal", "std": "1 um"},
        **SHAPES[shape],
    }
    ensemble = rm.generate(section, seed=3)
    highest = float(ensemble.height.max())
    asked: dict[str, Any] = {
        "separation": np.append(np.linspace(highest + 2e-6, highest - 1.5e-6, 13), highest - 1.6e-6),
        "work": "20 mJ/m^2",
        "unload": True,
        "modulus": "3 MPa",
        "poisson": 0.49,
        "variables": NAMES,
    }
    alone = rm.load_separation(ensemble, **asked)
    coupled = rm.load_separation(ensemble, interaction={"model": "pairwise", "boundary": "free"}, **asked)
    assert float(coupled.marked_steps) == 0.0
    for name in NAMES:
        largest = float(np.abs(alone[name]).max())
        if name == "stiffness":  # near a fold it goes to infinity
            np.testing.assert_allclose(coupled[name], alone[name], rtol=1e-2, atol=1e-3 * largest)
        else:
            np.testing.assert_allclose(coupled[name], alone[name], rtol=0.0, atol=2e-4 * largest)
    assert float(coupled.pull_off_force) == pytest.approx(float(alone.pull_off_force), rel=1e-4)
    assert float(coupled.avalanche_count) == 2.0 * float(alone.contact_count.max())
