"""One contact on a displaced surface against integrals of the profile of its shape on that surface."""

import math
from typing import Any

import numba
import numpy as np
import pytest
from forms import large_where_compiled
from scipy.integrate import quad
from scipy.optimize import brentq

import roughmdr as rm
from roughmdr.interaction.contacts import coupled_kernels
from roughmdr.interaction.interface import Asperities, Contacts, CoupledKernels
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.shapes import SHAPES
from roughmdr.shapes.base import Shape

EXAMPLES: dict[str, Shape] = {
    "paraboloid": rm.Paraboloid(radius=0.7),
    "cone": rm.Cone(slope=0.3),
    "power_law": rm.PowerLaw(exponent=4.0, coefficient=2.0),
    "rough power_law": rm.PowerLaw(exponent=1.3, width=0.2, rise=0.05),
    "sphere": rm.Sphere(radius=0.9),
    "truncated_cone": rm.TruncatedCone(slope=0.3, flat_radius=0.05),
    "truncated_paraboloid": rm.TruncatedParaboloid(radius=0.8, flat_radius=0.06),
    "rounded_cone": rm.RoundedCone(slope=0.4, blend_radius=0.05),
    "capped_paraboloid": rm.CappedParaboloid(radius=0.5, cap_radius=1.1, blend_radius=0.08),
    "rounded_punch": rm.RoundedPunch(flat_radius=0.06, edge_radius=0.5),
}
INDENTATIONS = 1e-3, 2e-2, 0.1
CURVATURES = 0.0, 0.15, 40.0


def one(shape: Shape) -> tuple[CoupledKernels, Asperities]:
    """Its kernels, in a patch of side 1 m."""
    width, rise, params = shape.nondimensional()
    columns = Columns(
        np.array([width]), np.array([rise]), np.atleast_1d(params)[None] if np.ndim(params) else np.array([params])
    )
    law = coupled_kernels(choose(shape.name, Adhesion(), columns.params))
    made = law.prepare(law.material(1.0, Adhesion()), columns, 0, 1, 0.0, math.inf)
    (depth, _), size, _, _ = law.scales(1.0, 0.0, width, rise, law.params_of(made, 0))
    return law, Asperities(np.zeros(1), np.array([depth]), np.array([size]), made)


def response(shape: Shape, x: float, curvature: float, tilt: float = 0.0) -> tuple[dict[str, float], int]:
    """Numbers in units of E* = 1 m: loads and moments times pi."""
    law, asperities = one(shape)
    contacts = Contacts(*np.zeros((len(Contacts._fields), 1)))
    law.load_alone(np.array([x]), asperities, contacts)
    field = np.array([[0.0], [0.6 * tilt], [-0.8 * tilt], [4.0 * curvature]])
    lost = law.respond(asperities, field, contacts)
    found = {name: float(values[0]) for name, values in contacts._asdict().items()}
    for name in ("load", "stiffness", "second_moment", "tilting"):
        found[name] *= math.pi
    return found, lost


def integral(shape: Shape, power: int, a: float) -> float:
    """∫ x^power g dx from 0 to a, with a break where a flat ends."""
    flat = min(shape.parameters.get("flat_radius", 0.0), a)
    parts = [(flat, a)] if flat else [(0.0, a)]
    return sum(
        quad(lambda x: x**power * float(shape.g(x)), *part, epsabs=0.0, epsrel=1e-11, limit=400)[0] for part in parts
    )


def least_radius(shape: Shape) -> float:
    return shape.parameters.get("flat_radius", 0.0)


def twin(shape: Shape, x: float, curvature: float) -> dict[str, float]:
    """The contact with the load of an indentation x alone, where the surface adds curvature r² to the profile."""

    def load(a: float, added: float) -> float:
        """2 ∫ (g(a) - g + 2 added (a² - x²)) dx."""
        return 2.0 * (a * float(shape.g(a)) - integral(shape, 0, a)) + 8.0 / 3.0 * added * a**3

    low, high = least_radius(shape), 1.0
    alone = brentq(lambda a: float(shape.g(a)) - x, low, min(high, 0.999 * shape.limit), xtol=1e-16, rtol=1e-14)
    carried = load(alone, 0.0)
    a = brentq(lambda a: load(a, curvature) - carried, 0.0, alone, xtol=1e-16, rtol=1e-14)
    inside = a < low
    depth = (0.0 if inside else float(shape.g(a))) + 2.0 * curvature * a * a
    moment = 4.0 * (depth * a**3 / 3.0 - (0.0 if inside else integral(shape, 2, a)) - 2.0 * curvature * a**5 / 5.0)
    return {"load": carried, "radius": a, "lift": depth - x, "second_moment": moment, "tilting": 4.0 / 3.0 * a**3}


@pytest.mark.few(12)
@pytest.mark.parametrize("curvature", CURVATURES)
@pytest.mark.parametrize("x", INDENTATIONS)
@pytest.mark.parametrize("name", EXAMPLES)
def test_a_contact_on_a_curved_surface(name: str, x: float, curvature: float) -> None:
    """With a curvature of 40 the contact of a blunted tip lies within the flat."""
    shape = EXAMPLES[name]
    found, lost = response(shape, x, curvature)
    exact = twin(shape, x, curvature)
    assert lost == 0
    for key, value in exact.items():
        scale = x if key == "lift" else 0.0
        assert found[key] == pytest.approx(value, rel=1e-8, abs=1e-9 * scale), key


