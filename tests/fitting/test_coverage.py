"""The true parameters are in the stated 95 % intervals as often as stated."""

import numpy as np
import pytest
from forms import large
from measurements import CASES, inside, noise_of

import roughmdr as rm

FAST = 10


@pytest.mark.large
@pytest.mark.parametrize("stated", [False, large(True)], ids=["unstated", "stated"])
@pytest.mark.parametrize("noise", [large("constant"), "proportional"])
@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("elastic", FAST),
        *(pytest.param(name, 40, marks=pytest.mark.large) for name in ("adhesive", "elastic", "zero")),
        pytest.param("machine", 10, marks=pytest.mark.large),
    ],
)
def test_intervals_hold_the_true_values(name: str, count: int, noise: str, stated: bool) -> None:
    case = CASES[name]
    force = case.force()
    deviation = noise_of(noise, force)
    rng = np.random.default_rng(1)
    spread = 1.2 if count == FAST else 3.0
    hits = dict.fromkeys(case.true, 0)
    for seed in range(count):
        measured = case.measure(deviation, force, seed)
        if stated:
            measured["force_error"] = deviation
        start = case.start({key: spread ** rng.uniform(-1.0, 1.0) for key in case.true})
        fit = rm.fit(measured, case.scene, case.true, set=start)
        for key, value in case.true.items():
            hits[key] += inside(fit, key, value)
    low = 0.95 * count - 3.0 * np.sqrt(0.05 * 0.95 * count)
    assert min(hits.values()) >= low, hits
