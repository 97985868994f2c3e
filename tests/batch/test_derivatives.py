"""Derivatives of expected laws: those of closed forms, within their own errors, in any units, and in files."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.integrate
import xarray as xr
from batches import write_scene
from command import said
from forms import large
from numpy.typing import NDArray

import roughmdr as rm

Floats = NDArray[np.float64]
RADIUS, SIGMA = 50.0, 1.0  # radius and standard deviation of heights of the rough scene, over its scale


def tip(scale: float, modulus: float, steps: Floats, **changes: Any) -> dict[str, Any]:
    """A paraboloid of radius ``scale`` [m] on a body of this E* [Pa]."""
    return {
        "title": "Tip",
        "material": {"effective_modulus": modulus},
        "asperities": {"source": "random", "shape": "paraboloid", "count": 1, "patch": 100.0 * scale,
                       "radius": scale, "height": 0.0},
        "path": {"separation": steps.tolist()},
        "batch": {"estimator": "expected"},
    } | changes  # fmt: skip


def by(result: Any, key: str, name: str = "force", ending: str = "derivative") -> Floats:
    return np.asarray(result[f"{name}_{ending}"].sel(parameter=key).to_numpy())


def holds(result: Any, key: str, exact: Floats, name: str = "force", off: float = 1e-8) -> None:
    """The derivative is right to ``off`` of its largest, and to its own error but for roundings."""
    found, error = by(result, key, name), by(result, key, name, "derivative_error")
    size = float(np.abs(exact).max())
    assert found == pytest.approx(exact, abs=off * size)
    assert (np.abs(found - exact) <= error + 1e-11 * size).all()
    assert error.max() <= 10.0 * off * size


@pytest.mark.parametrize(("scale", "modulus"), [(1e-9, 1e11), (1e-6, 1e3), (1e-2, 1e6)])
def test_of_a_paraboloid_it_is_that_of_hertz(scale: float, modulus: float) -> None:
    steps = np.linspace(-0.01, -0.1, 5) * scale
    keys = ["material.effective_modulus", "asperities.radius", "asperities.height"]
    result = rm.run(tip(scale, modulus, steps), derivatives=keys)
    force, area = result.force.to_numpy()[0], result.contact_area.to_numpy()[0]
    holds(result, keys[0], force / modulus)
    holds(result, keys[1], 0.5 * force / scale)
    holds(result, keys[2], 1.5 * force / -steps)
    holds(result, keys[1], area / scale, "contact_area")
    assert not by(result, keys[0], "contact_area").any()
    assert not by(result, keys[2], "contact_count").any()
    assert result.parameter_unit.to_numpy().tolist() == ["Pa", "m", "m"]


def test_with_adhesion_it_is_that_of_the_energy() -> None:
    """dP/dw = -2 pi a da/d(delta) = (k - 2 E* a) (pi a/(2 E* w))^(1/2) of JKR, on loading and unloading."""
    scale, modulus, work = 1e-6, 1e6, 1e-3
    steps = np.concatenate([np.linspace(-0.01, -0.1, 4), np.linspace(-0.09, 0.01, 5)]) * scale
    scene = tip(scale, modulus, steps, adhesion={"model": "jkr", "work": work})
    result = rm.run(scene, derivatives=["adhesion.work", "material.effective_modulus"])
    force, area, stiffness = (result[name].to_numpy()[0] for name in ("force", "contact_area", "stiffness"))
    radius = np.sqrt(area / math.pi)
    exact = (stiffness - 2.0 * modulus * radius) * np.sqrt(math.pi * radius / (2.0 * modulus * work))
    holds(result, "adhesion.work", exact)
    holds(result, "material.effective_modulus", (force - work * exact) / modulus)


def test_pull_off_is_as_the_work() -> None:
    """-1.5 pi w R of a dead load; under fixed grips -(5/6) pi w R."""
    scale, work = 1e-6, 1e-3
    scene = tip(scale, 1e6, np.array([-0.01, 0.1]) * scale, adhesion={"model": "jkr", "work": work})
    result = rm.run(scene, derivatives=["adhesion.work", "asperities.radius"])
    pull_off = float(result.pull_off_force.squeeze())
    for key, number in (("adhesion.work", work), ("asperities.radius", scale)):
        error = float(by(result, key, "pull_off_force", "derivative_error"))
        assert float(by(result, key, "pull_off_force")) == pytest.approx(pull_off / number, abs=error)
        assert error < 1e-5 * abs(pull_off / number)  # it is located to some 1e-9


def rough(scale: float, modulus: float, steps: Floats) -> dict[str, Any]:
    asperities = {"count": 300, "patch": 1e4 * scale, "radius": RADIUS * scale}
    scene = tip(scale, modulus, steps * scale)
    scene["asperities"] |= asperities | {"height": {"distribution": "normal", "mean": 0.0, "std": SIGMA * scale}}
    return scene


@pytest.mark.parametrize(("scale", "modulus"), [(1e-6, 2e9), large(1e-9, 1e11), large(1e-2, 1e4)])
def test_of_a_rough_surface_it_is_an_integral(scale: float, modulus: float) -> None:
    """Greenwood and Williamson's, with 2 E* R^(1/2) (z - h)^(1/2) dz/dp under the integral."""
    steps = np.array([2.5, 1.0, -0.5])
    keys = ["material.effective_modulus", "asperities.height.std", "asperities.height.mean", "asperities.radius"]
    result = rm.run(rough(scale, modulus, steps), derivatives=keys)

    def mean(power: float, weight: float, h: float) -> float:
        return scipy.integrate.quad(
            lambda u: 2.0 * u * u ** (2.0 * power) * (u * u + h) ** weight * math.exp(-0.5 * (u * u + h) ** 2),
            0.0, 4.0, epsabs=0.0, epsrel=1e-12,
        )[0] / math.sqrt(2.0 * math.pi)  # fmt: skip

    size = 300 * modulus * math.sqrt(RADIUS) * scale**2
    force = 4.0 / 3.0 * size * np.array([mean(1.5, 0.0, h) for h in steps])
    assert result.force.to_numpy()[0] == pytest.approx(force, rel=1e-9)
    holds(result, keys[0], force / modulus)
    holds(result, keys[1], 2.0 * size / scale * np.array([mean(0.5, 1.0, h) for h in steps]))
    holds(result, keys[2], 2.0 * size / scale * np.array([mean(0.5, 0.0, h) for h in steps]))
    holds(result, keys[3], 0.5 * force / (RADIUS * scale))


