"""The study of one asperity: its numbers are those of the theory, whatever its pictures look like."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from figures import one_asperity as study
from forms import large_where_compiled
from scipy.optimize import brentq
from scipy.special import digamma, gamma

import roughmdr as rm
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf

pytestmark = large_where_compiled
PIPELINES = Path(__file__).parents[2] / "pipelines"


E, W = study.MODULUS, study.WORK
TOUCH_RADIUS = 8 * W / (math.pi * E * study.SLOPE**2)  # contact radius of the cone at first touch [m]


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return study.measure(quick=True)


def kappa(n: np.ndarray) -> np.ndarray:
    return math.sqrt(math.pi) / 2 * n * gamma(n / 2) / gamma((n + 1) / 2)


def test_the_cone_lets_go_at_a_quarter_of_its_first_contact(result: xr.Dataset) -> None:
    """t^2 = a/a0 with 2n t^(2n-1) = 1 under fixed grips, 3 under dead load."""
    a0, d0 = TOUCH_RADIUS, 0.5 * math.pi * study.SLOPE * TOUCH_RADIUS
    cone = result.sel(shape="cone")
    np.testing.assert_allclose(cone.pull_off_radius / a0, [0.25, 2.25], rtol=1e-12)
    np.testing.assert_allclose(cone.pull_off_indentation / d0, [-0.25, 0.75], rtol=1e-12)


def test_the_pull_off_forces_of_theory(result: xr.Dataset) -> None:
    np.testing.assert_allclose(result.pull_off_force, result.known_force, rtol=1e-12)
    ratio = result.pull_off_force.sel(control="displacement") / result.pull_off_force.sel(control="force")
    np.testing.assert_allclose(ratio, [1 / 9, 5 / 9, 1.0], rtol=1e-12)
    kendall = -math.sqrt(8 * math.pi * E * W * study.FLAT**3)
    np.testing.assert_allclose(result.pull_off_force.sel(shape="flat punch"), kendall, rtol=1e-12)


def test_the_curves_meet_where_they_should(result: xr.Dataset) -> None:
    force, depth = result.curve_force, result.curve_indentation
    touch = force.sel(course="loading").isel(point=0)
    jump = [-math.pi / 2 * E * study.SLOPE * TOUCH_RADIUS**2, -4 / 3 * math.pi * W * study.RADIUS, 0.0]
    np.testing.assert_allclose(touch, jump, rtol=1e-12)
    for control in ("displacement", "force"):
        least = force.sel(course="unloading").min("point")
        assert (result.pull_off_force.sel(control=control) >= least * (1 + 1e-3)).all()
    last = {"course": "unloading", "point": -1}
    np.testing.assert_array_equal(
        force.sel(course=last["course"]).isel(point=last["point"]), result.pull_off_force.sel(control="displacement")
    )
    curved = {"shape": ["cone", "paraboloid"], "course": "unstable"}
    unstable, below = force.sel(curved), depth.sel(curved)
    np.testing.assert_allclose(
        unstable.isel(point=0), result.pull_off_force.sel(shape=curved["shape"], control="displacement"), rtol=1e-12
    )
    assert (below.diff("point") > 0.0).all()  # with less contact it would have to come nearer: no control holds it
    np.testing.assert_array_equal([unstable.isel(point=-1), below.isel(point=-1)], 0.0)


def test_shapes_of_one_size_hold_as_the_scaling_says(result: xr.Dataset) -> None:
    n, ratio = result.exponent, result.relative_stretch
    dead = -result.held_force.sel(control="force") / math.sqrt(8 * math.pi * E * W * study.WIDTH**3)
    grips = -result.held_force.sel(control="displacement") / math.sqrt(8 * math.pi * E * W * study.WIDTH**3)
    edge = ratio / (n * kappa(n))  # dl/(n g) at the width
    free = (2 * n - 1) / (2 * n + 2) * (1.5 * edge) ** (3 / (2 * n - 1))
    pinned = 1 - n / (n + 1) * kappa(n) / ratio
    np.testing.assert_allclose(dead, xr.where(1.5 * edge > 1, pinned, free).transpose(*dead.dims), rtol=1e-11)
    expected = (2 * n + 1) / (2 * n + 2) * (0.5 * edge) ** (3 / (2 * n - 1))
    np.testing.assert_allclose(grips, expected.transpose(*grips.dims), rtol=1e-11)
    assert (result.held_radius <= study.WIDTH).all()
    assert float(result.held_radius.max()) == study.WIDTH


def test_the_worst_exponent(result: xr.Dataset) -> None:
    """Where the derivative of ln P is zero: L/(n - 1/2) = 1/(n+1) - 1/n - kappa'/kappa, L = ln(3 dl/2 n g)."""

    def derivative(n: float, ratio: float) -> float:
        log = 1 / n + 0.5 * digamma(n / 2) - 0.5 * digamma((n + 1) / 2)
        return float(1 / (n + 1) - 1 / n - log - np.log(1.5 * ratio / (n * kappa(np.array(n)))) / (n - 0.5))

    dead = result.sel(control="force")
    for ratio in (1.0, 3.0):
        worst = float(dead.worst_exponent.sel(relative_stretch=ratio))
        assert worst == pytest.approx(brentq(derivative, 1.0, 10.0, args=(ratio,)), rel=1e-3)
        assert 2.4 < worst * kappa(np.array(worst)) / ratio < 2.65
    assert float(dead.worst_exponent.sel(relative_stretch=0.3)) == 1.0  # from the cone on blunter holds better
    assert (result.held_force.sel(relative_stretch=0.3).diff("exponent") < 0.0).all()
    assert (result.held_force > result.flat_force).all()


@pytest.mark.large
def test_every_number_has_a_unit_and_a_name_and_goes_to_a_file(result: xr.Dataset, tmp_path: Path) -> None:
    for name, array in result.variables.items():
        assert array.attrs["long_name"], name
        assert "units" in array.attrs or array.dtype.kind == "U", name
    write_netcdf(Labelled.of(result), tmp_path / "one_asperity.nc")
    with xr.open_dataset(tmp_path / "one_asperity.nc") as read:
        xr.testing.assert_equal(read.load(), result)
    for draw in study.STUDY.draw.values():
        draw(result).savefig(tmp_path / "one.png", dpi=50)
        assert (tmp_path / "one.png").stat().st_size > 5000


@pytest.mark.large
def test_the_scene_of_shapes_agrees_with_single_asperities() -> None:
    scene = tomllib.loads((PIPELINES / "scenes" / "shape_and_pull_off.toml").read_text())
    scene["batch"]["realizations"] = 2
    law = rm.run(scene)
    effective_modulus = rm.effective_modulus(2e9, 0.4)
    most = -law.force.min("step").mean("realization") / 100
    single = [
        -float(
            rm.pull_off(
                rm.PowerLaw(exponent=float(n), width=1e-6, rise=11.5e-9),
                effective_modulus=effective_modulus,
                work=0.05,
                control="force",
            ).force
        )
        for n in law.asperities_exponent
    ]
    # A sum never holds more than its parts one by one; the scatter of heights costs the stiff ones more.
    assert (most <= single).all()
    assert (most[:4] > 0.99 * np.array(single[:4])).all()
    assert (most > 0.95 * np.array(single)).all()
    assert float(law.asperities_exponent[int(np.argmin(most.to_numpy()))]) == 1.5
    assert float(law.contact_area.max()) < 100 * math.pi * 1e-12  # no contact reaches its rim
    np.testing.assert_array_equal(law.contact_count.isel(step=[0, -1]), 0.0)
