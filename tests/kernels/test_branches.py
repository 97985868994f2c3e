"""The stable branch: there and back, its slope, its order, and what happens where it ends."""

import math
import re

import numpy as np
import pytest
import xarray as xr

import roughmdr as rm

E, W = 3e6, 0.05
SHAPES = [
    rm.Paraboloid(radius=1e-5),
    rm.Cone(slope=0.3),
    rm.PowerLaw(exponent=0.7, coefficient=2e-3),
    rm.PowerLaw(exponent=3.3, coefficient=1e10),
    rm.PowerLaw(exponent=40.0, width=1e-5, rise=3e-6),
    rm.Sphere(radius=1e-3),
    rm.PowerSeries({1.2: 0.5, 2.0: 3e4, 6.0: 1e24}),
    rm.TruncatedCone(slope=0.3, flat_radius=2e-6),
    rm.TruncatedParaboloid(radius=1e-5, flat_radius=2e-6),
    rm.RoundedCone(slope=0.3, blend_radius=4e-6),
    rm.CappedParaboloid(radius=1e-5, cap_radius=2.5e-5, blend_radius=2e-6),
    rm.RoundedPunch(flat_radius=2e-6, edge_radius=1e-5),
    rm.Tabulated(np.linspace(0.0, 1e-5, 9), 0.1 * np.linspace(0.0, 1e-5, 9) ** 2 / 1e-5),
]
CORNERED = (rm.TruncatedCone, rm.TruncatedParaboloid)
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=str)
every_work = pytest.mark.parametrize("work", [0.0, W], ids=["elastic", "jkr"])


def indent(shape: rm.PowerLaw, work: float, **control: object) -> xr.Dataset:
    return rm.indent(shape, effective_modulus=E, work=work, **control)


def onset(shape: rm.PowerLaw, control: str) -> float:
    """The control's value at pull-off, negative."""
    kind = "force" if control == "force" else "displacement"
    return float(rm.pull_off(shape, effective_modulus=E, work=W, control=kind)[control])


@pytest.mark.few(14)
@every_shape
@every_work
@pytest.mark.parametrize(("control", "through"), [("indentation", "contact_radius"), ("force", "indentation")])
def test_there_and_back(shape: rm.PowerLaw, work: float, control: str, through: str) -> None:
    distance = np.logspace(-1, 3, 41)
    values = -onset(shape, control) * (distance if work == 0.0 else distance - 1.0)
    there = indent(shape, work, **{control: values})
    back = indent(shape, work, **{through: there[through].values})
    np.testing.assert_allclose(back[control], values, rtol=1e-12, atol=-1e-12 * onset(shape, control))
    np.testing.assert_allclose(back.stiffness, there.stiffness, rtol=1e-11, atol=1e-11 * E * there.contact_radius[0])


@every_shape
@every_work
def test_stiffness_is_the_slope_of_the_force(shape: rm.PowerLaw, work: float) -> None:
    delta = -onset(shape, "indentation") * (1.0 if work == 0.0 else -0.4)
    steps = abs(delta) * 2.0 ** -np.arange(4.0, 9.0)
    right = indent(shape, work, indentation=delta + steps).force.values
    left = indent(shape, work, indentation=delta - steps).force.values
    errors = np.abs((right - left) / (2.0 * steps) - float(indent(shape, work, indentation=delta).stiffness))
    orders = np.log2(errors[:-1] / errors[1:])
    if isinstance(shape, rm.Cone) and work == 0.0:  # a quadratic law: the difference quotient is exact
        assert (errors <= 1e-12 * E * float(indent(shape, work, indentation=delta).contact_radius)).all()
    else:
        assert orders[-2:] == pytest.approx([2.0, 2.0], abs=0.05)


@every_shape
def test_the_fold_itself_is_finite_with_a_steep_fall(shape: rm.PowerLaw) -> None:
    off = rm.pull_off(shape, effective_modulus=E, work=W, control="displacement")
    at_fold = indent(shape, W, indentation=float(off.indentation))
    assert all(np.isfinite(at_fold[name]) for name in at_fold.variables)
    assert float(at_fold.force) == pytest.approx(float(off.force), rel=1e-12)
    assert float(at_fold.contact_radius) == pytest.approx(float(off.contact_radius), rel=1e-7)
    if isinstance(shape, CORNERED):  # pinned to the corner: K. Kendall's punch
        assert float(off.contact_radius) == shape.flat_radius
        assert float(off.force) == pytest.approx(-math.sqrt(8.0 * math.pi * E * W * shape.flat_radius**3), rel=1e-14)
        assert float(at_fold.stiffness) == pytest.approx(2.0 * E * shape.flat_radius, rel=1e-12)
    else:
        assert float(at_fold.stiffness) < -1e6 * E * float(off.contact_radius)


