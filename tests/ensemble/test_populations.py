"""Truncated distributions, two populations, correlated heights, random numbers of asperities, and positions."""

import math
from pathlib import Path

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.streams import HEIGHT, PARAMETER, POPULATION, make_streams
from roughmdr.scene import read

UM = 1e-6


def generate(seed: int = 1, realization: int = 0, **changes: object) -> xr.Dataset:
    section = {**ASPERITIES, **changes}
    return rm.generate(
        {key: value for key, value in section.items() if value is not None}, seed=seed, realization=realization
    )


CUT = [
    ({"distribution": "normal", "std": UM, "max": 0.5 * UM}, scipy.stats.truncnorm(-np.inf, 0.5, scale=UM)),
    ({"distribution": "normal", "std": UM, "min": 6 * UM}, scipy.stats.truncnorm(6, np.inf, scale=UM)),
    ({"distribution": "normal", "mean": UM, "std": UM, "min": 0, "max": 9 * UM}, scipy.stats.truncnorm(-1, 8, UM, UM)),
    ({"distribution": "expon", "loc": 0, "scale": UM, "max": 2 * UM}, scipy.stats.truncexpon(2, scale=UM)),
    ({"distribution": "lognorm", "s": 0.4, "loc": 0, "scale": UM, "min": 0}, scipy.stats.lognorm(0.4, scale=UM)),
]


@pytest.mark.parametrize(("entry", "known"), CUT)
def test_a_cut_distribution_is_the_known_one(entry: dict[str, object], known: scipy.stats.rv_continuous) -> None:
    """Quantiles, density, mean and std; and no draw lies beyond the cut."""
    distribution = DistributionReader("m", mean=0.0)(entry)
    levels = np.array([1e-15, 1e-6, 0.1, 0.5, 0.9, 1 - 1e-3])
    values = distribution.quantile(levels)
    np.testing.assert_allclose(values, known.ppf(levels), rtol=1e-12, atol=1e-14 * known.std())
    np.testing.assert_allclose(distribution.density(values), known.pdf(values), rtol=1e-12)
    np.testing.assert_allclose(distribution.from_scores(distribution.scores(values[1:-1])), values[1:-1], rtol=1e-8)
    assert distribution.mean == pytest.approx(known.mean(), rel=1e-12)
    assert distribution.std == pytest.approx(known.std(), rel=1e-10)
    drawn = generate(height=entry, count=2000).height
    assert distribution.min <= float(drawn.min())
    assert float(drawn.max()) <= distribution.max


@pytest.mark.large
@settings(deadline=None, max_examples=40)
@given(
    st.sampled_from([("norm", ()), ("lognorm", (0.7,)), ("gamma", (2.5,)), ("uniform", ()), ("weibull_min", (1.5,))]),
    st.floats(0.02, 0.45),
    st.floats(0.55, 0.98),
    st.sampled_from([1e-9, 1.0]),
)
def test_scores_and_moments_of_any_cut_distribution(
    family: tuple[str, tuple[float, ...]], low: float, high: float, unit: float
) -> None:
    """Scores are the inverse of values; mean and std are those by integration of the density, in any unit."""
    uncut = Distribution(*family, 0.3 * unit, unit)
    least, most = uncut.quantile(np.array([low, high]))
    distribution = Distribution(*family, 0.3 * unit, unit, float(least), float(most))
    scores = np.linspace(-5.0, 5.0, 11)
    np.testing.assert_allclose(distribution.scores(distribution.from_scores(scores)), scores, rtol=1e-8, atol=1e-9)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    z = least + 0.5 * (most - least) * (1.0 + nodes)
    mass = 0.5 * (most - least) * weights * distribution.density(z)
    assert mass.sum() == pytest.approx(1.0, rel=1e-9)
    assert mass @ z == pytest.approx(distribution.mean, rel=1e-9)
    assert math.sqrt(mass @ (z - distribution.mean) ** 2) == pytest.approx(distribution.std, rel=1e-8)


@pytest.mark.large
@pytest.mark.parametrize("rank", [-1.0, -0.6, 0.3, 1.0])
def test_heights_and_radii_are_correlated(rank: float) -> None:
    """Each alone is unchanged: the same heights, and radii from the same distribution."""
    plain, joined = generate(count=20_000), generate(count=20_000, correlation={"radius": rank})
    got = scipy.stats.spearmanr(joined.height, joined.radius).statistic
    assert got == pytest.approx(rank, abs=4.0 / np.sqrt(20_000))
    np.testing.assert_array_equal(plain.height, joined.height)
    spread = np.sqrt(np.log(1.0 + 0.1**2))
    lognormal = scipy.stats.lognorm(spread, scale=50 * UM / np.sqrt(1.0 + 0.1**2))
    draws = [generate(realization=number, correlation={"radius": rank}).radius for number in range(40)]
    levels = [scipy.stats.kstest(radius, lognormal.cdf).pvalue for radius in draws]
    assert scipy.stats.kstest(levels, "uniform").pvalue > 0.01  # levels of a right law are evenly spread


