"""Cones and flat punches that yield: springs summed, similarity, limits, energies, memory, their mean, and refusals."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import example, given, settings, strategies as st
from oracles.multiprecision import mp
from oracles.plastic import Springs
from single import Single

import roughmdr as rm
from roughmdr.aggregate import LoadingPath, simulate
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import AREA, COUNT, DISSIPATED, ENERGY, FORCE, STIFFNESS, TOTAL_INDEX
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss
from roughmdr.scene import read
from roughmdr.stages.plastic.body import LIMIT, Body
from roughmdr.stages.plastic.drawn import DrawnAsperities
from roughmdr.stages.plastic.mean import MeanAsperities
from roughmdr.stages.plastic.models import compare, kernels_of
from roughmdr.stages.plastic.total import add_up, rows_of

few = settings(deadline=None, max_examples=30)
STIFF = st.floats(-1.0, 7.0).map(lambda power: 10.0**power)  # E* S/Y of cones, E*/Y of punches
POISSON = st.sampled_from([0.0, 0.3, 0.5, -0.5])
STICKY = st.one_of(st.just(0.0), st.floats(-9.0, -1.0).map(lambda power: 10.0**power))  # w/(E* b)
SHAPES = {"cone": "slope", "flat_punch": "radius"}
ALL = {FORCE, AREA, COUNT, STIFFNESS, ENERGY, DISSIPATED}
STATES = [FORCE, AREA, COUNT, STIFFNESS, ENERGY]
STD, MOST = 1e-6, 1000


class Contact(Single):
    """One cone or flat punch on a body with E* = 1 Pa, in units of a length [m] and a pressure [Pa]."""

    def __init__(
        self, shape: str, own: float, yield_strength: float, sticky: float = 0.0, poisson: float = 0.3,
        units: tuple[float, float] = (1.0, 1.0),
    ) -> None:  # fmt: skip
        length, pressure = units
        body = Body(pressure, yield_strength * pressure, sticky * length * pressure, poisson, math.inf, 0.0)
        super().__init__(kernels_of("mdr", body, shape), own * (length if shape == "flat_punch" else 1.0), body)

    def along(self, indentation: Floats) -> Floats:
        return add_up(self.kernels, np.zeros(1), self.rows, -np.asarray(indentation), self.body, ALL).total


def flow_pressure(stiff: float, poisson: float) -> Any:
    """p/Y of a cone with E* S/Y = ``stiff``; infinite where it stays elastic."""
    nu = mp.mpf(poisson)
    cavity = 2 * (2 + mp.log(((1 - nu**2) * stiff + 4 - 8 * nu) / (6 - 6 * nu))) / 3
    p = min(max(cavity, mp.mpf("0.5")), mp.mpf("2.845"))
    return p if mp.mpf(stiff) > 2 * p else mp.inf


@pytest.mark.large
@few
@given(STIFF, POISSON, st.floats(0.02, 5.0), st.floats(0.0, 0.98))
def test_cones_are_springs_that_are_summed(stiff: float, poisson: float, slope: float, back: float) -> None:
    contact, d = Contact("cone", slope, slope / stiff, poisson=poisson), 0.7
    p = flow_pressure(stiff, poisson)
    if p == mp.inf:
        springs, made, rise = Springs(lambda x: mp.pi / 2 * slope * x, mp.mpf(9) / slope, 1.0, 0.0), d, back * d
        own = springs.state(mp.mpf(d) - rise)
    else:
        p *= mp.mpf(slope) / stiff
        b, lost = d / (slope + (mp.pi - 2) * p), 0
        made = 2 * p * b
        rise = back * float(made)
        springs = Springs(lambda x: made * (1 - mp.sqrt(max(1 - (x / b) ** 2, 0))), b, 1.0, 0.0)
        own, full = springs.state(made - rise), springs.state(made)
        assert full[0] == pytest.approx(mp.pi * b**2 * p, rel=1e-14)
        lost = full[0] * d / 3 - full[2]
        assert contact.lost(d) == pytest.approx(float(lost), rel=1e-12)
    there = contact.state(d, rise)
    assert contact.ends(d) == pytest.approx((float(made), float(made)), rel=1e-14)
    full = contact.state(d)
    assert there.force == pytest.approx(float(own[0]), rel=1e-13, abs=1e-13 * full.force)
    assert there.radius == pytest.approx(float(own[1]), rel=1e-13, abs=1e-13 * full.radius)
    assert there.stored == pytest.approx(float(own[2]), rel=1e-13, abs=1e-13 * full.stored)


@few
@given(STIFF, STICKY, st.floats(0.01, 50.0), st.floats(0.0, 0.99))
def test_punches_are_springs_that_are_summed(stiff: float, sticky: float, deep: float, back: float) -> None:
    contact = Contact("flat_punch", 1.0, 1.0 / stiff, sticky)
    limit = mp.pi * mp.mpf("2.845") / (2 * mp.mpf(stiff))
    d, springs = deep * float(limit), Springs(lambda x: mp.mpf(0), mp.mpf(1), 1.0, sticky)
    held = min(mp.mpf(d), limit)
    made, gone = contact.ends(d)
    assert (made, gone) == pytest.approx((float(held), float(held - springs.indentation(mp.mpf(1)))), rel=1e-14)
    exact, there = springs.state(held - back * gone), contact.state(d, back * gone)
    for own, plain, scale in zip((there.force, there.radius, there.stored), exact, (gone, 1.0, gone**2), strict=True):
        assert own == pytest.approx(float(plain), rel=1e-13, abs=1e-13 * scale)
    flow = 2 * held * max(d - limit, mp.mpf(0))
    assert contact.lost(d) == pytest.approx(float(flow), rel=1e-12, abs=1e-14 * float(held) * d)


@few
@given(STIFF, POISSON, st.floats(0.02, 5.0), st.integers(-30, 30))
def test_cones_have_no_length(stiff: float, poisson: float, slope: float, octaves: int) -> None:
    contact, more = Contact("cone", slope, slope / stiff, poisson=poisson), 2.0**octaves
    for rise in (0.0, 0.3 * contact.ends(1.0)[0]):
        small, big = contact.state(1.0, rise), contact.state(more, more * rise)
        assert big == (small.force * more**2, small.radius * more, small.stiffness * more, small.stored * more**3)
    assert contact.lost(more) == contact.lost(1.0) * more**3


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_the_slope_changes_force_and_radius_without_a_jump(poisson: float) -> None:
    """Where cones begin to yield their dents appear at once: 1 - 2/pi of the indentation stays."""
    contacts = [Contact("cone", slope, 0.01, poisson=poisson) for slope in np.geomspace(0.005, 1.0, 2001).tolist()]
    force, radius = np.array([contact.state(1.0)[:2] for contact in contacts]).T
    yields = np.array([contact.lost(1.0) > 0.0 for contact in contacts])
    first = int(np.argmax(yields))
    assert 0 < first < yields.size
    assert yields[first:].all()
    for value in (force, radius):
        assert (np.abs(np.diff(np.log(value))) < 1e-2).all()
        assert (np.diff(value) < 0.0).all()
    assert contacts[first].ends(1.0)[0] == pytest.approx(2.0 / math.pi, rel=1e-2)
    elastic, rigid = 2.0 / (math.pi * 0.005), 1.0 / (1.0 + (math.pi - 2.0) * 0.02845)
    assert radius[[0, -1]] == pytest.approx([elastic, rigid], rel=1e-12)
    assert force[-1] == pytest.approx(math.pi * radius[-1] ** 2 * 0.02845, rel=1e-12)


def of(yield_strength: float, modulus: float = 1.0, work: float = 0.0) -> Body:
    return Body(modulus, yield_strength, work, 0.3, math.inf, 0.0)


def ensemble(shape: str, count: int, seed: int) -> Ensemble:
    rng = np.random.default_rng(seed)
    own = (0.1 if shape == "cone" else 5e-6) * rng.uniform(0.5, 2.0, count)
    return Ensemble(shape, np.sort(rng.normal(0.0, STD, count))[::-1].copy(), {SHAPES[shape]: own})


def wandering(rng: np.random.Generator, steps: int) -> Floats:
    return np.concatenate([[6.0 * STD], np.cumsum(rng.normal(-0.1, 1.5, steps)) * STD])


CASES = [("cone", 0.0), large("flat_punch", 0.0), ("flat_punch", 0.05)]


@pytest.mark.parametrize(("shape", "work"), CASES)
def test_hard_asperities_are_elastic(shape: str, work: float) -> None:
    asperities, path = ensemble(shape, 300, 4), wandering(np.random.default_rng(8), 40)
    of = Body(1e9, 1e15, work, 0.3, math.inf, 0.0)
    kernels = kernels_of("mdr", of, shape)
    names = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]
    along = LoadingPath.along(path, unload=False, adhesive=work > 0.0)
    elastic = simulate(Problem(asperities, 1e9, Adhesion(work, "jkr")), along, names).variables
    rows = rows_of(kernels, asperities.parameters[SHAPES[shape]], of)
    found = add_up(kernels, asperities.height, rows, path, of, ALL).total
    for name in names:
        scale = np.abs(elastic[name]).max() or 1.0
        np.testing.assert_allclose(found[TOTAL_INDEX[name]], elastic[name], rtol=0.0, atol=2e-13 * scale)


def _leg(begin: float, end: float, kinks: list[float]) -> tuple[Floats, Floats]:
    """Return nodes and weights of a leg from one indentation to another; roots at the ends of its parts are smooth."""
    inner = [kink for kink in kinks if min(begin, end) < kink < max(begin, end)]
    y, weight = gauss(40)
    angle = 0.5 * math.pi * (y + 1.0)
    parts = [
        (a + (b - a) * 0.5 * (1.0 - np.cos(angle)), (b - a) * 0.25 * math.pi * weight * np.sin(angle))
        for a, b in pairwise([begin, *sorted(inner, reverse=bool(begin > end)), end])
    ]
    nodes, weights = (np.concatenate(each) for each in zip(*parts, strict=True))
    return np.append(nodes, end), np.append(weights, 0.0)


@few
@given(st.sampled_from([*SHAPES]), STIFF, STICKY, st.lists(st.floats(0.05, 1.0), min_size=4, max_size=4))
def test_the_work_of_the_flat_is_stored_or_lost(shape: str, stiff: float, sticky: float, ways: list[float]) -> None:
    contact = Contact(shape, 1.0, 1.0 / stiff, sticky if shape == "flat_punch" else 0.0)
    limit = contact.row[LIMIT] if 1e-300 < contact.row[LIMIT] < math.inf else 1.0
    first = 3.0 * ways[0] * limit
    second = first * (1.0 + ways[1])
    gone = [deepest - (1.0 + ways[2]) * contact.ends(deepest)[1] for deepest in (first, second)]
    turns = [first, first - ways[3] * contact.ends(first)[0], second, gone[1], 0.99 * second, gone[1], 2.0 * second]
    path, weight, ends, lowest = [np.array([-limit])], [np.zeros(1)], [0], 0.0
    for begin, end in zip([-limit, *turns[:-1]], turns, strict=True):
        lowest = max(lowest, begin)
        kinks = [0.0, limit, lowest]
        if lowest > 0.0:
            made, loss = contact.ends(lowest)
            kinks.append(lowest - (made if end > begin else loss))
        nodes, weights = _leg(begin, end, kinks)
        path.append(nodes)
        weight.append(weights)
        ends.append(ends[-1] + nodes.size)
    total = contact.along(np.concatenate(path))
    work = np.cumsum(np.concatenate(weight) * total[FORCE])[ends]
    kept = (total[ENERGY] + total[DISSIPATED])[ends]
    scale = np.abs(total[ENERGY]).max() + total[DISSIPATED].max()
    np.testing.assert_allclose(work, kept, rtol=0.0, atol=1e-10 * scale)
    assert (np.diff(total[DISSIPATED]) >= -1e-12 * scale).all()


@few
@given(st.sampled_from([*SHAPES]), STIFF, STICKY, st.sampled_from([1e-9, 1e-6, 1e3]), st.sampled_from([1e3, 1e12]))
def test_other_units(shape: str, stiff: float, sticky: float, length: float, pressure: float) -> None:
    sticky = sticky if shape == "flat_punch" else 0.0
    one, other = (Contact(shape, 0.5, 1.0 / stiff, sticky, units=units) for units in ((1.0, 1.0), (length, pressure)))
    units = np.array([length**2 * pressure, length, length * pressure, length**3 * pressure])
    for deepest, part in ((0.3, 0.0), (0.3, 0.4), (3.0, 0.9), (3.0, 0.0)):
        rise = part * one.ends(deepest)[1]
        there = np.array(other.state(deepest * length, rise * length)) / units
        scale = 1.0 + deepest**2 + one.ends(deepest)[1]
        np.testing.assert_allclose(there, one.state(deepest, rise), rtol=1e-12, atol=1e-13 * scale)


@few
@given(st.sampled_from([*SHAPES]), STIFF, STICKY, st.floats(0.05, 0.95))
def test_the_stiffness_is_a_slope(shape: str, stiff: float, sticky: float, back: float) -> None:
    contact = Contact(shape, 1.0, 1.0 / stiff, sticky if shape == "flat_punch" else 0.0)
    for deepest in (0.5, 1e-4, 20.0):
        made = contact.ends(deepest)[0]
        small = 1e-5 * min(made * back, made * (1.0 - back), abs(deepest - contact.row[LIMIT]))
        for rise in (0.0, back * made):
            more, less = ((deepest, rise - s) if rise else (deepest + s, 0.0) for s in (small, -small))
            slope = (contact.state(*more).force - contact.state(*less).force) / (2.0 * small)
            there = contact.state(deepest, rise)
            assert abs(slope - there.stiffness) < 1e-4 * there.radius + 1e-14 * abs(there.force) / small


@pytest.mark.parametrize(("shape", "work"), CASES)
def test_a_turning_point_that_is_passed_again_is_forgotten(shape: str, work: float) -> None:
    rng, asperities = np.random.default_rng(11), ensemble(shape, 30, 6)
    of = Body(1e9, 1e7, work, 0.3, math.inf, 0.0)
    kernels = kernels_of("mdr", of, shape)
    rows = rows_of(kernels, asperities.parameters[SHAPES[shape]], of)
    for _ in range(300):
        path = wandering(rng, 12)
        turn = int(rng.choice(np.flatnonzero(path == np.minimum.accumulate(path))))
        up = path[turn] + np.sort(rng.uniform(0.0, 8.0, 3)) * STD
        with_excursion = np.concatenate([path[: turn + 1], up, up[:2][::-1], path[turn:]])
        plain, excursion = (
            add_up(kernels, asperities.height, rows, way, of, ALL).total for way in (path, with_excursion)
        )
        plain, excursion = plain[:, turn:], excursion[:, turn - path.size :]
        assert (plain[STATES, 1:] == excursion[STATES, 1:]).all()
        lost, more = plain[DISSIPATED, -1], excursion[DISSIPATED, -1]
        assert more >= lost * (1.0 - 1e-12) if work > 0.0 else more == lost


def test_other_estimates_differ() -> None:
    """Rough punches bear 6.05/5.69; cones that pile up, or bear the pressure of the core alone, and elastic ones."""
    deep = -np.array([1e-9, 1.0, 1.27323955, 10.0])  # over the indentation at the limit load
    punch = Contact("flat_punch", 1.0, 1e-3)
    found = compare("mdr", punch.body, "flat_punch", np.zeros(1), np.ones(1), punch.row[LIMIT] * deep).force
    sine = math.pi / 4.0
    saturated = 2.0 / math.pi * (math.asin(sine) + sine * math.sqrt(1.0 - sine**2))
    assert found[1:] == pytest.approx([1.0 - saturated, 3.025 / 2.845 - 1.0, 3.025 / 2.845 - 1.0], rel=1e-9)
    assert 0.0 <= found[0] < 1e-17
    for stiff in (0.9, 1.5, 10.0, 100.0, 1e9):
        own, core, piled_up = (cone_force(stiff, *each) for each in ((2.0 / 3.0, 1.0), (0.0, 1.0), (2.0 / 3.0, 0.8)))
        error = compare("mdr", of(0.1 / stiff), "cone", np.zeros(1), np.array([0.1]), -np.array([0.1, 1.0])).force
        assert error[1] == pytest.approx(max(abs(core - own), abs(piled_up - own)) / own, rel=1e-9)
        assert error[0] == pytest.approx(0.01 * error[1], rel=1e-12)
        assert (error[1] == 0.0) == (stiff < 1.0)


def test_other_estimates_differ_at_equal_force() -> None:
    dry = Contact("flat_punch", 1.0, 1e-3)
    flowing = compare("mdr", dry.body, "flat_punch", np.zeros(1), np.ones(1), -2.0 * dry.row[LIMIT : LIMIT + 1])
    assert flowing.at_force == (0.0, 1.0, 0.0)  # all have the same radius, and some have no stiffness
    assert flowing.softness == 0.0
    for stiff in (10.0, 40.0, 1e4):
        area, stiffness, radii = compare(
            "mdr", of(0.1 / stiff), "cone", np.zeros(1), np.array([0.1]), -np.ones(1)
        ).at_force
        own, core = cone_pressure(stiff, 2.0 / 3.0), cone_pressure(stiff, 0.0)
        assert area == pytest.approx(1.0 - core / own, rel=1e-9)
        assert radii == pytest.approx(1.0 - math.sqrt(core / own), rel=1e-9)
        assert 0.1 < stiffness < 0.5


def cone_force(stiff: float, share: float, rigid: float) -> float:
    """Force over Y (d/S)^2 of a cone with E* S/Y = ``stiff`` and Poisson's ratio 0.3."""
    p = cone_pressure(stiff, share)
    return math.pi * p / (rigid + (math.pi - 2.0 * rigid) * p / stiff) ** 2


