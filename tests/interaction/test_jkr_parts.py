"""The parts that adhesive contacts are solved by, each on its own."""

import math
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

import roughmdr as rm
from roughmdr.interaction import close
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import Periodic
from roughmdr.interaction.interface import Asperities, CoupledKernels
from roughmdr.interaction.jkr import coincident, equilibrium, factors
from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.contacts import Contacts
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, Step, evaluate
from roughmdr.interaction.jkr.factors import Factors
from roughmdr.interaction.jkr.front import jkr_kernels
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.jkr.newton import at_rest
from roughmdr.interaction.jkr.tangent import Mixing, Tangent, _respond
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.shapes.base import Shape

Floats = NDArray[np.float64]

WORK = 1e-9
EXAMPLES: dict[str, Shape] = {
    "paraboloid": rm.Paraboloid(radius=0.7),
    "cone": rm.Cone(slope=0.02),
    "power_law": rm.PowerLaw(exponent=4.0, coefficient=1e4),
    "sphere": rm.Sphere(radius=0.9),
    "flat_punch": rm.FlatPunch(radius=2e-3),
    "truncated_cone": rm.TruncatedCone(slope=0.02, flat_radius=1e-3),
    "rounded_punch": rm.RoundedPunch(flat_radius=1e-3, edge_radius=0.5),
}


def kernels_of(shape: Shape, count: int) -> tuple[CoupledKernels, Asperities]:
    """Return the kernels of equal asperities, in a patch of side 1 m."""
    width, rise, params = shape.nondimensional()
    own = np.array([params], dtype=np.float64).reshape(1, -1)
    own = own if np.ndim(params) else own[0]
    columns = Columns(np.full(count, width), np.full(count, rise), np.repeat(own, count, axis=0))
    law = jkr_kernels(choose(shape.name, Adhesion(), columns.params))
    made = law.prepare(law.material(1.0, Adhesion()), columns, 0, count, 0.0, math.inf)
    (depth, _), size, _, _ = law.scales(1.0, 0.0, width, rise, law.params_of(made, 0))
    return law, Asperities(np.zeros(count), np.full(count, depth), np.full(count, size), made)


def flanks(law: CoupledKernels, asperities: Asperities, natural: Floats, h: float) -> Floats:
    """Return the radii that decide on overlap under a flat at h, and their slopes over it."""
    found = np.empty((2, natural.size))
    law.flanks(np.arange(natural.size), h, natural, asperities, found)
    return found


def guess(shape: Shape, at: Floats, order: int, *, overlapping: bool = False) -> tuple[PairProblem, State]:
    """Return contacts near those alone at different indentations, of which none is in equilibrium.

    Overlapping ones are brought so near that some pairs share half, and others less or more.
    """
    law, asperities = kernels_of(shape, len(at))
    natural = np.full(len(at), 1e-6)
    radius = flanks(law, asperities, natural, -1e-6)[0]
    if overlapping:
        at = at * (0.9 * radius[:2].sum() / np.hypot(*(at[1] - at[0])))
    x, y = np.ascontiguousarray(at.T)
    coupling = Dense(x, y, Periodic(1.0, 1.0), periodic=False)
    t, load = np.empty((2, len(at)))
    for i in range(len(at)):
        depth = 1e-6 * (1.0 + 0.3 * i)
        t[i] = law.next_state(0.0, True, Surface(depth), WORK, i, asperities)
        load[i] = 1.2 * law.lone_load(t[i], Surface(depth), WORK, i, asperities)
    inside = np.ones(len(at), np.bool_)
    near = coincident.Near(law, asperities, natural, close.find_pairs(at, radius * overlapping, None, growth=1.0))
    problem = PairProblem(law, asperities, coupling, near, order, WORK, natural)
    return problem, evaluate(problem, inside, t, load, -1e-6, np.zeros((5, len(at))))


AT = np.array([[0.0, 0.0], [0.04, 0.01], [-0.02, 0.05], [0.05, 0.06]])


@pytest.mark.few(4)
@pytest.mark.parametrize("overlapping", [False, True])
@pytest.mark.parametrize("name", EXAMPLES)
def test_factors_of_the_first_order_are_the_tangent(name: str, overlapping: bool) -> None:
    problem, state = guess(EXAMPLES[name], AT, 1, overlapping=overlapping)
    assert state.overlap.pairs.share.any() == overlapping
    tangent = Tangent(problem, state, Drive(0.0, np.zeros((5, 4))))
    rng = np.random.default_rng(4)
    step = Step(1e-3 * state.contacts.radius * rng.normal(size=4), 1e-3 * np.abs(state.load) * rng.normal(size=4))
    if problem.kernels.pinned:
        step = step._replace(radius=np.zeros(4))
    found = Factors(problem, state).solve(*tangent.product(step))
    np.testing.assert_allclose(found.load, step.load, rtol=1e-10)
    np.testing.assert_allclose(found.radius, step.radius, rtol=1e-10)


