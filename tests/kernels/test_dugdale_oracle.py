"""Adhesion of finite range against 60 digits where profiles are very steep, or nearly of exponent 1/2."""

import numba
import pytest
from oracles.dugdale_power_law import DugdalePowerLaw
from oracles.multiprecision import Number, mp
from oracles.promises import judge_dugdale

import roughmdr as rm

pytestmark = pytest.mark.skipif(
    numba.config.DISABLE_JIT, reason="Python floats raise where compiled ones overflow to inf"
)
E, W = 2e9, 0.07


def asked(exponent: float, tabor: float) -> tuple[rm.PowerLaw, dict[str, float]]:
    shape = rm.PowerLaw(exponent=exponent, width=3e-6, rise=4e-7)
    strength = tabor / rm.tabor(shape, effective_modulus=E, work=W, strength=1.0)
    return shape, {"effective_modulus": E, "work": W, "strength": strength}


@pytest.mark.large
@pytest.mark.parametrize("tabor", [3e-3, 0.2, 1.4, 300.0])
@pytest.mark.parametrize("exponent", [0.53, 1.0, 2.0, 50.0, 200.0])
def test_every_answer_is_as_accurate_as_promised(exponent: float, tabor: float) -> None:
    shape, numbers = asked(exponent, tabor)
    exact = DugdalePowerLaw(shape, **numbers)

    def holds(control: str, value: Number) -> None:
        contact = rm.indent(shape, **numbers, adhesion="dugdale", **{control: float(value)})
        got = {str(name): float(contact[name]) for name in contact.variables}
        for name, judged in judge_dugdale(exact, control, got).items():
            assert judged.excess <= 1.0, (control, name, judged)

    for control in ("indentation", "force"):
        for distance in (1e-11, 1e-4, 0.3, 40.0):
            holds(control, exact.pull_off(control).under(control) * (1 - mp.mpf(distance)))
    for part in (0.9, 3.0):
        holds("contact_radius", part * exact.pull_off("force").a)


@pytest.mark.parametrize("exponent", [0.53, 1.0, 2.0, 50.0])
def test_the_oracle_fulfils_the_definitions(exponent: float) -> None:
    """Gap and force by quadrature over u1, as Maugis has them for the sphere."""
    shape, numbers = asked(exponent, 0.9)
    exact = DugdalePowerLaw(shape, **numbers)
    state = exact.retracted("indentation", exact.pull_off("indentation").delta / 3)
    a, c, jkr = state.a, state.c, exact.jkr

    unit = exact.beta * c  # quadrature stops at an absolute error

    def u1(phi: Number) -> Number:
        x = c * mp.sin(phi)
        return (state.delta - jkr.g(x) if x < a else -exact.beta * mp.sqrt(c * c - x * x)) / unit

    places = [0, mp.asin(a / c), mp.pi / 2] if a > 0 else [0, mp.pi / 2]
    with mp.workdps(25):
        opened = unit * mp.quad(u1, places)
        force = 2 * jkr.effective_modulus * unit * c * mp.quad(lambda phi: u1(phi) * mp.cos(phi), places)
        gap = jkr.g(c) / jkr.kappa - state.delta + 2 / mp.pi * opened
    if a > 0:
        assert abs(force / state.force - 1) < 1e-15
        assert abs(gap / exact.range - 1) < 1e-15
    assert mp.diff(lambda d: exact.retracted("indentation", d).force, state.delta) == pytest.approx(
        state.stiffness, rel=1e-12
    )


def test_a_contact_of_a_power_law_so_small_that_its_square_is_no_float_is_refused() -> None:
    shape = rm.PowerLaw(exponent=0.5107, width=0.08, rise=3.2e-5)
    with pytest.raises(rm.OutOfRange, match="representable"):
        rm.indent(
            shape, effective_modulus=4.76e9, work=0.003745, adhesion="dugdale", strength=2.7e89, indentation=1e-91,
        )  # fmt: skip


@pytest.mark.parametrize("shape", [rm.Paraboloid(radius=4e-6), rm.PowerLaw(exponent=1.0, width=3e-6, rise=4e-7)])
@pytest.mark.parametrize("tabor", [0.1, 1e-4, 1e-8])
def test_a_given_radius_keeps_its_digits_far_below_the_range(shape: rm.Paraboloid | rm.PowerLaw, tabor: float) -> None:
    """Contacts from far smaller than their zone to far larger: the indentation to rounding of its two terms."""
    strength = tabor / rm.tabor(shape, effective_modulus=E, work=W, strength=1.0)
    exact = DugdalePowerLaw(shape, E, W, strength)
    for ratio in (1e8, 1e4, 30.0, 1.0, 1e-2):
        state = exact.at(mp.mpf(ratio))
        given = {"effective_modulus": E, "work": W, "adhesion": "dugdale", "strength": strength}
        got = rm.indent(shape, **given, contact_radius=float(state.a))
        terms = exact.jkr.g(state.a), exact.jkr.g(state.a) - state.delta
        assert abs(float(got.indentation) - state.delta) <= 4e-15 * max(terms)
        assert abs(float(got.cohesive_radius) - state.c) <= 4e-15 * state.c
