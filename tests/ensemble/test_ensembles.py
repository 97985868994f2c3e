"""Random ensembles: the right distribution, the same draws for the same seed, independent streams."""

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from forms import large
from scenes import ASPERITIES, ensemble

import roughmdr as rm
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.random.distribution_families import find_family
from roughmdr.ensemble.streams import SMALLEST_UNIFORM, uniforms


def generate(seed: int = 1, realization: int = 0, **changes: object) -> object:
    return rm.generate({**ASPERITIES, **changes}, seed=seed, realization=realization)


def test_the_stream_is_numpys_philox_under_the_documented_key() -> None:
    raw = np.random.Philox(np.random.SeedSequence(9, spawn_key=(3, 2))).random_raw(5)
    expected = [(int(bits) >> 12) * 2.0**-52 + 2.0**-53 for bits in raw]
    assert uniforms(9, 3, 2, 5).tolist() == expected
    assert uniforms(9, 3, 2, 2).tolist() == expected[:2]
    assert 0.0 < SMALLEST_UNIFORM < 1.0 - SMALLEST_UNIFORM < 1.0


@pytest.mark.large
def test_heights_and_radii_follow_their_distributions() -> None:
    spread = np.sqrt(np.log(1.0 + 0.1**2))
    radius = scipy.stats.lognorm(spread, scale=50e-6 / np.sqrt(1.0 + 0.1**2))
    draws = [generate(realization=realization) for realization in range(100)]
    for name, law in (("height", scipy.stats.norm(0.0, 1e-6)), ("radius", radius)):
        levels = [scipy.stats.kstest(data[name], law.cdf).pvalue for data in draws]
        assert scipy.stats.kstest(levels, "uniform").pvalue > 0.01  # levels of a right law are evenly spread
    data = generate(count=20_000)
    assert float(data.radius.mean()) == pytest.approx(50e-6, rel=4 * 0.1 / np.sqrt(20_000))
    assert float(data.radius.std()) == pytest.approx(5e-6, rel=0.03)
    assert abs(scipy.stats.spearmanr(data.height, data.radius).statistic) < 4.0 / np.sqrt(20_000)


@pytest.mark.parametrize(
    ("entry", "mean", "std"),
    [
        ({"distribution": "norm", "loc": "2 um", "scale": "1 um"}, 2e-6, 1e-6),
        ({"distribution": "exponential", "std": "1 um"}, 0.0, 1e-6),
        ({"distribution": "expon", "loc": 0, "scale": "1 um"}, 1e-6, 1e-6),
        ({"distribution": "gamma", "a": 4, "mean": "3 um", "std": "1 um"}, 3e-6, 1e-6),
        ({"distribution": "uniform", "mean": "1 um", "std": "1 um"}, 1e-6, 1e-6),
        ({"distribution": "halfnorm", "std": "1 um"}, 0.0, 1e-6),
        ({"distribution": "weibull", "c": 2.0, "std": "1 um"}, 0.0, 1e-6),
    ],
)
def test_any_scipy_distribution_with_its_own_or_usual_parameters(
    entry: dict[str, object], mean: float, std: float
) -> None:
    height = generate(count=20_000, height=entry).height
    assert float(height.mean()) == pytest.approx(mean, abs=4.0 * std / np.sqrt(20_000))
    assert float(height.std()) == pytest.approx(std, rel=0.05)


def test_the_contract_of_the_dataset() -> None:
    data = generate(seed=5)
    assert data.sizes == {"asperity": 1000}
    assert data.attrs["shape"] == "paraboloid"
    assert data.attrs["patch"] == 1e-3
    assert data.attrs["nominal_area"] == 1e-6
    assert data.attrs["seed"] == 5
    assert data.height.attrs["units"] == data.radius.attrs["units"] == "m"
    assert (np.diff(data.height) <= 0.0).all()
    fixed = generate(radius="20 um")
    np.testing.assert_array_equal(fixed.radius, np.full(1000, 2e-5))


def test_the_same_seed_gives_the_same_bits_and_streams_do_not_mix() -> None:
    base = generate()
    assert base.equals(generate())
    np.testing.assert_array_equal(base.height, generate(radius="20 um").height)
    assert not np.array_equal(base.height, generate(seed=2).height)
    assert not np.array_equal(base.height, generate(realization=1).height)
    doubled = generate(height={"distribution": "normal", "std": "2 um"})
    np.testing.assert_allclose(doubled.height, 2.0 * base.height, rtol=1e-15)


def of_shape(shape: str, parameters: dict[str, object]) -> xr.Dataset:
    """Asperities of a shape, which have its parameters."""
    section = {key: value for key, value in ASPERITIES.items() if key != "radius"}
    data = rm.generate({**section, "patch": "10 cm", "shape": shape, **parameters}, seed=1)
    assert set(data.data_vars) == {"height", *parameters}
    return data


CONES = {"slope": {"distribution": "uniform", "loc": 0.1, "scale": 0.2}, "flat_radius": "1 um"}
POWERS = {"exponent": {"distribution": "uniform", "loc": 1, "scale": 2}, "coefficient": 1e3}


def test_parameters_of_other_shapes_are_drawn() -> None:
    of_shape("truncated_cone", CONES)
    of_shape("power_law", POWERS)