@pytest.mark.large
def test_a_spring_yields() -> None:
    """dF/dp = k/(k + S) of that at the separation; dF/dk = F S/(k (k + S))."""
    scale, modulus, steps = 1e-6, 2e9, np.array([2.0, 0.5, -1.0])
    keys, spring = ["material.effective_modulus", "path.machine_stiffness"], 2e5
    path = {"remote": (scale * steps).tolist(), "machine_stiffness": spring}
    scene = rough(scale, modulus, steps) | {"path": path}
    scene["output"] = {"variables": ["force", "stiffness", "separation"][:2]}
    result = rm.run(scene, derivatives=keys)
    force, stiffness = result.force.to_numpy()[0], result.stiffness.to_numpy()[0]
    holds(result, keys[0], force / modulus * spring / (spring + stiffness))
    holds(result, keys[1], force * stiffness / (spring * (spring + stiffness)))


@pytest.mark.parametrize("scale", [1e-9, 1.0])
def test_a_time_that_is_longer_is_as_a_flat_that_is_faster(scale: float) -> None:
    """Force depends on their product alone."""
    time, speed = "viscoelastic.relaxation[1].time", "viscoelastic.speed"
    terms = [{"share": 0.0, "time": 1.0}, {"share": 0.6, "time": 0.7}]
    law = {"viscoelastic": {"relaxation": terms, "speed": scale}}
    steps = np.concatenate([np.linspace(0.5, -1.0, 12), np.linspace(-0.9, 0.5, 12)]) * scale
    result = rm.run(tip(scale, 3e6, steps, **law), derivatives=[time, speed])
    holds(result, time, by(result, speed) * scale / 0.7, off=1e-7)
    assert np.abs(by(result, time)).max() > 0.0