def cone_pressure(stiff: float, share: float) -> float:
    """Mean pressure over Y of a cone."""
    core = 2.0 / 3.0 * (1.0 + math.log((0.91 * stiff + 1.6) / 4.2))
    return min(max(core + share, 0.5), 2.845, 0.5 * stiff)


def source(shape: str, own: Any, count: int = MOST) -> Any:
    height = {"distribution": "normal", "std": STD}
    section = {"source": "random", "count": count, "patch": "1 cm", "shape": shape, SHAPES[shape]: own}
    material = {"modulus": 1e9, "poisson": 0.3}
    scene = {"material": material, "asperities": section | {"height": height}, "path": {"separation": [STD, 0]}}
    return read(scene).asperities


WAY = np.array([2.5, 1.5, 0.5, 0.6, 1.1, 2.5, 1.0, -0.5, -0.3]) * STD
RANDOM = {
    "cone": {"distribution": "lognormal", "mean": 0.1, "std": 0.03},
    "flat_punch": {"distribution": "lognormal", "mean": 5e-6, "std": 1e-6},
}


@pytest.mark.parametrize("own", [0, large(1)])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_mean_is_that_of_many_draws(shape: str, own: int) -> None:
    of = Body(1e9, 1e7, 0.0, 0.3, math.inf, 0.0)
    parameter = RANDOM[shape] if own else {"cone": 0.1, "flat_punch": 5e-6}[shape]
    count = 1_000_000 if own else 200_000
    mean, error = MeanAsperities(source(shape, parameter), "mdr", of)._converged(WAY, ALL)
    drawn = source(shape, parameter, count).ensemble(1, 0, stratified=True)
    many = DrawnAsperities(Problem(drawn, 1e9, Adhesion(0.0)), "mdr", of).totals(WAY, ALL) * MOST / count
    for row in ALL:
        np.testing.assert_allclose(many[row], mean[row], rtol=0.0, atol=(2e-3 + error[row]) * np.abs(mean[row]).max())


