"""roughmdr info OUT.nc.parts: what it tells of batches at work, killed and interrupted, which it never disturbs."""

import json
import os
import re
import shutil
import signal
import sys
from contextlib import chdir
from pathlib import Path
from typing import Any, get_type_hints

import psutil
import pytest
from batches import Batch, interrupted, kept, lines, running, slow_scene, until, write_scene
from command import roughmdr, said
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.resume import kept as module
from roughmdr.report.documents import PartCellTable, PartsTable

SWEPT = slow_scene(48, count=2000, sweep={"adhesion.work": ["10 mJ/m^2", "50 mJ/m^2"]})


def told(path: Path, *options: str) -> str:
    done = roughmdr("info", path, *options)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


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


def state(folder: Path) -> dict[str, tuple[int, bytes]]:
    return {path.name: (path.stat().st_mtime_ns, path.read_bytes()) for path in folder.iterdir()}


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
        early = roughmdr("info", folder / "out.nc")
        assert early.returncode == 2
        assert f"is not written yet; what is finished is told by: roughmdr info {parts}" in early.stderr
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
            done = roughmdr("info", parts, "--json")
            document = json.loads(done.stdout)
            if done.returncode == 0:
                counts.append(document["parts"]["done"])
            else:  # it has just ended
                assert done.returncode == 2
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


@pytest.mark.large
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
    manifest = tmp_path / "out.nc.parts" / "manifest.jsonl"
    head, *rest = map(json.loads, manifest.read_text().splitlines())

    def found(header: dict[str, Any], others: list[Any]) -> str:
        manifest.write_text("".join(f"{json.dumps(line)}\n" for line in (header, *others)) + '{"file": "0000')
        table(manifest.parent)
        return told(manifest.parent)

    assert "4 of 16 runs" in found(head, rest)
    assert "cells        not told: other versions began" in found({**head, "versions": "roughmdr 0"}, rest)
    old = [{name: line[name] for name in ("file", "sha256", "realizations")} for line in rest]
    text = found({name: head[name] for name in ("scene", "versions", "replaces")}, old)
    assert "4 of 16 runs" in text
    assert f"goes on by   roughmdr run SCENE -o {tmp_path / 'out.nc'}" in text
    assert "cells        not told: its scene cannot be read here" in found({**head, "scene": "a = "}, rest)
    strange = [3, {"file": 3}, {"failed": [3, ["a"], ["b", "c"]], "remark": ""}, {"failed": [["a", 1]], "remark": ""}]
    assert "failed       1 runs ()" in found({**head, "command": "a 'b"}, [*rest, *strange])


@pytest.mark.parametrize("listed", [True, False])
def test_who_is_at_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, listed: bool) -> None:
    """Also on systems that do not list their locks, where a process of the same number is taken for it."""
    interrupted(scene(asperities={**ASPERITIES, "count": 20}), tmp_path / "out.nc", 2, monkeypatch)
    parts = tmp_path / "out.nc.parts"
    if not listed:
        monkeypatch.setattr(module, "_LOCKS", tmp_path / "none")
    with chdir(tmp_path):
        for process, works in ((os.getpid(), not listed), (2**22 + 1, False)):
            (parts / "lock").write_text(f"process {process} on {os.uname().nodename}\n")
            assert (table(parts)["holder"] is not None) == works
        (parts / "lock").write_text("process 3 on elsewhere\n")
        assert table(parts)["holder_known"] is False
        assert "perhaps process 3 on elsewhere" in told(parts)
        (parts / "lock").unlink()
        assert table(parts)["holder"] is None
        shutil.rmtree(parts)
        parts.mkdir()
        done = roughmdr("info", parts, "--json")
        assert done.returncode == 2
        assert "holds no runs" in json.loads(done.stdout)["faults"][0]["message"]
        (parts / "lock").touch()
        assert "kept         nothing: a run has just begun here, or has just ended" in told(parts)


def test_a_result_says_nothing_of_it(tmp_path: Path) -> None:
    rm.run(scene(batch=None), tmp_path / "out.nc")
    assert json.loads(told(tmp_path / "out.nc", "--json"))["parts"] is None
    assert lines(tmp_path) == []


@pytest.mark.large
def test_a_batch_is_followed_to_its_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["roughmdr.cli.info"], "_PAUSE", 0.02)
    folder = tmp_path / "batch"
    write_scene(folder, SWEPT)
    with running(Batch(folder, "--workers", "1", "--part", "1/2")) as batch:
        until((folder / "out.nc.1-of-2.parts" / "000002.npz").exists)
        followed = said("info", "--follow", folder / "out.nc.1-of-2.parts")
        batch.succeed()
    counts = [int(count) for count in re.findall(r"^A small scene: (\d+) of 48 runs", followed, re.MULTILINE)]
    assert counts == sorted(counts)
    assert len(set(counts)) > 1
    assert "kept         A small scene: 48 of 48 runs" in followed
    with running(Batch(folder, "--workers", "1")) as batch:
        batch.wait_for_lines(2)
        followed = said("info", "--follow", folder / "out.nc")
        batch.succeed()
    assert " of 96 runs; about " in followed
    laws = [int(each) for each in re.findall(r"^law so far   mean force over (\d+) runs", followed, re.MULTILINE)]
    assert laws
    assert laws == sorted(laws)
    assert "pull-off" in followed  # the result is told at the end
    assert roughmdr("info", "--follow", "--json", folder / "out.nc").returncode == 2


def test_where_no_run_is_at_work_there_is_nothing_to_follow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted(SWEPT, tmp_path / "out.nc", 5, monkeypatch)
    followed = said("info", "--follow", tmp_path / "out.nc")
    assert "A small scene: 10 of 96 runs\n" in followed
    assert "at work      no run" in followed
