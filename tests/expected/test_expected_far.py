"""The expected law where densities have poles or heavy tails: within its error bound, or refused.

Most values of these distributions lie within one rounding of an end, or very few of them bear most of the force.
"""

import copy
import math

import numpy as np
import pytest
import scipy.stats
from forms import large
from hypothesis import given, settings, strategies as st
from mpmath import mp, mpf
from twins.all_distributions import Scene, draw, families, judge
from twins.quantile_means import mean_of_correlated, mean_of_heights, mean_of_radii

import roughmdr as rm
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.population import heights_of
from roughmdr.expected.heights import HeightTable

UM = 1e-6
POLES = [
    ("powerlaw", {"a": 0.03}),
    ("powerlaw", {"a": 0.1}),
    ("beta", {"a": 3.0, "b": 0.05}),
    ("beta", {"a": 0.05, "b": 3.0}),
    ("beta", {"a": 0.05, "b": 0.5}),
    ("weibull_min", {"c": 0.2}),
    ("gamma", {"a": 0.1}),
    ("gamma", {"a": 0.2}),
    ("dgamma", {"a": 0.1}),
    ("dweibull", {"c": 0.3}),
]


def expected(height: dict[str, object], separation: list[float], **more: object) -> object:
    asperities = {"source": "random", "shape": "paraboloid", "count": 1000, "patch": "1e20 m", "radius": "50 um"}
    scene = {
        "material": {"effective_modulus": "4 MPa"},
        "asperities": {**asperities, "height": height, **more.pop("asperities", {})},
        "path": {"separation": separation},
        "output": {"variables": ["force", "contact_count"]},
        **({"batch": {"estimator": "expected"}} if "accuracy" not in more else {}),
        **more,
    }
    return rm.run(scene).isel(realization=0, missing_dims="ignore")


@pytest.mark.few(1)
@pytest.mark.parametrize(("family", "own"), POLES)
@pytest.mark.parametrize(("loc", "unit"), [(0.0, UM), (1e-3, UM), (-2.0, 1e-2)])
def test_heights_whose_density_has_a_pole(family: str, own: dict[str, float], loc: float, unit: float) -> None:
    """All heights count, however near to the pole; wherever the pole lies and whatever the unit."""
    height = {"distribution": family, **own, "loc": loc, "scale": 2.0 * unit}
    separation = [loc + unit, loc + 0.01 * unit, loc, loc - unit]
    law = expected(height, separation, asperities={"radius": 50.0 * unit})
    from_loc = getattr(scipy.stats, family)(**own, scale=2.0 * unit)  # without the roundings of loc
    np.testing.assert_allclose(law.contact_count, 1000.0 * from_loc.sf(np.array(separation) - loc), rtol=1e-9)
    means = [mean_of_heights(from_loc, h - loc, 1.5) for h in separation]
    force = 1000.0 * 4.0 / 3.0 * 4e6 * math.sqrt(50.0 * unit) * np.array([mean.value for mean in means])
    doubt = max(mean.doubt for mean in means) / max(mean.value for mean in means)
    assert doubt < 1e-10
    off = float(np.abs(law.force - force).max() / force.max())
    assert off <= float(law.numerical_error) + doubt
    assert float(law.numerical_error) < 1e-5


@pytest.mark.few(1)
@pytest.mark.parametrize(("df", "worst"), [(1.8, 2e-12), (1.6, 1e-7), (1.55, 2e-4)])
def test_heights_of_heavy_tails(df: float, worst: float) -> None:
    """E[T^1.5; T > 0] of Student's t has a closed form; very few of the heights bear most of it."""
    law = expected({"distribution": "t", "df": df, "loc": 0.0, "scale": "2 um"}, [0.0])
    with mp.workdps(30):
        n, p = mpf(df), mpf(3) / 2
        moment = n ** (p / 2) * mp.gamma((p + 1) / 2) * mp.gamma((n - p) / 2) / (2 * mp.sqrt(mp.pi) * mp.gamma(n / 2))
        force = float(1000 * mpf(4) / 3 * mpf(4e6) * mp.sqrt(mpf(5e-5)) * mpf(2e-6) ** p * moment)
    stated = float(law.numerical_error)
    assert abs(float(law.force[0]) / force - 1.0) <= stated
    assert stated < worst


