"""The energy of one contact: against the integral of its springs in 60 digits, and the jumps known in closed form."""

import math

import numpy as np
import pytest
from oracles.dugdale import Punch
from oracles.jkr import JkrPowerLaw
from oracles.multiprecision import Number, mp
from test_accuracy import SHAPES, draw

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.elementwise import apply

E, W, R = 4e6, 0.05, 5e-5


def energy(contact: Contact, state: float) -> float:
    """U [J]."""
    value = apply(contact.kernels.energy, np.array([state]), contact.params)[0]
    return float(contact.force * contact.depth[0] * value)


def springs(exact: JkrPowerLaw, a: Number) -> tuple[Number, Number]:
    """E* ∫_0^a (delta - g)^2 dx, by the expanded square, and pi w a^2."""
    delta, g = exact.state(a)["indentation"], exact.g(a)
    square = delta**2 - 2 * delta * g / (exact.n + 1) + g**2 / (2 * exact.n + 1)
    return exact.effective_modulus * a * square, mp.pi * exact.work * a**2


@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize("kind", SHAPES)
def test_it_is_the_energy_of_the_springs(kind: str, adhesive: bool) -> None:
    rng = np.random.default_rng([SHAPES.index(kind), adhesive, 5])
    compared = 0
    while compared < 60:
        case = draw(rng, kind, adhesive)
        try:
            contact = Contact.of(case.shape, case.effective_modulus, Adhesion(case.work))
        except rm.OutOfRange:
            continue
        distance = 10.0 ** rng.uniform(-12.0, 3.0)
        state = apply(contact.kernels.state, np.array([distance]), contact.params)
        elastic, surface = springs(
            case.exact, mp.mpf(contact.radius) * apply(contact.kernels.radius, state, contact.params)[0]
        )
        if not all(mp.mpf("1e-299") < abs(part) < mp.mpf("1e299") for part in (elastic, surface or elastic)):
            continue
        # a itself is a float, and goes into U with the power 2 n + 1.
        allowed = (2 * case.exact.n + 4) * mp.mpf("1e-15") * (elastic + surface)
        assert abs(energy(contact, state[0]) - (elastic - surface)) <= allowed, (case, distance)
        compared += 1


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1.0])
def test_the_jumps_of_a_paraboloid(unit: float) -> None:
    contact = Contact.of(rm.Paraboloid(R * unit), E, Adhesion(W))
    a0 = (2.0 * math.pi * W * (R * unit) ** 2 / E) ** (1.0 / 3.0)
    on, off = (energy(contact, apply(contact.kernels.state, np.array([X]), 2.0)[0]) for X in (1.0, 0.0))
    assert on == pytest.approx(-0.6 * math.pi * W * a0**2, rel=1e-14)
    assert off == pytest.approx(0.4 * 4.0 ** (-4.0 / 3.0) * math.pi * W * a0**2, rel=1e-14)
    whole = (W**5 * (R * unit) ** 4 / E**2) ** (1.0 / 3.0)
    assert off - on == pytest.approx(7.092 * whole, rel=1e-4)


@pytest.mark.parametrize("work", [0.0, W])
@pytest.mark.parametrize("shape", [rm.Paraboloid(R), rm.Cone(0.1), rm.PowerLaw(3.3, width=1e-5, rise=1e-6)])
def test_it_grows_by_the_work_of_the_force(shape: rm.Paraboloid, work: float) -> None:
    """U(2) - U(1) = ∫ P d(delta), by Gauss-Legendre over the force that indent gives."""
    contact = Contact.of(shape, E, Adhesion(work))
    ends = np.array([0.3, 2.0]) * contact.depth[0]
    x, weights = np.polynomial.legendre.leggauss(40)
    delta = ends[0] + (ends[1] - ends[0]) * (x + 1.0) / 2.0
    force = rm.indent(shape, effective_modulus=E, work=work, indentation=delta).force.to_numpy()
    states = apply(contact.kernels.state, contact.reduced(ends, contact.depth), contact.params)
    gained = energy(contact, states[1]) - energy(contact, states[0])
    assert gained == pytest.approx(float(np.sum(weights * force)) * (ends[1] - ends[0]) / 2.0, rel=1e-12)


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1.0])
@pytest.mark.parametrize("strength", [5e4, 4e5, 8e6])
def test_that_of_a_flat_punch_with_a_range_of_adhesion(strength: float, unit: float) -> None:
    """In contact, with an open edge, and lifted, up to where it lets go; and what is lost there."""
    b, work = 2.7 * unit, 0.05 * unit
    contact = Contact.of(rm.FlatPunch(b), E, Adhesion(work, "dugdale", strength))
    exact = Punch(b, E, work, strength)
    depth = contact.depth[0]
    far, scale = 0.0, abs(float(exact.energy(exact.state(mp.mpf(-depth)))))
    for share in (-1.0, -0.999, -0.7, -0.3, -0.01, 0.0, 0.4, 2.0):
        delta = mp.mpf(share * depth)
        wanted = float(exact.energy(exact.state(delta)))
        far = max(far, abs(wanted))
        state = apply(contact.kernels.state, np.array([share + 1.0]), contact.params)[0]
        assert abs(energy(contact, state) - wanted) <= 1e-13 * max(far, scale, math.pi * work * b * b), share
    lost = apply(contact.kernels.jump_energy, np.array([1.0]), 0.0, contact.params)[0] * contact.force * depth
    gained = apply(contact.kernels.jump_energy, np.array([0.0]), 1.0, contact.params)[0] * contact.force * depth
    let_go = float(exact.energy(exact.state(mp.mpf(-depth))))
    caught = -float(exact.energy(exact.state(mp.mpf(-work / strength))))
    assert (lost, gained) == pytest.approx((let_go, caught), rel=1e-11, abs=1e-13 * math.pi * work * b * b)
