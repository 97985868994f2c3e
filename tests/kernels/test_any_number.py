"""Whatever numbers come in: finite answers, or an error of roughmdr's own."""

import numba
import numpy as np
import pytest
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st

import roughmdr as rm

KINDS = {
    "paraboloid": lambda p: rm.Paraboloid(radius=p[0]),
    "cone": lambda p: rm.Cone(slope=p[0]),
    "coefficient": lambda p: rm.PowerLaw(exponent=p[0], coefficient=p[1]),
    "rise": lambda p: rm.PowerLaw(exponent=p[0], width=p[1], rise=p[2]),
    "flat": lambda p: rm.FlatPunch(radius=p[0]),
    "sphere": lambda p: rm.Sphere(radius=p[0]),
    "power_series": lambda p: rm.PowerSeries({p[0]: p[1], 3.0: p[2]}),
    "truncated_cone": lambda p: rm.TruncatedCone(slope=p[0], flat_radius=p[1]),
    "truncated_paraboloid": lambda p: rm.TruncatedParaboloid(radius=p[0], flat_radius=p[1]),
    "rounded_cone": lambda p: rm.RoundedCone(slope=p[0], blend_radius=p[1]),
    "capped_paraboloid": lambda p: rm.CappedParaboloid(radius=p[0], cap_radius=p[1], blend_radius=p[2]),
    "rounded_punch": lambda p: rm.RoundedPunch(flat_radius=p[0], edge_radius=p[1]),
    "tabulated": lambda p: rm.Tabulated([0.0, p[0], p[0] + p[1]], [0.0, p[2], 3.0 * p[2]]),
}
compiled = pytest.mark.skipif(
    numba.config.DISABLE_JIT, reason="Python floats raise where compiled ones overflow to inf"
)
decades = st.floats(-320.0, 308.0).map(lambda d: 10.0**d)
moderate = st.floats(-12.0, 12.0).map(lambda d: 10.0**d)
exponents = st.floats(0.3, 300.0)
sizes = st.one_of(exponents, moderate, decades, st.floats(allow_nan=False, allow_infinity=False))
works = st.one_of(st.just(0.0), sizes)
controls = st.builds(lambda size, sign: sign * size, st.one_of(st.just(0.0), sizes), st.sampled_from([1.0, -1.0]))


@pytest.mark.few(1)
@compiled
@pytest.mark.parametrize("control", ["indentation", "force", "contact_radius"])
@pytest.mark.parametrize("kind", KINDS)
@given(
    parameters=st.tuples(sizes, sizes, sizes),
    effective_modulus=sizes,
    work=works,
    values=st.lists(controls, max_size=3),
)
@settings(deadline=None, max_examples=60)
def test_indent(
    kind: str,
    control: str,
    parameters: tuple[float, float, float],
    effective_modulus: float,
    work: float,
    values: list[float],
) -> None:
    try:
        with np.errstate(all="ignore"):
            contact = rm.indent(
                KINDS[kind](parameters), effective_modulus=effective_modulus, work=work, **{control: values}
            )
    except rm.RoughmdrError:
        return
    for name in contact.variables:
        assert np.isfinite(contact[name]).all(), name
    assert (contact.contact_radius >= 0.0).all()


@pytest.mark.few(1)
@compiled
@pytest.mark.parametrize("control", ["displacement", "force"])
@pytest.mark.parametrize("kind", KINDS)
@given(parameters=st.tuples(sizes, sizes, sizes), effective_modulus=sizes, work=works)
@settings(deadline=None, max_examples=60)
def test_pull_off(
    kind: str, control: str, parameters: tuple[float, float, float], effective_modulus: float, work: float
) -> None:
    try:
        with np.errstate(all="ignore"):
            off = rm.pull_off(KINDS[kind](parameters), effective_modulus=effective_modulus, work=work, control=control)
    except rm.RoughmdrError:
        return
    for name in ("force", "indentation", "contact_radius"):
        assert np.isfinite(off[name]), name
    assert off.force <= 0.0
    assert (off.contact_radius > 0.0) == (work > 0.0)


@large_where_compiled
@given(values=st.lists(st.floats(-1.0, 1000.0), min_size=1, max_size=5), kind=st.sampled_from(sorted(KINDS)))
@settings(deadline=None, max_examples=100)
def test_ordinary_numbers_are_never_refused(values: list[float], kind: str) -> None:
    shape = KINDS[kind]((1.5, 1.6, 0.2))
    off = rm.pull_off(shape, effective_modulus=1e6, work=0.05, control="displacement")
    contact = rm.indent(shape, effective_modulus=1e6, work=0.05, indentation=np.array(values) * -float(off.indentation))
    assert ((contact.contact_radius > 0.0) == (np.array(values) >= -1.0)).all()


@compiled
@pytest.mark.parametrize(
    "given",
    [
        {"work": 0.0, "indentation": 1e307},
        {"work": 0.0, "contact_radius": 1e160},
        {"work": 1.0, "indentation": 1e300},
        {"work": 1.0, "contact_radius": 1e160},
    ],
    ids=str,
)
@pytest.mark.parametrize("kind", ["paraboloid", "cone", "coefficient", "rise"])
def test_an_overflow_is_refused_without_a_warning(kind: str, given: dict[str, float]) -> None:
    with pytest.raises(rm.OutOfRange, match="representable"):
        rm.indent(KINDS[kind]((1.5, 1.6, 1e-6)), effective_modulus=1e13, **given)


def test_a_fold_that_is_no_float_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="representable"):
        rm.indent(rm.PowerLaw(exponent=1.5, width=1e-200, rise=1e45), effective_modulus=1e6, work=1.0, indentation=0.0)


def test_a_contact_has_an_area() -> None:
    with pytest.raises(rm.OutOfRange, match=r"contact_area .* is not representable"):
        rm.indent(rm.Cone(slope=1.0), effective_modulus=1e6, contact_radius=1e-163)