@every_shape
def test_one_step_beyond_the_fold_contact_is_lost(shape: rm.PowerLaw) -> None:
    fold = onset(shape, "indentation")
    beyond = indent(shape, W, indentation=[fold, math.nextafter(fold, -math.inf), -1.0])
    for name in ("force", "contact_radius", "contact_area", "stiffness"):
        assert beyond[name][0] != 0.0
        assert (beyond[name][1:] == 0.0).all()


@every_shape
def test_without_adhesion_contact_begins_at_0(shape: rm.PowerLaw) -> None:
    contact = indent(shape, 0.0, indentation=[-1e-9, -0.0, 0.0, 1e-9])
    for name in ("force", "contact_radius", "contact_area", "stiffness"):
        assert (contact[name][:3] == 0.0).all()
        assert contact[name][3] > 0.0


@pytest.mark.few(4)
@every_shape
@every_work
def test_no_contact_holds_a_stronger_pull(shape: rm.PowerLaw, work: float) -> None:
    pull = onset(shape, "force") * (1.0 + 1e-13) if work else -5e-324
    with pytest.raises(rm.OutOfRange, match=re.escape(f"force is {pull!r} N")):
        indent(shape, work, force=[0.0, pull])


@pytest.mark.few(4)
@every_shape
@pytest.mark.parametrize("effective_modulus", [1e3, 3.3e4, 7.1e6, 1.9e9, 5.7e12])
def test_the_pull_off_force_that_is_stated_is_the_least_that_holds(
    shape: rm.PowerLaw, effective_modulus: float
) -> None:
    off = rm.pull_off(shape, effective_modulus=effective_modulus, work=W, control="force")
    at_fold = rm.indent(shape, effective_modulus=effective_modulus, work=W, force=float(off.force))
    assert float(at_fold.contact_radius) == pytest.approx(float(off.contact_radius), rel=1e-6)
    assert all(np.isfinite(at_fold[name]) for name in at_fold.variables)
    with pytest.raises(rm.OutOfRange, match="force is"):
        rm.indent(shape, effective_modulus=effective_modulus, work=W, force=math.nextafter(float(off.force), -math.inf))


@pytest.mark.few(20)
@every_shape
@every_work
@pytest.mark.parametrize("control", ["indentation", "force"])
def test_more_load_more_contact(shape: rm.PowerLaw, work: float, control: str) -> None:
    distance = np.logspace(-12, 3, 400)
    values = -onset(shape, control) * (distance if work == 0.0 else distance - 1.0)
    values = values[np.diff(values, prepend=-np.inf) > 0.0]
    contact = indent(shape, work, **{control: values})
    # Where the flank begins with a corner the radius grows by less than a float shows.
    grows = np.diff(contact.contact_radius)
    cornered = isinstance(shape, (*CORNERED, rm.CappedParaboloid))
    assert (grows >= 0.0).all() if cornered else (grows > 0.0).all()
    other = "force" if control == "indentation" else "indentation"
    stable_under_both = contact.contact_radius.values >= float(
        rm.pull_off(shape, effective_modulus=E, work=work, control="force").contact_radius
    )
    assert (np.diff(contact[other].values[stable_under_both]) > 0.0).all()


@pytest.mark.parametrize("shape", [shape for shape in SHAPES if not getattr(shape, "flat_radius", 0.0)], ids=str)
def test_a_given_radius_below_the_fold_is_the_unstable_equilibrium(shape: rm.PowerLaw) -> None:
    fold = rm.pull_off(shape, effective_modulus=E, work=W, control="displacement")
    inner = indent(shape, W, contact_radius=np.array([0.2, 0.9]) * float(fold.contact_radius))
    outer = indent(shape, W, indentation=inner.indentation.values)
    assert (inner.indentation > float(fold.indentation)).all()
    assert (outer.contact_radius.values > float(fold.contact_radius)).all()
    assert (outer.force.values < 0.0).all()
