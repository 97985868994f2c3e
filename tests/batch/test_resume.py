"""Runs that were begun, finished or asked for otherwise before: nothing is computed twice, to the same bits."""

import os
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import batches
import numpy as np
import pytest
import xarray as xr
from batches import interrupted, let_fail
from hypothesis import HealthCheck, given, settings, strategies as st
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch import tasks
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume import find, keys, writer
from roughmdr.batch.resume.store import store_folder
from roughmdr.result import assemble as result
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.variables import CURVE_VARIABLES, DEFAULT_VARIABLES

FEW: dict[str, Any] = {**ASPERITIES, "count": 60}
PATH: dict[str, Any] = {"separation": {"start": "2 sigma", "stop": "-0.5 sigma", "steps": 8}, "unload": True}
WORKS = ["10 mJ/m^2", "30 mJ/m^2", "50 mJ/m^2"]


def small(realizations: int = 6, **changes: Any) -> dict[str, Any]:
    """A scene of a few milliseconds."""
    return scene(**{"asperities": FEW, "path": PATH, "batch": {"realizations": realizations}, **changes})


def swept(values: list[Any], **changes: Any) -> dict[str, Any]:
    return small(sweep={"adhesion.work": values}, **changes)


def kept(keep: str = "curves", variables: list[str] | None = None) -> dict[str, Any]:
    return {"keep": keep, "variables": variables or ["force", "contact_area"]}


class Calls:
    """The realisations that were computed, by cell's work of adhesion; where some are to fail, or the run to end."""

    def __init__(self) -> None:
        self.done: list[tuple[float, int]] = []
        self.fails: Callable[[float, int], bool] = lambda work, number: False

    def taken(self) -> list[tuple[float, int]]:
        """Return the runs since the last call, in order."""
        done, self.done = sorted(self.done), []
        return done


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    counted, run = Calls(), tasks._run

    def counting(runs: tasks.RunRange, realization: int, names: Any) -> Any:
        counted.done.append((runs.cell.scene.work, realization))
        return run(runs, realization, names)

    monkeypatch.setattr(tasks, "_run", counting)
    let_fail(monkeypatch, lambda cell, realization: counted.fails(cell.work, realization))
    return counted


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out.nc"


def go(
    table: dict[str, Any], out: Path | None, runs_per_task: int = 2, workers: int = 2, resume: bool = True
) -> xr.Dataset:
    """A run in many tasks, small as it is."""
    return execute(
        make_plan(read(table)), out, Backend(workers=workers, runs_per_task=runs_per_task), resume=resume
    ).to_xarray()


def assert_same(found: xr.Dataset, fresh: xr.Dataset) -> None:
    """To the last bit, in all but the clock and the words of the scene."""
    batches.assert_same(found, fresh, but=("history", "scene", "title", "checksum"))


def every(works: list[float], first: int, last: int) -> list[tuple[float, int]]:
    return [(work, number) for work in works for number in range(first, last)]


SCENES: dict[str, dict[str, Any]] = {
    "curves": small(),
    "statistics": swept(WORKS, output=kept("statistics")),
    "accurate": small(accuracy={"relative": 0.05, "method": "sampled"}),
    "accurate statistics": swept(WORKS, accuracy={"relative": 0.05, "method": "sampled"}, output=kept("statistics")),
    "auto": small(accuracy={"relative": 1e-4}),
    "drawn at last": small(accuracy={"relative": 1e-16, "max_realizations": 20}, output=kept("statistics")),
    "force beside": small(accuracy={"relative": 0.05, "method": "sampled"}, output=kept(variables=["contact_area"])),
}


@pytest.mark.few(3)
@pytest.mark.parametrize("name", SCENES)
def test_the_same_again_computes_nothing(name: str, calls: Calls, out: Path) -> None:
    first = go(SCENES[name], out)
    assert calls.taken()
    content = out.read_bytes()
    again = go(SCENES[name], out)
    assert not calls.taken()
    assert out.read_bytes() == content
    assert not store_folder(out).exists()
    assert_same(again, first)
    np.testing.assert_array_equal(again.run_time, first.run_time)


