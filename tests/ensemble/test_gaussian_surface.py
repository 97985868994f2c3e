"""Summits of Gaussian surfaces: their distribution against quadrature and Gaussian derivatives, and how it is drawn."""

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import scipy.stats
from numpy.polynomial.legendre import leggauss
from scenes import scene
from scipy.integrate import quad

import roughmdr as rm
from roughmdr.ensemble import NayakAsperities
from roughmdr.ensemble.gaussian.summit_distribution import (
    SummitDistribution,
    mean_curvature,
    product_density,
    product_of_curvatures,
)
from roughmdr.spectrum import Moments, SelfAffine

WAVES: dict[str, Any] = {
    "source": "nayak",
    "patch": "1 mm",
    "hurst": 0.8,
    "rms_slope": 0.1,
    "long_wave": "100 um",
    "short_wave": "5 um",
}
MOMENTS: dict[str, Any] = {"source": "nayak", "patch": "1 mm", "m0": "1 um^2", "m2": 0.01, "m4": "1000 /mm^2"}
MICRO = SummitDistribution(Moments(1e-12, 0.01, 1e9))  # alpha = 10
ALPHAS = (1.5 + 1e-9, 1.51, 3.0, 10.0, 1e6)
EXTREME = [2.0**-53, 2.0**-40, 1e-6, 0.02, 0.3, 0.5, 0.5000001, 0.9, 1.0 - 1e-6, 1.0 - 2.0**-53]


def of_alpha(alpha: float) -> SummitDistribution:
    """Moments of no unit."""
    return SummitDistribution(Moments(2.5, 0.3, alpha * 0.3**2 / 2.5))


def expect(moment: Any) -> float:
    """The mean of moment(S, v) over the density sqrt(6/pi) v exp(v - 3 S^2/2), by quadrature in S and sqrt(v)/S."""
    nodes, weights = leggauss(160)
    S, x = 6.0 * (1.0 + nodes[:, None]), 0.5 * (1.0 + nodes[None, :])
    v = (S * x) ** 2
    values = moment(S, v) * v * np.exp(v - 1.5 * S * S) * 2.0 * S * S * x
    return float(math.sqrt(6.0 / math.pi) * 3.0 * (weights @ values @ weights))


def test_moments_of_the_summits() -> None:
    m0, m2, m4 = MICRO.moments
    assert expect(lambda S, v: 1.0) == pytest.approx(1.0, rel=1e-13)
    S1, S2 = expect(lambda S, v: S), expect(lambda S, v: S * S)
    tied = 1.5 / MICRO.moments.alpha
    assert MICRO.mean == pytest.approx(math.sqrt(tied * m0) * S1, rel=1e-13)
    assert MICRO.sigma == pytest.approx(math.sqrt(m0 * (1.0 - tied + tied * (S2 - S1**2))), rel=1e-13)
    assert MICRO.sigma == pytest.approx(math.sqrt(m0 * (1.0 - 0.8968 / 10.0)), rel=1e-5)
    assert math.sqrt(2.0 * m4 / 3.0) * S1 == pytest.approx(8.0 / 3.0 * math.sqrt(m4 / math.pi), rel=1e-13)
    root = expect(lambda S, v: np.sqrt(v))
    assert math.sqrt(2.0 / 3.0) * root == pytest.approx(1.3562, rel=3e-5)
    by_radius = quad(lambda x: 2.0 * x * product_density(x * x) / MICRO.radius(x * x), 0.0, 12.0, epsabs=0.0)[0]
    assert by_radius == pytest.approx(math.sqrt(2.0 * m4 / 3.0) * root, rel=1e-12)
    assert MICRO.density == pytest.approx(m4 / (6.0 * math.pi * math.sqrt(3.0) * m2), rel=1e-15)


@pytest.mark.large
def test_summits_are_maxima_of_gaussian_derivatives() -> None:
    """From covariances alone: (h, hxx, hyy, hxy) are normal, and the density of maxima goes as the determinant."""
    m0, m2, m4 = MICRO.moments
    covariance = np.array([[m0, -m2, -m2], [-m2, m4, m4 / 3.0], [-m2, m4 / 3.0, m4]])
    unit = np.sqrt(np.diag(covariance))
    rng = np.random.default_rng(4)
    normal = rng.standard_normal((4, 1_000_000))
    h, hxx, hyy = unit[:, None] * (np.linalg.cholesky(covariance / np.outer(unit, unit)) @ normal[:3])
    hxy = math.sqrt(m4 / 3.0) * normal[3]
    determinant, mean = hxx * hyy - hxy**2, -0.5 * (hxx + hyy)
    top = (determinant > 0.0) & (mean > 0.0)
    weight = np.where(top, determinant, 0.0)
    assert weight.mean() / (2.0 * math.pi * m2) == pytest.approx(MICRO.density, rel=0.01)
    summits = MICRO.draw(*rng.random((3, 300_000)))
    drawn = summits.height, summits.mean_curvature, 1.0 / summits.radius
    wanted = h, mean, np.sqrt(np.where(top, determinant, 0.0))
    for ours, theirs in zip(drawn, wanted, strict=True):
        for power in (1, 2, 3):
            assert np.mean(ours**power) == pytest.approx(np.average(theirs**power, weights=weight), rel=0.015)
    for one, other in ((0, 1), (0, 2), (1, 2)):
        product = np.average(wanted[one] * wanted[other], weights=weight)
        assert np.mean(drawn[one] * drawn[other]) == pytest.approx(product, rel=0.015)
    assert summits.height.mean() == pytest.approx(MICRO.mean, abs=4.0 * MICRO.sigma / math.sqrt(300_000))
    assert summits.height.std() == pytest.approx(MICRO.sigma, rel=0.01)