def test_constant_parameters_take_no_random_numbers() -> None:
    drawn: list[int] = []

    def streams(stream: int, count: int) -> np.ndarray:
        drawn.append(stream)
        return make_streams(1, 0)(stream, count)

    equal = {**ASPERITIES, "radius": 50 * UM}
    mixed = {**equal, "second": {"share": 0.3, "radius": ASPERITIES["radius"]}}
    for entry, random in ((equal, [HEIGHT]), (mixed, [HEIGHT, PARAMETER, POPULATION])):
        drawn.clear()
        heights, parameters = read(scene(asperities=entry)).asperities.populations.draw(streams, 5)
        assert sorted(drawn) == sorted(random)
        assert heights.size == parameters["radius"].size == 5


def test_two_populations_are_mixed_by_their_share() -> None:
    second = {"share": 0.3, "height": {"distribution": "normal", "mean": "3 um", "std": "0.1 um"}, "radius": "9 um"}
    mixed = generate(count=20_000, second=second)
    other = mixed.radius == 9 * UM
    assert float(other.mean()) == pytest.approx(0.3, abs=4.0 * np.sqrt(0.21 / 20_000))
    assert float(mixed.height.where(other).mean()) == pytest.approx(3 * UM, abs=0.01 * UM)
    first = generate(count=20_000)  # the others are the same asperities as without a second population
    assert set(mixed.height.to_numpy()[~other.to_numpy()]) <= set(first.height.to_numpy())
    section = rm.run(scene(asperities={**ASPERITIES, "second": second, "count": 50}, path={"separation": ["1 sigma"]}))
    spread = np.sqrt(0.7 * 1.0 + 0.3 * 0.1**2 + 0.7 * 0.3 * 3.0**2) * UM
    assert float(section.separation[0]) == pytest.approx(spread, rel=1e-12)


@pytest.mark.large
def test_the_number_of_asperities_follows_poisson() -> None:
    counts = [generate(seed, count=None, density="50 /mm^2").sizes["asperity"] for seed in range(400)]
    assert np.mean(counts) == pytest.approx(50.0, abs=4.0 * np.sqrt(50.0 / 400))
    assert np.var(counts) == pytest.approx(50.0, rel=4.0 * np.sqrt(2.0 / 400))
    long, short = generate(7, count=1000), generate(7, count=None, density="50 /mm^2")
    assert set(short.height.to_numpy()) <= set(long.height.to_numpy())  # the same draws, only fewer


def test_an_empty_ensemble_bears_no_force() -> None:
    few = {**{key: value for key, value in ASPERITIES.items() if key != "count"}, "density": 1e5}  # 0.1 on a patch
    result = rm.run(scene(asperities=few, batch={"realizations": 50}))
    empty = result.force.max("step") == 0.0
    assert 0 < int(empty.sum()) < 50
    assert np.isfinite(result.force).all()


def nearest(data: xr.Dataset) -> float:
    """The smallest distance between two summits of a periodic patch, over the root of its area."""
    sides = np.array([data.attrs.get("patch", data.attrs.get(f"patch_{name}")) for name in "xy"])
    places = np.column_stack([data.x, data.y])
    apart = np.abs(places[:, None] - places[None])
    apart = np.hypot(*np.minimum(apart, sides - apart).T)
    return float(apart[np.triu_indices(len(places), 1)].min() / np.sqrt(sides.prod()))


def test_positions() -> None:
    """They lie within the patch, at the distance asked for or on a lattice, and never change the heights."""
    plain = generate(count=500)
    assert "x" not in plain
    for changes in (
        {"placement": "random"},
        {"placement": "hexagonal"},
        {"placement": "hard_core", "min_distance": "30 um"},
    ):
        data = generate(count=500, **changes)
        np.testing.assert_array_equal(data.height, plain.height)
        for name in ("x", "y"):
            assert float(data[name].min()) >= 0.0
            assert float(data[name].max()) < data.attrs.get("patch", data.attrs.get(f"patch_{name}"))
    assert nearest(data) >= 0.03
    lattice = generate(count=780, placement="hexagonal")  # 30 rows of 26
    assert nearest(lattice) == pytest.approx(np.sqrt(2.0 / (np.sqrt(3.0) * 780)), rel=1e-9)
    assert nearest(generate(count=780, placement="random")) < 0.1 * nearest(lattice)