VARIABLES = ["force", "contact_area", "energy"]
LONGER = swept(["50 mJ/m^2", 0.02, "0.01 J/m^2", 0.04, 0.03])
ONE = swept(["50 mJ/m^2"])
EXTENDED: dict[str, tuple[dict[str, Any], dict[str, Any], list[tuple[float, int]]]] = {
    "more realisations": (small(6), small(11), every([0.05], 6, 11)),
    "more cells": (swept(WORKS), LONGER, every([0.02, 0.04], 0, 6)),
    "more variables": (small(output=kept()), small(output=kept(variables=["energy", *kept()["variables"]])),
                       every([0.05], 0, 6)),
    "statistics of more realisations": (small(output=kept("statistics")), small(9, output=kept("statistics")),
                                        every([0.05], 0, 9)),
    "a sweep of one value": (small(), ONE, []),
    "zipped": (ONE, small(sweep={"mode": "zip", "adhesion.work": ["50 mJ/m^2"]}), []),
    "axes in another order": (small(sweep={"adhesion.work": ["50 mJ/m^2"], "asperities.count": [50, 60]}),
                              small(sweep={"asperities.count": [50, 60], "adhesion.work": ["50 mJ/m^2"]}), []),
    "another title": (small(), small(title="Another"), []),
    "variables in another order": (small(), small(output=kept(variables=[*reversed(DEFAULT_VARIABLES)])), []),
}  # fmt: skip
"""Scenes that were run, scenes asked for after that, and the runs that are computed then."""


@pytest.mark.few(4)
@pytest.mark.parametrize("name", EXTENDED)
def test_only_what_is_missing_is_computed(name: str, calls: Calls, out: Path) -> None:
    before, after, missing = EXTENDED[name]
    first = go(before, out)
    calls.taken()
    found = go(after, out)
    assert calls.taken() == missing
    assert_same(found, go(after, None))
    assert found.attrs["title"] == after["title"]
    if name == "more realisations":
        np.testing.assert_array_equal(found.run_time[:6], first.run_time)


LESS: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "realisations": (small(11), small(3), "11 realisations"),
    "cells": (LONGER, small(), "4 cells more"),
    "curves": (swept(WORKS[:2]), swept(WORKS[:2], realizations=8, output={"keep": "statistics"}),
               "the curves of its realisations"),
} | {
    f"{', '.join(asked)}, {realizations}, {keep}": (
        small(output=kept(keep, VARIABLES)), small(realizations, output=kept(keep, asked)), gone
    )
    for asked, gone in ((["energy", "force"], "contact_area"), (["pressure"], ", ".join(VARIABLES)))
    for realizations in (6, 9) for keep in ("curves", "statistics")
}  # fmt: skip
"""Scenes that were run, scenes asked for after that, and what their results would lack."""


@pytest.mark.few(2)
@pytest.mark.parametrize("name", LESS)
def test_nothing_is_dropped_unasked(name: str, calls: Calls, out: Path) -> None:
    before, fewer, gone = LESS[name]
    go(before, out)
    refused(fewer, out, f"holds {gone}, which this scene does not ask for", calls)
    assert_same(go(fewer, out, resume=False), go(fewer, None))


def refused(table: dict[str, Any], out: Path, message: str, calls: Calls) -> None:
    """Nothing is computed, nothing replaced."""
    content = out.read_bytes()
    calls.taken()
    with pytest.raises(rm.StoreError, match=rf"{message}(.|\n)*--fresh.*resume=False"):
        go(table, out)
    assert not calls.taken()
    assert out.read_bytes() == content
    assert not store_folder(out).exists()


@pytest.mark.large
def test_curves_say_all_that_statistics_say(calls: Calls, out: Path) -> None:
    go(swept(WORKS[:2], output={"keep": "statistics"}), out)
    curves = swept(WORKS[:2])
    assert_same(go(curves, out), go(curves, None))


def held_by(result: xr.Dataset) -> set[tuple[str, str, str, int]]:
    """All that a result holds: cell, variable, what of it, realisation."""
    found: set[tuple[str, str, str, int]] = set()
    names = [name for name in CURVE_VARIABLES if name in result or f"{name}_mean" in result]
    keys, status = np.atleast_1d(result.cell_key), result.status.to_numpy().reshape(result.cell_key.size, -1)
    counts = np.atleast_1d(result.realization_count) if "realization_count" in result else None
    for cell, key in enumerate(keys):
        for name in names:
            if name in result:
                runs = [number for number, one in enumerate(status[cell]) if one == 0]
                found |= {(key, name, "curve", number) for number in runs}
            else:
                assert counts is not None
                runs = list(range(int(counts[cell])))
            found |= {(key, name, "mean", number) for number in runs}
    return found


