"""Adhesive contacts that feel each other: by hand where it can be done, equilibrium and stability where it cannot."""

import itertools
import math
from typing import NamedTuple

import mpmath as mp
import numpy as np
import pytest
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.jkr import tension
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, Step, alone
from roughmdr.interaction.jkr.front import Front, Piece
from roughmdr.interaction.jkr.path import Descent
from roughmdr.interaction.jkr.tangent import Tangent
from roughmdr.interaction.settings import Boundary, Interaction

Floats = NDArray[np.float64]


class Units(NamedTuple):
    """A paraboloid of radius R under E*, and the work for which its natural radius is ``a0``."""

    radius: float
    modulus: float
    a0: float

    @property
    def d0(self) -> float:
        return self.a0**2 / self.radius

    @property
    def work(self) -> float:
        return self.a0**3 * self.modulus / (2.0 * math.pi * self.radius**2)

    @property
    def force(self) -> float:
        return 2.0 * self.modulus * self.a0 * self.d0


UNITS = [Units(1.0, 1.0, 1.0), Units(50e-6, 3e6, 4e-6), Units(20e-9, 70e9, 1.5e-9)]
UNIT = UNITS[1]


def placed(units: Units, at: object, z: object, side: float | None = None) -> Ensemble:
    """Return paraboloids at positions [a0] and heights [d0], on a patch of a side [a0]."""
    position = np.array(at, dtype=np.float64).reshape(-1, 2) * units.a0
    height = np.array(z, dtype=np.float64) * units.d0
    order = np.argsort(-height, kind="stable")
    parameters = {"radius": np.full(height.size, units.radius)}
    x, y = position[order].T
    attrs = {} if side is None else {"patch": side * units.a0}
    return Ensemble("paraboloid", height[order], parameters, None, {"x": x, "y": y}, attrs)


def follow(
    ensemble: Ensemble, units: Units, h: object, *, order: int = 1, boundary: Boundary = "free", names: str = ""
) -> Adhering:
    """Return the contacts along separations [d0]."""
    asked = Interaction(model="pairwise", boundary=boundary, order=order)
    separation = np.array(h, dtype=np.float64) * units.d0
    return Descent(ensemble, units.modulus, units.work, asked).along(separation, set(names.split()))


@pytest.mark.large
def test_a_way_begins_where_one_before_has_been(monkeypatch: pytest.MonkeyPatch) -> None:
    rng, gone = np.random.default_rng(4), list[float]()
    at, z = rng.uniform(0.0, 30.0, (12, 2)), rng.normal(size=12)
    ensemble, names = placed(UNIT, at, z), {"energy", "stiffness"}

    def going(self: Front, state: State, h: float) -> tuple[State, list[Piece]]:
        gone.append(state.separation * self.length / UNIT.d0)
        return go(self, state, h)

    go = Front.go
    monkeypatch.setattr(Front, "go", going)
    descent = Descent(ensemble, UNIT.modulus, UNIT.work, Interaction(model="pairwise", boundary="free"))
    descent.along(np.linspace(3.0, -1.0, 9) * UNIT.d0, names)
    for way in ([-0.2, -0.4, 3.0, -2.0], [1.2, 0.7], [-3.0, 3.0]):
        gone.clear()
        found = descent.along(np.array(way) * UNIT.d0, names)
        assert gone[0] == pytest.approx({-0.2: 0.0, 1.2: 1.5, -3.0: -1.0}[way[0]], abs=1e-12)
        alone = follow(ensemble, UNIT, way, order=2, names="energy stiffness")
        for step, other in zip(found.steps, alone.steps, strict=True):
            np.testing.assert_allclose(step.force, other.force, rtol=1e-10, atol=1e-10 * UNIT.force)
            np.testing.assert_allclose(step.energy, other.energy, rtol=1e-9)
            np.testing.assert_allclose(step.dissipated, other.dissipated, rtol=1e-9)
        assert [each.size for each in found.avalanches] == [each.size for each in alone.avalanches]