@pytest.mark.large
@example("cone", 40.0, [3.0, 0.0, 0.1, 0.3])  # of whose slopes some are elastic
@given(
    st.sampled_from([*SHAPES]),
    st.floats(0.0, 4.0).map(lambda power: 10.0**power),
    st.lists(st.floats(-1.0, 3.0), min_size=2, max_size=5),
)
@settings(deadline=None, max_examples=30)
def test_the_stated_error_is_a_bound(shape: str, stiff: float, way: list[float]) -> None:
    of, path = Body(1e9, 1e9 / stiff, 0.0, 0.3, math.inf, 0.0), STD * np.array(way)
    mean = MeanAsperities(source(shape, RANDOM[shape]), "mdr", of)
    law = mean.law(LoadingPath.along(path, unload=False, adhesive=False), ["force"])
    exact = mean._at_order(path, {FORCE}, 256)[FORCE]
    assert np.abs(law.variables["force"] - exact).max() <= law.numerical_error * np.abs(exact).max() * (1.0 + 1e-3)


SCENE: dict[str, Any] = {
    "title": "Cones",
    "material": {"modulus": "70 GPa", "poisson": 0.33},
    "asperities": {
        "source": "random", "shape": "cone", "count": 50, "patch": "1 mm", "slope": 0.1,
        "height": {"distribution": "normal", "std": "1 um"},
    },
    "plasticity": {"yield_strength": "300 MPa"},
    "path": {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 6}, "unload": True},
}  # fmt: skip
PUNCHES = {**SCENE["asperities"], "shape": "flat_punch", "slope": None, "radius": "2 um"}
PUNCHES = {key: value for key, value in PUNCHES.items() if value is not None}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"adhesion": {"model": "jkr", "work": 0.05}}, "adhesion: does not go with .* cones"),
        (
            {"plasticity": {"hardness": 1e9, "model": "jackson-green"}},
            "model = 'jackson-green' it must be paraboloid or",
        ),
        ({"plasticity": {"hardness": 1e9, "body": "sphere"}}, "body = 'sphere' it must be paraboloid or sphere"),
        ({"material": {"effective_modulus": 1e9}}, "material: needs modulus and poisson, on which a cone that yields"),
        ({"asperities": {**PUNCHES, "shape": "truncated_cone", "flat_radius": 1e-6, "slope": 0.1}}, "asperities.shape"),
    ],
)
def test_refusals_are_in_words(changes: dict[str, Any], words: str) -> None:
    scene = {**SCENE, **changes}
    if "flat_radius" in scene["asperities"]:
        scene["asperities"] = {key: value for key, value in scene["asperities"].items() if key != "radius"}
    with pytest.raises(rm.SceneError, match=words):
        read(scene)


