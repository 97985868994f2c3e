"""Parts of a batch, computed by themselves and joined: the same bits, and words for what is missing."""

import json
import os
import random
import shutil
import time
from contextlib import ExitStack
from functools import cache
from pathlib import Path

import pytest
import xarray as xr
from batches import CURVES, STATISTICS, Batch, assert_clean, assert_result, let_fail, running, write_scene
from click.testing import CliRunner, Result
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import scene

from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.share import Share
from roughmdr.batch.resume.store import locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import RunRange
from roughmdr.cli import main
from roughmdr.scene import read

SWEPT = scene(sweep={"material.modulus": [1e9, 2e9, 3e9]}, batch={"realizations": 5})


def roughmdr(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(each) for each in arguments])


def compute(folder: Path, part: str, *options: object) -> Result:
    return roughmdr("run", folder / "scene.toml", "-o", folder / "out.nc", "--part", part, *options)


def refused(done: Result) -> str:
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output
    return done.output


@cache
def all_runs() -> RunRange:
    return Rounds(make_plan(read(scene()))).begin()[0]


@pytest.mark.large
@settings(deadline=None)
@given(
    counts=st.lists(st.integers(1, 40), min_size=1, max_size=12), total=st.integers(1, 60), first=st.integers(0, 1000)
)
def test_each_run_is_in_one_part_and_all_parts_have_about_as_many(counts: list[int], total: int, first: int) -> None:
    ranges = [all_runs()._replace(key=str(cell), first=first, last=first + count) for cell, count in enumerate(counts)]
    parts = [Share(number, total).of(ranges) for number in range(1, total + 1)]
    runs = sorted((each.key, run) for part in parts for each in part for run in range(each.first, each.last))
    assert runs == sorted((each.key, run) for each in ranges for run in range(each.first, each.last))
    sizes = [sum(each.last - each.first for each in part) for part in parts]
    assert max(sizes) - min(sizes) <= 1


@pytest.mark.parametrize("text", ["0/3", "4/3", "1", "1/0", "-1/3", "1/3/5", "a/b", "1.0/3", "01/3", ""])
def test_what_is_no_part_is_refused(tmp_path: Path, text: str) -> None:
    write_scene(tmp_path, SWEPT)
    assert f"part is {text!r}; it must be" in refused(compute(tmp_path, text))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("keep", "total"),
    [("curves", 4), ("statistics", 4), large("statistics", 7), large("curves", 1), large("curves", 20)],
)
def test_joined_they_have_the_bits_of_one_run(tmp_path: Path, keep: str, total: int) -> None:
    table = SWEPT | {"output": {"keep": keep}}
    for name in ("one", "parts"):
        write_scene(tmp_path / name, table)
    one, parts = tmp_path / "one", tmp_path / "parts"
    assert roughmdr("run", one / "scene.toml", "-o", one / "out.nc").exit_code == 0
    for number in random.Random(total).sample(range(1, total + 1), total):
        done = compute(parts, f"{number}/{total}", "--workers", 1 + number % 3)
        assert done.exit_code == 0, done.output
        assert ("fewer runs than parts" if number > 15 else "this part is done") in done.output
        assert not (parts / "out.nc").exists()
    assert roughmdr("join", parts / "out.nc").exit_code == 0
    with xr.open_dataset(one / "out.nc") as base:
        assert_result(parts, base.load(), alone=True)