def fold_of_ring(g: float) -> float:
    """Return the largest separation [d0] of equal contacts that all feel g times their load [2 E* a0 d0]."""
    t = mp.findroot(lambda t: 4 * t**3 - 1 + g * (4 * t**5 - 3 * t**2), 0.6)
    return float(-(t**4 - t) - g * (2 * t**6 / 3 - t**3))


@pytest.mark.parametrize("units", UNITS)
def test_two_equal_contacts_part_together_where_the_reduced_problem_folds(units: Units) -> None:
    found = follow(placed(units, [(0, 0), (4, 0)], [0, 0]), units, [1.0, -0.3, 1.0])
    assert fold_of_ring(0.5 / math.pi) == pytest.approx(0.5072847999203925, rel=1e-14)
    assert [each.size for each in found.avalanches] == [2, 2]
    assert found.avalanches[-1].separation == pytest.approx(fold_of_ring(0.5 / math.pi) * units.d0, rel=1e-12)


@pytest.mark.parametrize("units", UNITS)
def test_a_lower_contact_pulls_the_higher_one_off(units: Units) -> None:
    found = follow(placed(units, [(0, 0), (4, 0)], [0, -0.02]), units, [1.0, -0.3, 1.0])
    last = found.avalanches[-1]
    assert last.size == 2
    assert last.separation == pytest.approx(0.4943357206053302 * units.d0, rel=1e-12)
    assert last.dissipated == pytest.approx(0.0374627074378634 * units.force * units.d0, rel=1e-11)


@pytest.mark.parametrize("units", UNITS)
def test_a_much_lower_contact_parts_alone(units: Units) -> None:
    found = follow(placed(units, [(0, 0), (4, 0)], [0, -0.1]), units, [1.0, -0.3, 1.0])
    assert [each.size for each in found.avalanches] == [1, 1, 1, 1]
    parted = np.array([each.separation for each in found.avalanches[2:]]) / units.d0
    assert parted == pytest.approx([0.4259352357708691, 0.75 * 4.0 ** (-1.0 / 3.0)], rel=1e-11)


@pytest.mark.parametrize("count", [3, 5, 8])
def test_a_ring_follows_its_reduced_problem(count: int) -> None:
    angle = 2.0 * math.pi * np.arange(count) / count
    at = 6.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    found = follow(placed(UNIT, at, np.zeros(count)), UNIT, [1.0, -0.3, 1.0])
    g = float(np.sum(2.0 / (math.pi * np.hypot(*(at[1:] - at[0]).T))))
    assert [each.size for each in found.avalanches] == [count, count]
    assert found.avalanches[-1].separation == pytest.approx(fold_of_ring(g) * UNIT.d0, rel=1e-12)


def test_three_in_a_row_fold_where_their_tangent_is_singular() -> None:
    g = 2 / (mp.pi * 5)

    def indentation(t: mp.mpf) -> mp.mpf:
        return t**4 - t

    def load(t: mp.mpf) -> mp.mpf:
        return 2 * t**6 / 3 - t**3

    def equations(outer: mp.mpf, middle: mp.mpf, h: mp.mpf) -> list[mp.mpf]:
        first = indentation(outer) + g * load(middle) + g / 2 * load(outer) + h
        second = indentation(middle) + 2 * g * load(outer) + h
        slopes = [4 * t**3 - 1 for t in (outer, middle)]
        loads = [4 * t**5 - 3 * t**2 for t in (outer, middle)]
        return [first, second, (slopes[0] + g / 2 * loads[0]) * slopes[1] - 2 * g * g * loads[0] * loads[1]]

    _, _, h = mp.findroot(equations, (0.65, 0.7, 0.52))
    found = follow(placed(UNIT, [(-5, 0), (0, 0), (5, 0)], [0, 0, 0]), UNIT, [1.0, -0.3, 1.0])
    assert found.avalanches[-1].separation == pytest.approx(float(h) * UNIT.d0, rel=1e-11)


