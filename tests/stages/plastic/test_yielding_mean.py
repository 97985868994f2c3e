"""The mean over asperities that yield: integrals over quantiles, draws, its error; machines on it and on draws."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import example, given, settings, strategies as st
from scipy import optimize, stats

from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import AREA, COUNT, DISSIPATED, ENERGY, ERROR, FORCE
from roughmdr.ensemble import Ensemble
from roughmdr.errors import TooMuchContact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import MachinePath, Preload, travel
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss
from roughmdr.scene.read import read
from roughmdr.stages.plastic.body import LIMIT, Body
from roughmdr.stages.plastic.drawn import DrawnAsperities
from roughmdr.stages.plastic.law import plastic_law
from roughmdr.stages.plastic.mean import MeanAsperities
from roughmdr.stages.plastic.models import kernels_of
from roughmdr.stages.plastic.total import rows_of

R, STD, E, MOST = 50e-6, 1e-6, 1e9, 1000
ROWS = {FORCE, AREA, COUNT, ENERGY, DISSIPATED, ERROR}
FAMILIES: dict[str, tuple[Any, dict[str, float]]] = {
    "normal": (stats.norm, {}),
    "uniform": (stats.uniform, {}),
    "exponential": (stats.expon, {}),
    "beta": (stats.beta, {"a": 0.5, "b": 0.4}),
    "lognorm": (stats.lognorm, {"s": 0.5}),
}
WAY = np.array([-0.5, -1.5, -3.0, -2.9, -2.4, -1.0, -2.5, -3.5, -3.3])  # from the highest of a thousand [STD]


def heights_of(family: str) -> tuple[Any, dict[str, Any]]:
    """Return heights with mean 0 and a standard deviation, as scipy has them and as a scene has."""
    kind, own = FAMILIES[family]
    scale = STD / kind(**own).std()
    return kind(**own, loc=-scale * kind(**own).mean(), scale=scale), {"distribution": family, **own, "std": STD}


def source(height: Any, radius: Any = R, shape: str = "paraboloid", count: int = MOST) -> Any:
    section = {"source": "random", "count": count, "patch": "1 cm", "shape": shape, "radius": radius, "height": height}
    scene = {"material": {"effective_modulus": E}, "asperities": section, "path": {"separation": [STD, 0]}}
    return read(scene).asperities


def body(stiff: float, squared: float = 0.0) -> Body:
    return Body(E, E / stiff, 0.0, 0.3, math.inf, squared)


def by_quantiles(family: str, model: str, of: Body, path: Floats) -> Floats:
    """Force, area and dissipated energy [quantity, step] of all asperities, as integrals over their fraction."""
    raw, kernels, (nodes, weights) = heights_of(family)[0], kernels_of(model, of), gauss(80)
    row, half = rows_of(kernels, np.array([R]), of)[0], 0.5 * np.pi * (1.0 + nodes)
    found = np.zeros((3, path.size))
    for step, (h, lowest) in enumerate(zip(path.tolist(), np.minimum.accumulate(path).tolist(), strict=True)):

        def left(z: float, lowest: float = lowest, rise: float = h - lowest) -> float:
            return float(kernels.ends(z - lowest, kernels.mark(z - lowest, row, of), row, of)[0]) - rise

        ends, top = [h, lowest, *(lowest + row[LIMIT] * kink for kink in (1.0, *kernels.kinks))], raw.isf(1e-18)
        begin = max(h, ends[2] + 1e-20)
        if begin < top and left(begin) < 0.0 < left(top):
            ends.append(optimize.brentq(left, begin, top, xtol=1e-22))
        cuts = sorted({0.0, *raw.sf(ends).tolist(), *np.geomspace(1e-18, raw.sf(lowest), 30).tolist()})
        for first, last in pairwise(cuts):
            fraction = first + (last - first) * np.sin(0.5 * half) ** 2
            share = MOST * (last - first) * 0.25 * math.pi * np.sin(half) * weights
            for z, part in zip(raw.isf(fraction).tolist(), share.tolist(), strict=True):
                if z > lowest:
                    mark = kernels.mark(z - lowest, row, of)
                    contact = kernels.state(z - h, h - lowest, mark, row, of)
                    found[2, step] += part * kernels.lost(z - lowest, mark, row, of) if model == "mdr" else 0.0
                    found[:2, step] += part * np.array([contact.force, math.pi * contact.radius**2])
    return found


@pytest.mark.few(1)
@pytest.mark.parametrize("stiff", [30.0, large(1000.0)])
@pytest.mark.parametrize("family", ["normal", "beta", *map(large, ("uniform", "exponential", "lognorm"))])
@pytest.mark.parametrize("model", ["mdr", *map(large, ("jackson-green", "kogut-etsion"))])
def test_the_mean_is_the_integral_over_quantiles(model: str, family: str, stiff: float) -> None:
    raw, height = heights_of(family)
    path = float(raw.isf(1e-3)) + WAY * STD
    rows, mean = ROWS if model == "mdr" else ROWS - {DISSIPATED}, MeanAsperities(source(height), model, body(stiff))
    found, exact = mean.totals(path, rows), by_quantiles(family, model, body(stiff), path)
    largest, error = exact.max(axis=1), found[ERROR]
    assert (np.abs(found[FORCE] - exact[0]) <= np.minimum(error, 1e-9 * largest[0]) + 1e-11 * largest[0]).all()
    np.testing.assert_allclose(found[AREA], exact[1], rtol=0.0, atol=3e-9 * largest[1])
    if model == "mdr":
        np.testing.assert_allclose(found[DISSIPATED], exact[2], rtol=0.0, atol=1e-11 * largest[2])


RADII = [
    {"distribution": "lognormal", "mean": R, "std": 0.2 * R},
    {"distribution": "exponential", "loc": 0.1 * R, "std": 0.4 * R},
]


@pytest.mark.large
@example("mdr", 300.0, 0.0, RADII[1], [0.1, 0.5, 1.5, 1.45, 1.0])  # equal heights, of which some yield
@given(
    st.sampled_from(["mdr", "jackson-green", "kogut-etsion"]),
    st.floats(1.0, 4.0).map(lambda power: 10.0**power),
    st.sampled_from([*FAMILIES]).map(lambda family: heights_of(family)[1]),
    st.sampled_from([R, *RADII]),
    st.lists(st.floats(-0.5, 3.0), min_size=2, max_size=5),
)
@settings(deadline=None, max_examples=60)
def test_the_stated_error_is_a_bound(model: str, stiff: float, height: Any, radius: Any, way: list[float]) -> None:
    drawn = source(height, radius)
    path = drawn.extremes(1e-3).height.max() - STD * np.array(way)
    mean = MeanAsperities(drawn, model, body(stiff))
    law = mean.law(LoadingPath.along(path, unload=False, adhesive=False), ["force"])
    exact = mean._at_order(path, {FORCE}, 256)[FORCE]
    assert np.abs(law.variables["force"] - exact).max() <= law.numerical_error * np.abs(exact).max() * (1.0 + 1e-3)


@pytest.mark.large
def test_the_mean_is_that_of_many_draws() -> None:
    drawn = source(heights_of("normal")[1], RADII[0])
    path = drawn.extremes(1e-3).height.max() + WAY * STD
    mean = MeanAsperities(drawn, "mdr", body(100.0))._converged(path, ROWS)[0]
    count = 1_000_000
    ensemble = source(heights_of("normal")[1], RADII[0], count=count).ensemble(1, 0, stratified=True)
    problem = Problem(ensemble, E, Adhesion(0.0))
    many = DrawnAsperities(problem, "mdr", body(100.0)).totals(path, ROWS) * MOST / count
    for row in (FORCE, AREA, COUNT, ENERGY, DISSIPATED):
        np.testing.assert_allclose(many[row], mean[row], rtol=0.0, atol=1e-3 * np.abs(mean[row]).max())


@pytest.mark.parametrize("shape", ["sphere", large("paraboloid")])
def test_asperities_are_pressed_at_most_to_their_centre(shape: str) -> None:
    """The highest of a sample and of a mean count; nodes of the mean that nobody takes do not."""
    drawn, of = source(heights_of("normal")[1], 8e-6, shape), body(30.0, float(shape == "sphere"))
    highest = drawn.ensemble(0, 0, stratified=True)
    for asperities in (
        MeanAsperities(drawn, "mdr", of),
        DrawnAsperities(Problem(highest, E, Adhesion(0.0)), "mdr", of),
    ):
        near, far = (LoadingPath.along(np.array([h * STD]), unload=False, adhesive=False) for h in (-3.0, -7.0))
        assert np.isfinite(asperities.law(near, ["force"]).variables["force"]).all()
        with pytest.raises(TooMuchContact, match=r"it must be at most 0\.9 of the radius"):
            asperities.law(far, ["force"])
        assert np.isfinite(asperities.totals(far.separation, {FORCE})[FORCE]).all()  # a search may look there


PATCH, K = 1e-4, 1e6
LOADS = np.array([0.0, 1e-3, 0.1, 5.0, 2.0, 0.1, 1e-3, 0.0, 0.05, 5.0, 8.0, 4.0, 0.0])
CASES = [
    ("drawn", "mdr", "normal", RADII[0]),
    ("mean", "mdr", "normal", RADII[0]),
    large(("mean", "kogut-etsion", "uniform", R)),
]


def asperities(estimator: str, model: str, family: str, radius: Any) -> Any:
    drawn = source(heights_of(family)[1], radius)
    if estimator == "mean":
        return MeanAsperities(drawn, model, body(50.0))
    return DrawnAsperities(Problem(drawn.ensemble(3, 0, stratified=False), E, Adhesion(0.0)), model, body(50.0))


def law(own: Any, path: MachinePath) -> dict[str, Floats]:
    return dict(plastic_law(own, path, ["force", "separation", "contact_fraction", "remote"]).variables)


@pytest.mark.few(1)
@pytest.mark.parametrize("case", CASES)
def test_loads_are_met_and_zero_load_is_where_the_last_contact_parts(case: Any) -> None:
    own = asperities(*case)
    found = law(own, MachinePath.along("pressure", LOADS / PATCH, area=PATCH, adhesive=False))
    np.testing.assert_allclose(found["force"], LOADS, rtol=0.0, atol=1e-10 * LOADS.max())
    h = found["separation"]
    np.testing.assert_allclose(own.totals(h, {FORCE})[FORCE], LOADS, rtol=0.0, atol=1e-10 * LOADS.max())
    for step in (7, 12):
        assert h[step] == pytest.approx(own.parting(float(h[:step].min())), rel=4e-15, abs=4e-15 * STD)
        beside = own.totals(np.append(h[:step], h[step] - 1e-13), {COUNT})
        assert beside[COUNT, -1] > own.totals(h[: step + 1], {COUNT})[COUNT, -1]
    assert h[9] == pytest.approx(h[3], abs=1e-10 * (h[0] - h[3]))  # loaded again as far as before


@pytest.mark.few(1)
@pytest.mark.parametrize("case", [CASES[0], large(CASES[1])])
@pytest.mark.parametrize("stiffness", [None, K])
@pytest.mark.parametrize("preload", [Preload("force", 5.0), Preload("contact_fraction", 1e-3)])
def test_a_preload_is_reached_and_taken_off(case: Any, stiffness: float | None, preload: Preload) -> None:
    own, way = asperities(*case), travel(6)
    way = np.concatenate([way, way[::-1]])
    found = law(own, MachinePath.to_preload(way, preload, machine_stiffness=stiffness, adhesive=False))
    if stiffness is not None:
        pull = stiffness * (found["separation"] - found["remote"])
        np.testing.assert_allclose(found["force"][1:], pull[1:], rtol=0.0, atol=1e-10 * pull.max())
    assert found[preload.quantity][5:7] == pytest.approx(preload.value, rel=1e-10)
    assert (np.diff(found["separation"][6:]) > 0.0).all()
    assert (found["force"][7:-1] < found["force"][4:0:-1]).all()
    assert abs(found["force"][-1]) <= 1e-15 * found["force"].max()  # a mean begins where 1e-9 of its asperities touch


def test_without_asperities_there_is_no_force() -> None:
    none = Problem(Ensemble("sphere", LOADS[:0], {"radius": LOADS[:0]}), E, Adhesion(0.0))
    path = MachinePath.along("remote", -LOADS, machine_stiffness=K, adhesive=False)
    assert plastic_law(DrawnAsperities(none, "mdr", body(50.0)), path, ["force"]).variables["force"].max() == 0.0
