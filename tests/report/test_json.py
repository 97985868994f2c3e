"""--json: one document on standard output whatever happens, with the exit status that there is without it."""

import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner
from command import ROUGHMDR
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.moments import mean_and_error
from roughmdr.cli import main
from roughmdr.report import documents
from roughmdr.report.result_document import result_table
from roughmdr.report.summary import info
from roughmdr.result import view
from roughmdr.runner import run as runner

FEW = scene(asperities={**ASPERITIES, "count": 50}, batch={"realizations": 3})
SWEPT = {
    **FEW,
    "sweep": {"adhesion.work": ["10 mJ/m^2", "50 mJ/m^2"], "asperities.radius": ["50 um", "1e300 m"]},
}


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path) -> Iterator[None]:
    with chdir(tmp_path):
        write("few.toml", FEW)
        yield


def write(name: str, table: dict[str, Any]) -> None:
    Path(name).write_text(tomli_w.dumps(table))


def told(*arguments: object) -> dict[str, Any]:
    """The document, which is all that is printed; the exit status is the one in it, and the one without --json."""
    words = list(map(str, arguments))
    done = CliRunner().invoke(main, [*words, "--json"])
    assert isinstance(done.exception, SystemExit | None), done.exception
    assert done.stderr == ""
    document = json.loads(done.stdout, parse_constant=pytest.fail)
    assert list(document) == list(documents.Document.__annotations__)
    assert document["exit_status"] == done.exit_code
    assert document["command"] == words[0]
    assert document["format"] == documents.FORMAT
    assert bool(document["faults"]) == (done.exit_code != 0)
    found: dict[str, Any] = document
    return found


def assert_keys(table: dict[str, Any], declared: Any) -> None:
    assert list(table) == list(get_type_hints(declared)), declared


def test_a_run_and_what_info_finds_in_it() -> None:
    result = told("run", "few.toml", "-o", "out.nc", "--set", "path.separation.start=6 sigma")["result"]
    assert_keys(result, documents.ResultTable)
    assert (result["title"], result["file"], result["realizations"], result["steps"]) == (
        "A small scene",
        "out.nc",
        3,
        80,
    )
    (cell,) = result["cells"]
    assert_keys(cell, documents.CellTable)
    assert_keys(cell["pull_off"], documents.PullOffTable)
    data = rm.run("out.nc")
    force = data.pull_off_force.to_numpy()
    assert cell["pull_off"]["force"] == pytest.approx(force.mean(), rel=1e-14)
    assert cell["pull_off"]["standard_error"] == pytest.approx(force.std(ddof=1) / math.sqrt(3.0), rel=1e-12)
    assert cell["pull_off"]["of_mean"] == float(data.pull_off_force_of_mean)
    assert cell["model_error"] == float(data.model_error.max())
    assert cell["parts"]["slope_error"] == float(data.slope_error.max())
    assert cell["status"] == {"done": 3, "failed": 0, "not_run": 0}
    assert result["seed"] == 7
    assert result["elapsed"] > 0.0
    again = told("info", "out.nc")["result"]
    assert again == {**result, "elapsed": None}
    text = " ".join(info("out.nc").split())
    for words in (*filter(None, result["trust"].values()), *result["left_out"]):
        assert all(part in text for part in words.split("; "))


def test_a_sweep_with_failed_runs() -> None:
    write("swept.toml", SWEPT)
    document = told("run", "swept.toml", "-o", "out.nc")
    assert document["exit_status"] == 1
    assert "6 of 12 runs failed" in document["faults"][0]["message"]
    result = document["result"]
    assert result["sizes"] == {"adhesion_work": 2, "asperities_radius": 2}
    assert result["coordinates"]["adhesion_work"] == {"units": "J m-2", "values": [0.01, 0.05]}
    assert [cell["swept"]["adhesion_work"] for cell in result["cells"]] == [0.01, 0.01, 0.05, 0.05]
    right, wrong = result["cells"][2:]
    assert (right["status"]["done"], wrong["status"]["failed"]) == (3, 3)
    assert wrong["pull_off"] is None
    assert wrong["model_error"] is None
    assert "realisation 0: " in wrong["remark"]


def test_statistics_an_error_asked_for_and_a_path_of_one_way() -> None:
    write("s.toml", {**FEW, "output": {"keep": "statistics"}, "sweep": {"mode": "zip", "adhesion.work": [0.01, 0.05]}})
    kept = told("run", "s.toml", "-o", "s.nc")["result"]
    assert kept["sizes"] == {"cell": 2}
    assert [cell["realizations"] for cell in kept["cells"]] == [3, 3]
    write("a.toml", {**FEW, "batch": {}, "accuracy": {"relative": 0.5, "max_realizations": 8}})
    (cell,) = told("run", "a.toml", "-o", "a.nc")["result"]["cells"]
    assert cell["accuracy"]["method"] in ("sampled", "stratified", "expected")
    assert cell["accuracy"]["reached"] <= 0.5
    write("one.toml", {**FEW, "path": {"separation": ["2 um", "1 um"]}})
    (cell,) = told("run", "one.toml", "-o", "one.nc")["result"]["cells"]
    assert cell["pull_off"] is None


@pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")
def test_a_plan() -> None:
    write("swept.toml", SWEPT)
    plan = told("plan", "swept.toml", "--workers", "1")["plan"]
    assert_keys(plan, documents.PlanTable)
    assert (plan["runs"], plan["workers"], plan["realizations"], plan["steps"]) == (12, 1, 3, 80)
    assert plan["time"]["total"] > plan["time"]["start_up"] > 0.0
    assert any("asperities.radius = 1e300 m" in failure for failure in plan["failures"])
    for cell in plan["cells"]:
        assert_keys(cell, documents.ForeseenTable)
    assert [cell["swept"] for cell in plan["cells"]] == [
        {"adhesion_work": work, "asperities_radius": 5e-5} for work in (0.01, 0.05)
    ]


@pytest.mark.parametrize(
    ("arguments", "key", "says"),
    [
        (["plan", "none.toml"], "", "no such file"),
        (["plan", "few.toml", "--nope"], "", "No such option"),
        (["run", "few.toml"], "", "Missing option"),
        (["run", "few.toml", "-o", "x.nc", "--quiet", "--verbose"], "", "exclude each other"),
        (["run", "few.toml", "-o", "x.nc", "--workers", "0"], "", "0 is not in the range"),
        (["run", "few.toml", "-o", "none/x.nc"], "", "does not exist"),
        (["run", "few.toml", "-o", "x.nc", "--set", "asperities.hieght=1"], "asperities.hieght", "'height'"),
        (["info", "few.toml"], "", "not a netCDF file"),
    ],
)
def test_wrong_input(arguments: list[str], key: str, says: str) -> None:
    document = told(*arguments)
    assert document["exit_status"] == 2
    assert document["result"] is document["plan"] is None
    assert document["faults"][0]["key"] == key
    assert says in document["faults"][0]["message"]
    assert not Path("x.nc").exists()


def test_all_faults_of_a_scene() -> None:
    write("wrong.toml", {**FEW, "seed": -1, "title": 3, "asperities": {**ASPERITIES, "shape": "sphree"}})
    faults = told("plan", "wrong.toml")["faults"]
    assert [fault["key"] for fault in faults] == ["title", "seed", "asperities.shape"]
    assert faults[2]["value"] == "'sphree'"
    assert faults[0]["location"].startswith("wrong.toml:")


def test_warnings_are_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    rm.run("few.toml", "out.nc")
    import netCDF4

    with netCDF4.Dataset("out.nc", "a") as file:
        file.checksum = "0"
    assert told("info", "out.nc")["warnings"] == ["out.nc: its numbers are not those that were written"]


def test_the_end_of_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    def none_left(*_: object) -> None:
        raise MemoryError("of the test")

    monkeypatch.setattr(runner, "plan_scene", none_left)
    monkeypatch.setattr("roughmdr.batch.choose.plan_scene", none_left)
    document = told("plan", "few.toml")
    assert document["exit_status"] == 1
    assert document["faults"][0]["message"] == "out of memory: of the test"


_INTERRUPTED = """
import os, signal
import roughmdr.runner.local as local
from roughmdr.cli import main
def interrupted(*arguments):
    os.kill(os.getpid(), signal.SIGINT)
    raise AssertionError
local.compute = interrupted
main()
"""


@pytest.mark.large
def test_an_interrupted_run() -> None:
    command = [sys.executable, "-c", _INTERRUPTED, "run", "few.toml", "-o", "out.nc", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 130, done.stderr
    document = json.loads(done.stdout)
    assert document["exit_status"] == 130
    assert document["faults"][0]["message"] == "interrupted; nothing was written"


@pytest.mark.large
def test_what_cannot_be_printed_is_told_in_one_line() -> None:
    for arguments in (["plan", "few.toml"], ["info", "none.nc"]):
        with open("/dev/full", "w") as full:
            command = [*ROUGHMDR, *arguments, "--json"]
            done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        assert done.returncode == 2
        assert "the standard output cannot be written: No space left" in done.stderr
        assert len(done.stderr.splitlines()) == 1


@pytest.mark.large
def test_nothing_in_it_reaches_a_terminal_and_any_encoding_holds_it() -> None:
    write("odd.toml", {**FEW, "title": "Reibung von Öl ± 3 µm"})
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    command = [*ROUGHMDR, "run", "odd.toml", "-o", "out.nc", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.isascii()
    assert json.loads(done.stdout)["result"]["title"] == "Reibung von Öl ± 3 µm"


def test_what_is_not_finite_is_null() -> None:
    table: Any = {"a": math.nan, "b": [math.inf, np.float64("-inf"), np.int64(3)], "c": (np.array([1.0, math.nan]),)}
    assert json.loads(documents.to_json(table)) == {"a": None, "b": [None, None, 3], "c": [[1.0, None]]}


def test_means_of_all_cells_are_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = list[int]()

    def counting(values: Any, known: Any) -> Any:
        calls.append(values.size)
        return mean_and_error(values, known)

    monkeypatch.setattr(view, "mean_and_error", counting)
    counts = []
    for works in (["10 mJ/m^2"], ["10 mJ/m^2", "20 mJ/m^2", "50 mJ/m^2"]):
        swept = rm.run({**FEW, "sweep": {"adhesion.work": works}})
        found = result_table(view.ResultView(swept), None)
        assert all(cell["pull_off"] for cell in found["cells"])
        counts.append(len(calls))
        calls.clear()
    assert counts[0] == counts[1] > 0
