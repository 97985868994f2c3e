"""roughmdr info OUT.nc.parts: what it tells of batches at work, killed and interrupted, which it never disturbs."""

import json
import os
import signal
import sqlite3
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any, get_type_hints

import psutil
import pytest
import tomli_w
from batches import Batch, interrupted, kept, lines, running, slow_scene, until, write_scene
from click.testing import CliRunner
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.resume.store import CheckpointStore
from roughmdr.cli import main
from roughmdr.report.documents import PartCellTable, PartsTable

SWEPT = slow_scene(48, count=2000, sweep={"adhesion.work": ["10 mJ/m^2", "50 mJ/m^2"]})


def told(path: Path, *options: str) -> str:
    done = CliRunner().invoke(main, ["info", str(path), *options])
    assert done.exit_code == 0, (done.output, done.exception)
    assert done.stderr == ""
    return done.output


def table(path: Path) -> dict[str, Any]:
    found = json.loads(told(path, "--json"))
    assert list(found["parts"]) == list(get_type_hints(PartsTable))
    assert all(list(cell) == list(get_type_hints(PartCellTable)) for cell in found["parts"]["cells"])
    parts: dict[str, Any] = found["parts"]
    return parts


def stopped(process: int) -> set[int]:
    """The threads of a process that are stopped."""
    states = {int(path.name): (path / "stat").read_text() for path in Path(f"/proc/{process}/task").iterdir()}
    return {thread for thread, text in states.items() if text.rpartition(")")[2].split()[0] == "T"}


def state(path: Path) -> dict[str, tuple[int, bytes]]:
    return {each.name: (each.stat().st_mtime_ns, each.read_bytes()) for each in path.parent.glob("out.nc.parts*")}


@pytest.mark.large
def test_a_batch_at_work_stopped_killed_and_resumed(tmp_path: Path) -> None:
    folder = tmp_path / "batch"
    parts = folder / "out.nc.parts"
    write_scene(folder, SWEPT)
    with running(Batch(folder, "--workers", "1")) as batch:
        batch.wait_for_lines(14)
        os.kill(batch.pid, signal.SIGSTOP)
        until(lambda: {each.id for each in psutil.Process(batch.pid).threads()} == stopped(batch.pid))
        before, done = state(parts), kept(folder)
        at_work = table(parts)
        assert (at_work["title"], at_work["done"], at_work["total"]) == ("A small scene", done, 96)
        assert at_work["holder"]["process"] == batch.pid
        assert at_work["holder_known"]
        assert [cell["swept"]["adhesion_work"] for cell in at_work["cells"]] == [0.01, 0.05]
        assert sum(cell["done"] for cell in at_work["cells"]) == done
        assert at_work["cells"][0]["done"] == at_work["cells"][0]["total"] == 48
        assert f"at work      process {batch.pid} since 20" in told(parts)
        assert state(parts) == before  # nothing was touched
        done_early = CliRunner().invoke(main, ["info", str(folder / "out.nc")])
        assert done_early.exit_code == 2
        assert f"is not written yet; what is finished is told by: roughmdr info {parts}" in done_early.output
        batch.kill()
    killed = table(parts)
    assert killed["holder"] is None
    assert killed["continued_by"] == "roughmdr run scene.toml -o out.nc --workers 1"
    text = told(parts)
    assert f"kept         A small scene: {done} of 96 runs" in text
    assert "48 of 48  adhesion.work = 10 mJ/m^2" in text
    assert "at work      no run" in text
    with running(Batch(folder, *killed["continued_by"].split()[5:])) as batch:
        assert batch.succeed() == 96 - done
    assert not parts.exists()


@pytest.mark.large
def test_while_it_runs_the_run_is_not_disturbed(tmp_path: Path) -> None:
    folder = tmp_path / "batch"
    parts = folder / "out.nc.parts"
    write_scene(folder, SWEPT)
    with running(Batch(folder, "--workers", "1")) as batch:
        batch.wait_for_lines(1)
        counts = []
        while batch.process.poll() is None:
            done = CliRunner().invoke(main, ["info", str(parts), "--json"])
            document = json.loads(done.stdout)
            if done.exit_code == 0:
                counts.append(document["parts"]["done"])
            else:  # it has just ended
                assert done.exit_code == 2
                said = document["faults"][0]["message"]
                assert any(words in said for words in ("no such file", "holds no runs", "is not readable")), said
        assert batch.succeed() == 96
    while counts[-1] == 0:  # its parts are removed
        counts.pop()
    assert counts
    assert counts == sorted(counts)


@pytest.mark.large
def test_fresh_would_throw_away_what_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / "batch"
    write_scene(folder, SWEPT)
    with running(Batch(folder, "--fresh", "--set", "title=a b")) as batch:
        batch.wait_for_lines(3)
        batch.kill()
    assert table(folder / "out.nc.parts")["continued_by"] == "roughmdr run scene.toml -o out.nc --set 'title=a b'"


def test_failed_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = {**ASPERITIES, "count": 20}
    swept = scene(asperities=few, batch={"realizations": 4}, sweep={"asperities.radius": ["50 um", "1e300 m", "60 um"]})
    interrupted(swept, tmp_path / "out.nc", 5, monkeypatch)
    found = table(tmp_path / "out.nc.parts")
    assert [(cell["done"], cell["failed"]) for cell in found["cells"]] == [(4, 0), (4, 0), (0, 2)]
    assert (found["done"], found["failed"], found["total"]) == (8, 2, 12)
    assert "not representable" in found["remark"]
    text = told(tmp_path / "out.nc.parts")
    assert "0 of 4, 2 failed  asperities.radius = 1e300 m" in text
    assert "failed       2 runs (OutOfRange: " in text
    assert "goes on by   roughmdr.run" in text
    interrupted(swept, tmp_path / "out.nc", 1, monkeypatch)  # the same ones fail again
    assert table(tmp_path / "out.nc.parts")["failed"] == 2