def test_mean_curvatures_are_the_inverse_of_their_distribution() -> None:
    S = mean_curvature(np.array(EXTREME))
    with mp.workdps(60):
        for u, s in zip(EXTREME, map(mp.mpf, S.tolist()), strict=True):
            below = mp.erf(s * mp.sqrt(1.5)) - mp.sqrt(6 / mp.pi) * s * mp.exp(-s * s / 2)
            density = mp.sqrt(6 / mp.pi) * (s * s - 1 + mp.exp(-s * s)) * mp.exp(-s * s / 2)
            assert abs(below - u) < 1e-14 * s * density


@pytest.mark.parametrize("S", [9.5e-4, 0.03, 0.7, 0.71, 1.5, 4.0, 8.9, 40.0])
def test_products_of_curvatures_are_the_inverse_of_their_distribution(S: float) -> None:
    product = product_of_curvatures(np.array(EXTREME), np.full(len(EXTREME), S))
    with mp.workdps(120):
        level = (mp.mpf(S) ** 2 - 1) * mp.exp(mp.mpf(S) ** 2) + 1
        for u, v in zip(EXTREME, map(mp.mpf, product.tolist()), strict=True):
            assert abs((v - 1) * mp.exp(v) + 1 - u * level) < 3e-14 * v * (v * mp.exp(v))


@pytest.mark.large
@pytest.mark.parametrize("alpha", ALPHAS[1:])
def test_the_density_of_height_is_the_integral_over_the_mean_curvature(alpha: float) -> None:
    summits, unit = of_alpha(alpha), math.sqrt(2.5)
    with mp.workdps(25):
        tied = 1.5 / mp.mpf(summits.moments.alpha)
        width = mp.sqrt((1 - tied) / (3 - 2 * tied))
        for v in (1e-8, 0.3, 2.0, 30.0):
            for z in (-3.0, 0.2, 2.0, 6.0):

                def joint(S: mp.mpf, z: float = z, v: float = v) -> mp.mpf:
                    """Times exp(3 v/2), since mpmath takes what is small for nothing."""
                    off = (z - mp.sqrt(tied) * S) ** 2 / (2 * (1 - tied))
                    return mp.sqrt(3 / (1 - tied)) / mp.pi * mp.exp(1.5 * (v - S * S) - off)

                root, peak = mp.sqrt(v), mp.sqrt(tied) * z / (3 - 2 * tied)
                start = max(root, peak - 12 * width)
                expected = mp.quad(joint, [start + k * width for k in (*range(8), 12, 16, 26)])
                expected /= mp.exp(1.5 * v) * mp.erfc(mp.sqrt(1.5 * v)) * unit
                assert float(summits.height_density(z * unit, v)) == pytest.approx(float(expected), rel=1e-12)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_densities_are_finite_everywhere(alpha: float) -> None:
    summits = of_alpha(alpha)
    z, v = np.linspace(-200.0, 200.0, 401)[:, None], np.concatenate([[0.0], np.geomspace(1e-300, 1e5, 200)])
    density = summits.height_density(z, v)
    assert density.shape == (401, 201)
    assert np.isfinite(density).all()
    assert (density >= 0.0).all()
    assert np.isfinite(product_density(v)).all()
    total = quad(lambda root: 2.0 * root * product_density(root * root), 0.0, 12.0, epsabs=0.0)[0]
    assert total == pytest.approx(1.0, rel=1e-12)
    for product in (0.0, 0.5, 9.0):
        centre = math.sqrt(2.5 * 1.5 / summits.moments.alpha * product)
        ends = (centre - 12.0 * math.sqrt(2.5), centre + 12.0 * math.sqrt(2.5))
        one = quad(summits.height_density, *ends, args=(product,), points=[centre], limit=400)[0]
        assert one == pytest.approx(1.0, rel=1e-7)