def test_second_order_comes_near_the_exact_pair() -> None:
    """Against a spectral solution of two bodies on a half-space: the separation at which both part (DESIGN, 5)."""
    for distance, exact in ((4.0, 0.507723241), (10.0, 0.486019386)):
        parted = [
            follow(placed(UNIT, [(0, 0), (distance, 0)], [0, 0]), UNIT, [1.0, -0.3, 1.0], order=order)
            .avalanches[-1].separation / UNIT.d0
            for order in (1, 2)
        ]  # fmt: skip
        first, second = np.abs(np.array(parted) - exact)
        assert second < 3e-5 * (4.0 / distance) ** 4
        assert second < 0.1 * first


def test_a_lone_contact_on_a_patch_goes_to_the_lone_one_as_the_patch_grows() -> None:
    lone = 0.75 * 4.0 ** (-1.0 / 3.0)
    off = []
    for side, expected in ((8.0, 0.41431), (20.0, 0.4476), (80.0, None), (320.0, None)):
        found = follow(placed(UNIT, [(0, 0)], [0], side), UNIT, [1.0, -0.3, 1.0], order=2, boundary="periodic")
        parted = found.avalanches[-1].separation / UNIT.d0
        if expected is not None:
            assert parted == pytest.approx(expected, abs=1e-4)
        off.append((lone - parted) * side)
    assert off[3] == pytest.approx(off[2], rel=0.02)  # as 1/side


def at_rest(ensemble: Ensemble, units: Units, h: Floats, order: int) -> list[tuple[PairProblem, State]]:
    """Return the problem and the state at each separation [d0] where there are contacts."""
    states = []
    stand = Account.stand

    def noting(self: Account, state: State, separation: float, *, rises: bool) -> None:
        if state.inside.any():
            states.append((self._front.problem, state))
        stand(self, state, separation, rises=rises)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Account, "stand", noting)
        found = follow(ensemble, units, h, order=order)
    assert all(math.isfinite(step.error) for step in found.steps)
    assert all(each.dissipated > 0.0 for each in found.avalanches)
    return states


def hessian(problem: PairProblem, state: State) -> tuple[Floats, Floats]:
    """Return the second derivatives of the energy over all radii and loads, and those over radii alone."""
    problem, state = alone(problem, state)
    tangent = Tangent(problem, state, Drive(0.0, np.zeros_like(state.outer)))
    size = state.t.size
    whole = np.empty((2 * size, 2 * size))
    for column in range(2 * size):
        unit = np.zeros(2 * size)
        unit[column] = 1.0
        edge, gap = tangent.product(Step(unit[:size], unit[size:]))
        whole[:, column] = np.concatenate([edge, math.pi * gap])
    loads = np.linalg.solve(whole[size:, size:], whole[size:, :size])
    return whole, whole[:size, :size] - whole[:size, size:] @ loads


def random_ensemble(seed: int, units: Units) -> Ensemble:
    """Return 2 to 12 asperities with distances from 2.2 a0 on."""
    rng = np.random.default_rng(seed)
    count, apart = int(rng.integers(2, 13)), rng.uniform(2.2, 6.0)
    at: list[Floats] = []
    while len(at) < count:
        one = rng.uniform(0.0, 1.5 * apart * math.sqrt(count), 2)
        if all(np.hypot(*(one - other)) > apart for other in at):
            at.append(one)
    z = rng.normal(0.0, 10.0 ** rng.uniform(-3.0, 0.3), count)
    return placed(units, at, z - z.max())


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(150))
def test_random_contacts_are_in_stable_equilibrium(seed: int) -> None:
    units = UNITS[seed % 3]
    h = np.concatenate([np.linspace(0.5, -1.5, 6), np.linspace(-1.5, 5.0, 12)])
    states = at_rest(random_ensemble(seed, units), units, h, 1 + seed % 2)
    assert states
    for problem, state in states:
        assert state.error < 1e-10
        whole, radii = hessian(problem, state)
        assert np.abs(whole - whole.T).max() < 1e-14 * np.abs(whole).max()
        assert np.linalg.eigvalsh(0.5 * (radii + radii.T)).min() > 0.0


