"""The contract of rm.indent and rm.pull_off: what goes in, what comes out, what is refused."""

import numpy as np
import pytest

import roughmdr as rm

SHAPES = [
    rm.Paraboloid(radius=1e-6),
    rm.Cone(slope=0.3),
    rm.PowerLaw(exponent=3.3, coefficient=1e12),
    rm.PowerLaw(exponent=0.7, width=1e-6, rise=1e-7),
]
UNITS = {
    "indentation": "m",
    "force": "N",
    "contact_radius": "m",
    "contact_area": "m2",
    "stiffness": "N m-1",
}
VALUES = {"indentation": [3e-8, 0.0, 1e-7], "force": [1e-6, 0.0, 3e-6], "contact_radius": [3e-7, 1e-7, 2e-7]}
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=str)
every_work = pytest.mark.parametrize("work", [0.0, 0.05], ids=["elastic", "jkr"])
every_control = pytest.mark.parametrize("control", VALUES)


@every_shape
@every_work
@every_control
def test_the_control_is_the_dimension_in_the_order_given(shape: rm.PowerLaw, work: float, control: str) -> None:
    contact = rm.indent(shape, effective_modulus=1e9, work=work, **{control: VALUES[control]})
    assert set(contact.variables) == set(UNITS)
    assert set(contact.coords) == {control}
    for name, unit in UNITS.items():
        assert contact[name].dims == (control,)
        assert contact[name].dtype == np.float64
        assert contact[name].attrs["units"] == unit
        assert contact[name].attrs["long_name"]
    np.testing.assert_array_equal(contact[control], VALUES[control])
    np.testing.assert_allclose(contact.contact_area, np.pi * contact.contact_radius.values**2, rtol=1e-15)
    for i, value in enumerate(VALUES[control]):
        one = rm.indent(shape, effective_modulus=1e9, work=work, **{control: value})
        for name in UNITS:
            assert one[name].dims == ()
            assert float(one[name]) == float(contact[name][i])


@every_control
def test_no_values_give_no_results(control: str) -> None:
    contact = rm.indent(SHAPES[0], effective_modulus=1e9, work=0.05, **{control: []})
    assert contact.sizes == {control: 0}
    assert set(contact.variables) == set(UNITS)


@every_shape
@pytest.mark.parametrize("control", ["displacement", "force"])
def test_pull_off_gives_scalars(shape: rm.PowerLaw, control: str) -> None:
    off = rm.pull_off(shape, effective_modulus=1e9, work=0.05, control=control)
    assert set(off.variables) == {"force", "indentation", "contact_radius"}
    for name in off.variables:
        assert off[name].dims == ()
        assert off[name].attrs["units"] == UNITS[name]
    without = rm.pull_off(shape, effective_modulus=1e9, work=0.0, control=control)
    assert all(float(without[name]) == 0.0 for name in without.variables)


def test_pull_off_is_the_largest_tension_unless_told() -> None:
    off = rm.pull_off(SHAPES[0], effective_modulus=1e9, work=0.05)
    assert off.identical(rm.pull_off(SHAPES[0], effective_modulus=1e9, work=0.05, control="force"))
    grips = rm.pull_off(SHAPES[0], effective_modulus=1e9, work=0.05, control="displacement")
    assert off.force < grips.force < 0.0
    assert (off.attrs["control"], grips.attrs["control"]) == ("force", "displacement")
    assert off.force.attrs["long_name"].endswith("at the largest tension")
    assert grips.force.attrs["long_name"].endswith("at the point of detachment under fixed grips")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, r"none.*indentation, force, contact_radius"),
        ({"indentation": 0.0, "force": 0.0}, "indentation and force"),
        ({"indentation": 0.0, "contact_radius": 1e-9}, "indentation and contact_radius"),
        ({"indentation": np.zeros((2, 2))}, "indentation .*2"),
        ({"force": [0.0, float("nan")]}, "force is nan"),
        ({"force": float("inf")}, "force is inf"),
        ({"indentation": "deep"}, "indentation is 'deep'"),
        ({"contact_radius": [1e-7, -3e-8]}, "contact_radius is -3e-08"),
        ({"indentation": 0.0, "effective_modulus": 0.0}, "modulus is 0"),
        ({"indentation": 0.0, "effective_modulus": -2.0}, "modulus is -2"),
        ({"indentation": 0.0, "effective_modulus": float("nan")}, "modulus is nan"),
        ({"indentation": 0.0, "effective_modulus": "soft"}, "modulus is 'soft'"),
        ({"indentation": 0.0, "effective_modulus": [1e9, 2e9]}, "modulus is"),
        ({"indentation": 0.0, "work": -0.05}, "work is -0.05"),
        ({"indentation": 0.0, "work": float("inf")}, "work is inf"),
        ({"indentation": 0.0, "work": "sticky"}, "work is 'sticky'"),
        ({"indentation": 0.0, "adhesion": "glue"}, "adhesion is 'glue'"),
    ],
    ids=lambda value: value if isinstance(value, str) else None,
)
def test_a_bad_argument_is_refused_by_name_and_value(given: dict[str, object], message: str) -> None:
    with pytest.raises(rm.RoughmdrError, match=message):
        rm.indent(SHAPES[0], **{"effective_modulus": 1e9, **given})


@pytest.mark.parametrize("exponent", [0.1, 0.5])
def test_adhesion_below_the_least_exponent_is_refused(exponent: float) -> None:
    shape = rm.PowerLaw(exponent=exponent, width=1e-6, rise=1e-7)
    with pytest.raises(rm.OutOfRange, match=f"exponent is {exponent:g}"):
        rm.indent(shape, effective_modulus=1e9, work=0.05, indentation=0.0)
    assert float(rm.indent(shape, effective_modulus=1e9, indentation=1e-8).force) > 0.0


def test_pull_off_refuses_another_control() -> None:
    with pytest.raises(rm.RoughmdrError, match="control is 'speed'"):
        rm.pull_off(SHAPES[0], effective_modulus=1e9, work=0.05, control="speed")