@pytest.mark.parametrize("name", EXAMPLES)
def test_factors_of_the_second_order_near_the_tangent_with_distance(name: str) -> None:
    """By a fourth power or faster: left out are what moments induce."""
    off = []
    for part in (1.0, 2.0, 4.0):
        problem, state = guess(EXAMPLES[name], part * AT, 2)
        tangent = Tangent(problem, state, Drive(0.0, np.zeros((5, 4))))
        gap = 1e-9 * np.array([1.0, -2.0, 0.5, 3.0])
        own = Factors(problem, state)
        rough, exact = own.solve(np.zeros(4), gap), tangent.solve(np.zeros(4), gap, own, 1e-14)
        off.append(float(np.abs(rough.load - exact.load).max() / np.abs(exact.load).max()))
    assert off[0] < 0.05
    if off[0] > 1e-12:
        assert math.log2(off[1] / off[2]) > 3.9


@pytest.mark.parametrize(("overlapping", "order"), [(False, 1), (True, 1), (False, 2), (True, 2)])
@pytest.mark.parametrize("name", EXAMPLES)
def test_what_is_known_of_some_is_not_found_again(name: str, overlapping: bool, order: int) -> None:
    """Two in contact and two beside them: both ways the state is that of all at once."""
    problem, state = guess(EXAMPLES[name], AT, order, overlapping=overlapping)
    inside = np.array([True, True, False, False])
    outer = 1e-3 * np.random.default_rng(3).normal(size=(5, 4)) * np.abs(np.vstack([state.field, state.field[:1]]))
    whole = evaluate(problem, inside, state.t * inside, state.load * inside, -1e-6, outer)
    kept = np.array([0, 1, 3])
    few = equilibrium.part_of(problem.part(kept), kept, whole)
    again = equilibrium.among(problem, kept, few, outer)
    fewer = evaluate(problem.part(kept), *(each[kept] for each in whole[:3]), -1e-6, outer[:, kept])
    for found, exact in ((again, whole), (few, fewer)):
        assert found.error == pytest.approx(exact.error, rel=1e-12)
        for field in ("field", "potential", "by_loads", "release", "edge", "gap", "t", "load", "outer", "inside"):
            scale = np.abs(getattr(whole, field)).max()
            np.testing.assert_allclose(getattr(found, field), getattr(exact, field), rtol=1e-12, atol=1e-14 * scale)
        for one, other in zip((*found.contacts, *found.bells), (*exact.contacts, *exact.bells), strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-14 * np.abs(other).max(initial=0.0))


@pytest.mark.parametrize(("separation", "found"), [(-1e-6, True), (1e-3, False)])
def test_contacts_far_below_the_flat_find_no_rest(separation: float, found: bool) -> None:
    problem, state = guess(EXAMPLES["paraboloid"], AT, 2)
    begin = evaluate(problem, state.inside, state.t, state.load, separation, state.outer)
    assert math.isfinite(begin.error)
    assert math.isfinite(at_rest(problem, begin).error) == found