@pytest.mark.few(1)
@pytest.mark.parametrize("alpha", ALPHAS[1:])
def test_summits_are_drawn_from_the_densities(alpha: float) -> None:
    """The fractions below each draw, of v and then of the height given v, are evenly spread (M. Rosenblatt, 1952)."""
    distribution, (nodes, weights) = of_alpha(alpha), leggauss(300)
    summits = distribution.draw(*np.random.default_rng(11).random((3, 3000)))
    v = (distribution.radius(1.0) / summits.radius) ** 2

    def fraction(least: np.ndarray, most: np.ndarray, density: Any) -> np.ndarray:
        half = 0.5 * (most - least)
        return np.asarray((density(least + half * (1.0 + nodes[:, None])) * weights[:, None]).sum(axis=0) * half)

    of_root = fraction(np.zeros_like(v), np.sqrt(v), lambda root: 2.0 * root * product_density(root**2))
    lowest = np.full_like(v, -8.0 * math.sqrt(2.5))
    of_height = fraction(lowest, summits.height, lambda z: distribution.height_density(z, v))
    for name, fractions in (("v", of_root), ("height", of_height)):
        assert scipy.stats.kstest(fractions, "uniform").pvalue > 0.01, name
    assert abs(scipy.stats.spearmanr(of_root, of_height).statistic) < 4.0 / math.sqrt(3000)


def section(**changes: Any) -> NayakAsperities:
    """The section of a spectrum."""
    made = NayakAsperities.model_validate({**WAVES, **changes})
    assert isinstance(made, NayakAsperities)
    return made


def test_a_spectrum_is_its_moments() -> None:
    given = SelfAffine.of(hurst=0.8, rms_slope=0.1, long_wave=1e-4, short_wave=5e-6)
    m0, m2, m4 = given.moments
    by_moments = rm.generate({"source": "nayak", "patch": 1e-3, "m0": m0, "m2": m2, "m4": m4}, seed=3)
    by_slope = rm.generate(WAVES, seed=3)
    assert by_moments.identical(by_slope)
    nothing = dict.fromkeys(("hurst", "long_wave", "short_wave", "rms_height", "rms_slope"))
    assert rm.generate({**MOMENTS, **nothing}, seed=3).identical(rm.generate(MOMENTS, seed=3))
    by_height = {key: value for key, value in WAVES.items() if key != "rms_slope"} | {"rms_height": given.rms_height}
    np.testing.assert_allclose(rm.generate(by_height, seed=3).radius, by_slope.radius, rtol=1e-13)
    assert by_slope.attrs["density"] == pytest.approx(m4 / (6.0 * math.pi * math.sqrt(3.0) * m2), rel=1e-14)
    assert by_slope.attrs["alpha"] == pytest.approx(m0 * m4 / m2**2, rel=1e-14)
    assert by_slope.sizes["asperity"] == round(by_slope.attrs["density"] * 1e-6)
    assert by_slope.attrs["nominal_area"] == pytest.approx(1e-6, rel=1e-15)
    assert by_slope.attrs["shape"] == "paraboloid"


@pytest.mark.parametrize("unit", [1e-9, 1e6])
def test_the_same_surface_in_another_unit(unit: float) -> None:
    lengths = {"patch": 1e-3 * unit, "long_wave": 1e-4 * unit, "short_wave": 5e-6 * unit}
    ours, theirs = rm.generate({**WAVES, **lengths}, seed=2), rm.generate(WAVES, seed=2)
    np.testing.assert_allclose(ours.height / unit, theirs.height, rtol=1e-11)
    np.testing.assert_allclose(ours.radius / unit, theirs.radius, rtol=1e-11)


def test_seeds_realizations_and_longer_draws() -> None:
    one = section()
    assert rm.generate(one, seed=5).identical(rm.generate(WAVES, seed=5))
    for other in (one.ensemble(6, 0), one.ensemble(5, 1)):
        assert (other.height != one.ensemble(5, 0).height).any()
    shorter = section(patch="0.3 mm")
    for stratified in (False, True):
        few, many = (made.ensemble(5, 0, stratified=stratified) for made in (shorter, one))
        assert set(few.height) < set(many.height)
        assert set(few.parameters["radius"]) < set(many.parameters["radius"])


def test_stratified_draws_are_nearer_to_the_distribution() -> None:
    one = section(patch="0.5 mm")
    summits, plain = one.summits, one.summits.sigma / math.sqrt(one.count)
    curvature = quad(lambda root: 2.0 * root * product_density(root**2) / summits.radius(root**2), 0.0, 12.0)[0]
    for realization in range(3):
        made = one.ensemble(1, realization, stratified=True)
        assert abs(made.height.mean() - summits.mean) < 0.2 * plain
        assert np.mean(1.0 / made.parameters["radius"]) == pytest.approx(curvature, rel=2e-3)