@pytest.mark.parametrize("heavy", [{"distribution": "t", "df": 1.4}, {"distribution": "pareto", "b": 1.5}])
def test_heights_whose_mean_force_has_no_bound(heavy: dict[str, object]) -> None:
    with pytest.raises(rm.OutOfRange, match="the mean force of these paraboloids is not known to have a bound"):
        expected({**heavy, "loc": 0.0, "scale": "2 um"}, [0.0])


RADII = [
    ("beta", {"a": 0.05, "b": 0.05}),
    ("beta", {"a": 3.0, "b": 0.05}),
    ("arcsine", {}),
    ("gamma", {"a": 0.1}),
    ("weibull_min", {"c": 0.2}),
    ("pareto", {"b": 1.05}),
    ("bradford", {"c": 1e5}),
]


@pytest.mark.few(1)
@pytest.mark.parametrize(("family", "own"), RADII)
def test_radii_whose_density_has_a_pole_or_a_heavy_tail(family: str, own: dict[str, float]) -> None:
    law = expected(
        {"distribution": "normal", "std": "1 um"},
        [2 * UM, 0.0, -UM],
        asperities={"radius": {"distribution": family, **own, "loc": 0.0, "scale": "50 um"}},
    )
    root = mean_of_radii(getattr(scipy.stats, family)(**own, scale=5e-5), 0.5)
    heights = [mean_of_heights(scipy.stats.norm(scale=UM), h, 1.5).value for h in (2 * UM, 0.0, -UM)]
    force = 1000.0 * 4.0 / 3.0 * 4e6 * root.value * np.array(heights)
    off = float(np.abs(law.force - force).max() / force.max())
    assert off <= float(law.numerical_error) + root.doubt / root.value
    assert float(law.numerical_error) < 1e-10


