"""Where an output goes: through links, over what is there, under any name, with little memory and on full disks."""

import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from batches import CURVES, RUNS, Batch, assert_result, interrupted, kept, mounted, running, write_scene
from command import ROUGHMDR, roughmdr
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.resume.store import store_folder
from roughmdr.storage.files import destination
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.netcdf_store import max_file_size, write_arrays
from roughmdr.storage.result_file import read_result

FEW = {**ASPERITIES, "count": 20}
PATH = {"separation": {"start": "3 um", "stop": "0 um", "steps": 6}, "unload": True}


def few(realizations: int = 12, **changes: Any) -> dict[str, Any]:
    return scene(**{"asperities": FEW, "path": PATH, "batch": {"realizations": realizations}} | changes)


def command(*arguments: object) -> tuple[int, str]:
    """In this process: exit status, and all that was said."""
    done = roughmdr(*arguments)
    return done.returncode, done.stdout + done.stderr


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


# Links


def absolute(link: Path, target: Path) -> None:
    link.symlink_to(target)


def relative(link: Path, target: Path) -> None:
    link.symlink_to(os.path.relpath(target, link.parent))


def of_links(link: Path, target: Path) -> None:
    second = link.with_name("second")
    relative(second, target)
    link.symlink_to("second")


@pytest.fixture(params=[absolute, relative, of_links], ids=lambda made: made.__name__)
def linked(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, Path]:
    """A link in one folder to a file in another that is not there yet."""
    link, target = tmp_path / "project" / "out.nc", tmp_path / "scratch" / "deep" / "real.nc"
    link.parent.mkdir()
    target.parent.mkdir(parents=True)
    request.param(link, target)
    return link, target


@pytest.mark.few(1)
def test_a_link_stays_one_and_what_it_leads_to_is_written(linked: tuple[Path, Path]) -> None:
    link, target = linked
    found = rm.run(few(), link)
    for _ in range(2):
        assert link.is_symlink()
        assert not target.is_symlink()
        assert names(target.parent) == ["real.nc"]
        assert "out.nc.parts" not in names(link.parent)
        assert rm.run(few(), target).identical(read_result(link).to_xarray())  # nothing is computed again
        xr.testing.assert_equal(rm.run(few(), link, resume=False).force, found.force)


@pytest.mark.few(1)
@pytest.mark.parametrize(("first", "second"), [(0, 1), (1, 0), (0, 0)])
def test_what_is_kept_is_found_by_way_of_a_link_and_without(
    linked: tuple[Path, Path], first: int, second: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = linked[1]
    interrupted(few(), linked[first], 3, monkeypatch)
    assert names(target.parent) == ["real.nc.parts"]
    assert len([*store_folder(target).glob("*.npz")]) == 3
    xr.testing.assert_equal(rm.run(few(), linked[second]).force, rm.run(few()).force)
    assert names(target.parent) == ["real.nc"]


@pytest.mark.large
def test_a_link_and_what_it_leads_to_have_one_lock(folder: Path, curves: xr.Dataset) -> None:
    (folder / "out.nc").symlink_to("scratch/real.nc")
    (folder / "scratch").mkdir()
    parts = folder / "scratch" / "real.nc.parts"
    with running(Batch(folder)) as first:
        while len([*parts.glob("*.npz")]) < 2:  # the manifest speaks of the first before there is a second
            assert first.process.poll() is None
        os.kill(first.pid, signal.SIGSTOP)
        for options in (["--set", "seed=77"], ["--fresh"]):
            done = roughmdr("run", "scene.toml", "-o", "scratch/real.nc", *options, cwd=folder)
            assert done.returncode == 2
            assert "another run is writing it" in done.stderr
        first.kill()
    assert 0 < len([*parts.glob("*.npz")]) < RUNS // 4
    with running(Batch(folder)) as second:
        assert 0 < second.succeed() < RUNS
    assert_result(folder, curves)
    assert names(folder / "scratch") == ["real.nc"]


@pytest.mark.parametrize(
    ("leads_to", "says"),
    [
        ("none/real.nc", r"out\.nc \(a link to .*real\.nc\): the folder .*none does not exist"),
        ("out.nc", "in a circle"),
        ("second", "in a circle"),
        (".", "is a folder"),
        ("/dev/null", "is not a regular file"),
        ("scene.toml", "is an input"),
    ],
)
def test_a_link_that_leads_nowhere_is_refused(tmp_path: Path, leads_to: str, says: str) -> None:
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(few()))
    (tmp_path / "second").symlink_to("out.nc")
    (tmp_path / "out.nc").symlink_to(leads_to)
    before = names(tmp_path)
    with pytest.raises(rm.StoreError, match=says):
        rm.run(tmp_path / "scene.toml", tmp_path / "out.nc")
    assert names(tmp_path) == before
    assert (tmp_path / "out.nc").is_symlink()


