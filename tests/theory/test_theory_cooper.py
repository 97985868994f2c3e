"""Cooper, Mikic and Yovanovich: their model of plane sections, summits that yield, and scenes of such surfaces."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scenes import scene
from scipy.special import erfc

import roughmdr as rm
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.ensemble.gaussian.summit_distribution import SummitDistribution
from roughmdr.pictures.overlay import Overlay, overlay_expected, overlay_theory
from roughmdr.scene import read
from roughmdr.spectrum import SelfAffine

SIGMA, AREA, K, HARDNESS = 1e-6, 1e-4, 160.0, 2.8e6
WAVES = {"hurst": 0.8, "long_wave": 3e-4, "short_wave": 1e-4, "rms_height": SIGMA}
MOMENTS = SelfAffine.of(**WAVES).moments
SLOPE = math.sqrt(2.0 * MOMENTS.m2 / math.pi)
FACES = {"hardness": HARDNESS, "rms_height": SIGMA, "mean_slope": SLOPE, "conductivity": K}
SURFACE = {"source": "nayak", "patch": 1e-2, **WAVES}
YIELDING: dict[str, Any] = {
    "adhesion": None,
    "material": {"modulus": 7e10, "poisson": 0.33},
    "plasticity": {"yield_strength": 1e6, "model": "kogut-etsion"},
    "conduction": {"conductivity": K},
    "asperities": SURFACE,
    "path": {"separation": {"start": 4.75 * SIGMA, "stop": 2.0 * SIGMA, "steps": 5}},
    "batch": {"estimator": "expected"},
    "output": {"variables": ["pressure", "contact_fraction", "thermal_conductance"]},
}
EVERY = ["pressure", "contact_fraction", "thermal_conductance"]
LAW = "cooper_mikic_yovanovich"


def asked(**changes: Any) -> Plan:
    return make_plan(read(scene(**(YIELDING | changes))))


def lines_of(found: Overlay) -> dict[str, np.ndarray]:
    return {line.variable: line.values for line in found.lines if line.label == LAW}


def remark_of(plan: Plan) -> str:
    return next(text for text in overlay_theory(plan, EVERY).remarks if text.startswith(LAW))


def test_the_correlation_is_that_of_plane_sections() -> None:
    depth = np.linspace(2.0, 4.75, 50)
    share = 0.5 * erfc(depth / math.sqrt(2.0))
    tubes = np.exp(-0.5 * depth**2) / (2.0 * math.sqrt(2.0 * math.pi)) / (1.0 - np.sqrt(share)) ** 1.5
    found = rm.theory.cooper_mikic_yovanovich(pressure=share * HARDNESS, **FACES)
    off = found / (K * SLOPE / SIGMA * tubes) - 1.0
    assert 0.014 < np.abs(off).max() < 0.016


@settings(deadline=None)
@given(st.floats(1e-9, 1.0), *[st.floats(1e-6, 1e6)] * 4)
def test_it_is_the_same_in_other_units(share: float, metre: float, pascal: float, kelvin: float, slope: float) -> None:
    units = {"hardness": pascal, "rms_height": metre, "mean_slope": slope, "conductivity": kelvin}
    found = rm.theory.cooper_mikic_yovanovich(pressure=[share * pascal, 0.0], **units)
    assert found[0] == pytest.approx(1.25 * share**0.95 * kelvin * slope / metre, rel=1e-12)
    assert found[1] == 0.0


@pytest.mark.parametrize("pressure", ["-1 Pa", 1.01 * HARDNESS, math.nan])
def test_pressures_beyond_the_hardness_are_refused(pressure: Any) -> None:
    with pytest.raises(rm.OutOfRange, match="pressure"):
        rm.theory.cooper_mikic_yovanovich(pressure=pressure, **FACES)


def test_summits_of_a_narrow_spectrum_that_have_all_yielded_conduct_as_it_says() -> None:
    """Independent contacts: from p/H = 1e-3 on they lack what the share of the flux tube adds."""
    run = rm.run(scene(**YIELDING)).isel(realization=0)
    share = run.pressure.values / HARDNESS
    assert run.plastic_load_fraction > 0.999
    np.testing.assert_allclose(share, run.contact_fraction, rtol=1e-6)
    alone = 1.0 / np.where(share > 1e-3, (1.0 - np.sqrt(share)) ** -1.5, 1.0)
    found = rm.theory.cooper_mikic_yovanovich(pressure=run.pressure, **FACES) * alone
    np.testing.assert_allclose(run.thermal_conductance / AREA, found, rtol=0.04)


def test_a_picture_has_it_at_its_own_pressure_and_over_that() -> None:
    plan = asked()
    found, depth = overlay_theory(plan, EVERY), plan.cells[0].path.separation / SIGMA
    lines = lines_of(found)
    assert [text.count("elastic bodies") for text in found.remarks] == [1, 0]  # all others have one reason
    share = 0.5 * erfc(depth / math.sqrt(2.0))
    np.testing.assert_allclose(lines["contact_fraction"], share, rtol=1e-12)
    conductance = AREA * rm.theory.cooper_mikic_yovanovich(pressure=HARDNESS * share, **FACES)
    np.testing.assert_allclose(lines["thermal_conductance"], conductance, rtol=1e-12)
    for law in (found, overlay_expected(plan, EVERY)):
        own = {line.variable: line.values for line in law.lines}["pressure"]
        over = law.over("pressure").lines
        assert [line.variable for line in over] == EVERY[1:]
        np.testing.assert_array_equal([line.x for line in over], [own, own])
    assert overlay_expected(plan, ["pressure"]).over("pressure").remarks == [
        "not drawn: nothing of it is over pressure"
    ]


def test_equal_summits_stand_on_the_surface_of_mccool() -> None:
    law = SummitDistribution(MOMENTS)
    summits = {
        "source": "random",
        "shape": "paraboloid",
        "density": law.density,
        "patch": 1e-2,
        "radius": 0.375 * math.sqrt(math.pi / MOMENTS.m4),
        "height": {"distribution": "normal", "mean": law.mean, "std": law.sigma},
    }
    of_summits, of_surface = (
        lines_of(overlay_theory(asked(**changed), EVERY)) for changed in ({"asperities": summits}, {})
    )
    for name in EVERY:
        np.testing.assert_allclose(of_summits[name], of_surface[name], rtol=1e-9)
    cut = summits | {"height": {**summits["height"], "max": 3.0 * SIGMA}}
    assert "not drawn: heights are not normal" in remark_of(asked(asperities=cut))


def test_elastic_scenes_and_those_that_do_not_conduct_have_none() -> None:
    assert "not drawn: for contacts that yield" in remark_of(asked(plasticity=None))
    assert "no conduction.conductivity" in remark_of(asked(conduction=None, output={"variables": ["pressure"]}))
