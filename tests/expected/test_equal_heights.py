"""Asperities of one height are their own expected law: the same as their sum, with every variable and control."""

from typing import Any

import numpy as np
import pytest

import roughmdr as rm

EVERY = ["force", "contact_area", "contact_count", "contact_radius_sum", "stiffness", "energy", "dissipated_energy"]
JKR = {"model": "jkr", "work": "0.1 mJ/m^2"}
CLEAR = {"separation": {"start": "clear", "stop": "-1 um", "steps": 30}, "unload": True}
LEVER = {"remote": {"start": "2 um", "stop": "-1 um", "steps": 30}, "machine_stiffness": "5 mN/m", "unload": True}
EXPECTED = {"batch": {"estimator": "expected"}}


def tips(**changes: Any) -> dict[str, Any]:
    """A tip on a gel, or some of them."""
    asperities = {"source": "random", "shape": "paraboloid", "count": 1, "patch": "1 mm", "height": "30 nm"}
    return {
        "title": "Tips",
        "material": {"modulus": "1 kPa", "poisson": 0.5},
        "adhesion": JKR,
        "asperities": asperities | {"radius": "10 um"},
        "path": CLEAR,
        "output": {"variables": EVERY},
    } | changes


@pytest.mark.parametrize("adhesion", [{"model": "jkr", "work": 0.0}, JKR], ids=["elastic", "jkr"])
@pytest.mark.parametrize("count", [1, 7])
def test_the_law_is_the_sum(adhesion: dict[str, Any], count: int) -> None:
    scene = tips(adhesion=adhesion)
    scene["asperities"]["count"] = count
    drawn, law = (rm.run(each).isel(realization=0) for each in (scene, scene | EXPECTED))
    for name in EVERY:
        largest = float(np.abs(drawn[name]).max())
        np.testing.assert_allclose(law[name], drawn[name], rtol=0, atol=1e-13 * largest)
    assert float(law.pull_off_force) == pytest.approx(float(drawn.pull_off_force), rel=1e-12, abs=0.0)
    assert float(law.numerical_error) < 2e-12


def test_on_a_machine() -> None:
    """The tip jumps into contact, and off again."""
    scene = tips(path=LEVER, output={"variables": ["force"]})
    drawn, law = (rm.run(each).isel(realization=0) for each in (scene, scene | EXPECTED))
    for name in ("force", "separation"):
        np.testing.assert_allclose(law[name], drawn[name], rtol=0, atol=1e-12 * float(np.abs(drawn[name]).max()))


def test_two_heights_and_a_density() -> None:
    """Each population is the law of one asperity, times its share of the mean number."""
    steps = np.linspace(5e-7, -5e-7, 20)
    scene = tips(path={"separation": [*steps, *steps[::-1]]}, output={"variables": ["force"]})
    asperities = {key: entry for key, entry in scene["asperities"].items() if key != "count"}
    scene["asperities"] = asperities | {"density": "4.5e6 m^-2", "second": {"share": 0.25, "height": "-200 nm"}}
    law = rm.run(scene | EXPECTED).force.values[0]
    gel = {"effective_modulus": rm.effective_modulus(1e3, 0.5), "work": 1e-4}
    by_hand = np.zeros(steps.size)
    for share, height in ((0.75, 30e-9), (0.25, -200e-9)):
        contact = rm.indent(rm.Paraboloid(radius=10e-6), indentation=height - steps, approach=True, **gel)
        by_hand += 4.5 * share * contact.force.values
    np.testing.assert_allclose(law[: steps.size], by_hand, rtol=0, atol=1e-12 * np.abs(by_hand).max())


def test_nodes_are_the_asperity_itself(tmp_path: Any) -> None:
    rm.run(tips(), tmp_path / "tip.nc")
    rm.export(tmp_path / "tip.nc", tmp_path / "nodes.csv", to="csv", quantity="nodes", error=1e-9)
    last = (tmp_path / "nodes.csv").read_text().splitlines()[-1]
    assert [float(each) for each in last.split(",")] == pytest.approx([30e-9, 1e6, 10e-6], rel=1e-12)
