"""Answers that are known in closed form: JKR's sphere, the cone, Hertz, and how they hang together."""

import math

import numpy as np
import pytest
import xarray as xr

import roughmdr as rm

SPHERE = rm.Paraboloid(radius=1e-6)
E, W = 1e9, 0.05


def close(got: xr.DataArray, expected: float, rel: float = 1e-14) -> bool:
    return bool(abs(float(got) - expected) <= rel * abs(expected))


def test_a_sphere_close_to_pull_off() -> None:
    contact = rm.indent(SPHERE, effective_modulus=E, work=W, indentation=-1.0917197969310225e-9)
    assert close(contact.contact_radius, 5.554976330387043e-8)
    assert close(contact.force, -2.355656444218766e-7)


@pytest.mark.parametrize("radius", [1e-9, 1e-6, 1.0])
def test_pull_off_of_a_sphere(radius: float) -> None:
    held = rm.pull_off(rm.Paraboloid(radius=radius), effective_modulus=E, work=W, control="displacement")
    dead = rm.pull_off(rm.Paraboloid(radius=radius), effective_modulus=E, work=W, control="force")
    assert close(held.force, -5 / 6 * math.pi * W * radius)
    assert close(dead.force, -1.5 * math.pi * W * radius)
    assert close(held.indentation, -0.75 * (math.pi**2 * W**2 * radius / E**2) ** (1 / 3))
    assert close(dead.contact_radius, (9 * math.pi * W * radius**2 / (8 * E)) ** (1 / 3))


def test_a_sphere_at_first_touch() -> None:
    contact = rm.indent(SPHERE, effective_modulus=E, work=W, indentation=0.0)
    assert close(contact.force, -4 / 3 * math.pi * W * 1e-6)
    assert close(contact.contact_radius, (2 * math.pi * W * 1e-12 / E) ** (1 / 3))


def test_a_sphere_without_load() -> None:
    contact = rm.indent(SPHERE, effective_modulus=E, work=W, force=0.0)
    assert close(contact.contact_radius, (4.5 * math.pi * W * 1e-12 / E) ** (1 / 3))


@pytest.mark.parametrize("slope", [1e-3, 0.7, 50.0])
def test_pull_off_of_a_cone(slope: float) -> None:
    held = rm.pull_off(rm.Cone(slope=slope), effective_modulus=E, work=W, control="displacement")
    dead = rm.pull_off(rm.Cone(slope=slope), effective_modulus=E, work=W, control="force")
    assert close(dead.force, -54 * W**2 / (math.pi * slope**3 * E))
    assert close(held.indentation, -W / (slope * E))
    assert close(held.contact_radius, 2 * W / (math.pi * slope**2 * E))


def rescaled(shape: rm.PowerLaw | rm.Paraboloid | rm.Cone, length: float) -> rm.PowerLaw | rm.Paraboloid | rm.Cone:
    powers = {"radius": 1.0, "slope": 0.0, "exponent": 0.0, "width": 1.0, "rise": 1.0}
    given = shape.parameters
    powers["coefficient"] = 1.0 - given.get("exponent", 1.0)
    return type(shape)(**{name: value * length ** powers[name] for name, value in given.items()})


@pytest.mark.parametrize("length", [1e9, 2.0**20, 3e-7])
@pytest.mark.parametrize("newton", [1.0, 1e12, 7e-5])
@pytest.mark.parametrize(
    "shape",
    [
        SPHERE,
        rm.Cone(slope=0.3),
        rm.PowerLaw(exponent=3.3, coefficient=1e12),
        rm.PowerLaw(exponent=0.8, width=1e-6, rise=2e-7),
    ],
    ids=str,
)
def test_other_units_give_the_same_contact(shape: rm.PowerLaw, length: float, newton: float) -> None:
    onset = float(rm.pull_off(shape, effective_modulus=E, work=W, control="displacement").indentation)
    delta = np.array([0.9, 0.3, -0.4, -50.0]) * onset
    here = rm.indent(shape, effective_modulus=E, work=W, indentation=delta)
    there = rm.indent(
        rescaled(shape, length),
        effective_modulus=E * newton / length**2,
        work=W * newton / length,
        indentation=delta * length,
    )
    scale = {
        "force": newton,
        "contact_radius": length,
        "contact_area": length**2,
        "stiffness": newton / length,
    }
    for name, factor in scale.items():
        np.testing.assert_allclose(there[name].values, here[name].values * factor, rtol=1e-13)