def test_an_error_asked_for_and_statistics(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = {**ASPERITIES, "count": 20}
    accuracy = {"relative": 1e-4, "max_realizations": 100, "method": "sampled"}
    interrupted(scene(asperities=few, batch=None, accuracy=accuracy), tmp_path / "a.nc", 3, monkeypatch)
    found = table(tmp_path / "a.nc.parts")
    assert found["total"] is None
    assert found["cells"][0]["done"] == found["done"] == 6
    assert "6 runs, of as many as the error asked for takes" in told(tmp_path / "a.nc.parts")
    kept_as = {"keep": "statistics"}
    interrupted(scene(asperities=few, batch={"realizations": 12}, output=kept_as), tmp_path / "s.nc", 3, monkeypatch)
    found = table(tmp_path / "s.nc.parts")
    assert (found["done"], found["total"], found["cells"][0]["done"]) == (6, 12, 6)


def test_parts_of_other_versions_and_of_scenes_that_cannot_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupted(scene(asperities={**ASPERITIES, "count": 20}), tmp_path / "out.nc", 2, monkeypatch)
    parts = tmp_path / "out.nc.parts"

    def found(**changes: str) -> str:
        with closing(sqlite3.connect(parts)) as database, database:
            for name, value in changes.items():
                database.execute(f"UPDATE batch SET {name} = ?", (value,))
        table(parts)
        return told(parts)

    assert "4 of 16 runs" in found()
    assert "goes on by   a 'b" in found(command="a 'b")
    assert f"goes on by   roughmdr run SCENE -o {tmp_path / 'out.nc'}" in found(command="")
    assert "cells        not told: other versions began" in found(versions="roughmdr 0")
    assert "cells        not told: its scene cannot be read here" in found(scene="a = ")


def begun(out: Path, stack: ExitStack) -> CheckpointStore:
    """A store in which nothing is kept, and which stays all the same."""
    store = CheckpointStore(out, stack)
    store.begin("title = 'a'", "roughmdr run")
    store.empty = False
    return store


def test_who_is_at_work(tmp_path: Path) -> None:
    out, parts, lock = (tmp_path / f"out.nc{ending}" for ending in ("", ".parts", ".parts-lock"))

    def holder() -> tuple[int | None, bool]:
        found = table(parts)
        return found["holder"] and found["holder"]["process"], found["holder_known"]

    with ExitStack() as stack:
        begun(out, stack)
        assert holder() == (os.getpid(), True)
        with pytest.raises(rm.StoreError, match=rf"another run is writing it \(process {os.getpid()} on "):
            rm.run(scene(batch=None), out)
        saved = lock.read_text()
    assert holder() == (None, True)
    for left, known in ((saved, (None, True)), ("process 3 on elsewhere\n", (3, False)), ("odd", (None, True))):
        lock.write_text(left)  # of a run that was killed
        assert holder() == known
    lock.write_text("process 3 on elsewhere\n")
    assert "perhaps process 3 on elsewhere" in told(parts)
    rm.run(scene(batch=None), out)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


def test_where_nothing_is_kept(tmp_path: Path) -> None:
    parts = tmp_path / "out.nc.parts"
    parts.touch()
    done = CliRunner().invoke(main, ["info", str(parts), "--json"])
    assert done.exit_code == 2
    assert "holds no runs" in json.loads(done.stdout)["faults"][0]["message"]
    (tmp_path / "out.nc.parts-lock").touch()
    assert "kept         nothing: a run has just begun here, or has just ended" in told(parts)


def test_a_run_that_was_killed_while_it_wrote_is_read_and_left_alone(tmp_path: Path) -> None:
    """Its journal stays for the run that goes on."""
    (tmp_path / "before").mkdir()
    parts, journal = (tmp_path / "before" / f"out.nc.parts{ending}" for ending in ("", "-journal"))
    with ExitStack() as stack:
        begun(tmp_path / "before" / "out.nc", stack)
    with closing(sqlite3.connect(parts)) as database:
        database.execute("PRAGMA cache_size = 1")
        for number in range(50):  # more than is held in memory: it is in the file before the transaction ends
            database.execute("INSERT INTO failed (cell, realization) VALUES (?, ?)", ("a" * 1000, number))
        for path in (parts, journal):
            (tmp_path / path.name).write_bytes(path.read_bytes())
    parts = tmp_path / "out.nc.parts"
    before = state(parts)
    assert len(before) == 2
    with pytest.raises(sqlite3.OperationalError, match="readonly"):
        sqlite3.connect(f"file:{parts}?mode=ro", uri=True).execute("SELECT * FROM failed")
    found = table(parts)
    assert (found["failed"], found["scene"]) == (0, "title = 'a'")
    assert state(parts) == before


def test_a_result_says_nothing_of_it(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(tomli_w.dumps(scene(batch=None)))
    rm.run(tmp_path / "s.toml", tmp_path / "out.nc")
    assert json.loads(told(tmp_path / "out.nc", "--json"))["parts"] is None
    assert lines(tmp_path) == []