def test_each_cell_of_a_sweep_has_its_own() -> None:
    scene = tip(1e-6, 1e6, np.array([-1e-7])) | {"sweep": {"material.effective_modulus": [1e5, 1e6]}}
    result = rm.run(scene, derivatives="asperities.radius")
    assert result.force_derivative.dims == ("material_effective_modulus", "parameter", "step")
    force = result.force.to_numpy().ravel()
    assert result.force_derivative.to_numpy().ravel() == pytest.approx(0.5 * force / 1e-6, rel=1e-8)


def test_a_cell_that_fails_has_none_and_keeps_the_others() -> None:
    """Heights of a distribution whose mean force has no bound."""
    scene = rough(1e-6, 2e9, np.array([1.0]))
    scene["asperities"]["height"] = {"distribution": "t", "df": 1.2, "scale": 1e-6}
    with pytest.warns(rm.FailedRuns), pytest.warns(rm.LimitWarning, match="no derivatives of 1 of 2 cells"):
        result = rm.run(scene | {"sweep": {"asperities.height.df": [1.2, 60.0]}}, derivatives="asperities.radius")
    failed, done = result.force_derivative.to_numpy().ravel()
    assert np.isnan(failed)
    assert done == pytest.approx(0.5 * float(result.force.to_numpy().ravel()[1]) / (RADIUS * 1e-6), rel=1e-8)


def test_beside_a_contact_that_is_lost_the_error_tells() -> None:
    steps = np.array([0.0, -0.05, 2.0]) * 1e-6
    result = rm.run(tip(1e-6, 1e6, steps, adhesion={"model": "jkr", "work": 1e-3}), derivatives="asperities.height")
    at_touch, within, apart = by(result, "asperities.height", ending="derivative_error")
    size = np.abs(by(result, "asperities.height")).max()
    assert at_touch > 0.1 * size  # where any lower tip has no contact yet
    assert within < 1e-6 * size
    assert apart == 0.0


def test_it_is_stored_read_and_asked_for_on_the_command_line(tmp_path: Path) -> None:
    out = tmp_path / "out.nc"
    write_scene(tmp_path, tip(1e-6, 1e6, np.array([-1e-7])))
    asked = "asperities.radius, material.effective_modulus"
    said("run", "scene.toml", "-o", "out.nc", "--derivatives", asked, cwd=tmp_path)
    stored = xr.open_dataset(out)
    assert stored.parameter.to_numpy().tolist() == ["asperities.radius", "material.effective_modulus"]
    assert "by asperities.radius, material.effective_modulus" in rm.info(out)
    assert float(by(stored, "asperities.radius")[0]) == pytest.approx(0.5 * float(stored.force.squeeze()) / 1e-6)


@pytest.mark.parametrize(
    ("key", "changes", "told"),
    [
        ("adhesion.work", {}, "adhesion.work.*is not in the scene"),
        ("asperities.count", {}, "whole numbers only"),
        ("material.modulos", {}, "is no number of the scene"),
        ("asperities.height", {"asperities.height": {"distribution": "normal", "std": 1e-7}}, "asperities.height.mean"),
        ("asperities.radius", {"batch.estimator": "sampled"}, "an expected law"),
        ("material.poisson", {"material": {"modulus": 1e6, "poisson": 0.5}}, "poisson.*at most 0.5"),
        ("path.separation", {}, "is no number of the scene"),
        ("adhesion.work", {"adhesion": {"model": "jkr", "work": 0.0}}, "is 0, the end of what is allowed"),
    ],
)
def test_what_cannot_be_differentiated_is_refused(key: str, changes: dict[str, Any], told: str) -> None:
    with pytest.raises(rm.SceneError, match=told):
        rm.run(tip(1e-6, 1e6, np.array([-1e-7])), set=changes, derivatives=[key])