@pytest.mark.large
def test_links_to_pictures_scenes_and_ensembles_stay(tmp_path: Path) -> None:
    (tmp_path / "scratch").mkdir()
    for name in ("s.toml", "out.nc", "e.nc", "a.png"):
        (tmp_path / name).symlink_to(f"scratch/{name}")
    scene_file, out, ensemble, picture = (tmp_path / name for name in ("s.toml", "out.nc", "e.nc", "a.png"))
    for _ in range(2):
        if not scene_file.exists():
            assert command("new", scene_file)[0] == 0
        assert command("run", scene_file, "-o", out, "--set", "batch.realizations=2")[0] == 0
        assert command("generate", scene_file, "-o", ensemble)[0] == 0
        assert command("plot", out, "-o", picture, "--variable", "force")[0] == 0
    assert all((tmp_path / name).is_symlink() for name in ("s.toml", "out.nc", "e.nc", "a.png"))
    assert names(tmp_path / "scratch") == ["a.png", "e.nc", "out.nc", "s.toml"]
    assert destination(picture) == tmp_path / "scratch" / "a.png"


# What is there already


@pytest.fixture
def kinds(tmp_path: Path) -> Path:
    """A folder with one file of each kind."""
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(few(3)))
    (tmp_path / "text").write_text("what somebody wrote")
    (tmp_path / "empty").touch()
    (tmp_path / "half.nc").write_bytes(b"\x89HDF\r\n\x1a\n rest")
    xr.Dataset({"height": (("x", "y"), np.ones((2, 2)))}).to_netcdf(tmp_path / "map.nc")
    rm.run(few(3), tmp_path / "out.nc")
    assert command("generate", tmp_path / "scene.toml", "-o", tmp_path / "ensemble.nc")[0] == 0
    for name in ("picture.png", "picture.pdf", "picture.svg"):
        assert command("plot", tmp_path / "out.nc", "-o", tmp_path / name, "--variable", "force")[0] == 0
    return tmp_path


@pytest.mark.large
def test_nothing_is_replaced_by_another_kind_of_file_unasked(kinds: Path) -> None:
    """Every command over every file, each with the ending that the command would give it."""
    rm.run(few(3), kinds / "input.nc")
    before = {path.name: path.read_bytes() for path in kinds.iterdir()}
    written = [("run", "nc", ["scene.toml"], "out.nc"), ("generate", "nc", ["scene.toml"], "ensemble.nc")]
    plotted = ["input.nc", "--variable", "contact_area"]
    written += [("plot", suffix, plotted, f"picture.{suffix}") for suffix in ("png", "pdf", "svg")]
    for name, suffix, (source, *options_of_all), own in written:
        for there in sorted(before.keys() - {"input.nc", "scene.toml"}):
            output = kinds / f"there.{suffix}"
            for options, replaced in ([], there == own), (["--fresh"], True):
                output.write_bytes(before[there])
                status, said = command(name, kinds / source, *options_of_all, "-o", output, *options)
                assert status == (0 if replaced else 2), (name, there, said)
                if not replaced:
                    assert output.read_bytes() == before[there]
                    assert " already" in said
                    assert "--fresh" in said
            output.unlink()
    assert {path.name: path.read_bytes() for path in kinds.iterdir()} == before