@pytest.mark.large
@pytest.mark.parametrize("c", [0.6, 0.8, 0.95, 1.2])
def test_an_area_that_has_no_mean_is_refused(c: float) -> None:
    """With Lomax's radii the mean force depends on their mean root, the mean area on their mean."""
    height = {"distribution": "uniform", "loc": 0.0, "scale": UM}
    radius = {"distribution": "lomax", "c": c, "loc": 0.0, "scale": "50 um"}
    both = {"asperities": {"radius": radius}, "output": {"variables": ["force", "contact_area"]}}
    alone = expected(height, [0.0], **{**copy.deepcopy(both), "output": {"variables": ["force"]}})
    root = math.gamma(1.5) * math.gamma(c - 0.5) / math.gamma(c) * math.sqrt(5e-5)
    force = 1000.0 * 4.0 / 3.0 * 4e6 * root * UM**1.5 / 2.5
    assert float(alone.force[0]) == pytest.approx(force, rel=float(alone.numerical_error))
    if c < 1.0:
        with pytest.raises(rm.OutOfRange, match="ask for the force alone"):
            expected(height, [0.0], **both)
    else:
        area = 1000.0 * math.pi * 5e-5 / (c - 1.0) * UM / 2.0
        assert float(expected(height, [0.0], **both).contact_area[0]) == pytest.approx(area, rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("h", [1e-18, 1e-20, 1e-22, 1e-25, 0.0])
def test_a_count_next_to_a_pole_is_right_or_refused(h: float) -> None:
    """Most of the heights lie within a rounding of the scale from the pole."""
    height = {"distribution": "gamma", "a": 0.01, "loc": 0.0, "scale": UM}
    try:
        count = float(expected(height, [UM, h]).contact_count[1])
    except rm.OutOfRange as error:
        assert "next to a pole" in str(error)  # noqa: PT017
        assert 0.0 < h < 1e-13 * UM
    else:
        assert count == pytest.approx(1000.0 * scipy.stats.gamma(0.01, scale=UM).sf(h), rel=1e-9)
    alone = expected(height, [UM, h], output={"variables": ["force"]})
    assert float(alone.numerical_error) < 1e-6


BOUNDED = [
    ("uniform", {}, -0.9),
    ("uniform", {}, 0.99),
    ("beta", {"a": 2.0, "b": 2.0}, 0.99),
    ("beta", {"a": 0.3, "b": 0.5}, -0.9),
    ("expon", {}, 0.99),
    ("weibull_max", {"c": 2.0}, -0.9),
]


@pytest.mark.large
@pytest.mark.parametrize(("family", "own", "spearman"), [*BOUNDED[:2], *(large(*case) for case in BOUNDED[2:])])
def test_heights_correlated_with_an_extreme_radius_may_all_be_equal(
    family: str, own: dict[str, float], spearman: float
) -> None:
    """With the smallest or the largest radii all heights lie next to an end, where floats cannot distinguish them."""
    frozen = getattr(scipy.stats, family)(**own, scale=2 * UM)
    separation = frozen.ppf([0.6, 0.3, 0.01]).tolist()
    s = math.sqrt(math.log(1.01))  # of radii whose std is a tenth of their mean
    radius = {"distribution": "lognormal", "mean": 5e-5, "std": 5e-6}
    asperities = {"radius": radius, "correlation": {"radius": spearman}}
    law = expected({"distribution": family, **own, "loc": 0.0, "scale": 2 * UM}, separation, asperities=asperities)

    def root(scores: np.ndarray) -> np.ndarray:
        return np.exp(0.5 * (math.log(5e-5) - 0.5 * s * s + s * scores))

    correlation = 2.0 * math.sin(math.pi * spearman / 6.0)  # of normal scores
    means = [mean_of_correlated(frozen, h, 1.5, root, correlation) for h in separation]
    force = 1000.0 * 4.0 / 3.0 * 4e6 * np.array(means)
    off = float(np.abs(law.force - force).max() / force.max())
    assert off <= float(law.numerical_error) + 1e-11
    assert float(law.numerical_error) < 1e-7


def test_heights_that_are_all_equal_are_all_counted() -> None:
    """Next to a pole so steep that no node of a rule lies where all heights do."""
    h, k = 11.246767058155399, 21.12384885324702
    law = expected({"distribution": "kappa4", "h": h, "k": k, "loc": 0.0, "scale": 2 * UM}, [0.0, -UM])
    force = 1000.0 * 4.0 / 3.0 * 4e6 * math.sqrt(5e-5) * (2 * UM / k + np.array([0.0, UM])) ** 1.5
    np.testing.assert_allclose(law.force, force, rtol=1e-9)
    np.testing.assert_allclose(law.contact_count, 1000.0, rtol=1e-12)


@pytest.mark.large
@pytest.mark.parametrize("cut", [{"max": "2 um"}, *map(large, [{"max": "4 um"}, {"min": "-2 um"}, {"min": 0.0}])])
def test_truncated_heights_correlated_with_the_radius(cut: dict[str, object]) -> None:
    """So many draws that their mean is right to 1 %."""
    height = {"distribution": "normal", "std": "1 um", "mean": 0.0, **cut}
    radius = {"distribution": "lognormal", "mean": 5e-5, "std": 5e-6}
    more = {"asperities": {"radius": radius, "correlation": {"radius": -0.9}}}
    law = expected(height, [1.5 * UM, 0.0], **copy.deepcopy(more))
    batch = {"estimator": "stratified", "realizations": 64}
    drawn = expected(height, [1.5 * UM, 0.0], **more, batch=batch, output={"keep": "statistics"})
    np.testing.assert_allclose(law.force, drawn.force_mean, rtol=0.01)


def test_a_requested_error_is_reached_next_to_a_pole() -> None:
    """The error bound of the expected law decides whether it is accurate enough."""
    for own, relative in (({"a": 0.03}, 1e-2), ({"a": 3.0, "b": 0.05}, 1e-2)):
        family = "powerlaw" if len(own) == 1 else "beta"
        height = {"distribution": family, **own, "loc": 0.0, "scale": "2 um"}
        accuracy = {"relative": relative, "method": "expected"}
        law = expected(height, [0.0, -UM], accuracy=accuracy)
        frozen = getattr(scipy.stats, family)(**own, scale=2 * UM)
        force = 1000.0 * 4.0 / 3.0 * 4e6 * math.sqrt(5e-5) * mean_of_heights(frozen, -UM, 1.5).value
        assert bool(law.accuracy_reached)
        assert abs(float(law.force[-1]) / force - 1.0) <= min(relative, float(law.numerical_error) + 1e-13)


@pytest.mark.large
@settings(deadline=None, max_examples=30)
@given(st.floats(0.02, 5.0), st.floats(0.02, 5.0), st.sampled_from([0.0, 1e-3]), st.floats(-0.5, 1.5))
def test_the_table_of_heights_counts_all_of_them(a: float, b: float, loc: float, at: float) -> None:
    """The fraction below any height is that of the distribution, within the doubt of the table."""
    distribution = Distribution("beta", (a, b), loc, 2 * UM)
    with np.errstate(all="ignore"):
        table = HeightTable.of(heights_of(distribution))
    y = np.array([2 * UM * at])
    below = table.between(np.array([-UM]), y)[0]
    anywhere = table.doubt[(table.low < y[0]) & (y[0] < table.high), 1].sum()
    unknown = table.doubt[:, 2].sum() + 1e-12
    assert abs(below - scipy.stats.beta(a, b).cdf(y[0] / (2 * UM))) <= anywhere + unknown
    assert abs(table.below[-1] - 1.0) <= unknown
    assert unknown < 1e-8 + np.finfo(np.float64).eps ** b  # what no float next to the upper end tells apart
    np.testing.assert_array_equal(table.low[1:], table.high[:-1])


def of_all_families(seed: int, scenes: int) -> None:
    """Judge so many random scenes, of heights and of radii: none may be wrong, and few are refused."""
    generator = np.random.default_rng(seed)
    names, outcomes = families(), []
    wrong: list[Scene] = []
    while len(outcomes) < scenes:
        scene = draw(generator, str(generator.choice(["heights", "heights", "radii"])), str(generator.choice(names)))
        if scene is None:
            continue
        verdict = judge(scene)
        outcomes.append(verdict.outcome)
        wrong += [verdict] if verdict.outcome == "wrong" else []
    assert not wrong
    assert outcomes.count("right") >= 0.75 * scenes
    assert outcomes.count("no reference") <= 0.1 * scenes


@pytest.mark.large
def test_random_distributions_of_scipy() -> None:
    of_all_families(2026, 40)


@pytest.mark.large
@pytest.mark.parametrize(
    "radius", [{"distribution": "pareto", "b": 0.8}, {"distribution": "beta", "a": 0.05, "b": 0.05}]
)
def test_the_steps_of_the_path_do_not_change_the_force(radius: dict[str, object]) -> None:
    """Contacts have no memory; a large force at one step among many is as accurate as at most of them."""
    height = {"distribution": "uniform", "loc": 0.0, "scale": UM}
    paths = [[2 * UM, 0.0], [2 * UM, 0.0] * 4 + [2 * UM], [2 * UM, 1.9 * UM, 1.8 * UM, 1.7 * UM, 0.0, 2 * UM]]
    laws = [expected(height, path, asperities={"radius": {**radius, "loc": 0.0, "scale": "50 um"}}) for path in paths]
    forces = [float(law.force.max()) for law in laws]
    assert max(forces) / min(forces) - 1.0 <= 2.0 * max(float(law.numerical_error) for law in laws)


@pytest.mark.few(1)
@pytest.mark.parametrize("s", [0.5, 3.0, 5.0])
def test_a_step_back_leaves_the_loading_as_it_is(s: float) -> None:
    """Very few asperities have the large radii that bear the force; a rule with cuts must not leave them out."""
    height = {"distribution": "expon", "loc": 0.0, "scale": UM}
    more = {
        "material": {"effective_modulus": 1e9},
        "adhesion": {"model": "jkr", "work": 0.05},
        "asperities": {"radius": {"distribution": "lognorm", "s": s, "loc": 0.0, "scale": "50 um"}},
    }
    path = [3 * UM, UM, 0.1 * UM]
    loading, turned = (expected(height, steps, **copy.deepcopy(more)) for steps in (path, [*path, 0.4 * UM]))
    stated = float(loading.numerical_error + turned.numerical_error)
    apart = np.abs(loading.force.to_numpy() - turned.force.to_numpy()[:3]).max()
    assert apart <= stated * float(np.abs(turned.force).max())
