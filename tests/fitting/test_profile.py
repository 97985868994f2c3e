"""Ends of intervals by the profile of the sum of squares: as scipy finds them, at bounds too, and only where needed."""

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import norm
from tips import MODULUS, OFFSET, WORK, Floats, Tip

import roughmdr as rm


def few(noise: float, seed: int) -> tuple[Tip, pd.DataFrame]:
    """Twelve points of a sphere, of which four are before the contact."""
    tip = Tip("hertz", 1e-7, 1e6)
    return tip, tip.measure(np.random.default_rng(seed), 12, ("constant", noise), 0.0)


def ends(fit: object, key: str) -> Floats:
    name = key.replace(".", "_")
    return np.array([float(fit[f"{name}{end}"]) for end in ("_low", "", "_high")])  # type: ignore[index]


@pytest.mark.parametrize("seed", range(3))
def test_ends_are_those_of_a_brute_search(seed: int) -> None:
    """Where the parabola is off, an end is where scipy's least sum of squares over the modulus has risen enough."""
    tip, frame = few(0.03, seed)
    fit = rm.fit(frame, tip.scene(), [MODULUS, OFFSET])

    def least(offset: float) -> float:
        depth = -(frame.separation.to_numpy() + offset)
        law = tip.law(1.0, 0.0, depth) / frame.force_error.to_numpy()
        load = (frame.force / frame.force_error).to_numpy()
        scale = max(float(law @ load) / max(float(law @ law), 1e-300), 0.0)
        return float(np.sum(np.square(load - scale * law)))

    low, best, high = ends(fit, OFFSET)
    found = minimize_scalar(least, bounds=(best - 2e-8, best + 2e-8), method="bounded", options={"xatol": 1e-14})
    goal = found.fun + norm.ppf(0.975) ** 2
    by_scipy = [brentq(lambda x: least(x) - goal, found.x, found.x + side * 6e-8) for side in (-1.0, 1.0)]
    tolerance = 0.01 if "by profile likelihood" in fit.attrs["intervals"] else 0.12
    assert [low - best, high - best] == pytest.approx([each - found.x for each in by_scipy], rel=tolerance)


def test_a_good_parabola_stays() -> None:
    tip, frame = few(0.001, 1)
    fit = rm.fit(frame, tip.scene(), [MODULUS, OFFSET])
    assert "profile" not in fit.attrs["intervals"]
    low, best, high = ends(fit, OFFSET)
    assert high - best == pytest.approx(best - low, rel=1e-9)


def test_work_under_loading_alone_has_an_uneven_interval_that_is_told() -> None:
    tip = Tip("jkr", 1e-7, 1e6)
    frame = tip.measure(np.random.default_rng(3), 120, ("constant", 0.05), 0.0).iloc[:60]
    fit = rm.fit(frame, tip.scene(), [MODULUS, WORK])
    assert "; by profile likelihood for adhesion.work" in fit.attrs["intervals"]
    low, best, high = np.log(ends(fit, WORK))
    assert abs((high - best) / (best - low) - 1.0) > 0.05
    assert ends(fit, WORK)[0] < tip.work < ends(fit, WORK)[2]


def test_a_bound_of_the_scene_ends_an_interval() -> None:
    """Poisson's ratio ends at 0.5."""
    tip, frame = few(0.1, 2)
    scene = tip.scene(material={"modulus": 1e6, "poisson": 0.4})
    fit = rm.fit(frame, scene, ["material.poisson"])
    low, best, high = ends(fit, "material.poisson")
    assert low <= best <= high <= 0.5
