"""Adhesion "auto" and the range of the attraction, for one contact and for an ensemble in Python."""

import numba
import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from scenes import scene

import roughmdr as rm
from roughmdr.shapes import Shape
from roughmdr.variables import ADHESION_CODES

W = 0.05
TIP = rm.Paraboloid(radius=1e-6)
SOFT = {"effective_modulus": 1e9, "work": W}


def strength_at(tabor: float, shape: Shape = TIP) -> float:
    """The strength with which a contact has this Tabor number."""
    return tabor / rm.tabor(shape, **SOFT, strength=1.0)


def test_a_range_is_work_over_strength() -> None:
    strength = strength_at(1.0)
    depth = np.linspace(-1e-9, 3e-9, 9)
    for function, arguments in (
        (rm.indent, {"indentation": depth}),
        (rm.pull_off, {"control": "force"}),
    ):
        by_strength = function(TIP, **SOFT, **arguments, adhesion="dugdale", strength=strength)
        by_range = function(TIP, **SOFT, **arguments, adhesion="dugdale", range=W / strength)
        xr.testing.assert_allclose(by_range, by_strength, rtol=1e-13)
    text = f"{W / strength * 1e9} nm"
    assert rm.tabor(TIP, **SOFT, range=text) == pytest.approx(1.0, rel=1e-12)
    for both in ({}, {"strength": strength, "range": W / strength}):
        with pytest.raises(rm.RoughmdrError, match="tabor takes exactly one of strength, range"):
            rm.tabor(TIP, **SOFT, **both)


@pytest.mark.parametrize(("tabor", "error"), [(0.3, 0.01), (3.0, 0.01), (3.0, 0.1), (10.0, 0.01), (100.0, 1e-6)])
def test_auto_takes_jkr_where_its_pull_off_is_right_enough(tabor: float, error: float) -> None:
    strength = strength_at(tabor)
    force = {
        model: rm.pull_off(TIP, **SOFT, control="force", adhesion=model, strength=strength)
        for model in ("jkr", "dugdale")
    }
    auto = rm.pull_off(TIP, **SOFT, control="force", adhesion="auto", strength=strength, error=error)
    taken = auto.attrs.pop("adhesion")
    xr.testing.assert_identical(auto, force[taken])
    off = abs(float(force["jkr"].force / force["dugdale"].force) - 1.0)
    assert taken == ("jkr" if off <= error else "dugdale")
    depth = np.linspace(-1e-9, 3e-9, 9)
    law = rm.indent(TIP, **SOFT, indentation=depth, adhesion="auto", strength=strength, error=error)
    assert law.attrs.pop("adhesion") == taken
    xr.testing.assert_identical(law, rm.indent(TIP, **SOFT, indentation=depth, adhesion=taken, strength=strength))


@large_where_compiled
def test_auto_sees_a_flat_that_the_tabor_number_does_not() -> None:
    """JKR is off by 1 % at a Tabor number of 3 for a paraboloid, and of 7 for a punch."""
    punch = rm.RoundedPunch(flat_radius=1e-5, edge_radius=1e-7)
    for shape, tabor, taken in ((TIP, 4.0, "jkr"), (punch, 4.0, "dugdale"), (punch, 8.0, "jkr")):
        strength = strength_at(tabor, shape)
        assert rm.pull_off(shape, **SOFT, adhesion="auto", strength=strength).attrs["adhesion"] == taken


def test_auto_without_adhesion_is_hertz_and_where_jkr_has_no_contact_dugdale() -> None:
    hertz = rm.indent(TIP, effective_modulus=1e9, indentation=1e-9)
    auto = rm.indent(TIP, effective_modulus=1e9, indentation=1e-9, adhesion="auto", range="1 nm")
    assert auto.attrs.pop("adhesion") == "jkr"
    xr.testing.assert_identical(auto, hertz)
    with pytest.raises(rm.RoughmdrError, match="with method='springs' it must be 'jkr'"):
        rm.indent(TIP, **SOFT, indentation=1e-9, adhesion="auto", range="1 nm", method="springs")


@pytest.mark.few(1)
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="a run takes seconds uncompiled, and the choice is tested alone")
@pytest.mark.parametrize("tabor", [0.3, 3.0, 300.0, 3e4])
def test_the_load_of_an_ensemble_takes_the_model_that_a_run_takes(tabor: float) -> None:
    adhesion = {"model": "auto", "work": W, "strength": strength_at(tabor), "error": 0.05}
    table = scene(adhesion=adhesion, batch={"realizations": 1}, material={"effective_modulus": 1e9})
    table["asperities"] |= {"radius": "1 um", "height": {"distribution": "normal", "std": "20 nm"}}
    run = rm.run(table)
    law = rm.load_separation(
        rm.generate(table["asperities"], seed=table["seed"]),
        separation=run.separation.values[: run.sizes["step"] // 2],
        unload=True,
        effective_modulus=1e9,
        work=W,
        adhesion="auto",
        strength=adhesion["strength"],
        error=0.05,
    )
    np.testing.assert_array_equal(law.force, run.force[0])
    assert ADHESION_CODES[int(run.adhesion_law[0])] == law.attrs["adhesion"]
