"""Plans say first what size, unit or pressure cannot be meant, and do not contradict themselves about summits."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from batches import write_scene
from command import roughmdr
from hypothesis import given, settings, strategies as st

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.resolution import radius_uncertainty, verdict
from roughmdr.ensemble.maps.words import implausible
from roughmdr.report.advice import advice_on

SURFACE = {"source": "surface", "file": "map.npy"}


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)
    x = np.arange(64.0)
    np.save("map.npy", 20.0 * np.cos(2.0 * np.pi * x / 16.3)[:, None] * np.cos(2.0 * np.pi * x / 15.1 + 1.0))

    def plan(*more: str, **asperities: object) -> str:
        scene = {
            "material": {"modulus": "5 MPa", "poisson": 0.49},
            "asperities": {**SURFACE, **asperities},
            "path": {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 3}},
        }
        write_scene(tmp_path, scene)
        return roughmdr("plan", "scene.toml", *more).stdout

    return plan


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"size": "160 m", "unit": "nm"}, "unit is implausible: an r.m.s. slope of 2.3e-09, 160 m x 160 m; give"),
        ({"size": "6.4 um"}, "its size or unit is implausible: an r.m.s. slope of .*, an r.m.s. height of 9.745 m"),
        ({"size": "6.4 nm", "unit": "pm"}, "unit is implausible: 6.4 nm x 6.4 nm, an r.m.s. height of 9.745 pm; give"),
    ],
)  # fmt: skip
def test_an_implausible_map_is_told_of_first(plan: Any, keys: dict[str, object], says: str) -> None:
    first = plan(**keys).splitlines()[0]
    assert first.startswith("implausible  ")
    assert re.search(says, first)
    table = json.loads(plan("--json", **keys))
    assert re.search(says, table["plan"]["implausible"][0])


def test_pressures_that_no_contact_bears_are_told_of(plan: Any) -> None:
    told = plan(size="6.4 um", unit="um")
    assert "a size or unit is implausible: contacts would bear" in told
    assert "on average at closest approach, more than E*, 6.58 MPa" in told


def test_no_contact_bears_more_than_diamond_whatever_its_modulus(plan: Any) -> None:
    """At closest approach, wherever on the path that is."""
    size = {"across": "6.4 um", "down": "6.4 um"}
    for more in ([], ["--set", "path.unload=true", "--set", "path.separation.start=9 sigma"]):
        told = plan("--set", "material.modulus=1e13", *more, size=size, unit="nm")
        assert "on average at closest approach, more than the hardness of diamond, 100 GPa" in told


def test_a_plausible_map_is_not_doubted(plan: Any) -> None:
    told = plan(size={"across": "6.4 um", "down": "6.4 um"}, unit="nm")
    assert told.startswith("scene ")
    assert "implausible" not in told
    assert "map          6.4 um x 6.4 um, rows of the file along y, 0.00% undefined" in told


def test_outliers_that_were_left_out_are_counted(plan: Any) -> None:
    height = np.load("map.npy")
    height[20:23, 30] = -9999.0
    np.save("map.npy", height)
    assert "0.07% undefined, 3 outliers among them" in plan(size="6.4 um", unit="nm", outliers="undefined")


@pytest.mark.parametrize("slope", [1e-5, 1e-3, 0.1, 2.0])
@pytest.mark.parametrize("side", [3e-7, 1e-4, 0.1])
def test_what_instruments_see_is_plausible(slope: float, side: float) -> None:
    assert implausible({"rms_slope": slope, "rms_height": 1e-3 * side, "patch_x": side, "patch_y": 0.5 * side}) == ""


@settings(deadline=None)
@given(points=st.floats(10.0, 1000.0), misfit=st.floats(0.01, 1.0))
def test_advice_and_verdict_agree_on_whether_summits_are_resolved(points: float, misfit: float) -> None:
    attrs: dict[str, float | int | str] = {"points_per_summit": points, "misfit": misfit, "of_surface": 1}
    attrs["radius_uncertainty"] = radius_uncertainty(attrs)
    error = Ensemble("paraboloid", np.zeros(1), {"radius": np.ones(1)}, attrs=attrs).resolution_error
    advice = advice_on(tomli_w.dumps({"asperities": SURFACE}), error)
    assert ("resolves its summits" in verdict(attrs)) == ("too coarse or noisy" not in advice)