@pytest.mark.large
@pytest.mark.parametrize(("keep", "total"), [("curves", 8), ("statistics", 8)])
def test_at_once_and_killed_at_random(tmp_path: Path, keep: str, total: int, request: pytest.FixtureRequest) -> None:
    """Each is killed until it has ended by itself before that."""
    folder, chosen = tmp_path / "batch", random.Random(total)
    write_scene(folder, CURVES if keep == "curves" else STATISTICS)
    left, kills = set(range(1, total + 1)), 0
    while left:
        with ExitStack() as stack:
            batches = {
                number: stack.enter_context(running(Batch(folder, "--part", f"{number}/{total}", "--workers", 1)))
                for number in left
            }
            if kills < total:
                folders = [Share(number, total).folder(folder / "out.nc") for number in left]
                while not any((path / "000001.npz").exists() for path in folders):
                    time.sleep(0.002)
                time.sleep(chosen.uniform(0.0, 0.1))
                for number in chosen.sample(sorted(left), (len(left) + 1) // 2):
                    kills += batches[number].process.poll() is None
                    batches.pop(number).kill()
            for number, batch in batches.items():
                batch.succeed()
                left.remove(number)
    assert kills
    assert roughmdr("join", folder / "out.nc").exit_code == 0
    assert_result(folder, request.getfixturevalue(keep), alone=True)


@pytest.mark.large
def test_parts_that_are_missing_or_not_done_are_named(tmp_path: Path) -> None:
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    assert f"no part of it is here; expected folders such as {out}.1-of-8.parts" in refused(roughmdr("join", out))
    Share(1, 8).folder(out).mkdir()
    assert "1-of-8.parts: no run of this part, nor of another, is kept yet" in refused(roughmdr("join", out))
    for number in (1, 3):
        assert compute(tmp_path, f"{number}/4").exit_code == 0
    told = roughmdr("info", out)
    assert told.exit_code == 0
    assert [line.split()[0] for line in told.output.splitlines()] == ["out.nc.1-of-4.parts", "out.nc.3-of-4.parts"]
    assert told.output.count("this part is done") == 2
    said = refused(roughmdr("join", out))
    assert f"7 runs of parts 2/4, 4/4 not done; compute by: roughmdr run SCENE -o {out} --part 2/4" in said
    for number in (2, 4):
        assert compute(tmp_path, f"{number}/4").exit_code == 0
    Share(3, 4).folder(out).joinpath("000001.npz").write_bytes(b"")
    assert "4 runs of part 3/4 not done" in refused(roughmdr("join", out))
    assert compute(tmp_path, "3/4").exit_code == 0
    assert "this part is done" in roughmdr("info", f"{out}.3-of-4.parts").output
    assert roughmdr("join", out).exit_code == 0
    assert_clean(tmp_path)
    assert "no part of it is here, and the file is there: is it joined already?" in refused(roughmdr("join", out))


@pytest.mark.large
def test_parts_of_other_batches_are_refused(tmp_path: Path) -> None:
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    assert compute(tmp_path, "1/2").exit_code == 0
    assert "is 8" in refused(compute(tmp_path, "1/2", "--set", "seed=8"))
    assert compute(tmp_path, "2/2", "--set", "seed=8").exit_code == 0
    assert "are parts of different scenes" in refused(roughmdr("join", out))
    assert compute(tmp_path, "2/2", "--fresh").exit_code == 0
    assert compute(tmp_path, "2/3").exit_code == 0
    said = f"{out}.2-of-2.parts and {out}.2-of-3.parts: are of other numbers of parts"
    assert said in refused(roughmdr("join", out))
    shutil.rmtree(Share(2, 3).folder(out))
    with locked_store(Share(2, 2).beside(out)):
        assert f"{out}.2-of-2: another run is writing it (process {os.getpid()}" in refused(roughmdr("join", out))
    assert roughmdr("join", out).exit_code == 0


@pytest.mark.large
def test_more_realisations_are_those_of_one_run_of_all(tmp_path: Path) -> None:
    """Parts that are computed again under a scene that asks for more go on, and the result is that of the new scene."""
    more = SWEPT | {"batch": {"realizations": 9}}
    for name, table in (("one", more), ("parts", SWEPT)):
        write_scene(tmp_path / name, table)
    one, parts = tmp_path / "one", tmp_path / "parts"
    assert roughmdr("run", one / "scene.toml", "-o", one / "out.nc").exit_code == 0
    for table in (SWEPT, more):
        write_scene(parts, table)
        for number in (1, 2, 3):
            assert compute(parts, f"{number}/3").exit_code == 0
    assert roughmdr("join", parts / "out.nc").exit_code == 0
    with xr.open_dataset(one / "out.nc") as base:
        assert_result(parts, base.load(), alone=True)


@pytest.mark.large
def test_a_result_that_is_there_is_extended_or_refused(tmp_path: Path) -> None:
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    assert roughmdr("run", tmp_path / "scene.toml", "-o", out).exit_code == 0
    for number in (1, 2):
        assert compute(tmp_path, f"{number}/2", "--set", "seed=8").exit_code == 0
    assert "is 8" in refused(roughmdr("join", out))
    assert len(list(tmp_path.glob("*.parts"))) == 2
    assert roughmdr("join", out, "--fresh").exit_code == 0
    assert_clean(tmp_path)
    for number in (1, 2):
        done = compute(tmp_path, f"{number}/2", "--set", "seed=8", "--set", "batch.realizations=7")
        assert done.exit_code == 0, done.output
    assert roughmdr("join", out).exit_code == 0
    assert_clean(tmp_path)
    with xr.open_dataset(out) as result:
        assert result.sizes["realization"] == 7


def test_a_join_killed_before_its_end_is_carried_on(tmp_path: Path) -> None:
    """The result was written, and some parts removed, others not; more than it asks for is never thrown away."""
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    for number in (1, 2):
        assert compute(tmp_path, f"{number}/2").exit_code == 0
    shutil.copytree(Share(2, 2).folder(out), tmp_path / "saved")
    assert roughmdr("join", out).exit_code == 0
    written = out.stat().st_mtime_ns
    shutil.move(tmp_path / "saved", Share(2, 2).folder(out))
    assert roughmdr("join", out).exit_code == 0
    assert out.stat().st_mtime_ns == written
    assert_clean(tmp_path)
    for part in ("1/2", "2/2"):
        assert compute(tmp_path, part, "--set", "batch.realizations=9").exit_code == 0
    for part in ("1/2", "2/2"):
        assert compute(tmp_path, part).exit_code == 0
    assert roughmdr("join", out).exit_code == 0
    assert len(list(tmp_path.glob("*.parts"))) == 2


def test_runs_that_a_later_scene_does_not_ask_for_are_kept(tmp_path: Path) -> None:
    write_scene(tmp_path, scene(batch={"realizations": 3}))
    for number in (1, 2, 3):
        assert compute(tmp_path, f"{number}/3").exit_code == 0
    for number in (1, 2, 3):
        done = compute(tmp_path, f"{number}/3", "--set", "batch.realizations=1")
        assert ("fewer runs" in done.output) == (number > 1)
    assert roughmdr("join", tmp_path / "out.nc").exit_code == 0
    assert len(list(tmp_path.glob("*.parts"))) == 3
    with xr.open_dataset(tmp_path / "out.nc") as result:
        assert result.sizes["realization"] == 1
    for number in (1, 2, 3):
        done = compute(tmp_path, f"{number}/3")
        assert "0 of 0 runs, 1 used again" in done.output
    assert roughmdr("join", tmp_path / "out.nc").exit_code == 0
    assert_clean(tmp_path)


def test_an_output_that_is_a_link(tmp_path: Path) -> None:
    (tmp_path / "scratch").mkdir()
    write_scene(tmp_path, SWEPT)
    (tmp_path / "out.nc").symlink_to(tmp_path / "scratch" / "real.nc")
    assert "this part is done" in compute(tmp_path, "1/1").output
    assert roughmdr("join", tmp_path / "out.nc").exit_code == 0
    assert [path.name for path in (tmp_path / "scratch").iterdir()] == ["real.nc"]


def test_how_far_a_part_is(tmp_path: Path) -> None:
    write_scene(tmp_path, SWEPT)
    told = json.loads(compute(tmp_path, "2/4", "--json").stdout)["parts"]
    assert (told["part"], told["done"], told["total"], told["output"]) == ("2/4", 4, 4, str(tmp_path / "out.nc"))
    said = roughmdr("info", tmp_path / "out.nc.2-of-4.parts").output
    assert "part         2 of 4" in said
    assert "A small scene: 4 of 4 runs" in said
    assert f"roughmdr join {tmp_path / 'out.nc'}" in said


def test_how_many_runs_an_error_takes_cannot_be_parted(tmp_path: Path) -> None:
    write_scene(tmp_path, SWEPT | {"accuracy": {"relative": 0.1}})
    assert "accuracy: how many runs there are follows from their results" in refused(compute(tmp_path, "1/2"))


def test_a_part_all_of_whose_runs_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    let_fail(monkeypatch, lambda given, realization: given.material.modulus == 1e9)
    ends = [compute(tmp_path, f"{number}/15", "--quiet") for number in range(1, 16)]
    assert sorted(each.exit_code for each in ends) == [0] * 10 + [1] * 5
    assert all(("1 runs failed: OutOfRange: it must fail" in each.stderr) == each.exit_code for each in ends)
    told = json.loads(compute(tmp_path, "1/15", "--json").stdout)
    assert told["faults"][0]["message"] == "1 runs failed: OutOfRange: it must fail"
    assert (told["parts"]["done"], told["parts"]["failed"], told["parts"]["total"]) == (0, 1, 1)
    assert roughmdr("join", out).exit_code == 1
    with xr.open_dataset(out) as result:
        assert result.status.sum() == 5


def test_runs_that_failed_are_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_scene(tmp_path, SWEPT)
    out = tmp_path / "out.nc"
    with monkeypatch.context() as patched:
        let_fail(patched, lambda given, realization: realization == 2)
        ends = [compute(tmp_path, f"{number}/2") for number in (1, 2)]
        assert sorted(each.exit_code for each in ends)[-1] == 1
        assert "it must fail" in "".join(each.output for each in ends)
        joined = roughmdr("join", out)
        assert (joined.exit_code, "it must fail" in joined.output) == (1, True)
    assert len(list(tmp_path.glob("*.parts"))) == 2  # the result lacks runs, and nothing is thrown away
    assert roughmdr("join", out).exit_code == 0
    assert_clean(tmp_path)
    with xr.open_dataset(out) as result:
        assert not result.status.any()