def graded(begin: float, end: float, count: int = 24) -> tuple[Floats, Floats]:
    """Return Gauss nodes and weights between two separations, for a force with a root at its end."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    u, w = 0.5 * (nodes + 1.0), 0.5 * weights
    return end - (end - begin) * (1.0 - u) ** 2, 2.0 * (end - begin) * (1.0 - u) * w


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(20))
def test_cycles_close(seed: int) -> None:
    """The work of the force along a closed cycle is what the jumps dissipate."""
    units, order = UNITS[seed % 3], 1 + seed % 2
    ensemble = random_ensemble(seed, units)
    top, bottom = 3.0, -0.8
    first = follow(ensemble, units, [top, bottom, top + 3.0], order=order)
    at = [each.separation / units.d0 for each in first.avalanches]
    turn = next((n for n in range(1, len(at)) if at[n] > at[n - 1]), len(at))
    ends = [top, *at[:turn], bottom, *at[turn:]]
    pieces = [graded(a, b) for a, b in itertools.pairwise(ends) if abs(b - a) > 1e-13]
    h, weight = (np.concatenate(each) for each in zip(*pieces, strict=True))
    found = follow(ensemble, units, [*h, top + 3.0], order=order)
    force = np.array([step.force for step in found.steps[:-1]])
    work = -float(np.sum(force * weight)) * units.d0
    assert not found.steps[-1].contacts
    assert found.steps[-1].dissipated == pytest.approx(work, rel=1e-8)


@pytest.mark.few(1)
@pytest.mark.parametrize("order", [1, 2])
def test_stiffness_is_the_slope_of_the_force_as_contacts_come_to_overlap(order: int) -> None:
    """Two contacts at 4 a0 change over from h = -2 d0 on, by differences of the fourth order."""
    middle, size = np.linspace(-1.0, -6.0, 11), 1e-3
    h = (middle[:, None] + size * np.array([2.0, 1.0, 0.0, -1.0, -2.0])).ravel()
    pair = placed(UNIT, [(0, 0), (4, 0)], [0, -0.3])
    found = follow(pair, UNIT, h, order=order, names="stiffness").steps
    force = np.array([step.force for step in found]).reshape(-1, 5)
    slope = -(force @ [-1.0, 8.0, 0.0, -8.0, 1.0]) / (12.0 * size * UNIT.d0)
    stiffness = np.array([step.stiffness for step in found]).reshape(-1, 5)[:, 2]
    np.testing.assert_allclose(stiffness, slope, rtol=1e-7)
    assert found[0].overlap.contacts == 0
    assert found[-1].overlap.contacts == 2


@pytest.mark.large
def test_events_depend_not_on_the_steps_where_contacts_overlap() -> None:
    at, z = [(0, 0), (3, 0), (0, 3), (4, 4), (8, 2)], np.array([0.0, -0.3, -0.6, -1.2, -1.7])
    few = follow(placed(UNIT, at, z), UNIT, [1.0, -2.5, 3.0], order=2)
    fine = np.concatenate([np.linspace(1.0, -2.5, 57), np.linspace(-2.5, 3.0, 91)])
    many = follow(placed(UNIT, at, z), UNIT, fine, order=2)
    assert max(step.overlap.contacts for step in few.steps) >= 3
    assert [each.size for each in few.avalanches] == [each.size for each in many.avalanches]
    for one, other in zip(few.avalanches, many.avalanches, strict=True):
        assert abs(one.separation - other.separation) < 1e-11 * UNIT.d0
        assert one.dissipated == pytest.approx(other.dissipated, rel=1e-8)


@pytest.mark.large
def test_events_depend_neither_on_the_steps_nor_on_the_order_of_asperities() -> None:
    at, z = [(0, 0), (5, 0), (0, 5), (6, 6), (11, 2)], np.array([0.0, -0.3, -0.05, -0.2, -0.01])
    few = follow(placed(UNIT, at, z), UNIT, [1.0, -1.0, 2.0], order=2)
    fine = np.concatenate([np.linspace(1.0, -1.0, 57), np.linspace(-1.0, 2.0, 91)])
    turned = [3, 1, 4, 0, 2]
    many = follow(placed(UNIT, np.array(at)[turned], z[turned]), UNIT, fine, order=2)
    assert [each.size for each in few.avalanches] == [each.size for each in many.avalanches]
    for one, other in zip(few.avalanches, many.avalanches, strict=True):
        assert abs(one.separation - other.separation) < 1e-12 * UNIT.d0
        assert one.dissipated == pytest.approx(other.dissipated, rel=1e-9)


@pytest.mark.large
def test_a_path_of_a_large_patch_is_lost_at_no_fold() -> None:
    """In an avalanche the tangent of the first order takes another contact for the one that folds."""
    rng, count, pitch = np.random.default_rng(0), 3969, 1e-3 * math.sqrt(4000 / 2000) / 63
    x, y = np.meshgrid(np.arange(63), np.arange(63))
    x, y = ((each.ravel() + 0.5 + rng.uniform(-0.25, 0.25, count)) * pitch for each in (x, y))
    z, radius = rng.normal(0.0, 1e-6, count), 50e-6 * rng.lognormal(0.0, 0.1, count)
    order = np.argsort(-z)
    at = {"x": x[order], "y": y[order]}
    ensemble = Ensemble("paraboloid", z[order], {"radius": radius[order]}, positions=at, nominal_area=(63 * pitch) ** 2)
    way = np.linspace(4.5e-6, 1.25e-6, 12)
    descent = Descent(ensemble, 3e6 / (1.0 - 0.49**2), 0.05, Interaction(model="pairwise"))
    found = descent.along(np.concatenate([way, way[::-1]]), set())
    assert np.isfinite([step.error for step in found.steps]).all()
    assert sum(each.size for each in found.avalanches) >= 2 * max(step.contacts for step in found.steps)
    assert found.steps[-1].contacts == 0


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_tension_is_looked_for_on_few_pieces(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng, (risen, looked) = np.random.default_rng([seed, 9]), (list[Piece](), list[Piece]())
    ensemble = placed(UNIT, rng.uniform(0.0, 16.0, (12, 2)), rng.normal(size=12))

    def passing(self: tension.LargestTension, piece: Piece) -> None:
        risen.append(piece)
        pass_over(self, piece)

    def looking(piece: Piece) -> tension.Tension:
        looked.append(piece)
        return largest_within(piece)

    pass_over, largest_within = tension.LargestTension.pass_over, tension.largest_within
    monkeypatch.setattr(tension.LargestTension, "pass_over", passing)
    monkeypatch.setattr(tension, "largest_within", looking)
    down = np.linspace(2.5, -1.5, 30)
    found = follow(ensemble, UNIT, np.concatenate([down, np.linspace(-1.5, 6.0, 60)]), order=2).pull_off
    everywhere = min(largest_within(piece) for piece in risen)
    length = max(np.ptp(ensemble.positions["x"]), np.ptp(ensemble.positions["y"]))
    assert found.contacts == everywhere.contacts
    assert found.separation == pytest.approx(everywhere.separation * length, rel=1e-9, abs=1e-9 * UNIT.d0)
    assert found.force < 0.0
    assert 1 <= len(looked) < 0.2 * len(risen)