@pytest.mark.parametrize("work", [0.0, W])
@pytest.mark.parametrize(
    ("power", "named"),
    [
        (rm.PowerLaw(exponent=2.0, coefficient=5e5), SPHERE),
        (rm.PowerLaw(exponent=2.0, width=1e-6, rise=5e-7), SPHERE),
        (rm.PowerLaw(exponent=1.0, coefficient=0.3), rm.Cone(slope=0.3)),
    ],
    ids=["coefficient", "rise", "cone"],
)
def test_a_power_law_is_the_shape_it_describes(power: rm.PowerLaw, named: rm.Cone, work: float) -> None:
    onset = float(rm.pull_off(named, effective_modulus=E, work=W, control="displacement").indentation)
    for control in ({"indentation": np.array([0.9, -0.5, -20.0]) * onset}, {"force": [0.0, 1e-8, 1e-3]}):
        got = rm.indent(power, effective_modulus=E, work=work, **control)
        xr.testing.assert_allclose(
            got, rm.indent(named, effective_modulus=E, work=work, **control), rtol=1e-13, atol=0.0
        )


def test_hertz() -> None:
    delta = np.array([1e-15, 1e-9, 1e-6])
    contact = rm.indent(SPHERE, effective_modulus=E, indentation=delta)
    np.testing.assert_allclose(contact.force, 4 / 3 * E * np.sqrt(1e-6) * delta**1.5, rtol=1e-14)
    np.testing.assert_allclose(contact.contact_radius, np.sqrt(1e-6 * delta), rtol=1e-14)
    np.testing.assert_allclose(contact.stiffness, 2 * E * np.sqrt(1e-6 * delta), rtol=1e-14)


@pytest.mark.parametrize("shape", [SPHERE, rm.Cone(slope=0.3), rm.PowerLaw(exponent=3.3, coefficient=1e12)], ids=str)
def test_weak_adhesion_tends_to_no_adhesion(shape: rm.PowerLaw) -> None:
    """At fixed indentation a grows by dl/g' ~ w^1/2; the force is stationary in a, so it falls by ~ w."""
    elastic = rm.indent(shape, effective_modulus=E, indentation=1e-8)
    works = W * 2.0 ** -np.arange(20.0, 28.0)
    order = {}
    for name in ("contact_radius", "force"):
        gaps = [
            float(abs(rm.indent(shape, effective_modulus=E, work=w, indentation=1e-8)[name] - elastic[name]))
            for w in works
        ]
        order[name] = np.polyfit(np.log(works), np.log(gaps), 1)[0]
    assert order["contact_radius"] == pytest.approx(0.5, abs=0.01)
    assert order["force"] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("slope", [0.02, 0.05, 0.3])
@pytest.mark.parametrize("unit", [1e-9, 1e-7, 1e-2])
def test_a_truncated_cone_lets_go_at_its_corner_as_a_flat_punch_does(slope: float, unit: float) -> None:
    effective_modulus, work = 1e9, 0.05 * unit / 1e-7 * (slope / 0.05) ** 2
    off, punch = (
        rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="displacement")
        for shape in (rm.TruncatedCone(slope, unit), rm.FlatPunch(unit))
    )
    assert float(off.contact_radius) == unit
    assert float(off.force) == pytest.approx(float(punch.force), rel=1e-14)
    last = rm.indent(
        rm.TruncatedCone(slope, unit),
        effective_modulus=effective_modulus,
        work=work,
        indentation=float(off.indentation),
    )
    assert float(last.stiffness) == pytest.approx(2.0 * effective_modulus * unit, rel=1e-12)
