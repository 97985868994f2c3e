"""Power laws: synthetic ones are found to rounding, their errors as by linear regression."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import roughmdr as rm


def made(y: np.ndarray, x: np.ndarray, dims: tuple[str, ...] = ("step",)) -> xr.Dataset:
    """A law with a stiffness y and a force x, whose flat comes down."""
    steps = np.shape(y)[-1]
    return xr.Dataset(
        {
            "stiffness": (dims, y, {"units": "N m-1", "long_name": "stiffness"}),
            "force": (dims, x, {"units": "N", "long_name": "force"}),
        },
        coords={
            "separation": ("step", np.linspace(1e-6, 0.0, steps), {"units": "m"}),
            "branch": ("step", np.full(steps, "loading")),
        },
    )


def test_a_power_law_is_found_to_rounding() -> None:
    force = np.geomspace(1e-9, 1e-3, 40)
    law = made(3.0e4 * force**0.7, force).roughmdr.fit_power_law("stiffness", "force")
    x0 = np.exp(np.log(force).mean())
    assert float(law.exponent) == pytest.approx(0.7, abs=1e-12)
    assert float(law.x0) == pytest.approx(x0, rel=1e-12)
    assert float(law.coefficient) == pytest.approx(3.0e4 * x0**0.7, rel=1e-12)
    assert float(law.rms_residual) < 1e-12
    assert float(law.points) == 40.0
    assert (law.coefficient.attrs["units"], law.x0.attrs["units"]) == ("N m-1", "N")


def test_the_errors_of_a_single_curve_are_those_of_linear_regression() -> None:
    rng = np.random.default_rng(0)
    force = np.geomspace(1e-6, 1e-3, 30)
    stiffness = force**0.6 * np.exp(rng.normal(0.0, 0.1, force.size))
    law = made(stiffness, force).roughmdr.fit_power_law("stiffness", "force")
    fit = stats.linregress(np.log(force / float(law.x0)), np.log(stiffness))
    assert float(law.exponent) == pytest.approx(fit.slope)
    assert float(law.exponent_error) == pytest.approx(fit.stderr)
    assert float(law.coefficient_error) == pytest.approx(fit.intercept_stderr * np.exp(fit.intercept))


def test_over_realisations_it_is_their_mean_and_standard_error() -> None:
    force = np.broadcast_to(np.geomspace(1e-6, 1e-3, 30), (4, 30))
    exponents, factors = np.array([0.5, 0.6, 0.7, 0.9]), np.array([1.0, 2.0, 3.0, 4.0])
    stiffness = factors[:, None] * (force / np.sqrt(1e-9)) ** exponents[:, None]
    law = made(stiffness, force, ("realization", "step")).roughmdr.fit_power_law("stiffness", "force")
    assert float(law.exponent) == pytest.approx(exponents.mean(), abs=1e-12)
    assert float(law.exponent_error) == pytest.approx(exponents.std(ddof=1) / 2.0)
    assert float(law.coefficient) == pytest.approx(factors.mean(), rel=1e-12)
    assert float(law.coefficient_error) == pytest.approx(factors.std(ddof=1) / 2.0)
    assert float(law.points) == 120.0


def test_realisations_that_reach_other_forces_are_compared_at_one() -> None:
    """At x0, the geometric mean of all forces, each law has the value that its exponent takes it to."""
    force = np.array([np.geomspace(1e-6, 1e-4, 20), np.geomspace(1e-5, 1e-2, 20)])
    exponents, factors = np.array([0.5, 0.8]), np.array([2.0, 300.0])
    stiffness = factors[:, None] * force ** exponents[:, None]
    law = made(stiffness, force, ("realization", "step")).roughmdr.fit_power_law("stiffness", "force")
    x0 = np.exp(np.log(force).mean())
    assert float(law.x0) == pytest.approx(x0, rel=1e-12)
    assert float(law.coefficient) == pytest.approx((factors * x0**exponents).mean(), rel=1e-12)
    assert float(law.exponent) == pytest.approx(exponents.mean(), abs=1e-12)


def test_only_steps_in_range_count_and_above_zero() -> None:
    force = np.array([-1.0, 0.0, 1e-3, 2e-3, 4e-3, 8e-3, np.nan])
    stiffness = np.array([1.0, 1.0, 7.0, 2e-3, 4e-3, 8e-3, 1.0])
    data = made(stiffness, force)
    law = data.roughmdr.fit_power_law("stiffness", "force", between=("1.5 mN", 1.0))
    assert float(law.points) == 3.0
    assert float(law.exponent) == pytest.approx(1.0, abs=1e-12)
    none = data.roughmdr.fit_power_law("stiffness", "force", between=(1.0, 2.0))
    assert (float(none.points), bool(none.exponent.isnull())) == (0.0, True)
    assert "no value where" in none.attrs["comment"]


def test_hertz_is_found_on_a_dead_simple_law() -> None:
    law = rm.load_separation(
        xr.Dataset(
            {"height": ("asperity", [0.0]), "radius": ("asperity", [5e-5])},
            attrs={"shape": "paraboloid", "nominal_area": 1e-8},
        ),
        separation=np.linspace(0.0, -1e-6, 30),
        effective_modulus=1e9,
    )
    fitted = law.roughmdr.fit_power_law("stiffness", "force")
    assert float(fitted.exponent) == pytest.approx(1.0 / 3.0, abs=1e-10)
    assert float(law.roughmdr.fit_power_law("force", "contact_area").exponent) == pytest.approx(1.5, abs=1e-10)


def test_statistics_and_sweeps(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    of_each = curves.roughmdr.fit_power_law("contact_area", "separation", branch="unloading")
    assert of_each.exponent.dims == ("adhesion_work", "asperities_height_std")
    of_mean = statistics.roughmdr.fit_power_law("contact_area", "separation", branch="unloading")
    np.testing.assert_allclose(of_mean.exponent, of_each.exponent, rtol=0.3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("stifness", "force"), "y is 'stifness', no variable of a result; did you mean 'stiffness'"),
        (("stiffness", "energy"), "x is 'energy', which this result does not hold; it holds"),
        (("stiffness", "force", {"between": (2.0, 1.0)}), "between is .*; it must be two values of x, the lower first"),
        (("stiffness", "force", {"between": ("1 m", "2 m")}), "between is '1 m'"),
    ],
)
def test_wrong_arguments_are_named(arguments: tuple, message: str) -> None:
    data = made(np.ones(3), np.ones(3))
    names, keywords = arguments[:2], dict(arguments[2]) if len(arguments) > 2 else {}
    with pytest.raises(rm.RoughmdrError, match=message):
        data.roughmdr.fit_power_law(*names, **keywords)
