"""Nothing is done that a scene does not need, by the counts of the study."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from studies.left_out import PARTS, SCENES, STUDY, scene_of

import roughmdr as rm
from roughmdr.aggregate import compute
from roughmdr.aggregate.problem import Problem
from roughmdr.batch.plan import make_plan
from roughmdr.variables import DEFAULT_VARIABLES

HERTZ = [name for name, options in SCENES.items() if not options.get("adhesive")]
JKR = [name for name in SCENES if name not in HERTZ]
ASPERITIES, RUNS, STEPS = 60, 300, 20  # sizes of the quick form


class Studied(NamedTuple):
    text: str
    folder: Path
    result: xr.Dataset

    def counted(self, part: str, scene: str) -> list[float]:
        case = self.result.isel(case=((self.result["part"] == part) & (self.result["scene"] == scene)).to_numpy())
        return case["counted"].squeeze("case").to_numpy().tolist()


pytestmark = pytest.mark.large  # the study takes most of it


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studied]:
    folder = tmp_path_factory.mktemp("left_out")
    text = STUDY.carry_out(folder, quick=True)
    with xr.open_dataset(folder / "left_out.nc") as result:
        yield Studied(text, folder, result)


def test_every_part_is_counted_and_reported(studied: Studied) -> None:
    assert set(studied.result["part"].to_numpy()) == set(PARTS)
    assert all(f"| {part} |" in studied.text for part in PARTS)
    assert np.isfinite(studied.result["counted"]).all()


@pytest.mark.parametrize("name", SCENES)
def test_what_is_counted_with_nothing_forced_on_is_a_run(name: str) -> None:
    scene = scene_of(ASPERITIES, **SCENES[name])
    problem = Problem(scene.asperities.ensemble(scene.seed, 0), scene.effective_modulus, scene.adhesion_model)
    found = compute(problem, make_plan(scene).cells[0].path, ["force"])
    assert found.variables["force"].max() > 0.0
    np.testing.assert_array_equal(rm.run(scene)["force"].squeeze(), found.variables["force"])


@pytest.mark.parametrize("name", SCENES)
def test_only_asperities_within_reach_are_visited(studied: Studied, name: str) -> None:
    scene = scene_of(ASPERITIES, **SCENES[name])
    loading = scene.path.values(scene.asperities.sigma)
    ensemble = scene.asperities.ensemble(scene.seed, 0)
    reduced = np.pi**2 * (scene.work / scene.effective_modulus) ** 2 * ensemble.parameters["radius"]
    deepest = (0.75 * np.cbrt(reduced)).max()  # |delta_c| of a paraboloid; all are visited down to the deepest
    touched = ensemble.height > loading.min()
    visits = sum(int((ensemble.height > h).sum()) for h in loading)
    if scene.path.unload:
        visits += sum(int((touched & (ensemble.height > h - deepest)).sum()) for h in loading)
    steps = STEPS * (2 if scene.path.unload else 1)
    assert studied.counted("asperities out of contact", name) == [visits, ASPERITIES * steps]


@pytest.mark.parametrize("name", HERTZ)
def test_without_adhesion_nothing_of_it_is_called(studied: Studied, name: str) -> None:
    left_out, forced_on = studied.counted("adhesion", name)
    assert left_out == 0.0
    assert forced_on > 1.0, "calls a visit"


@pytest.mark.parametrize("name", JKR)
def test_where_jkr_is_right_the_range_of_adhesion_is_not_computed(studied: Studied, name: str) -> None:
    left_out, forced_on = studied.counted("range of adhesion", name)
    assert forced_on > 10.0 * left_out


@pytest.mark.parametrize("name", SCENES)
def test_positions_are_not_drawn(studied: Studied, name: str) -> None:
    assert studied.counted("positions", name) == [2.0, 4.0], "height and radius, then x and y as well"


@pytest.mark.parametrize("name", HERTZ)
def test_a_variable_not_asked_for_is_not_computed(studied: Studied, name: str) -> None:
    """A variable takes two calls a visit: that of its kernel, and that of what this needs to know of the asperity.

    Contacts are counted without, and the area is always known, for the model error; pressure and contact_fraction are
    made from force and area, and without adhesion nothing is dissipated.
    """
    default, others = (studied.counted(part, name) for part in ("the other default variables", "all other variables"))
    assert default[0] == others[0]
    assert default[1] - default[0] == pytest.approx(2.0 * len(("stiffness",)), abs=1e-12)
    assert others[1] - default[1] == pytest.approx(2.0 * len(("contact_radius_sum", "energy")), abs=1e-12)


def test_curves_are_not_kept_beside_statistics(studied: Studied) -> None:
    one = len(DEFAULT_VARIABLES) * STEPS
    counted = studied.counted("curves of the realisations", f"{RUNS} realisations")
    assert counted == [one * len(("mean", "sem", "min", "max")), one * RUNS]


def test_what_is_left_out_changes_no_number(studied: Studied) -> None:
    for case in range(studied.result.sizes["case"]):
        row = studied.result.isel(case=case)
        part, difference = str(row["part"].values), float(row["difference"])
        if part in ("adhesion", "curves of the realisations"):
            assert difference <= float(row["stated"]), part
        elif part == "range of adhesion":
            assert 0.0 < difference < 0.01, "what the scene allows"
        else:
            assert difference == 0.0, part