@pytest.mark.parametrize("shape", ["paraboloid", "tabulated"])
def test_asperities_are_replaced_unasked_by_the_very_ones_alone(tmp_path: Path, shape: str) -> None:
    section = {**FEW, "placement": "random"}
    if shape == "tabulated":
        section |= {"shape": shape, "r": [0, "1 um", "2 um"], "f": [0, "1 nm", "4 nm"]}
        del section["radius"]
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(few(asperities=section)))
    out = tmp_path / "ensemble.nc"
    generate = ["generate", tmp_path / "scene.toml", "-o", out]
    assert command(*generate)[0] == 0
    before = out.read_bytes()
    for others in (
        ["--set", "seed=8"],
        ["--realization", 1],
        ["--set", "asperities.count=19"],
        ["--set", "asperities.patch='2 mm'"],
        ["--set", "asperities.height.std='2 um'"],
    ):
        status, said = command(*generate, *others)
        assert (status, "holds other asperities already" in said, out.read_bytes()) == (2, True, before)
    assert command(*generate)[0] == 0
    assert command(*generate, "--set", "seed=8", "--fresh")[0] == 0
    with xr.open_dataset(out) as ensemble:
        assert ensemble.attrs["seed"] == 8
        edited = ensemble.load().assign(height=ensemble.height + 1e-9)
    edited.to_netcdf(out)
    assert command(*generate, "--set", "seed=8")[0] == 2


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["out", "out.png", "out.toml.txt", "nc", ".nc", "out.nc.gz", "out.json"])
def test_the_name_of_an_output_says_what_it_is(tmp_path: Path, name: str) -> None:
    """Before anything is computed: the scene would fail where it is drawn."""
    impossible = {**FEW, "placement": "hard_core", "min_distance": "1 m"}
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(few(asperities=impossible)))
    rm.run(few(3), tmp_path / "result.nc")
    before = names(tmp_path)
    asked = {
        "run": ([tmp_path / "scene.toml", "-o", tmp_path / name, "--fresh"], "result must end in .nc"),
        "generate": ([tmp_path / "scene.toml", "-o", tmp_path / name, "--fresh"], "asperities must end in .nc"),
        "plot": ([tmp_path / "result.nc", "-o", tmp_path / f"{name}.nc", "--fresh"], "end in .png, .pdf or .svg"),
        "new": ([tmp_path / name], "scene must end in .toml"),
    }
    for verb, (arguments, says) in asked.items():
        status, said = command(verb, *arguments)
        assert (status, says in said) == (2, True), said
    with pytest.raises(rm.StoreError, match="must end in"):
        rm.run(few(3), tmp_path / name)
    assert names(tmp_path) == before


@pytest.mark.parametrize("name", ["out.NC", "out.nc4", "out.netcdf", "out.cdf", "a.b.nc"])
def test_every_usual_name_of_a_netcdf_file_will_do(tmp_path: Path, name: str) -> None:
    rm.run(few(3), tmp_path / name)
    assert names(tmp_path) == [name]


@pytest.mark.large
def test_an_input_is_never_replaced(kinds: Path) -> None:
    (kinds / "link.png").symlink_to("out.nc")
    before = {path.name: path.read_bytes() for path in kinds.iterdir()}
    file = ["--set", f"asperities={{source='file', file='{kinds / 'ensemble.nc'}'}}", "--set", "batch.realizations=1"]
    for arguments in (
        ["run", kinds / "scene.toml", "-o", kinds / "scene.toml"],
        ["run", kinds / "scene.toml", *file, "-o", kinds / "ensemble.nc"],
        ["generate", kinds / "scene.toml", *file, "-o", kinds / "ensemble.nc"],
        ["plot", kinds / "out.nc", "-o", kinds / "link.png"],
    ):
        status, said = command(*arguments, "--fresh")
        assert (status, "is an input" in said) == (2, True), said
    assert {path.name: path.read_bytes() for path in kinds.iterdir()} == before


# Names


