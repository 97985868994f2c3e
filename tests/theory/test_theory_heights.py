"""Named laws over heights of any distribution."""

import math

import mpmath as mp
import numpy as np
import pytest
import scipy.stats as st

import roughmdr as rm
from roughmdr.numerics.quadrature import integrate

ONE = {"effective_modulus": 0.75, "radius": 1.0, "density": 1.0}
"""With these the pressure is the integral F_3/2."""


def f_3_2(h: float, heights: object) -> float:
    return float(rm.theory.greenwood_williamson(separation=h, heights=heights, **ONE))


def test_exponential_heights_give_force_in_proportion_to_area() -> None:
    """Greenwood and Williamson: F_n(h) = n! scale^n exp(-h/scale) above 0."""
    surface = {"effective_modulus": 4e6, "radius": 5e-5, "density": 2e9, "heights": st.expon(scale=1e-6)}
    h = np.linspace(0.0, 30e-6, 60)
    force, area, number = (
        rm.theory.greenwood_williamson(separation=h, variable=variable, **surface)
        for variable in ("pressure", "contact_fraction", "contact_density")
    )
    np.testing.assert_allclose(number, 2e9 * np.exp(-h / 1e-6), rtol=1e-12)
    np.testing.assert_allclose(area, math.pi * 5e-5 * 1e-6 * number, rtol=1e-12)
    np.testing.assert_allclose(force, 4e6 / math.sqrt(math.pi) * math.sqrt(1e-6 / 5e-5) * area, rtol=1e-12)


@pytest.mark.parametrize("h", [-2.0, -0.5, 0.99])
def test_uniform_heights(h: float) -> None:
    exact = ((1.0 - h) ** 2.5 - max(-1.0 - h, 0.0) ** 2.5) / 5.0
    assert f_3_2(h, st.uniform(-1.0, 2.0)) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("h", [-1.0, 0.0, 0.3, 9.0])
@pytest.mark.parametrize("c", [0.5, 3.0])
def test_heights_of_weibull(h: float, c: float) -> None:
    """Their density is infinite at 0 for c below 1: u is the exponent of the share of higher ones."""
    lowest = mp.mpf(max(h, 0.0)) ** c
    exact = mp.quad(
        lambda u: max(u ** (1 / mp.mpf(c)) - h, 0) ** 1.5 * mp.exp(-u), [lowest, lowest + 1, lowest + 9, mp.inf]
    )
    assert f_3_2(h, st.weibull_min(c)) == pytest.approx(float(exact), rel=1e-9 if h else 1e-12)
    assert exact > 0


def test_heights_of_beta_with_two_infinite_ends() -> None:
    assert f_3_2(0.0, st.beta(0.5, 0.5)) == pytest.approx(float(mp.beta(2, 0.5) / mp.beta(0.5, 0.5)), rel=1e-7)


@pytest.mark.parametrize(
    "heights", [st.gumbel_r(), st.gumbel_l(), st.skewnorm(30.0), st.skewnorm(-30.0), st.exponnorm(9.0)]
)
def test_all_heights_count_however_thin_a_tail_is(heights: st.distributions.rv_frozen) -> None:
    given = {"heights": heights, "effective_modulus": 1.0, "radius": 1.0 / math.pi, "density": 1.0}
    h = np.append(heights.ppf([1e-9, 1e-3, 0.5, 0.999]), heights.mean() - 50.0)
    number = rm.theory.greenwood_williamson(separation=h, variable="contact_density", **given)
    np.testing.assert_allclose(number, heights.sf(h), rtol=1e-10)
    area = rm.theory.greenwood_williamson(separation=h[-1], variable="contact_fraction", **given)
    assert area == pytest.approx(50.0, rel=1e-10)


def test_heavy_tails() -> None:
    """Student's t with 5 degrees of freedom has the mean of z^(3/2), Cauchy's law has not."""
    exact = mp.quad(lambda z: z**1.5 * (1 + z * z / 5) ** -3, [0, 1, 10, mp.inf]) * 8 / (3 * mp.sqrt(5) * mp.pi)
    assert f_3_2(0.0, st.t(5)) == pytest.approx(float(exact), rel=1e-12)
    with pytest.raises(rm.OutOfRange, match="tail"):
        f_3_2(0.0, st.cauchy())
    number = rm.theory.greenwood_williamson(separation=1.0, heights=st.cauchy(), variable="contact_density", **ONE)
    assert float(number) == pytest.approx(0.25, rel=1e-12)


@pytest.mark.parametrize("variable", ["pressure", "contact_fraction", "contact_density"])
@pytest.mark.parametrize("turning", [None, -1e-6])
def test_normal_heights_are_those_of_a_std(variable: str, turning: float | None) -> None:
    surface = {
        "effective_modulus": 4e6,
        "radius": 5e-5,
        "density": 2e9,
        "work": 0.05,
        "turning": turning,
        "variable": variable,
    }
    h = np.linspace(-1e-6, 5e-6, 7)
    given = rm.theory.fuller_tabor(separation=h, heights=st.norm(scale=1e-6), **surface)
    np.testing.assert_allclose(given, rm.theory.fuller_tabor(separation=h, std=1e-6, **surface), rtol=1e-11)


class Step:
    """Heights from 0 to 1, above a step three times as dense as below it."""

    def __init__(self, at: float) -> None:
        self.at, self.level = at, 1.0 / (3.0 - 2.0 * at)

    def pdf(self, z: np.ndarray) -> np.ndarray:
        return self.level * np.where(z < self.at, 1.0, 3.0)

    def ppf(self, q: np.ndarray) -> np.ndarray:
        q = np.asarray(q) / self.level
        return np.where(q < self.at, q, self.at + (q - self.at) / 3.0)

    def support(self) -> tuple[float, float]:
        return 0.0, 1.0


@pytest.mark.parametrize("at", [0.1234, 0.4990269942147343, 0.7488977605179967])
def test_a_jump_that_lies_between_the_nodes_is_found(at: float) -> None:
    exact = (3.0 - 2.0 * at**2.5) / 2.5 / (3.0 - 2.0 * at)
    assert f_3_2(0.0, Step(at)) == pytest.approx(exact, rel=1e-10)


def test_summits_out_of_reach_carry_nothing() -> None:
    assert f_3_2(1.5, st.uniform(-1.0, 2.0)) == 0.0


@pytest.mark.parametrize("heights", [[1.0, 2.0], st.poisson(3.0), "normal"])
def test_what_is_no_distribution_is_refused(heights: object) -> None:
    with pytest.raises(rm.RoughmdrError, match="heights"):
        f_3_2(0.0, heights)


def test_the_quadrature_finds_jumps_and_powers_and_bears_noise() -> None:
    edges = np.array([[0.0, 1.0, 1.0], [0.0, 0.3, 1.0]])
    power = integrate(lambda rows, x: x**-0.6, edges)
    np.testing.assert_allclose(power, 2.5, rtol=1e-12)
    jump = integrate(lambda rows, x: np.where(x > 1.0 / math.pi, 1.0, 0.0), edges)
    np.testing.assert_allclose(jump, 1.0 - 1.0 / math.pi, rtol=1e-12)
    noise = np.random.default_rng(1)
    rough = integrate(lambda rows, x: 1.0 + 1e-6 * noise.standard_normal(x.shape), edges)
    np.testing.assert_allclose(rough, 1.0, rtol=1e-5)
    assert np.isnan(integrate(lambda rows, x: x * math.nan, edges)).all()