@pytest.mark.parametrize("batch", [{}, {"estimator": "expected"}])
def test_punches_bear_no_more_than_their_limit_loads(batch: dict[str, Any]) -> None:
    limit = 50.0 * math.pi * 4e-12 * 2.845 * 3e8
    scene = {
        **SCENE,
        "asperities": PUNCHES,
        "batch": batch,
        "path": {"force": [0.0, 0.5 * limit, 0.0], "unload": False},
    }
    found = rm.run(scene)
    np.testing.assert_allclose(found.force.to_numpy().ravel(), [0.0, 0.5 * limit, 0.0], atol=1e-10 * limit)
    with pytest.raises(rm.SceneError, match=f"out of reach of these contacts, which bear at most {limit:.3g}"):
        rm.run({**scene, "path": {"force": [0.5 * limit, 1.5 * limit]}})


@pytest.mark.parametrize("asperities", [SCENE["asperities"], PUNCHES])
def test_results_tell_what_yields(asperities: dict[str, Any]) -> None:
    found = rm.run({**SCENE, "asperities": asperities, "output": {"variables": ["force", "dissipated_energy"]}})
    assert float(found.plastic_contact_fraction.max()) > 0.9
    assert 0.06 < float(found.plasticity_error.max()) < 0.5
    assert found.force.to_numpy().ravel()[-1] == 0.0
