"""What a scene does not need is not done: the study of it in its quick form, by what it counts, never what it times."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from left_out import STUDY
from left_out_cases import BATCH, SCENES, SIZES, Size, Way, scene_of
from left_out_child import CURVES
from left_out_measured import COMMANDS, IMPORTS, PARTS, REDUCED, imports

import roughmdr as rm
from roughmdr.variables import DEFAULT_VARIABLES

pytestmark = pytest.mark.slow
HERTZ = [name for name, size in SCENES.items() if not size.adhesive]
JKR = [name for name, size in SCENES.items() if size.adhesive]
BLOCK = 256  # asperities that are visited as far down as the deepest fold among them


class Studied(NamedTuple):
    text: str
    folder: Path
    result: xr.Dataset

    def case(self, part: str, scene: str) -> xr.Dataset:
        return self.result.isel(case=((self.result["part"] == part) & (self.result["scene"] == scene)).to_numpy())

    def counted(self, part: str, scene: str) -> list[float]:
        return self.case(part, scene)["counted"].squeeze("case").to_numpy().tolist()


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studied]:
    folder = tmp_path_factory.mktemp("left_out")
    text = STUDY.carry_out(folder, quick=True)
    with xr.open_dataset(folder / "left_out.nc") as result:
        yield Studied(text, folder, result)


def quick(name: str) -> Size:
    return SCENES[name].reduced(REDUCED)


def test_every_part_is_measured_drawn_and_told(studied: Studied) -> None:
    assert set(studied.result["part"].to_numpy()) == set(PARTS)
    assert all(f"| {part} |" in studied.text for part in PARTS)
    assert f"{REDUCED} times smaller" in studied.text
    assert (studied.folder / "left_out.png").stat().st_size > 5000
    for name in ("seconds", "memory", "counted"):
        assert np.isfinite(studied.result[name]).all()


@pytest.mark.parametrize("name", SCENES)
def test_what_is_measured_with_nothing_forced_on_is_a_run(name: str) -> None:
    scene = scene_of(quick(name))
    force = np.array([law.variables["force"] for law in Way.of(scene).laws()])
    assert force.max() > 0.0
    np.testing.assert_array_equal(rm.run(scene)["force"], force)


@pytest.mark.parametrize("name", SCENES)
def test_only_asperities_within_reach_are_visited(studied: Studied, name: str) -> None:
    size = quick(name)
    scene = scene_of(size)
    way_in = scene.path.separations(scene.asperities.sigma)
    visits = 0
    for realization in range(size.realizations):
        ensemble = scene.asperities.ensemble(scene.seed, realization)
        reduced = np.pi**2 * (scene.work / scene.effective_modulus) ** 2 * ensemble.parameters["radius"]
        fold = 0.75 * np.cbrt(reduced)  # |delta_c| of a paraboloid
        for start in range(0, size.asperities, BLOCK):
            z, deepest = ensemble.height[start : start + BLOCK], fold[start : start + BLOCK].max()
            touched = z > way_in.min()
            visits += sum(int((z > h).sum()) for h in way_in)
            visits += sum(int((touched & (z > h - deepest)).sum()) for h in way_in) if size.unload else 0
    steps = size.steps * (2 if size.unload else 1)
    assert studied.counted("asperities out of reach", name) == [visits, size.asperities * size.realizations * steps]


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

    Contacts are counted without; pressure and contact_fraction are made from force and area, and without adhesion
    nothing is dissipated.
    """
    default, others = (studied.counted(part, name) for part in ("the other default variables", "all other variables"))
    assert default[0] == others[0]
    assert default[1] - default[0] == pytest.approx(2.0 * len(("contact_area", "stiffness")), abs=1e-12)
    assert others[1] - default[1] == pytest.approx(2.0 * len(("contact_radius_sum", "energy")), abs=1e-12)


def test_curves_are_not_kept_beside_statistics(studied: Studied) -> None:
    size = SIZES[BATCH].reduced(REDUCED)
    one = len(DEFAULT_VARIABLES) * size.steps
    assert studied.counted(CURVES, BATCH) == [one * len(("mean", "sem", "min", "max")), one * size.realizations]


def test_what_is_left_out_changes_no_number(studied: Studied) -> None:
    same = {"positions", "asperities out of reach", "the other default variables", "all other variables"}
    for case in range(studied.result.sizes["case"]):
        row = studied.result.isel(case=case)
        part, difference = str(row["part"].values), float(row["difference"])
        if part in same:
            assert difference == 0.0, part
        elif part in ("adhesion", CURVES):
            assert difference <= float(row["stated"]), part
        elif part == "range of adhesion":
            assert 0.0 < difference < 0.01, "what the scene allows"
        else:
            assert np.isnan(difference), part


@pytest.mark.parametrize("command", ["import roughmdr", "roughmdr --help"])
def test_imports_not_used_are_not_made(command: str) -> None:
    script = Path(__file__).parents[2] / "pipelines" / "left_out_command.py"

    def packages(modules: list[str]) -> set[str]:
        call = [sys.executable, script, ",".join(modules), *COMMANDS[command]]
        done = subprocess.run(call, capture_output=True, text=True, check=True)
        return {name.split(".")[0] for name in done.stdout.splitlines()[-1].split()} - sys.stdlib_module_names

    possible = {name.split(".")[0] for name in imports()} - sys.stdlib_module_names
    assert {"numba", "numpy", "scipy", "xarray", "dask", "matplotlib", "netCDF4"} < possible
    assert packages([]) & possible == ({"click"} if COMMANDS[command] else set())
    assert possible <= packages(imports())


def test_a_run_loads_less_than_the_package_can(studied: Studied) -> None:
    for command in ("roughmdr --help", "roughmdr run"):
        case = studied.case(IMPORTS, command).squeeze("case")
        for name in ("counted", "memory"):
            left_out, forced_on = case[name].to_numpy()
            assert left_out < forced_on, f"{name} of {command}"