@pytest.mark.large
@settings(
    max_examples=int(os.environ.get("ROUGHMDR_RESULTS", "5")),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_no_result_holds_less_than_the_one_before(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Whatever is asked for one after the other, a result is replaced only by one that holds all that it held."""
    out = tmp_path_factory.mktemp("any") / "out.nc"
    names = st.lists(st.sampled_from(["force", "contact_area", "energy"]), min_size=1, max_size=3, unique=True)

    def asked() -> dict[str, Any]:
        table = {
            "sweep": {"adhesion.work": data.draw(st.lists(st.sampled_from([0.01, 0.03]), min_size=1, unique=True))},
            "output": kept(data.draw(st.sampled_from(["curves", "statistics"])), data.draw(names)),
        }
        if data.draw(st.booleans()):
            return small(data.draw(st.integers(1, 30)), **table)
        accuracy = {"relative": data.draw(st.sampled_from([0.5, 0.1, 0.05])), "method": "sampled"}
        return small(1, accuracy=accuracy, **table)

    before = go(asked(), out)
    for _ in range(3):
        content, table = out.read_bytes(), asked()
        try:
            after = go(table, out)
        except rm.StoreError as error:
            said = str(error)
        else:
            said = ""
        if said:
            assert "--fresh" in said
            assert out.read_bytes() == content
            continue
        assert held_by(before) <= held_by(after)
        assert_same(after, go(table, None))
        before = after


CHANGES: dict[str, tuple[dict[str, Any], str]] = {
    "seed": ({"seed": 8}, r"seed was 7, is 8"),
    "work": ({"adhesion": {"model": "jkr", "work": 0.06}}, r"adhesion\.work was '50 mJ/m\^2', is 0\.06"),
    "path": ({"path": {**PATH, "unload": False}}, r"path\.unload was True, is False"),
    "estimator": ({"batch": {"estimator": "stratified"}}, r"batch\.estimator was not given, is 'stratified'"),
    "method": ({"accuracy": {"relative": 0.1, "method": "stratified"}}, r"accuracy\.method was not given, is 'strat"),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("name", CHANGES)
def test_another_scene_is_refused(name: str, keep: str, calls: Calls, out: Path) -> None:
    change, message = CHANGES[name]
    go(small(output=kept(keep)), out)
    other = small(**({"output": kept(keep)} | change))
    refused(other, out, message, calls)
    assert_same(go(other, out, resume=False), go(other, None))


@pytest.mark.large
def test_files_count_by_what_is_in_them(calls: Calls, out: Path, tmp_path: Path) -> None:
    def written(name: str, seed: int) -> dict[str, Any]:
        rm.generate(FEW, seed=seed).to_netcdf(tmp_path / name)
        asperities = {"source": "file", "file": str(tmp_path / name)}
        return scene(asperities=asperities, batch=None, path={"separation": ["2 um", "1 um", "0 um"]})

    one, same, other = written("one.nc", 1), written("same.nc", 1), written("other.nc", 2)
    (tmp_path / "same.nc").write_bytes((tmp_path / "one.nc").read_bytes())
    go(one, out)
    calls.taken()
    go(same, out)
    assert not calls.taken()
    go({**same, "title": "Of this file"}, out)
    assert not calls.taken()
    with pytest.raises(rm.StoreError, match=r"asperities\.file was .*same\.nc.*other\.nc"):
        go(other, tmp_path / "out.nc")
    (tmp_path / "same.nc").write_bytes((tmp_path / "other.nc").read_bytes())
    with pytest.raises(rm.StoreError, match="a file that it reads holds something else"):
        go(same, out)
    assert not calls.taken()
    assert_same(go(same, out, resume=False), go(other, None))


@pytest.mark.few(1)
@pytest.mark.parametrize("content", [b"", b"no result", b"\x89HDF\r\n\x1a\n rest"])
def test_a_file_that_is_no_result_is_left_alone(content: bytes, out: Path) -> None:
    out.write_bytes(content)
    with pytest.raises(rm.StoreError, match="there already"):
        go(small(), out)
    assert out.read_bytes() == content
    go(small(), out, resume=False)
    assert go(small(), out).sizes["realization"] == 6


def test_a_netcdf_file_of_another_kind_is_left_alone(out: Path) -> None:
    xr.Dataset({"force": ("step", [1.0, 2.0])}).to_netcdf(out)
    with pytest.raises(rm.StoreError, match="not a result as roughmdr writes it"):
        go(small(), out)
    assert xr.load_dataset(out).force.to_numpy().tolist() == [1.0, 2.0]


CHANGED: dict[str, Callable[[xr.Dataset], xr.Dataset]] = {
    "separation": lambda data: data.assign_coords(separation=2.0 * data.separation),
    "scene": lambda data: data.assign_attrs(scene=data.attrs["scene"].replace("seed = 7", "seed = 9")),
    "key": lambda data: data.assign_coords(cell_key=data.cell_key.copy(data=data.cell_key.to_numpy()[::-1])),
    "numbers": lambda data: data.assign(
        {
            name: 2.0 * data[name]
            for name in ("force", *(f"force_{each}" for each in ("mean", "sem", "min", "max")))
            if name in data
        }
    ),
}


@pytest.mark.large
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_numbers_that_were_changed_are_refused(keep: str, calls: Calls, out: Path) -> None:
    table = swept(WORKS[:2], output=kept(keep))
    go(table, out)
    calls.taken()
    data = xr.load_dataset(out)
    out.unlink()
    data.to_netcdf(out)  # as it was, through other hands
    go(table, out)
    assert not calls.taken()
    for change in CHANGED.values():
        out.unlink()
        change(data).to_netcdf(out)
        with pytest.raises(rm.StoreError, match="numbers are not those that were written"):
            go(table, out)
    out.unlink()
    data.assign_attrs(scene="no = = toml").to_netcdf(out)
    with pytest.raises(rm.StoreError, match="its scene cannot be read"):
        go(table, out)
    out.unlink()
    del data.attrs["checksum"]
    data.to_netcdf(out)
    with pytest.raises(rm.StoreError, match="has no checksum: its numbers may not be"):
        go(table, out)
    assert not calls.taken()


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_cells_that_are_the_same_are_computed_once(keep: str, calls: Calls, out: Path) -> None:
    table = small(
        sweep={"mode": "zip", "adhesion.work": [0.01, 0.02, 0.01], "asperities.count": [60, 60, 60]},
        output=kept(keep),
    )
    found = go(table, out)
    assert calls.taken() == every([0.01, 0.02], 0, 6)
    assert (found.status == 0).all()
    for name, array in found.data_vars.items():
        np.testing.assert_array_equal(array[0], array[2], err_msg=str(name))
    fresh = go(small(output=kept(keep), adhesion={"model": "jkr", "work": 0.01}), None)
    name = "force" if keep == "curves" else "force_mean"
    np.testing.assert_array_equal(found[name][2], fresh[name])
    calls.taken()
    go(table, out)
    assert not calls.taken()


@pytest.fixture
def other_versions(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    def change() -> None:
        for module in (keys, find, writer, tasks, result):
            monkeypatch.setattr(module, "versions", lambda: "roughmdr 99")

    return change


@pytest.mark.parametrize("begun", [False, True])
def test_other_versions_are_not_used(
    begun: bool, calls: Calls, out: Path, other_versions: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    if begun:
        interrupted(small(), out, 2, monkeypatch)
    else:
        go(small(), out)
    calls.taken()
    other_versions()
    with pytest.raises(rm.StoreError, match=r"it was made with roughmdr .*, this is roughmdr 99"):
        go(small(), out)
    assert not calls.taken()
    go(small(), out, resume=False)
    assert calls.taken() == every([0.05], 0, 6)
    assert not store_folder(out).exists()


RUNS = every([0.01, 0.03, 0.05], 0, 6)
OTHERWISE = [0.03, 0.02, "10 mJ/m^2"]
INTERRUPTED: list[tuple[dict[str, Any], int, dict[str, Any], list[tuple[float, int]]]] = [
    *((table, after, table, RUNS) for after in (1, 4, 8)
      for table in (swept(WORKS, output=kept(keep)) for keep in ("curves", "statistics"))),
    *((swept(WORKS, output=kept(keep)), 5, swept(OTHERWISE, realizations=8, output=kept(keep)),
       every([0.01, 0.02, 0.03], 0, 8)) for keep in ("curves", "statistics")),
    *((swept(WORKS[:2], realizations=11), 7, swept(WORKS[:2], realizations=runs, output={"keep": "statistics"}),
       every([0.01, 0.03], 0, runs)) for runs in (11, 19)),
]  # fmt: skip
"""Scenes that were begun, finished tasks, scenes asked for after that, and the runs of which these consist."""


@pytest.mark.few(3)
@pytest.mark.parametrize(("begun", "after", "asked", "runs"), INTERRUPTED)
def test_what_an_interrupted_run_finished_is_used(
    begun: dict[str, Any], after: int, asked: dict[str, Any], runs: list[tuple[float, int]],
    calls: Calls, out: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Also by a sweep in another order, by more realisations, and curves by statistics."""
    interrupted(begun, out, after, monkeypatch, runs_per_task=3 if begun is not asked else 2)
    done = calls.taken()
    assert len(done) >= 2 * after
    found = go(asked, out, runs_per_task=4)
    assert calls.taken() == sorted({*runs} - {*done})
    assert store_folder(out).exists() == bool({*done} - {*runs})
    assert_same(found, go(asked, None))


def test_variables_of_an_interrupted_run_that_are_not_asked_for_stay(
    calls: Calls, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    more, fewer = small(output=kept(variables=VARIABLES)), small(output=kept(variables=["energy"]))
    interrupted(more, out, 2, monkeypatch)
    calls.taken()
    assert_same(go(fewer, out), go(fewer, None))
    out.unlink()
    calls.taken()
    assert_same(go(more, out), go(more, None))
    assert calls.taken() == sorted([*every([0.05], 4, 6), *every([0.05], 0, 6)])
    assert not store_folder(out).exists()


def test_interrupted_twice_and_shorter_at_last(calls: Calls, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted(swept(WORKS), out, 2, monkeypatch)
    interrupted(swept(WORKS), out, 3, monkeypatch)
    done = calls.taken()
    assert len({*done}) == len(done) == 10
    work = done[0][0]
    found = go(swept([work]), out)
    assert {*calls.taken()} == {*every([work], 0, 6)} - {*done}
    assert_same(found, go(swept([work]), None))
    calls.taken()
    assert_same(go(swept(WORKS), out), go(swept(WORKS), None))  # runs of other cells were kept
    anew = calls.taken()
    assert all(anew.count(run) == 2 - (run in done or run[0] == work) for run in RUNS)
    assert not store_folder(out).exists()


def test_an_interrupted_run_of_another_scene_is_refused(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted(small(), out, 2, monkeypatch)
    with pytest.raises(rm.StoreError, match=r"seed was 7, is 8"):
        go(small(seed=8), out)
    assert store_folder(out).is_dir()
    go(small(seed=8), out, resume=False)
    assert not store_folder(out).exists()


@pytest.mark.large
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_what_failed_is_computed_again(keep: str, calls: Calls, out: Path) -> None:
    table = swept(WORKS[:2], output=kept(keep))
    calls.fails = lambda work, number: work == 0.03 and number == 3
    found = go(table, out)
    assert (found.status == 1).sum() == 1
    assert "it must fail" in str(found.remark.to_numpy())
    name = "force" if keep == "curves" else "force_mean"
    assert np.isnan(found[name]).any(...).item()
    assert len(calls.taken()) == 12
    again = go(table, out)
    assert calls.taken() == [(0.03, 3)]
    assert_same(again, found)
    calls.fails = lambda work, number: False
    whole = go(table, out)
    assert calls.taken() == [(0.03, 3)]
    assert not store_folder(out).exists()
    assert_same(whole, go(table, None))


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_failures_leave_the_same_whatever_the_tasks(keep: str, calls: Calls) -> None:
    calls.fails = lambda work, number: work == 0.01 and number in (2, 5)
    table = swept(WORKS[:2], realizations=9, output=kept(keep), asperities={**FEW, "radius": "2 um"})
    one = go(table, None, runs_per_task=1)
    for runs_per_task, workers in ((1, 1), (4, 2), (18, 2)):
        assert_same(go(table, None, runs_per_task, workers), one)
    assert (one.status == 1).sum() == (2 if keep == "curves" else 1)
    if keep == "statistics":
        assert np.isfinite(one.numerical_error).all()


def test_where_all_failed_the_first_error_is_raised_and_nothing_written(calls: Calls, out: Path) -> None:
    calls.fails = lambda work, number: True
    with pytest.raises(rm.OutOfRange, match="realisation 0: it must fail"):
        go(small(), out)
    assert not out.exists()
    calls.fails = lambda work, number: False
    assert (go(small(), out).status == 0).all()
    assert not store_folder(out).exists()


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_warnings_are_those_of_a_fresh_run(keep: str, calls: Calls, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    steep = {**FEW, "radius": "2 um"}
    table = small(asperities=steep, output=kept(keep))
    with pytest.warns(rm.LimitWarning, match="slopes of up to"):
        fresh = rm.run(table)
    interrupted(table, out, 2, monkeypatch)
    for _ in range(2):
        with pytest.warns(rm.LimitWarning, match="slopes of up to"):
            again = rm.run(table, out)
        assert again.attrs["warnings"] == fresh.attrs["warnings"]
    assert_same(again, fresh)


def test_a_result_is_the_scene_that_made_it(calls: Calls, out: Path, tmp_path: Path) -> None:
    table, copy = swept(WORKS), tmp_path / "copy.nc"
    go(table, out)
    calls.taken()
    copy.write_bytes(out.read_bytes())
    go(tomllib.loads(read(copy).toml), out)
    assert not calls.taken()
