"""Barton and Bandis's closure: a hyperbola is found again, and of laws it is told by how much it misses them."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from exports import header_of
from hypothesis import given, settings, strategies as st
from scenes import scene
from scipy.optimize import curve_fit

import roughmdr as rm
from roughmdr.report.export.header import SEATING, hyperbola


@settings(deadline=None)
@given(stiffness=st.floats(1e6, 1e15), most=st.floats(1e-9, 1e-3), part=st.floats(0.05, 0.99), datum=st.floats(-1, 1))
def test_a_hyperbola_is_found_again(stiffness: float, most: float, part: float, datum: float) -> None:
    """From the seating pressure on it is one too: of the closure that is left, and stiffer."""
    v = np.linspace(0.0, part * most, 1001)
    pressure = stiffness * v / (1.0 - v / most)
    found = hyperbola(most * datum - v, pressure)
    left = most / (1.0 + SEATING * pressure[-1] / (stiffness * most))
    assert found.closure == pytest.approx(left, rel=1e-4)
    assert found.stiffness == pytest.approx(stiffness * (most / left) ** 2, rel=1e-3)
    assert found.misfit < 1e-4
    assert found.seating == SEATING * pressure[-1]


def test_it_goes_with_the_units() -> None:
    v = np.linspace(0.0, 1e-6, 300)
    one, other = (hyperbola(-v * size, 1e4 * 2.0**20 * size * np.expm1(8e6 * v)) for size in (1.0, 2.0**-4))
    assert other.stiffness == pytest.approx(one.stiffness, rel=1e-9)
    assert other.closure == pytest.approx(2.0**-4 * one.closure, rel=1e-9)
    assert other.misfit == pytest.approx(one.misfit, rel=1e-9)


def test_a_straight_law_has_no_largest_closure_and_too_few_steps_no_law() -> None:
    v = np.linspace(0.0, 1e-6, 50)
    straight = hyperbola(-v, 1e11 * v)
    assert straight.stiffness == pytest.approx(1e11, rel=1e-4)
    assert straight.closure > 1e-2
    assert straight.misfit < 1e-5
    assert hyperbola(-v[-4:], 1e11 * v[-4:]) is None
    assert hyperbola(-v[:4], 1e11 * v[:4]) is None


def test_the_header_has_the_hyperbola_of_least_squares_and_its_misfit(tmp_path: Path) -> None:
    path = {"separation": {"start": "clear", "stop": "0 sigma", "steps": 120}}
    rm.run(scene(adhesion=None, path=path, batch={"estimator": "expected"}), tmp_path / "joint.nc")
    rm.export(tmp_path / "joint.nc", tmp_path / "joint.csv", to="csv", error=5e-3, units="mm,N,MPa")
    said = re.search(
        r"Barton-Bandis: .* k_ni = (\S+) MPa/mm and v_m = (\S+) mm, p and v from a pressure of (\S+) MPa on "
        r"\(1% of the largest\), is off by up to (\S+) of the largest",
        header_of(tmp_path / "joint.csv"),
    )
    k, most, seat, misfit = map(float, said.groups())
    with xr.open_dataset(tmp_path / "joint.nc") as data:
        h, p = data.separation.to_numpy() * 1e3, (data.force[0] / data.nominal_area).to_numpy() * 1e-6
    assert seat == pytest.approx(0.01 * p[-1], rel=1e-3)
    first = int(np.argmax(p > seat))
    datum = np.interp(seat, p[first - 1 : first + 1], h[first - 1 : first + 1])
    v, p = np.append(0.0, datum - h[first:]), np.append(0.0, p[first:] - seat)
    assert misfit == pytest.approx(np.abs(k * v / (1.0 - v / most) - p).max() / p[-1], abs=1e-3)
    assert 0.05 < misfit < 0.1  # an almost exponential law is no hyperbola
    deviation, x, y = np.gradient(v) ** -0.5, v / v[-1], p / p[-1]
    limits = {"bounds": ((0.0, 1.0001), np.inf), "xtol": 1e-14, "ftol": 1e-14, "gtol": 1e-14}
    fitted, _ = curve_fit(lambda v, a, b: a * v / (1.0 - v / b), x, y, (0.1, 1.5), deviation, **limits)
    assert (k * v[-1] / p[-1], most / v[-1]) == pytest.approx(tuple(fitted), rel=2e-3)
    rm.export(tmp_path / "joint.nc", tmp_path / "area.csv", to="csv", error=5e-3, quantity="area")
    assert "Barton" not in header_of(tmp_path / "area.csv")