@pytest.mark.parametrize(
    ("shape", "parameters"),
    [
        ("sphere", {"radius": {"distribution": "uniform", "loc": "1 mm", "scale": "1 mm"}}),
        large("truncated_cone", CONES),
        large(
            "power_law",
            {"exponent": 3, "width": "10 um", "rise": {"distribution": "lognormal", "mean": "1 um", "std": "1 um"}},
        ),
        large("power_law", POWERS),
    ],
)
def test_other_shapes(shape: str, parameters: dict[str, object]) -> None:
    law = rm.load_separation(of_shape(shape, parameters), separation=[1e-6, 0.0], effective_modulus=1e7, work=0.01)
    assert float(law.force[1]) > float(law.force[0])


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"shape": "spheer"}, "asperities.shape = 'spheer': not available"),
        ({"source": "fiel"}, "asperities.source = 'fiel': not available; did you mean 'file'?"),
        ({"source": "file"}, "asperities.file: is missing"),
        ({"count": 0}, "asperities.count = 0: must be from 1"),
        ({"radius": "-1 um"}, "asperities.radius = '-1 um': must be above 0$"),
        (
            {"radius": {"distribution": "normal", "mean": 1e-6, "std": 1e-6}},
            "can be as low as -7.* um; it must be above 0",
        ),
        ({"radius": {"distribution": "lognormal", "mean": "1 um"}}, "lognormal takes a mean above 0 and a std"),
        ({"height": {"distribution": "norml", "std": 1}}, "did you mean 'normal'"),
        (
            {"height": {"distribution": "normal", "sd": 1}},
            "height.sd = 1: normal has no such parameter; it takes loc, scale, mean, std",
        ),
        ({"height": {"distribution": "normal"}}, "needs a std or a scale"),
        ({"height": {"distribution": "normal", "std": 0}}, "height.std = 0: must be above 0"),
        ({"height": {"distribution": "gamma", "std": 1}}, "gamma needs a"),
        ({"height": {"distribution": "gamma", "a": -1, "std": 1}}, "not defined for a = -1"),
        (
            {"height": {"distribution": "lognormal", "mean": 5e-324, "std": 1.0, "max": 10.0}},
            "lognormal has no finite mean and standard deviation",
        ),
        ({"height": {"distribution": "invgauss", "mu": 1e-310, "std": 1}}, r"height\.mu.*1e-12 to 1e\+12 in magnitude"),
        ({"height": {"distribution": "normal", "std": 1, "scale": 1}}, "std or scale, not both"),
        ({"radius": {"distribution": "lognormal", "mean": 1e-200, "std": 1}}, "asperities.radius"),
        ({"patch": "1e999999999 m"}, "asperities.patch"),
        ({"height": {"distribution": "cauchy", "scale": 1e308}}, "cannot be drawn from"),
        ({"min_distance": "1 um"}, 'goes with placement = "hard_core" only'),
        ({"placement": "hard_core"}, "needs min_distance"),
        ({"slope": 1.0}, "asperities.slope: unknown key"),
    ],
)
def test_a_wrong_section_is_refused(changes: dict[str, object], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        generate(**changes)


@pytest.mark.parametrize("seed", [-1, 1.5, True, "7"])
def test_a_wrong_seed_is_refused(seed: object) -> None:
    with pytest.raises(rm.SceneError, match="seed is"):
        rm.generate(ASPERITIES, seed=seed)  # type: ignore[arg-type]


@pytest.mark.parametrize(("name", "own"), [("norm", ()), ("lognorm", (0.3,)), ("lognorm", (4.0,)), ("uniform", ())])
def test_fast_families_are_those_of_scipy_to_the_bit(name: str, own: tuple[float, ...]) -> None:
    drawn = uniforms(3, 1, 0, 10_000)
    levels = np.concatenate([[SMALLEST_UNIFORM], drawn, [1.0 - SMALLEST_UNIFORM]])
    fast, slow = find_family(name), getattr(scipy.stats, name)
    assert fast is not None
    assert fast.parameters == (() if slow.shapes is None else tuple(slow.shapes.split(", ")))
    np.testing.assert_array_equal(fast.ppf(levels, *own), slow.ppf(levels, *own))
    np.testing.assert_array_equal(fast.isf(levels, *own), slow.isf(levels, *own))
    np.testing.assert_allclose(fast.moments(*own), slow.stats(*own, moments="mv"), rtol=1e-14)
    assert fast.is_defined(*own)


def test_the_nominal_area_is_that_of_the_sides_unless_it_is_given() -> None:
    """The area is patch^2, or patch_x patch_y, in any unit; without sides it is not known."""
    for unit in (1e-6, 1.0):
        made = ensemble([0.0], None, radius=unit)
        for attrs, area in (
            ({"patch": 3.0 * unit}, 9.0),
            ({"patch_x": 2.0 * unit, "patch_y": 5.0 * unit}, 10.0),
            ({"patch_x": 2.0 * unit, "patch_y": 5.0 * unit, "nominal_area": 7.0 * unit**2}, 7.0),
        ):
            assert Ensemble.from_dataset(made.assign_attrs(attrs)).nominal_area == pytest.approx(area * unit**2)
        for attrs in ({}, {"patch_x": 2.0 * unit}, {"patch_y": 2.0 * unit}):
            assert Ensemble.from_dataset(made.assign_attrs(attrs)).nominal_area is None