@pytest.mark.parametrize("name", ["paraboloid", "truncated_cone"])
def test_the_stiffness_is_the_diameter(name: str) -> None:
    """The diameter is that of the contact that carries its load alone."""
    found, _ = response(EXAMPLES[name], 0.02, 0.0)
    assert found["stiffness"] == pytest.approx(2.0 * found["radius"], rel=1e-12)


@pytest.mark.parametrize("curvature", [0.0, 0.15, -0.1])
@pytest.mark.parametrize("name", EXAMPLES)
def test_a_contact_on_a_tilted_surface_goes_deeper(name: str, curvature: float) -> None:
    """By a tilt²/g', to second order; ten times the tilt a hundred times as much."""
    shape, x = EXAMPLES[name], 0.05
    level, _ = response(shape, x, curvature)
    a = level["radius"]
    step = 1e-4 * a
    slope = float(shape.g(a + step) - shape.g(a - step)) / (2.0 * step) + 4.0 * curvature * a
    for tilt in (1e-4 * slope, 1e-3 * slope):
        deeper = level["lift"] - response(shape, x, curvature, tilt)[0]["lift"]
        assert deeper == pytest.approx(a * tilt**2 / slope, rel=1e-5, abs=1e-15)


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_steep_tilt_takes_the_top_where_the_profile_is_as_steep(name: str) -> None:
    """A tilt continuous in its effect, and never more than that of a surface that touches the profile elsewhere."""
    shape, x = EXAMPLES[name], 1e-3
    tilts = np.linspace(0.0, 0.3, 61)
    lifts = np.array([response(shape, x, 0.0, tilt)[0]["lift"] for tilt in tilts])
    assert np.isfinite(lifts).all()
    assert (np.diff(lifts) <= 1e-15).all()
    if name != "cone":  # whose slope is the limit
        assert np.abs(np.diff(lifts)).max() < 0.3 * 0.005 * 10.0


def test_a_paraboloid_in_closed_form() -> None:
    """1/R becomes 1/R + 2 curvature; K is R P, M is 2 P a²/5, and a tilt deepens by R tilt²/2."""
    radius, x, curvature, tilt = 0.7, 0.02, 0.15, 1e-3
    found, _ = response(rm.Paraboloid(radius=radius), x, curvature, tilt)
    curved = 1.0 / (1.0 / radius + 2.0 * curvature)
    load = 4.0 / 3.0 * math.sqrt(radius * x**3)
    a = (0.75 * load * curved) ** (1.0 / 3.0)
    assert found["load"] == pytest.approx(load, rel=1e-12)
    assert found["radius"] == pytest.approx(a, rel=1e-12)
    assert found["lift"] == pytest.approx(a * a / curved - x - 0.5 * curved * tilt**2, rel=1e-10)
    assert found["second_moment"] == pytest.approx(0.4 * load * a * a, rel=1e-12)
    assert found["tilting"] == pytest.approx(curved * load, rel=1e-12)


@pytest.mark.parametrize("curvature", [0.0, 0.2, -0.2])
def test_a_flat_punch_keeps_its_radius(curvature: float) -> None:
    """Its load comes from x, its mean displacement and its second moment from the curvature as well."""
    a, x = 0.1, 0.02
    found, lost = response(rm.FlatPunch(radius=a), x, curvature, 1e-3)
    assert lost == 0
    assert found["radius"] == pytest.approx(a)
    assert found["load"] == pytest.approx(2.0 * a * x, rel=1e-12)
    depth = x + 2.0 / 3.0 * curvature * a * a  # at which a punch on the curved surface carries the load
    assert x + found["lift"] == pytest.approx(depth, rel=1e-12)
    moment = 4.0 * quad(lambda r: r * r * (depth - 2.0 * curvature * r * r), 0.0, a)[0]
    assert found["second_moment"] == pytest.approx(moment, rel=1e-12)
    assert found["tilting"] == pytest.approx(4.0 / 3.0 * a**3, rel=1e-12)


@pytest.mark.parametrize("name", ["paraboloid", "sphere", "cone"])
def test_a_surface_curved_away_more_than_the_tip_is_no_disc(name: str) -> None:
    shape = EXAMPLES[name]
    found, lost = response(shape, 0.02, -1e3)
    assert lost == 1
    assert all(math.isfinite(value) for value in found.values())


@large_where_compiled
def test_without_load_there_is_no_contact() -> None:
    for shape in EXAMPLES.values():
        found, _ = response(shape, -0.01, 0.3)
        assert found.pop("punch") == least_radius(shape)
        assert not any(found.values())


def test_every_shape_has_its_example() -> None:
    given = {type(shape).name for shape in EXAMPLES.values()} | {"flat_punch"}
    assert set(SHAPES) - given <= {"power_series", "tabulated", "mdr_table"}


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("name", ["paraboloid", "cone", "truncated_cone"])
def test_the_compiled_loops_are_their_sources(name: str) -> None:
    """Each is run as plain Python too, on the same contact."""
    law, asperities = one(EXAMPLES[name])
    field = np.array([[0.0], [0.01], [0.02], [0.3]])
    found = []
    for run in (lambda f: f, lambda f: f.py_func):
        contacts = Contacts(*np.zeros((len(Contacts._fields), 1)))
        load_alone: Any = run(law.load_alone)
        respond: Any = run(law.respond)
        load_alone(np.array([0.02]), asperities, contacts)
        assert respond(asperities, field, contacts) == 0
        found.append(np.array(contacts))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-14)