@pytest.mark.parametrize("overlapping", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_unstable_modes_are_counted(seed: int, overlapping: bool) -> None:
    """Radii below that of a fold have negative stiffness: as many modes as the second derivatives over radii have."""
    rng = np.random.default_rng(seed)
    problem, state = guess(EXAMPLES["paraboloid"], AT, 1, overlapping=overlapping)
    t = state.t * rng.uniform(0.2, 1.1, 4)
    load = np.array([problem.kernels.lone_load(t[i], Surface(0.0), WORK, i, problem.asperities) for i in range(4)])
    state = evaluate(problem, state.inside, t, load, -1e-6, state.outer)
    tangent = Tangent(problem, state, Drive(0.0, np.zeros((5, 4))))
    whole = np.empty((8, 8))
    for column, unit in enumerate(np.eye(8)):
        edge, gap = tangent.product(Step(unit[:4], unit[4:]))
        whole[:, column] = np.concatenate([edge, math.pi * gap])
    over_radii = whole[:4, :4] - whole[:4, 4:] @ np.linalg.solve(whole[4:, 4:], whole[4:, :4])
    negative = int(np.count_nonzero(np.linalg.eigvalsh(0.5 * (over_radii + over_radii.T)) < 0.0))
    assert Factors(problem, state).unstable == negative


@pytest.mark.parametrize(("overlapping", "order"), [(False, 2), (True, 1), (True, 2)])
@pytest.mark.parametrize("name", EXAMPLES)
def test_residuals_are_derivatives_of_the_energy(name: str, overlapping: bool, order: int) -> None:
    """The tangent is the change of the residuals, by differences."""
    problem, state = guess(EXAMPLES[name], AT, order, overlapping=overlapping)
    tangent = Tangent(problem, state, Drive(0.0, np.zeros((5, 4))))
    for asperity in range(4):
        size = 1e-5
        unit = np.eye(4)[asperity]
        for load in (False, True):
            if problem.kernels.pinned and not load:
                continue
            t = [state.t + sign * size * state.t * unit * (not load) for sign in (1.0, -1.0)]
            p = [state.load + sign * size * np.abs(state.load) * unit * load for sign in (1.0, -1.0)]
            more, less = (evaluate(problem, state.inside, *each, -1e-6, state.outer) for each in zip(t, p, strict=True))
            step = Step(
                0.5 * (more.contacts.radius - less.contacts.radius) if not load else np.zeros(4),
                0.5 * (p[0] - p[1]),
            )
            edge, gap = tangent.product(step)
            found = 0.5 * (more.gap - less.gap)
            assert np.abs(found - gap).max() < 1e-7 * np.abs(gap).max()
            if not problem.kernels.pinned:
                found = 0.5 * (more.edge * 2.0 * more.release - less.edge * 2.0 * less.release)
                assert np.abs(found - edge).max() < 1e-6 * np.abs(edge).max()
    size = 1e-11
    more, less = (evaluate(problem, state.inside, state.t, state.load, -1e-6 + h, state.outer) for h in (size, -size))
    edge, gap = Tangent(problem, state, Drive(size, np.zeros((5, 4)))).along()
    assert np.abs(0.5 * (more.gap - less.gap) - gap).max() < 1e-6 * np.abs(gap).max()
    if not problem.kernels.pinned:
        found = 0.5 * (more.edge * 2.0 * more.release - less.edge * 2.0 * less.release)
        scale = max(float(np.abs(edge).max()), 1e-9 * float(np.abs(state.edge * 2.0 * state.release).max()))
        assert np.abs(found - edge).max() < 1e-5 * scale


@pytest.mark.parametrize("name", EXAMPLES)
def test_pairs_overlap_by_the_radii_at_which_profiles_have_risen(name: str) -> None:
    """By the natural depth far above first touch, and by the depth in addition well below it; smoothly between."""
    shape = EXAMPLES[name]
    law, asperities = kernels_of(shape, 2)
    natural = np.array([1e-6, 3e-6])
    if law.pinned:
        np.testing.assert_array_equal(flanks(law, asperities, natural, -1e-5), [asperities.size, [0.0, 0.0]])
        return

    def risen(h: float) -> Floats:
        """Return g at the radii, by their states."""
        radius, found = flanks(law, asperities, natural, h)[0], []
        for i in range(2):
            low, high = 0.0, 1e6
            for _ in range(200):
                middle = 0.5 * (low + high)
                inside = law.terms(middle, law.params_of(asperities.params, i))[0] * asperities.size[i] < radius[i]
                low, high = (middle, high) if inside else (low, middle)
            found.append(law.terms(low, law.params_of(asperities.params, i))[2] * asperities.depth[i])
        return np.array(found)

    rtol = 1e-6 if law.flat else 1e-10  # next to a flat the radius has few digits of the rise
    np.testing.assert_allclose(risen(1.0), natural, rtol=rtol)
    np.testing.assert_allclose(risen(1e-6), natural + np.array([0.0, 1e-6 / 3.0]), rtol=rtol)
    np.testing.assert_allclose(risen(0.0), 1.25 * natural, rtol=rtol)
    np.testing.assert_allclose(risen(-1e-5), natural + 1e-5, rtol=rtol)
    for h in (2e-6, 1e-6, 0.0, -2e-6, -3e-6, -1e-5):
        more, less = (flanks(law, asperities, natural, h + size)[0] for size in (1e-10, -1e-10))
        slope = flanks(law, asperities, natural, h)[1]
        np.testing.assert_allclose((more - less) / 2e-10, slope, rtol=1e-4, atol=1e-4 * np.abs(slope).max())


def plain(function: Any) -> Any:
    return getattr(function, "py_func", function)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_compiled_loops_are_their_sources(name: str) -> None:
    problem, state = guess(EXAMPLES[name], AT, 2)
    law, asperities = problem.kernels, problem.asperities
    field = state.field + 1e-4
    rows, above = np.array([state.edge, state.edge, state.gap]), asperities.height - state.separation
    found: list[list[Floats]] = []
    for run in (lambda function: function, plain):
        contacts = Contacts(*np.zeros((len(Contacts._fields), 4)))
        run(law.fill)(state.inside, state.t, state.load, field, WORK, asperities, contacts)
        compared = rows.copy()
        given = above, contacts, problem.natural, compared
        errors = run(equilibrium._compare)(state.inside, law.pinned, WORK, *given)
        block, cross = np.zeros((2, 4, 4))
        pairs = state.overlap.pairs
        run(factors._fill)(problem.coupling.matrices, pairs, 2, contacts, field[1:3], block, cross)
        matrix = block.copy()
        run(factors._eliminate)(cross, contacts.radius, np.full(4, -0.7), np.full(4, 0.3), matrix)
        changes = np.zeros((5, 4))
        run(_respond)(contacts, 0.01 * contacts.radius, 0.1 * state.load, field, 0.1 * field, 2, changes)
        states = [run(law.next_state)(0.0, True, Surface(2e-6, 0.1, 1e-8), WORK, 1, asperities)]
        states.append(run(law.next_state)(states[0], False, Surface(-1e-3), WORK, 1, asperities))
        states.append(run(law.lone_load)(state.t[1], Surface(2e-6, 0.1, 1e-8), WORK, 1, asperities))
        found.append([np.array(contacts), compared, np.array([*errors, *states]), block, matrix, changes])
    for compiled, source in zip(*found, strict=True):
        np.testing.assert_allclose(compiled, source, rtol=1e-12, atol=1e-14 * np.abs(source).max())


@pytest.mark.parametrize("seed", range(20))
def test_a_bracket_narrows_to_a_root(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root, scale = rng.normal(), 10.0 ** rng.uniform(-9.0, 9.0)
    power = float(rng.choice([1.0, 1.0 / 3.0, 3.0]))

    def value(x: float) -> float:
        return math.copysign(abs(x / scale - root) ** power, x / scale - root)

    low, high = scale * (root - rng.uniform(0.1, 3.0)), scale * (root + rng.uniform(0.1, 3.0))
    bracket = Bracket((low, value(low)), (high, value(high)))
    for _ in range(200):
        point = bracket.next
        assert low <= point <= high
        if bracket.width <= 1e-13 * scale:
            break
        bracket.narrow(point, value(point))
    assert abs(bracket.next - scale * root) <= (1e-4 if power == 3.0 else 1e-12) * scale


def test_a_bracket_with_a_jump_halves() -> None:
    """A straight line through values that jump from -1 to 1e6 goes to one end again and again."""
    bracket, rounds = Bracket((0.0, -1.0), (1.0, 1e6)), 0
    while bracket.width > 1e-10:
        bracket.narrow(bracket.next, -1.0 if bracket.next < 0.37 else 1e6)
        rounds += 1
    assert abs(bracket.next - 0.37) < 1e-10
    assert rounds < 6 * math.log2(1e10)


@pytest.mark.parametrize("count", [1, 3, 6])
def test_mixing_solves_a_linear_iteration_in_as_many_steps_as_unknowns(count: int) -> None:
    """Though the iteration on its own goes away from the fixed point."""
    rng = np.random.default_rng(count)
    matrix = rng.normal(size=(count, count)) + 1.5 * np.eye(count)
    exact = rng.normal(size=count)
    at, mixing = np.zeros(count), Mixing()
    for _ in range(count + 1):
        way = mixing.improved(matrix @ (exact - at))
        mixing.go(way)
        at = at + way
    np.testing.assert_allclose(at, exact, rtol=1e-8)


def test_a_step_that_no_float_holds_is_left_as_it_is() -> None:
    """So that who takes it sees that there is no equilibrium."""
    mixing = Mixing()
    mixing.go(mixing.improved(np.ones(2)))
    for step in ([math.nan, 1.0], [1.0, math.inf]):
        np.testing.assert_array_equal(mixing.improved(np.array(step)), step)


@pytest.mark.parametrize("periodic", [False, True])
def test_matrices_of_more_points_take_over_those_of_the_first(periodic: bool) -> None:
    x, y = np.random.default_rng(3).uniform(0.0, 1.0, (2, 7))
    patch = Periodic.of(1.3)
    known = Dense(x[:4], y[:4], patch, periodic)
    whole = Dense(x, y, patch, periodic)
    np.testing.assert_array_equal(Dense(x, y, patch, periodic, known).matrices, whole.matrices)