@pytest.mark.large
def test_a_name_that_cannot_be_read_again_is_refused_before(kinds: Path) -> None:
    odd = os.fsencode(kinds) + b"/a\xff"
    os.symlink(odd + b".nc", kinds / "link.nc")
    os.symlink(b"plain.nc", odd + b"_link.nc")
    before = sorted(os.listdir(os.fsencode(kinds)))
    for name, last in (("run", b".nc"), ("plot", b".png"), ("run", b"_link.nc"), ("generate", b"")):
        given = "out.nc" if name == "plot" else "scene.toml"
        output = odd + last if last else b"link.nc"
        done = subprocess.run([*ROUGHMDR, name, given, "-o", output], cwd=kinds, capture_output=True, check=False)
        assert done.returncode == 2, done.stderr
        assert b"the name is not UTF-8" in done.stderr
        assert b"Traceback" not in done.stderr
    assert sorted(os.listdir(os.fsencode(kinds))) == before


# Memory and disks


def big(steps: int) -> Labelled:
    """Arrays of the shape of a result with a long path."""
    h = np.linspace(0.0, 1.0, steps)
    branch = np.where(np.arange(steps) < steps // 2, "loading", "unloading")
    coordinates = {"separation": Array(("step",), h, {}), "branch": Array(("step",), branch, {})}
    return Labelled({"force": Array(("realization", "step"), h[None], {})}, coordinates, {"title": "big"})


_WRITE = """
import resource, sys
from pathlib import Path
from test_outputs import big
from roughmdr.errors import RoughmdrError
from roughmdr.storage.netcdf_store import write_netcdf
write_netcdf(big(2), Path("small.nc"))
data = big(int(sys.argv[1]))
with open("/proc/self/statm") as sizes:
    now = int(sizes.read().split()[0]) * resource.getpagesize()
limit = now + int(sys.argv[2]) * 1_000_000
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    write_netcdf(data, Path("big.nc"))
except RoughmdrError as error:
    print(error)
"""


@pytest.mark.large
@pytest.mark.skipif(sys.platform != "linux", reason="no limit of the address space can be relied on here")
@pytest.mark.parametrize("megabytes", [*map(large, [1, 8, 30, 75, 100]), 60])
def test_too_little_memory_is_said_before_a_file_is_written(tmp_path: Path, megabytes: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _WRITE, "1000000", str(megabytes)],
        cwd=tmp_path,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(map(str, Path(__file__).parents[:3])),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    if megabytes < 64:
        assert "to write a file takes about 67.1 MB of memory, with" in done.stdout
        assert "of address space (ulimit -v)" in done.stdout
    else:
        assert not done.stdout
        assert read_text(tmp_path / "big.nc") == (500_000, 500_000)
    assert names(tmp_path) == (["small.nc"] if megabytes < 64 else ["big.nc", "small.nc"])


def read_text(path: Path) -> tuple[int, int]:
    with xr.open_dataset(path) as data:
        branch = data.branch.to_numpy()
    return int((branch == "loading").sum()), int((branch == "unloading").sum())


@pytest.mark.large
def test_a_run_that_memory_cannot_hold_is_refused_before_it_computes(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(scene(batch={"realizations": 10_000_000})))
    limited = "import resource\nresource.setrlimit(resource.RLIMIT_AS, (8 * 10**9, 8 * 10**9))\n" + ROUGHMDR[2]
    for arguments, status in (["run", "scene.toml", "-o", "out.nc"], 2), (["plan", "scene.toml"], 0):
        done = subprocess.run(
            [sys.executable, "-c", limited, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == status, done.stderr
        if status:
            # With space on the disk for three times the curves, the numbers beside them; else the curves as well.
            assert re.search(r"the run takes about (11\.1|35\.6) GB of memory, with", done.stderr)
            assert "left of the 8 GB of address space (ulimit -v)" in done.stderr
            assert "output.keep = 'statistics'" in done.stderr
        else:
            assert "only 7" in done.stdout or "only 6" in done.stdout
    assert names(tmp_path) == ["scene.toml"]


@pytest.mark.large
@pytest.mark.parametrize("free", [*map(large, [0, 4_000, 90_000, 1_000_000, 5_000_000]), 20_000])
def test_a_disk_that_is_full_when_the_result_is_written_says_so(tmp_path: Path, free: int) -> None:
    """All is one task, of which nothing is kept."""
    path = {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 32_000}, "unload": True}
    folder = tmp_path / "disk"
    with mounted(folder, "8m"):
        write_scene(folder, few(1, path=path))  # 64 000 steps of 48 bytes and a text
        space = os.statvfs(folder)
        (folder / "filling").write_bytes(bytes(space.f_bavail * space.f_frsize - free))
        with running(Batch(folder, runs_per_task=1)) as batch:
            said = batch.fail(2)
        assert "No space left on device" in said
        assert names(folder) == ["filling", "scene.toml"]
        (folder / "filling").unlink()
        with running(Batch(folder, runs_per_task=1)) as batch:
            assert batch.succeed() == 1
        assert names(folder) == ["out.nc", "scene.toml"]


@pytest.mark.large
def test_a_disk_that_is_full_at_the_end_keeps_what_is_finished(tmp_path: Path) -> None:
    folder = tmp_path / "disk"
    with mounted(folder, "64m"):
        write_scene(folder, CURVES)
        full = """
import os
import roughmdr.batch.resume.writer as writer
def write(*arguments, write=writer.write_netcdf):
    space = os.statvfs(".")
    with open("filling", "wb") as file:
        file.write(bytes(space.f_bavail * space.f_frsize - 50_000))
    write(*arguments)
writer.write_netcdf = write
"""
        with running(Batch(folder, code=full)) as batch:
            said = batch.fail(1)
        assert "out.nc: cannot be written: No space left on device, and it takes up to" in said
        assert "what is finished is kept in out.nc.parts" in said
        assert kept(folder) == RUNS
        (folder / "filling").unlink()
        with running(Batch(folder)) as batch:
            assert batch.succeed() == 0
        assert names(folder) == ["out.nc", "scene.toml"]


@pytest.mark.large
def test_the_room_that_is_had_beforehand_is_enough_and_given_back(tmp_path: Path) -> None:
    """Whatever is in a file: more than is reserved is never written, and no more is kept than is."""
    texts = np.array(["", "a", "ü" * 50, "x" * 3000] * 300, dtype=object)
    many = {f"v{number}": Array(("step",), np.zeros(3), {"units": "m", "long_name": "n" * 90}) for number in range(60)}
    datasets = [
        big(10),
        big(100_000),
        Labelled({}, {"remark": Array(("text",), texts, {})}, {"title": "ü" * 20_000}),
        Labelled(many, {}, {f"a{number}": "x" for number in range(200)}),
        Labelled({"one": Array((), np.array(1.0), {})}, {"key": Array((), np.array("text", dtype=object), {})}, {}),
        Labelled({"wide": Array(("a", "b", "c"), np.ones((3, 2, 70_000)), {})}, {}, {}),
    ]
    for number, data in enumerate(datasets):
        path, most = tmp_path / f"{number}.nc", max_file_size(data)
        path.touch()
        write_arrays(data, path)
        assert path.stat().st_size <= most < 1.5 * path.stat().st_size + 2**18
        assert path.stat().st_blocks * 512 < path.stat().st_size + 2**14
        with xr.open_dataset(path, decode_cf=False) as file:
            for name, array in (data.variables | data.coordinates).items():
                np.testing.assert_array_equal(file[name].to_numpy(), array.values)


def test_scratch_disks_are_written_to_by_way_of_a_link(tmp_path: Path) -> None:
    """Another disk, where nothing can be moved to: what is temporary must be there too."""
    with mounted(tmp_path / "scratch", "16m"):
        (tmp_path / "out.nc").symlink_to(tmp_path / "scratch" / "out.nc")
        xr.testing.assert_equal(rm.run(few(), tmp_path / "out.nc").force, rm.run(few()).force)
        assert (tmp_path / "out.nc").is_symlink()
        assert names(tmp_path / "scratch") == ["out.nc"]
    assert shutil.disk_usage(tmp_path).free > 0
