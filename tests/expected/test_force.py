"""The force alone is that of the whole law, also by a rule that was found for parameters nearby."""

from typing import Any

import numpy as np
import pytest
from forms import large

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


@pytest.mark.few(2)
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


TIP = {"shape": "paraboloid", "radius": "1 um"}
DRAWN = {"distribution": "lognormal", "mean": "1 um", "std": "0.2 um"}
ON_A_BASE = {"shape": "tabulated", "r": [0.0, 1e-6, 2e-6, 9e-6, 12e-6], "f": [0.0, 0.3e-6, 0.5e-6, 1.2e-6, 3.2e-6]}


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("shape", "adhesion"),
    [
        (TIP, {"model": "jkr", "work": 0.05}),
        (TIP, {"model": "dugdale", "work": 0.05, "range": "100 nm"}),
        large(ON_A_BASE, {"model": "jkr", "work": 0.02}),
        large(ON_A_BASE, {"model": "jkr", "work": 0.2}),
        large(TIP | {"radius": DRAWN}, {"model": "jkr", "work": 0.05}),
    ],
    ids=["jkr", "dugdale", "on a base", "sticky on a base", "drawn"],
)
def test_contact_is_made_and_lost_where_finer_steps_show_it(shape: dict[str, Any], adhesion: dict[str, Any]) -> None:
    """On random paths, by the first step in contact or the first out of it in paths that are finer there."""
    own = read(
        {
            "title": "Tips",
            "material": {"effective_modulus": "3 MPa"},
            "adhesion": adhesion,
            "asperities": {"source": "random", "count": 1, "patch": "1 mm", "height": "30 nm"} | shape,
            "path": {"separation": [0.0]},
        }
    )

    def law(path: Any) -> Any:
        along = LoadingPath.along(path, unload=False, adhesive=True)
        return expected_force(own.asperities, along, own.effective_modulus, own.adhesion_model)

    seen, drawn = set(), shape.get("radius") is DRAWN  # contacts of drawn shapes are lost one by one
    for seed in range(6):
        path = 1e-6 * np.cumsum(np.random.default_rng(seed).normal(0.0, 0.4, 40)) + 2e-7
        force, _, (step, place, _), _ = law(path)
        changed = np.flatnonzero(np.diff((force != 0.0).astype(int)))
        assert step.tolist() == changed[(force[changed + 1] != 0.0) | (not drawn)].tolist()
        for m, expected in zip(step.tolist(), place.tolist(), strict=True):
            finer = np.linspace(path[m], path[m + 1], 1001)
            touching = law(np.append(path[:m], finer)).force[m:] != 0.0
            first = int(np.flatnonzero(touching != touching[0])[0])
            low, high = sorted(finer[first - 1 : first + 1])
            assert low - 1e-15 <= expected <= high + 1e-15
            seen.add(bool(touching[0]))
    assert seen == ({False} if drawn else {False, True})
