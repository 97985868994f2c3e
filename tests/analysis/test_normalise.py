"""Laws without dimensions against the integrals F_n of Greenwood and Williamson."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import ASPERITIES, scene
from scipy import integrate, stats

import roughmdr as rm

_ORDERS = {
    "force": 1.5,
    "contact_area": 1.0,
    "contact_count": 0.0,
    "stiffness": 0.5,
    "contact_radius_sum": 0.5,
    "energy": 2.5,
    "pressure": 1.5,
    "contact_fraction": 1.0,
}


def F(n: float, d: float) -> float:
    """The integral of (s - d)^n phi(s) over s > d."""
    return float(integrate.quad(lambda x: x**n * stats.norm.pdf(d + x), 0.0, math.inf, epsabs=0.0, epsrel=1e-11)[0])


def run(**changes: Any) -> xr.Dataset:
    path = {"separation": {"start": "3 sigma", "stop": "-1 sigma", "steps": 9}}
    return rm.run(scene(**{"adhesion": None, "path": path, "batch": {"estimator": "expected"}, **changes}))


@pytest.mark.large
def test_the_expected_law_is_f_of_n() -> None:
    scaled = run(asperities=ASPERITIES | {"radius": "50 um"}, output={"variables": list(_ORDERS)}).roughmdr.normalise(
        "gw"
    )
    np.testing.assert_allclose(scaled.separation, np.linspace(3.0, -1.0, 9), atol=1e-12)
    for name, n in _ORDERS.items():
        expected = [F(n, d) for d in scaled.separation.values]
        np.testing.assert_allclose(scaled[name][0], expected, rtol=1e-8, err_msg=name)
        assert scaled[name].attrs["units"] == "1"
    assert scaled.stiffness.attrs["long_name"].endswith("over 2 N E* (R sigma)^(1/2)")


@pytest.mark.large
def test_the_cells_of_a_sweep_fall_on_one_curve() -> None:
    sweep = {
        "mode": "product",
        "material.modulus": ["1 MPa", "9 MPa"],
        "asperities.count": [100, 300],
        "asperities.height.std": ["0.3 um", "2 um"],
    }
    result = run(asperities=ASPERITIES | {"radius": "20 um"}, sweep=sweep)
    scaled = result.roughmdr.normalise("gw")
    np.testing.assert_allclose(scaled.force, np.broadcast_to(scaled.force[0, 0, 0], scaled.force.shape), rtol=1e-9)
    assert scaled.separation.dims == ("asperities_height_std", "step")
    part = result.sel(material_modulus=9e6).isel(asperities_count=[1])
    np.testing.assert_allclose(part.roughmdr.normalise("gw").force, scaled.force[1, [1]], rtol=1e-12)


def test_the_cells_of_a_zipped_sweep_too() -> None:
    sweep = {"mode": "zip", "material.modulus": ["1 MPa", "9 MPa"], "asperities.count": [100, 300]}
    result = run(asperities=ASPERITIES | {"radius": "20 um"}, sweep=sweep)
    scaled = result.roughmdr.normalise("gw")
    np.testing.assert_allclose(scaled.force[1], scaled.force[0], rtol=1e-9)
    with pytest.raises(rm.StoreError, match="normalise needs all 2 cells of the sweep along cell"):
        result.isel(cell=[0]).roughmdr.normalise("gw")


@pytest.mark.large
def test_statistics_and_pull_offs_are_scaled_too(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    each, mean = curves.roughmdr.normalise("gw"), statistics.roughmdr.normalise("gw")
    np.testing.assert_allclose(mean.force_mean, each.force.mean("realization"), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(mean.pull_off_force_mean, each.pull_off_force.mean("realization"), rtol=1e-9)
    sigma = curves.asperities_height_std
    np.testing.assert_allclose(each.pull_off_separation, curves.pull_off_separation / sigma, rtol=1e-12)


def test_a_nayak_surface_has_a_mean_radius() -> None:
    surface = {"source": "nayak", "shape": "paraboloid", "patch": "0.3 mm", "rms_height": "1 um", "hurst": 0.8}
    surface |= {"long_wave": "100 um", "short_wave": "5 um"}
    path = {"separation": ["3 um", "1 um"]}
    result = run(asperities=surface, path=path, batch=None, output={"variables": ["contact_area", "contact_count"]})
    scaled = result.roughmdr.normalise("gw")
    asperities = rm.generate(surface, seed=7)
    area = result.contact_area / (math.pi * asperities.sizes["asperity"] * float(asperities.radius.mean()))
    ratio = (scaled.contact_area / area).values
    assert ratio == pytest.approx(1.0 / float(asperities.height.std()), rel=0.05)


@pytest.mark.parametrize(
    ("asperities", "message"),
    [
        ({"shape": "cone", "slope": 0.1, "radius": None}, "needs paraboloids, which have a radius; .* are cones"),
        ({"height": "1 um"}, "needs heights that scatter; their standard deviation in this scene is 0 m"),
    ],
)
def test_without_a_radius_or_a_sigma_it_is_refused(asperities: dict[str, Any], message: str) -> None:
    section = {key: value for key, value in (ASPERITIES | asperities).items() if value is not None}
    result = run(asperities=section, path={"separation": ["3 um", "0.5 um"]}, batch=None)
    with pytest.raises(rm.StoreError, match=message):
        result.roughmdr.normalise("gw")


def test_another_theory_or_no_scene_is_refused(curves: xr.Dataset) -> None:
    with pytest.raises(rm.StoreError, match="theory is 'persson'; it must be 'gw'"):
        curves.roughmdr.normalise("persson")
    del (bare := curves.copy()).attrs["scene"]
    with pytest.raises(rm.StoreError, match="normalise needs the attribute scene"):
        bare.roughmdr.normalise("gw")