@pytest.mark.parametrize("distance", ["40 um", "33 um", "0.9 mm"])
def test_positions_that_do_not_fit_are_refused(distance: str) -> None:
    with pytest.raises(rm.OutOfRange, match=r"do not fit so far apart on a patch of 0\.001 m; at random about"):
        generate(count=650, placement="hard_core", min_distance=distance)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"density": "5 /mm^2"}, "density = 5000000.0: does not go with count"),
        ({"count": None, "density": "1e30 /m^2"}, "asperities.density = 1e"),
        ({"correlation": {}}, "names no parameter of the paraboloid; it takes radius"),
        ({"correlation": {"radius": 1.1}}, "correlation.radius = 1.1: must be at most 1"),
        ({"correlation": {"radius": 0.5}, "radius": "1 um"}, "needs a radius that is not always the same"),
        ({"correlation": {"radius": 0.5}, "height": "1 um"}, "needs a height that is not always the same"),
        ({"second": {"radius": "1 um"}}, "second.share: is missing"),
        ({"second": {"share": 0.5, "slope": 1}}, "second.slope: unknown key"),
        ({"height": {"distribution": "normal", "std": UM, "min": UM, "max": 0}}, "must be above min"),
        ({"height": {"distribution": "normal", "std": UM, "min": 1.0}}, "next to nothing between min"),
    ],
)
def test_contradictory_keys_are_refused(changes: dict[str, object], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        generate(**changes)


def test_an_ensemble_from_a_file_is_that_ensemble(tmp_path: Path) -> None:
    """Its curves are those of the ensemble in Python, in any order and unit; other files are refused."""
    data = generate(count=300)
    path = [2 * UM, 0.5 * UM, 2 * UM]
    curves = rm.load_separation(data, separation=path, effective_modulus=4e6, work=0.05)
    turned = data.isel(asperity=slice(None, None, -1))
    turned["height"] = turned.height * 1e6
    turned["height"].attrs["units"] = "um"
    turned.to_netcdf(tmp_path / "own.nc")
    asked = scene(
        asperities={"source": "file", "file": str(tmp_path / "own.nc")},
        material={"effective_modulus": 4e6},
        path={"separation": path},
        batch=None,
    )
    run = rm.run(asked)
    np.testing.assert_allclose(run.force[0], curves.force, rtol=1e-9)
    again = rm.generate(asked["asperities"], seed=0)
    np.testing.assert_allclose(again.height, data.height, rtol=1e-15)
    assert again.attrs["patch"] == data.attrs["patch"]
    for name, change in (("no shape", {}), ("no height", {"shape": "paraboloid"})):
        xr.Dataset(attrs=change).to_netcdf(tmp_path / f"{name}.nc")
        with pytest.raises(rm.SceneError, match=f"{name}.nc: ensemble: "):
            rm.run({**asked, "asperities": {"source": "file", "file": str(tmp_path / f"{name}.nc")}})
    (tmp_path / "text.nc").write_text("height")
    with pytest.raises(rm.SceneError, match="not a netCDF file"):
        rm.run({**asked, "asperities": {"source": "file", "file": str(tmp_path / "text.nc")}})


@pytest.mark.parametrize("end", [{"max": -20 * UM}, {"min": 20 * UM}])
def test_moments_far_out_in_a_tail(end: dict[str, float]) -> None:
    """The excess over a cut far out is nearly exponential, with a mean of a twentieth of the std."""
    distribution = DistributionReader("m", mean=0.0)({"distribution": "normal", "std": UM, **end})
    assert abs(distribution.mean) - 20 * UM == pytest.approx(UM * (1 / 20 - 2 / 20**3), rel=1e-3)
    assert distribution.std == pytest.approx(UM * (1 / 20 - 3 / 20**3), rel=1e-3)


def test_warnings_of_scipy_are_suppressed() -> None:
    """Both where a distribution is read and where it is refused."""
    drawn = DistributionReader("m")({"distribution": "invgauss", "mu": 0.3541, "scale": 1e-6, "mean": 314.0})
    assert (np.diff(drawn.quantile(np.linspace(0.01, 0.99, 50))) >= 0.0).all()
    with pytest.raises(rm.RoughmdrError, match="cannot be drawn from"):
        DistributionReader("m")({"distribution": "weibull", "c": 1e-4, "scale": 1e-6})


@pytest.mark.parametrize("mu", [0.02, 0.1, 0.3, 1.0])
@pytest.mark.parametrize("unit", [1e-9, 1.0])
def test_moments_of_a_family_whose_inverse_is_wrong_far_out(mu: float, unit: float) -> None:
    """scipy's inverse of invgauss is wrong by up to 200 orders for fractions below 1e-16 to 1e-50."""
    distribution = Distribution("invgauss", (mu,), 0.0, unit, min=-unit)  # which cuts nothing off
    assert distribution.mean == pytest.approx(mu * unit, rel=1e-11, abs=0.0)
    assert distribution.std == pytest.approx(mu**1.5 * unit, rel=1e-11, abs=0.0)


def test_populations_so_far_apart_that_squares_overflow_have_a_spread() -> None:
    far = {"height": {"distribution": "normal", "mean": 1e200, "std": 1.0}, "share": 0.5}
    section = read(scene(asperities={**ASPERITIES, "second": far})).asperities
    assert section.sigma == pytest.approx(0.5e200, rel=1e-12, abs=0.0)
