"""The expected law on unloading, where of the lowest summits some have detached, against plain nested quadrature.

The twin knows nothing of the package: JKR's equations with the contact radius as variable, the depth of detachment by
bisection, and over the shape parameters panels that end where the depth has the value at which there is a kink.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from numpy.polynomial.hermite_e import hermegauss
from numpy.polynomial.legendre import leggauss
from scenes import ensemble
from scipy.stats import norm

import roughmdr as rm
from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import FORCE
from roughmdr.ensemble.nodes import Rule
from roughmdr.expected.converge import FIRST_ORDER, converge_at_kinks
from roughmdr.expected.detached import PartialRule
from roughmdr.expected.node import MeanProblem, set_up, totals_of
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import read

UM = 1e-6
MODULUS, WORK = 4e6, 0.05
BISECTIONS = 60
INNER, HEIGHTS = 20, 24  # nodes on each panel
SPLIT = "flat_radius", "width", "radius", "slope"
"""The parameter whose panels end at the kink is the first of these."""
NORMAL = {"distribution": "normal", "std": "1 um"}


def lognormal(mean: float, std: float) -> dict[str, object]:
    return {"distribution": "lognormal", "mean": mean, "std": std}


def values_of(entry: object, score: Floats) -> Floats:
    """Return the parameter at normal scores."""
    if not isinstance(entry, dict):
        return np.full_like(score, float(str(entry)))
    if entry["distribution"] == "uniform":
        return np.asarray(entry["loc"] + entry["scale"] * norm.cdf(score))
    variance = math.log1p((entry["std"] / entry["mean"]) ** 2)
    return np.asarray(entry["mean"] * np.exp(math.sqrt(variance) * score - 0.5 * variance))


class Profile(NamedTuple):
    """g, g' and ∫ x g' dx of a shape (Hess 2012, table 1), arrays of a and of the parameters, and where flats end."""

    g: Callable[..., Floats]
    slope: Callable[..., Floats]
    moment: Callable[..., Floats]
    corner: Callable[..., Floats]


def kappa(n: Floats) -> Floats:
    return np.asarray(0.5 * math.sqrt(math.pi) * n * np.exp(gammaln(0.5 * n) - gammaln(0.5 * n + 0.5)))


def gammaln(x: Floats) -> Floats:
    from scipy.special import gammaln as log_gamma

    return np.asarray(log_gamma(x))


def _root(a: Floats, b: Floats) -> Floats:
    return np.sqrt(np.maximum((a - b) * (a + b), 0.0))


PROFILES = {
    "paraboloid": Profile(
        lambda a, radius: a * a / radius,
        lambda a, radius: 2.0 * a / radius,
        lambda a, radius: 2.0 * a**3 / (3.0 * radius),
        lambda radius: 0.0 * radius,
    ),
    "cone": Profile(
        lambda a, slope: 0.5 * math.pi * slope * a,
        lambda a, slope: 0.5 * math.pi * slope + 0.0 * a,
        lambda a, slope: 0.25 * math.pi * slope * a * a,
        lambda slope: 0.0 * slope,
    ),
    "sphere": Profile(
        lambda a, radius: a * np.arctanh(a / radius),
        lambda a, radius: np.arctanh(a / radius) + a * radius / (radius * radius - a * a),
        lambda a, radius: 0.5 * (a * a + radius * radius) * np.arctanh(a / radius) - 0.5 * radius * a,
        lambda radius: 0.0 * radius,
    ),
    "power_law": Profile(
        lambda a, exponent, width, rise: kappa(exponent) * rise * (a / width) ** exponent,
        lambda a, exponent, width, rise: exponent * kappa(exponent) * rise * (a / width) ** exponent / a,
        lambda a, exponent, width, rise: (
            exponent / (exponent + 1.0) * kappa(exponent) * rise * a * (a / width) ** exponent
        ),
        lambda exponent, width, rise: 0.0 * width,
    ),
    "truncated_cone": Profile(
        lambda a, slope, flat_radius: slope * a * np.arccos(np.minimum(flat_radius / a, 1.0)),
        lambda a, slope, flat_radius: (
            slope
            * (np.arccos(np.minimum(flat_radius / a, 1.0)) + flat_radius / np.maximum(_root(a, flat_radius), 1e-30))
        ),
        lambda a, slope, flat_radius: (
            0.5 * slope * (a * a * np.arccos(np.minimum(flat_radius / a, 1.0)) + flat_radius * _root(a, flat_radius))
        ),
        lambda slope, flat_radius: flat_radius,
    ),
}


class Asperities(NamedTuple):
    """Asperities, arrays over their parameters; at detachment contacts are smaller than ``reach`` [m]."""

    profile: Profile
    parameters: list[Floats]
    reach: float = 8.0 * UM

    def indentation(self, a: Floats) -> Floats:
        own = [column.reshape(column.shape + (1,) * (a.ndim - 1)) for column in self.parameters]
        return self.profile.g(a, *own) - np.sqrt(2.0 * math.pi * WORK * a / MODULUS)

    def slope(self, a: Floats) -> Floats:
        own = [column.reshape(column.shape + (1,) * (a.ndim - 1)) for column in self.parameters]
        return self.profile.slope(a, *own) - 0.5 * np.sqrt(2.0 * math.pi * WORK / MODULUS / a)

    def force(self, a: Floats) -> Floats:
        own = [column.reshape(column.shape + (1,) * (a.ndim - 1)) for column in self.parameters]
        return 2.0 * MODULUS * (self.profile.moment(a, *own) - a * np.sqrt(2.0 * math.pi * WORK * a / MODULUS))

    @property
    def fold(self) -> Floats:
        """Return the contact radius at detachment."""
        corner = self.profile.corner(*self.parameters)
        low, high = np.maximum(corner, 1e-12), corner + self.reach
        for _ in range(BISECTIONS):
            middle = np.sqrt(low * high)
            falls = self.slope(middle) < 0.0
            low, high = np.where(falls, middle, low), np.where(falls, high, middle)
        return np.where(corner > 0.0, corner, high)

    def force_above(self, lowest: Floats, h: float, mean: Floats, std: float) -> Floats:
        """Return the mean force of the summits from ``lowest`` on, under the flat at h; heights are normal."""
        nodes, weights = leggauss(HEIGHTS)
        y, weights = 0.5 * (1.0 + nodes), 0.5 * weights
        corner, fold = self.profile.corner(*self.parameters)[:, None], self.fold[:, None]
        ends = mean[:, None] + std * np.array([-9.0, -6.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 6.0, 9.0])
        level = np.maximum(np.column_stack([lowest, np.maximum(ends, lowest[:, None])]) - h, self.indentation(fold))
        low = _root(fold, corner) + 0.0 * level  # in sqrt(a^2 - corner^2) all is smooth, also at a corner
        high = low + 5.0 * self.reach
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            below = self.indentation(np.hypot(corner, middle)) < level
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        begin, width = high[:, :-1, None], np.diff(high, axis=1)[:, :, None]
        q = begin + width * y
        a = np.hypot(corner[:, :, None], q)
        density = np.exp(-0.5 * ((h + self.indentation(a) - mean[:, None, None]) / std) ** 2)
        integrand = self.force(a) * density * self.slope(a) * (q / a) * width
        return np.asarray((integrand @ weights).sum(axis=1) / (std * math.sqrt(2.0 * math.pi)))


def mean_force(case: dict[str, object], h: float, bottom: float, order: int) -> float:
    """Return the mean force of an asperity after loading to ``bottom``, at h, by nested quadrature over the scores."""
    profile = PROFILES[str(case["shape"])]
    names = [name for name in case if name not in ("shape", "correlation")]
    drawn = [name for name in names if isinstance(case[name], dict)]
    rank = next(iter(dict(case.get("correlation", {"": 0.0})).values()))  # type: ignore[call-overload]
    correlation = 2.0 * math.sin(math.pi * rank / 6.0)
    inner = next(name for name in SPLIT if name in drawn)
    outer = [name for name in drawn if name != inner]
    scores, shares = hermegauss(order)
    shares = shares / shares.sum()
    grid = np.meshgrid(*[scores] * len(outer), indexing="ij") if outer else []
    weight = np.ones(1)
    for _ in outer:
        weight = np.multiply.outer(weight, shares).ravel()
    fixed = {name: values_of(case[name], one.ravel()) for name, one in zip(outer, grid, strict=True)}
    fixed |= {name: values_of(case[name], np.zeros(weight.size)) for name in names if name not in drawn}

    def asperities(score: Floats) -> Asperities:
        repeat = score.size // weight.size
        columns = {name: np.repeat(column, repeat) for name, column in fixed.items()} | {
            inner: values_of(case[inner], score)
        }
        return Asperities(profile, [columns[name] for name in names])

    def depth(score: Floats) -> Floats:
        one = asperities(score)
        return -one.indentation(one.fold)

    low, high = np.full(weight.size, -8.5), np.full(weight.size, 8.5)
    rises = depth(high) > depth(low)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        deeper = (depth(middle) > h - bottom) == rises
        low, high = np.where(deeper, low, middle), np.where(deeper, middle, high)
    nodes, weights = leggauss(INNER)
    y = 0.5 * (1.0 + nodes)
    total = 0.0
    edges = np.sort(np.column_stack([high, np.tile([-8.5, -5.0, -2.5, 0.0, 2.5, 5.0, 8.5], (weight.size, 1))]), axis=1)
    for begin, end in pairwise(edges.T):
        score = (begin[:, None] + (end - begin)[:, None] * y * y * (3.0 - 2.0 * y)).ravel()
        one = asperities(score)
        lowest = np.maximum(bottom, h - (-one.indentation(one.fold)))
        force = one.force_above(lowest, h, correlation * score * UM, math.sqrt(1.0 - correlation**2) * UM)
        share = np.exp(-0.5 * score**2) / math.sqrt(2.0 * math.pi) * force
        widths = (end - begin)[:, None] * 3.0 * y * (1.0 - y) * weights
        total += float((weight[:, None] * widths * share.reshape(weight.size, -1)).sum())
    return total


RADIUS = lognormal(50.0 * UM, 5.0 * UM)
CASES: list[dict[str, object]] = [
    {"shape": "paraboloid", "radius": RADIUS},
    {"shape": "paraboloid", "radius": {"distribution": "uniform", "loc": 40.0 * UM, "scale": 20.0 * UM}},
    {"shape": "paraboloid", "radius": RADIUS, "correlation": {"radius": -0.6}},
    {"shape": "sphere", "radius": RADIUS},
    {"shape": "cone", "slope": lognormal(0.2, 0.02)},
    {"shape": "truncated_cone", "slope": lognormal(0.2, 0.02), "flat_radius": lognormal(UM, 0.1 * UM)},
    {
        "shape": "power_law",
        "exponent": 2.0,
        "width": lognormal(5.0 * UM, 0.5 * UM),
        "rise": lognormal(0.3 * UM, 0.03 * UM),
    },
]
TURN = -0.2 * UM


def made_of(case: dict[str, object], path: list[float], **more: object) -> dict[str, object]:
    return {
        "material": {"effective_modulus": MODULUS},
        "adhesion": {"model": "jkr", "work": WORK},
        "asperities": {"source": "random", "count": 1, "patch": "1 mm", "height": NORMAL, **case},
        "path": {"separation": path},
        "batch": {"estimator": "expected"},
        **more,
    }


def rises_of(case: dict[str, object]) -> list[float]:
    """Return rises of the flat [m] over the middle of the depths of an ensemble."""
    ensemble = rm.generate({**made_of({**case}, [0.0])["asperities"], "count": 400}, seed=1)  # type: ignore[dict-item]
    names = [name for name in case if name not in ("shape", "correlation")]
    one = Asperities(PROFILES[str(case["shape"])], [ensemble[name].to_numpy() for name in names])
    depths = -one.indentation(one.fold)
    return np.asarray(np.quantile(depths, [0.1, 0.5, 0.8])).tolist()


@pytest.mark.few(2)
@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, (case["shape"], *list(case)[1:]))))
def test_unloading_against_nested_quadrature(case: dict[str, object]) -> None:
    """At steps at which of the lowest summits some have detached, within the stated error, which is small."""
    rises = rises_of(case)
    path = [3.0 * UM, TURN, *(TURN + rise for rise in rises), 3.0 * UM]
    got = rm.run(made_of(case, path)).isel(realization=0)
    force, stated = got.force.to_numpy(), float(got.numerical_error)
    largest = float(np.abs(force).max())
    several = sum(isinstance(entry, dict) for entry in case.values()) > 1
    for h, value in zip(path[2:-1], force[2:-1], strict=True):
        twin, coarse = (mean_force(case, h, TURN, order) for order in ((20, 16) if several else (1, 1)))
        assert abs(twin - coarse) <= 1e-11 * largest
        assert abs(value - twin) <= (stated + 1e-11) * largest
    assert stated < 1e-9


M0, M2, M4 = UM * UM, 4.2e-3, 1.8e8
NAYAK = {"source": "nayak", "patch": "1 mm", "m0": M0, "m2": M2, "m4": M4}


def mean_force_of_summits(h: float, bottom: float, order: int) -> float:
    """Return the mean force of the summits of a Gaussian surface after loading to ``bottom``, at h.

    By quadrature over t, y = t^3 and u, y^2 and y + u the product of the curvatures and their mean without units, whose
    density is sqrt(6/pi) y^2 exp(y^2 - 3/2 (y + u)^2) 2 y; given these the height is normal (Nayak 1971).
    """
    part = 1.5 * M2 * M2 / (M0 * M4)

    def asperities(t: Floats) -> Asperities:
        return Asperities(PROFILES["paraboloid"], [math.sqrt(1.5 / M4) / t**3], reach=1e-2)

    def depth(t: float) -> float:
        one = asperities(np.array([t]))
        return float(-one.indentation(one.fold)[0])

    low, high = 0.05, 2.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if depth(middle) > h - bottom else (low, middle)
    edges = np.unique([0.05, 0.35, 0.7, 1.0, 1.3, 1.6, 2.0, high])  # a fraction of 1e-16 lies below the first
    nodes, weights = leggauss(order)
    x, weights = 0.5 * (1.0 + nodes), 0.5 * weights
    total = 0.0
    for begin, end in pairwise(edges.tolist()):
        t, wide = begin + (end - begin) * x * x * (3.0 - 2.0 * x), (end - begin) * 6.0 * x * (1.0 - x) * weights
        for low_u, high_u in pairwise([0.0, 1.0, 2.5, 6.0]):
            u, wide_u = low_u + (high_u - low_u) * x, (high_u - low_u) * weights
            y, S = np.repeat(t**3, order), np.add.outer(t**3, u).ravel()
            share = math.sqrt(6.0 / math.pi) * y * y * np.exp(y * y - 1.5 * S * S) * 2.0 * y
            share *= np.outer(3.0 * t * t * wide, wide_u).ravel()
            one = asperities(np.repeat(t, order))
            lowest = np.maximum(bottom, h + one.indentation(one.fold))
            force = one.force_above(lowest, h, math.sqrt(part * M0) * S, math.sqrt(M0 * (1.0 - part)))
            total += float((share * force).sum())
    return total


@pytest.mark.large
def test_summits_of_gaussian_surfaces_against_nested_quadrature() -> None:
    """Their radius has a pole, and goes with the height."""
    path = [4.0 * UM, 0.5 * UM, 0.8 * UM, 4.0 * UM]
    asked = made_of({}, path)
    got = rm.run({**asked, "asperities": NAYAK}).isel(realization=0)
    force, stated = got.force.to_numpy(), float(got.numerical_error)
    count = read({**asked, "asperities": NAYAK}).asperities.expected_count
    twin, coarse = (count * mean_force_of_summits(0.8 * UM, 0.5 * UM, order) for order in (20, 16))
    largest = float(np.abs(force).max())
    assert abs(twin - coarse) <= 1e-10 * largest
    assert abs(force[2] - twin) <= (stated + 1e-10) * largest
    assert stated < 1e-9


def test_each_parameter_has_as_many_scores_as_it_needs() -> None:
    """The flat, on which the depth of detachment depends most, has more than the slope."""
    case = CASES[5]
    separation = np.array([3.0 * UM, TURN, *(TURN + rise for rise in rises_of(case))])
    chosen, _ = converge_at_kinks(problem_of(case, separation), dissipating=False)
    slope, flat = (rule.scores.size for rule in chosen.rules)
    assert slope == FIRST_ORDER < flat <= 18
    assert len(chosen.nodes) == slope * flat
    assert chosen.error < 1e-10


def test_weights_of_parts_integrate_polynomials() -> None:
    """Up to any score, and with all that lies above to the weights of the whole."""
    rule, ends = Rule.smooth(12), np.array([-np.inf, -3.0, -0.4, 0.0, 1.7, np.inf])
    below = rule.weights_below(ends)
    x, weights = leggauss(200)
    for power in range(12):
        scale = float(rule.weights @ np.abs(rule.scores) ** power)
        for end, part in zip(np.clip(ends, -12.0, 12.0).tolist(), below, strict=True):
            score = 0.5 * (end - 12.0) + 0.5 * (end + 12.0) * x
            exact = 0.5 * (end + 12.0) * float((weights * norm.pdf(score) * score**power).sum())
            assert abs(float(part @ rule.scores**power) - exact) <= 1e-12 * scale
    np.testing.assert_allclose(below[-1], rule.weights, rtol=1e-9)


def problem_of(case: dict[str, object], separation: Floats) -> MeanProblem:
    made = read(made_of(case, separation.tolist()))
    path = LoadingPath.along(separation, unload=False, adhesive=True)
    return MeanProblem(made.asperities, path, made.effective_modulus, made.adhesion_model, (FORCE,))


@pytest.mark.large
def test_the_error_falls_exponentially_with_the_order() -> None:
    """Without the parts it falls about as one over the order squared."""
    case = CASES[-1]
    separation = np.array([3.0 * UM, TURN, *(TURN + rise for rise in rises_of(case))])
    problem, steps = problem_of(case, separation), list(range(separation.size))
    exact = np.array([mean_force(case, h, TURN, 20) for h in separation[2:].tolist()])
    parts, whole = [], []
    for order in (8, 12, 18):
        rule = Rule.smooth(order)
        nodes = set_up(problem, rule)
        partial = PartialRule.of(problem, (rule, rule), nodes)
        assert partial is not None
        whole.append(np.abs(totals_of(nodes, separation, (FORCE,), steps)[0][FORCE, 2:] - exact).max())
        parts.append(np.abs(partial.totals(steps)[0][FORCE, 2:] - exact).max())
    assert parts[0] > 30.0 * parts[1] > 1000.0 * parts[2]
    assert whole[2] > 0.1 * whole[1] > 1e3 * parts[1]


def test_the_energy_lost_is_that_of_many_draws_of_the_depth() -> None:
    """Paraboloids lose the energies of jumps times the fractions that made them, by a fine rule over the radius."""
    case = CASES[0]
    path = [3.0 * UM, TURN, *(TURN + rise for rise in rises_of(case)), 3.0 * UM]
    asked = made_of(case, path, output={"variables": ["force", "dissipated_energy"]})
    got = rm.run(asked).isel(realization=0).dissipated_energy.to_numpy()
    score, step = np.linspace(-8.0, 8.0, 400_001, retstep=True)
    share = norm.pdf(score) * step
    one = Asperities(PROFILES["paraboloid"], [values_of(RADIUS, score)])
    depth = -one.indentation(one.fold)
    scale = math.pi * WORK * (2.0 * math.pi * WORK * one.parameters[0] ** 2 / MODULUS) ** (2.0 / 3.0)
    made, lost = 0.6 * scale, 0.4 * 4.0 ** (-4.0 / 3.0) * scale
    in_contact = [norm.sf(TURN / UM)]
    for h in path[2:]:
        in_contact.append(norm.sf(np.maximum(TURN, h - depth) / UM))
    expected = [share @ (made * in_contact[0] + lost * (in_contact[0] - now)) for now in in_contact]
    np.testing.assert_allclose(got[1:], expected, rtol=1e-8)


def count_products(order: int, *, unload: bool) -> int:
    down = np.linspace(4.0 * UM, -0.5 * UM, 40)
    problem = problem_of(CASES[0], np.concatenate([down, down[::-1]]) if unload else down)
    steps = list(range(problem.path.separation.size))
    return totals_of(set_up(problem, Rule.smooth(order)), problem.path.separation, (FORCE,), steps)[1]


def test_heights_above_the_flat_are_integrated_once_for_all_nodes() -> None:
    """And once for loading and unloading; on the way back only those between the flat and the lowest height of each
    node are left to do.
    """
    coarse, fine = (count_products(order, unload=False) for order in (12, 24))
    assert fine < 1.5 * coarse
    assert count_products(12, unload=True) - coarse < 2 * 12 * 40


def test_the_rule_is_left_whole_where_its_parts_do_not_hold() -> None:
    """For heights with an end or a kink, after a second turn, and where no step has a kink."""
    down = np.array([3.0, -0.2, 0.1]) * UM
    rule = Rule.smooth(12)

    def holds(case: dict[str, object], separation: Floats) -> bool:
        problem = problem_of(case, separation)
        return PartialRule.of(problem, (rule,), set_up(problem, rule)) is not None

    assert holds(CASES[0], down)
    assert not holds({**CASES[0], "height": {"distribution": "exponential", "scale": "1 um"}}, down)
    assert not holds({**CASES[0], "height": {"distribution": "laplace", "scale": "1 um"}}, down)
    assert not holds(CASES[0], np.append(down, [0.0, 0.05 * UM]))
    assert not holds(CASES[0], np.array([3.0, -0.2, 2.9]) * UM)


@pytest.mark.large
def test_asperities_of_one_shape_lose_the_energy_of_their_sum() -> None:
    """The shape is one whose energies compiled code calls by address."""
    path = np.array([3.0, -0.2, 0.2, 3.0]) * UM
    case: dict[str, object] = {"shape": "truncated_cone", "slope": 0.2, "flat_radius": UM}
    asked = made_of(case, path.tolist(), output={"variables": ["dissipated_energy"]})
    law = rm.run(asked).isel(realization=0).dissipated_energy.to_numpy()
    heights = norm.ppf((np.arange(2000) + 0.5) / 2000) * UM
    data = ensemble(heights, shape="truncated_cone", slope=0.2, flat_radius=UM)
    summed = rm.load_separation(
        data, separation=path, effective_modulus=MODULUS, work=WORK, variables="dissipated_energy"
    )
    np.testing.assert_allclose(law, summed.dissipated_energy.to_numpy() / 2000, rtol=0.0, atol=2e-3 * law.max())