def test_an_ensemble_limited_to_a_count() -> None:
    part = section().limited_to(100)
    assert part.expected_count == part.ensemble(1, 0).height.size == 100.0
    assert part.sigma == section().sigma
    assert section().limited_to(10**8).expected_count == section().expected_count


def changed(table: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {key: value for key, value in {**table, **changes}.items() if value is not None}


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (changed(WAVES, rms_height="1 um"), "asperities.rms_slope = 0.1: does not go with rms_height"),
        (changed(WAVES, rms_slope=None), "asperities: needs rms_height or rms_slope; source 'nayak' takes m0, m2 and"),
        (changed(WAVES, hurst=None, long_wave=None), "asperities: needs hurst and long_wave"),
        (changed(WAVES, m0="1 um^2"), "asperities.hurst = 0.8: does not go with m0"),
        (changed(WAVES, short_wave="200 um"), "asperities.short_wave = '200 um': must be below long_wave, 0.0001 m"),
        (changed(WAVES, short_wave=1e-200), "no float can hold the moments"),
        (changed(WAVES, long_wave=1e150, patch=1e3, short_wave=1.0), "no float can hold the moments"),
        (changed(WAVES, hurst=1.2), "asperities.hurst = 1.2: must be at most 1"),
        (changed(WAVES, rms_slope=0), "asperities.rms_slope = 0: must be above 0"),
        (changed(WAVES, rms_slop=0.1), "did you mean 'rms_slope'"),
        (changed(WAVES, shape="cone"), "asperities.shape = 'cone': not available; it can be paraboloid"),
        (changed(WAVES, patch="1 um"), "asperities.patch = 1e-06: holds 0.00865 summits; at least one"),
        (changed(WAVES, patch="1 km"), r"asperities.patch = 1000.0: holds 8.65e\+15 summits; at most 1e\+09"),
        (changed(MOMENTS, m2=None), "asperities: needs m2"),
        (changed(MOMENTS, m0="1 um"), "'um' is a unit of m; expected a unit of m2"),
        (changed(MOMENTS, m4="1 um^2"), "'um\\^2' is a unit of m2; expected a unit of m-2"),
        (changed(MOMENTS, m4="140 /mm^2"), "alpha = m0 m4/m2\\^2 is 1.4; it must be above 3/2"),
        (changed(MOMENTS, m4="150 /mm^2"), "alpha = m0 m4/m2\\^2 is 1.5; it must be above 3/2"),
        ({"source": "nayak", "patch": 1.0}, "asperities: takes m0, m2 and m4, or hurst"),
    ],
)
def test_impossible_surfaces_are_refused(table: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        rm.generate(table, seed=1)


def test_all_faults_are_reported_at_once() -> None:
    with pytest.raises(rm.SceneError) as error:
        rm.generate({**WAVES, "m0": "1 um^2", "short_wave": "1 mm", "rms_height": "-1 um"}, seed=1)
    wrong = {fault.key for fault in error.value.faults}
    assert wrong == {f"asperities.{key}" for key in ("hurst", "long_wave", "short_wave", "rms_height", "rms_slope")}


def test_a_scene_runs_and_sweeps_its_slope() -> None:
    """Twice the slope is twice the heights and half the radii: without adhesion, at the same sigma, twice the force."""
    asperities = changed(WAVES, patch="0.3 mm", rms_slope=None)
    asked = scene(
        adhesion=None,
        asperities=asperities,
        batch={"realizations": 2},
        sweep={"asperities.rms_slope": [0.05, 0.1], "asperities.hurst": [0.5, 0.8]},
    )
    result = rm.run(asked)
    assert dict(result.sizes) == {"asperities_rms_slope": 2, "asperities_hurst": 2, "realization": 2, "step": 80}
    force = result.force
    assert float(force.min()) >= 0.0 < float(force.max())
    np.testing.assert_allclose(force[1], 2.0 * force[0], rtol=1e-9)
    ensemble = rm.generate({**asperities, "rms_slope": 0.1}, seed=7, realization=1)
    h = result.separation.sel(asperities_rms_slope=0.1, asperities_hurst=0.8)
    assert float(h[0]) == pytest.approx(3.0 * section().sigma, rel=1e-12)
    alone = rm.load_separation(
        ensemble, separation=h.to_numpy()[:40], effective_modulus=rm.effective_modulus(3e6, 0.49)
    )
    np.testing.assert_allclose(force[1, 1, 1, :40], alone.force, rtol=1e-12)


def test_a_swept_moment_that_no_surface_has_is_named() -> None:
    asked = scene(asperities=MOMENTS, sweep={"asperities.m2": [0.01, 0.1]})
    with pytest.raises(rm.SceneError, match=r"alpha = m0 m4/m2\^2 is 0.1.*asperities.m2 = 0.1"):
        rm.run(asked)
