"""Named laws against mpmath, and sampled ensembles against the named laws."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES

import roughmdr as rm

GW = {"effective_modulus": 4e6, "radius": 5e-5, "std": 1e-6, "density": 2e9}


def f_3_2(h: float) -> float:
    """F_3/2 of Greenwood and Williamson for a standard normal."""
    pressure = rm.theory.greenwood_williamson(separation=h * GW["std"], **GW)
    return float(pressure) / (
        4.0 / 3.0 * GW["effective_modulus"] * math.sqrt(GW["radius"]) * GW["density"] * GW["std"] ** 1.5
    )


def test_the_integral_of_greenwood_and_williamson() -> None:
    assert f_3_2(1.0) == pytest.approx(0.07566817739097507, rel=1e-13)
    assert f_3_2(3.0) == pytest.approx(2.639675542694673e-4, rel=1e-13)
    for h in (-3.0, -0.5, 0.0, 4.5, 6.0):
        exact = mp.quad(lambda s, h=h: (s - h) ** 1.5 * mp.npdf(s), [h, h + 0.5, h + 2, h + 5, h + 10, h + 20])
        assert f_3_2(h) == pytest.approx(float(exact), rel=1e-11)


def scaled(variable: str, h: float) -> float:
    """F_n of Greenwood and Williamson for a standard normal, from each of the variables."""
    units = {
        "pressure": 4.0 / 3.0 * GW["effective_modulus"] * math.sqrt(GW["radius"]) * GW["std"] ** 1.5,
        "contact_fraction": math.pi * GW["radius"] * GW["std"],
        "contact_density": 1.0,
    }
    value = rm.theory.greenwood_williamson(separation=h * GW["std"], variable=variable, **GW)
    return float(value) / (GW["density"] * units[variable])


@pytest.mark.parametrize(("variable", "n"), [("pressure", 1.5), ("contact_fraction", 1.0), ("contact_density", 0.0)])
@pytest.mark.parametrize("h", [-6.0, -1.3, 0.0, 0.4, 2.0, 6.0])
def test_the_integrals_are_parabolic_cylinder_functions(variable: str, n: float, h: float) -> None:
    exact = mp.gamma(n + 1) / mp.sqrt(2 * mp.pi) * mp.exp(-(mp.mpf(h) ** 2) / 4) * mp.pcfd(-n - 1, h)
    assert scaled(variable, h) == pytest.approx(float(exact), rel=1e-12)


def fuller_tabor_by_mpmath(h: float, lowest: float, work: float) -> float:
    """Return the integral over the contact radius, where the JKR force is a polynomial in sqrt(a)."""
    effective_modulus, radius, std, density = (
        mp.mpf(GW[key]) for key in ("effective_modulus", "radius", "std", "density")
    )
    fold = mp.cbrt(mp.pi * work * radius**2 / (8 * effective_modulus))

    def stretch(a: mp.mpf) -> mp.mpf:
        return mp.sqrt(2 * mp.pi * a * work / effective_modulus)

    def delta(a: mp.mpf) -> mp.mpf:
        return a * a / radius - stretch(a)

    def integrand(a: mp.mpf) -> mp.mpf:
        force = 2 * effective_modulus * a * (2 * a * a / (3 * radius) - stretch(a))
        return force * mp.npdf(h + delta(a), 0, std) * (2 * a / radius - stretch(a) / (2 * a))

    first = (
        fold if lowest - h <= delta(fold) else mp.findroot(lambda a: delta(a) - (lowest - h), (fold * 1.01, fold * 9))
    )
    far = mp.sqrt(radius * 16 * std) + 6 * fold
    return float(density * mp.quad(integrand, [first + (far - first) * k / 8 for k in range(9)]))


@pytest.mark.few(1)
@pytest.mark.parametrize("h", [-0.5e-6, 0.3e-6, 1e-6, 2e-6])
def test_the_integral_of_fuller_and_tabor(h: float) -> None:
    work, turning = 0.05, -0.6e-6
    inward = rm.theory.fuller_tabor(separation=h, work=work, **GW)
    outward = rm.theory.fuller_tabor(separation=h, work=work, turning=turning, **GW)
    scale = GW["density"] * math.pi * work * GW["radius"]
    assert float(inward) == pytest.approx(fuller_tabor_by_mpmath(h, h, work), abs=1e-11 * scale)
    assert float(outward) == pytest.approx(fuller_tabor_by_mpmath(h, turning, work), abs=1e-11 * scale)
    assert outward < inward


def test_without_work_the_second_tends_to_the_first() -> None:
    h = np.array([0.0, 1e-6, 2e-6])
    hertz = rm.theory.greenwood_williamson(separation=h, **GW)
    gaps = [
        np.max(np.abs(rm.theory.fuller_tabor(separation=h, work=w, **GW) / hertz - 1.0)) for w in (1e-8, 1e-10, 1e-12)
    ]
    assert gaps[0] > 50 * gaps[1] > 2500 * gaps[2]


@pytest.mark.parametrize(
    ("name", "value"), [("std", 0.0), ("density", -1.0), ("radius", math.nan), ("separation", math.inf)]
)
def test_wrong_arguments_are_refused(name: str, value: float) -> None:
    with pytest.raises(rm.RoughmdrError, match=name):
        rm.theory.greenwood_williamson(**{"separation": 0.0, **GW, name: value})


def test_separations_below_the_turning_point_are_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="turning"):
        rm.theory.fuller_tabor(separation=[0.0, 1e-6], work=0.1, turning=0.5e-6, **GW)


@pytest.mark.large
@pytest.mark.parametrize("work", [0.0, 0.05])
def test_sampled_ensembles_agree_within_three_standard_errors(work: float) -> None:
    """Four separations a branch; the seed is fixed, so that this either holds or does not."""
    h = np.array([2.0, 1.0, 0.3, -0.5]) * 1e-6
    section = {**ASPERITIES, "count": 2000, "radius": "50 um"}
    forces = []
    for realization in range(64):
        data = rm.generate(section, seed=3, realization=realization)
        forces.append(rm.load_separation(data, separation=h, effective_modulus=4e6, work=work, unload=True).force)
    pressure = np.array(forces) / 1e-6
    mean, error = pressure.mean(axis=0), pressure.std(axis=0, ddof=1) / math.sqrt(64)
    if work:
        inward = rm.theory.fuller_tabor(separation=h, work=work, **GW)
        outward = rm.theory.fuller_tabor(separation=h[::-1], work=work, turning=h[-1], **GW)
        assert (np.abs(inward - outward[::-1])[:3] > 3.0 * error[:3]).all()
    else:
        inward = rm.theory.greenwood_williamson(separation=h, **GW)
        outward = inward[::-1]
    deviation = (mean - np.concatenate([inward, outward])) / error
    assert (np.abs(deviation) < 3.0).all(), deviation


def test_the_area_and_the_number_of_fuller_and_tabor() -> None:
    """All summits in contact, equally deep: those of one contact, times their number."""
    h, narrow = -2e-6, {**GW, "std": 1e-12}
    one = rm.indent(
        rm.Paraboloid(radius=GW["radius"]), effective_modulus=GW["effective_modulus"], work=0.05, indentation=-h
    )
    for variable, each in (("pressure", one.force), ("contact_fraction", one.contact_area), ("contact_density", 1.0)):
        law = rm.theory.fuller_tabor(separation=h, work=0.05, variable=variable, **narrow)
        assert float(law) == pytest.approx(GW["density"] * float(each), rel=1e-9)


@given(h=st.floats(-4.0, 6.0), work=st.floats(1e-4, 1.0))
@settings(deadline=None, max_examples=20)
def test_maugis_is_hertz_less_the_pull_of_every_contact(h: float, work: float) -> None:
    h *= GW["std"]
    hertz, number = (
        float(rm.theory.greenwood_williamson(separation=h, variable=variable, **GW))
        for variable in ("pressure", "contact_density")
    )
    pull = 2.0 * math.pi * work * GW["radius"] * number
    law = float(rm.theory.dmt_maugis(separation=h, work=work, **GW))
    assert law == pytest.approx(hertz - pull, abs=1e-12 * (hertz + pull))
    for variable in ("contact_fraction", "contact_density"):
        same = rm.theory.greenwood_williamson(separation=h, variable=variable, **GW)
        assert rm.theory.dmt_maugis(separation=h, work=work, variable=variable, **GW) == same


@given(h=st.floats(-3.0, 6.0), size=st.floats(1e-9, 1e9), stiffer=st.floats(1e-6, 1e6))
@settings(deadline=None, max_examples=20)
def test_the_laws_hold_at_every_size(h: float, size: float, stiffer: float) -> None:
    """Lengths times ``size``, stresses times ``stiffer``: work by both, pressure by one."""
    other = {
        "effective_modulus": GW["effective_modulus"] * stiffer,
        "radius": GW["radius"] * size,
        "std": GW["std"] * size,
        "density": GW["density"] / size**2,
    }
    h *= GW["std"]
    for law, work in ((rm.theory.greenwood_williamson, {}), (rm.theory.fuller_tabor, {"work": 1e-3})):
        more = {"work": work["work"] * size * stiffer} if work else {}
        here, there = law(separation=h, **GW, **work), law(separation=h * size, **other, **more)
        scale = float(rm.theory.greenwood_williamson(separation=h, **GW))
        assert float(there) / stiffer == pytest.approx(float(here), rel=1e-10, abs=1e-10 * scale)


@pytest.mark.parametrize("name", ["greenwood_williamson", "fuller_tabor", "dmt_maugis"])
def test_shapes_are_kept_and_far_away_there_is_nothing(name: str) -> None:
    law, work = getattr(rm.theory, name), {} if name == "greenwood_williamson" else {"work": 0.05}
    assert law(separation=1e-6, **GW, **work).shape == ()
    assert law(separation=[], **GW, **work).shape == (0,)
    h = np.linspace(-3e-6, 6e-6, 700)
    many = law(separation=h, **GW, **work)
    assert many[650] == pytest.approx(float(law(separation=h[650], **GW, **work)), rel=1e-13)
    assert law(separation=[1e-3, 1e300], **GW, **work).tolist() == [0.0, 0.0]
    with pytest.raises(rm.OutOfRange, match="representable"):
        law(separation=-1e300, **GW, **work)
    with pytest.raises(rm.RoughmdrError, match="'contact_fraction'"):
        law(separation=0.0, variable="area", **GW, **work)
    with pytest.raises(rm.RoughmdrError, match="exactly one"):
        law(separation=0.0, **{**GW, "std": None}, **work)


def test_every_law_is_listed() -> None:
    for name in rm.theory.__all__:
        assert getattr(rm.theory, name).__doc__
