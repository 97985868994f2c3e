"""Zarr stores: the numbers of the netCDF file, read by xarray and every command, whole or not there."""

import json
import sys
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.result.view import ResultView
from roughmdr.storage import files, room, zarr_store
from roughmdr.storage.labelled import Array, Labelled, blocks, chunks_of
from roughmdr.storage.result_file import read_result

SWEPT = scene(
    path={"separation": {"stop": "0.5 sigma", "steps": 20}, "unload": True},
    adhesion={"model": "jkr", "work": 0.05},
    sweep={"adhesion.work": [0.02, 0.05], "asperities.placement": ["random", "square"]},
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result in both formats, and the store as xarray writes it again in the format before."""
    here = tmp_path_factory.mktemp("stores")
    for name in ("out.nc", "out.zarr"):
        rm.run(SWEPT, here / name)
    with xr.open_zarr(here / "out.zarr") as opened:
        for variable in opened.variables.values():
            variable.encoding.clear()
        old = opened.load().map(lambda each: each.astype(object) if each.dtype.kind == "T" else each)
        old.assign_coords(
            {k: v.astype(object) if v.dtype.kind == "T" else v for k, v in opened.coords.items()}
        ).to_zarr(here / "old.zarr", zarr_format=2)
    return here


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["out.zarr", "old.zarr"])
def test_it_holds_what_the_netcdf_file_holds(folder: Path, name: str) -> None:
    stored, expected = (read_result(folder / each) for each in (name, "out.nc"))
    assert stored.integrity_fault() == ""
    assert stored.variables.keys() == expected.variables.keys()
    assert stored.coordinates.keys() == expected.coordinates.keys()
    for each, array in (expected.variables | expected.coordinates).items():
        found = (stored.variables | stored.coordinates)[each]
        assert found.dims == array.dims
        if each != "run_time":
            np.testing.assert_array_equal(found.values, array.values)
        if name == "out.zarr":
            assert {k: np.array(v).tolist() for k, v in found.attrs.items()} == {
                k: np.array(v).tolist() for k, v in array.attrs.items()
            }
    assert ResultView(stored).curves == ResultView(expected).curves


def test_xarray_reads_it_chunk_by_chunk(folder: Path) -> None:
    with xr.open_zarr(folder / "out.zarr") as stored, xr.open_dataset(folder / "out.nc") as expected:
        assert stored.force.chunks is not None
        assert stored.chunks.keys() == stored.sizes.keys()  # which needs those of all variables to agree
        assert set(stored.coords) == set(expected.coords)
        for name in expected.data_vars:
            if name != "run_time":
                np.testing.assert_array_equal(stored[name], expected[name])
        np.testing.assert_array_equal(stored.roughmdr.pull_off().force, expected.roughmdr.pull_off().force)
        cell = {"asperities_placement": "square", "adhesion_work": 0.05}
        one = [each.sel(cell).roughmdr.at_force(1e-5).separation for each in (stored, expected)]
        np.testing.assert_array_equal(*one)


@pytest.mark.parametrize(
    "command",
    [
        "info {}",
        large("info {} --cells --json"),
        large("plan {}"),
        large("cite {}"),
        large("plot {} -o picture.svg --fresh"),
        large("report {} -o page.html --fresh"),
    ],
)
def test_commands_read_it(folder: Path, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    done, expected = (CliRunner().invoke(main, command.format(name).split()) for name in ("out.zarr", "out.nc"))
    assert done.exit_code == expected.exit_code == 0, done.output
    lines = [each.output.replace("out.zarr", "out.nc").splitlines() for each in (done, expected)]
    assert len(lines[0]) == len(lines[1])


@pytest.mark.large
def test_a_run_goes_on_from_it(tmp_path: Path) -> None:
    table = scene(batch={"realizations": 3})
    rm.run(table, tmp_path / "out.zarr")
    more = scene(batch={"realizations": 5})
    again, once = rm.run(more, tmp_path / "out.zarr"), rm.run(more, tmp_path / "out.nc")
    np.testing.assert_array_equal(again.force, once.force)
    np.testing.assert_array_equal(read_result(tmp_path / "out.zarr").variables["force"].values, once.force)
    with pytest.raises(rm.StoreError, match="holds results of another scene: seed was 7, is 8"):
        rm.run(scene(seed=8), tmp_path / "out.zarr")
    assert {path.name for path in tmp_path.iterdir()} == {"out.nc", "out.zarr"}


@pytest.mark.few(1)
@pytest.mark.parametrize("mine", ["notes.txt", "figures/one.png"])
def test_what_else_lies_in_it_is_not_lost(tmp_path: Path, mine: str) -> None:
    out = tmp_path / "out.zarr"
    rm.run(scene(), out)
    with pytest.raises(rm.StoreError, match=r"out\.zarr is a Zarr store; the output must be outside of it"):
        rm.run(scene(), out / "other.zarr")
    (out / mine).parent.mkdir(exist_ok=True)
    (out / mine).write_text("kept")
    with pytest.raises(rm.StoreError, match=rf"holds {mine[:5]}\w*(\.txt)?, which is no part of it and would be lost"):
        rm.run(scene(batch={"realizations": 17}), out)
    assert (out / mine).read_text() == "kept"


def test_its_size_is_that_of_all_its_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    told = json.loads(CliRunner().invoke(main, ["info", "out.zarr", "--json"]).output)
    sizes = [each.stat().st_size for each in (folder / "out.zarr").rglob("*") if each.is_file()]
    assert told["result"]["file_size"] == sum(sizes) > max(sizes)


def test_a_folder_that_is_no_store_is_told(tmp_path: Path) -> None:
    (tmp_path / "out.zarr").mkdir()
    with pytest.raises(rm.StoreError, match=r"out\.zarr: is no Zarr store: it has no zarr\.json"):
        read_result(tmp_path / "out.zarr")


@pytest.mark.large
def test_what_a_killed_writer_left_is_in_nobodys_way(tmp_path: Path) -> None:
    left = tmp_path / "out.zarr.parts" / ".roughmdr.x.tmp"
    (left / "force").mkdir(parents=True)
    (left / "force" / "zarr.json").write_text("{")
    rm.run(scene(), tmp_path / "out.zarr")
    (tmp_path / "out.zarr").rename(files.before_of(tmp_path / "out.zarr"))  # killed where no names can be exchanged
    rm.run(scene(batch={"realizations": 17}), tmp_path / "out.zarr")
    assert read_result(tmp_path / "out.zarr").sizes["realization"] == 17
    assert [path.name for path in tmp_path.iterdir()] == ["out.zarr"]


@pytest.mark.large
@pytest.mark.parametrize("exchanges", [True, False])
def test_the_store_of_before_is_replaced_whole(
    tmp_path: Path, exchanges: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not exchanges:
        monkeypatch.setattr(files, "_exchange", lambda *_: False)
    rm.run(scene(path={"separation": [1e-6]}), tmp_path / "out.zarr")
    before = read_result(tmp_path / "out.zarr")
    other = rm.run(scene(adhesion={"model": "jkr", "work": 0.05}), tmp_path / "out.zarr", resume=False)
    found = read_result(tmp_path / "out.zarr")
    assert found.checksum() == Labelled.of(other).checksum() != before.checksum()
    assert [path.name for path in tmp_path.iterdir()] == ["out.zarr"]


@pytest.mark.large
def test_if_it_cannot_be_written_the_one_of_before_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rm.run(scene(), tmp_path / "out.zarr")
    before = read_result(tmp_path / "out.zarr").checksum()

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    rename = Path.rename

    def only_away(self: Path, target: Path) -> Path:
        return full() if self.name.endswith(".tmp") else rename(self, target)

    for where, name, broken in ((zarr_store, "write_arrays", full), (Path, "rename", only_away)):
        with monkeypatch.context() as patched:
            patched.setattr(files, "_exchange", lambda *_: False)
            patched.setattr(where, name, broken)
            with pytest.raises(rm.RoughmdrError, match=r"out\.zarr: cannot be written: No space left on device"):
                rm.run(scene(seed=9), tmp_path / "out.zarr", resume=False)
        assert read_result(tmp_path / "out.zarr").checksum() == before


def test_no_bit_of_any_number_is_lost(tmp_path: Path) -> None:
    bits = np.array([[-np.nan, np.nan], [-0.0, 5e-324]])
    odd = Labelled({"force": Array(("step", "x"), bits, {}), "none": Array(("x",), bits[0] * -1.0, {})}, {}, {})
    zarr_store.write_zarr(odd, tmp_path / "odd.zarr")
    found = zarr_store.read_zarr(tmp_path / "odd.zarr").variables
    for name, array in odd.variables.items():
        assert found[name].values.tobytes() == array.values.tobytes()


@pytest.mark.parametrize("there", ["file", "folder", "empty"])
def test_what_is_no_store_is_not_replaced(tmp_path: Path, there: str) -> None:
    out = tmp_path / "out.zarr"
    if there == "file":
        out.write_text("mine")
    else:
        out.mkdir()
    if there == "folder":
        (out / "mine").write_text("mine")
    for resume in (True, False):
        with pytest.raises(
            rm.StoreError, match=r"out\.zarr: is no Zarr store; the output must be one, or not be there"
        ):
            rm.run(scene(), out, resume=resume)
    with pytest.raises(rm.StoreError, match=r"out\.zarr: (is no Zarr store: it has no zarr|not a netCDF file)"):
        read_result(out)
    assert there == "empty" or (out if there == "file" else out / "mine").read_text() == "mine"


def test_without_the_package_it_is_told_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(rm.StoreError, match=r"out\.zarr: Zarr stores need the package zarr, 3\.0 or newer"):
        rm.run(scene(), tmp_path / "out.zarr")
    assert not list(tmp_path.iterdir())


def test_damage_is_told(tmp_path: Path) -> None:
    rm.run(scene(), tmp_path / "out.zarr")
    metadata = tmp_path / "out.zarr" / "zarr.json"
    table = json.loads(metadata.read_text())
    chunk = next(path for path in (tmp_path / "out.zarr" / "force" / "c").rglob("*") if path.is_file())
    content = chunk.read_bytes()
    chunk.write_bytes(content[:-8])
    with pytest.raises(rm.StoreError, match=r"out\.zarr: not a Zarr store that can be read"):
        read_result(tmp_path / "out.zarr")
    chunk.unlink()  # the values of a missing chunk are not known
    with pytest.raises(rm.StoreError, match="force is not finite, and status says that it was computed"):
        read_result(tmp_path / "out.zarr")
    chunk.write_bytes(content)
    shorter = Labelled.of(xr.open_zarr(tmp_path / "out.zarr").load())
    status = shorter.variables["status"]
    shorter.variables["status"] = status._replace(values=status.values[:1])
    zarr_store.write_zarr(shorter, tmp_path / "shorter.zarr")
    with pytest.raises(rm.StoreError, match="status has another number of realization than other arrays"):
        read_result(tmp_path / "shorter.zarr")
    table["attributes"]["checksum"] = "0"
    metadata.write_text(json.dumps(table))
    assert read_result(tmp_path / "out.zarr").integrity_fault() == "its numbers are not those that were written"
    metadata.write_text("{}")
    with pytest.raises(rm.StoreError, match=r"out\.zarr: not a result as roughmdr writes it: it has no title"):
        read_result(tmp_path / "out.zarr")


@pytest.mark.large
@settings(deadline=None)
@given(st.lists(st.integers(1, 2000), max_size=4))
def test_chunks_are_small_and_cover_all_once(shape: list[int]) -> None:
    chunks = chunks_of(tuple(shape), zarr_store._CHUNK_SIZE)
    assert np.prod(chunks, dtype=float) <= zarr_store._CHUNK_SIZE
    counts = [-(-size // chunk) for size, chunk in zip(shape, chunks, strict=True)]
    if np.prod(counts, dtype=float) < 1e4:
        found = list(blocks(tuple(shape), chunks))
        assert len(set(map(str, found))) == len(found) == np.prod(counts)
        whole = np.broadcast_to(0.0, shape)
        assert sum(whole[block].size for block in found) == whole.size


@pytest.mark.large
@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_large_curves_take_little_memory(tmp_path: Path, ending: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Computed, extended and read; the numbers are those of a run in memory."""
    asperities = {**scene()["asperities"], "count": 3}
    path = {"separation": {"start": "3 um", "stop": "0 um", "steps": 2000}}
    tables = [scene(asperities=asperities, path=path, batch={"realizations": runs}) for runs in (150, 300)]
    expected = rm.run(tables[1])
    size = sum(each.nbytes for each in expected.data_vars.values())
    monkeypatch.setattr(room, "IN_MEMORY", 2**19)
    monkeypatch.setattr("roughmdr.batch.tasks.IN_MEMORY", 2**19)
    for module in ("resume.find", "moments"):
        monkeypatch.setattr(f"roughmdr.batch.{module}._AT_ONCE", 2**14)
    out = tmp_path / f"out.{ending}"
    rm.run(scene(), tmp_path / f"first.{ending}")  # with all that is imported
    tracemalloc.start()
    try:
        for table in tables:
            rm.run(table, out)
        found = read_result(out)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert size > 1.8e7
    assert peak < size  # in memory there are two copies; here finished runs wait for the disk, at most 0.76 seen
    for name in ("force", "contact_area", "stiffness"):
        np.testing.assert_array_equal(found.variables[name].values, expected[name])
    assert {each.name for each in tmp_path.iterdir()} == {out.name, f"first.{ending}"}


def test_without_space_on_the_disk_curves_stay_in_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rm.run(scene(), tmp_path / "out.nc")
    expected = read_result(tmp_path / "out.nc").checksum()

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(room, "IN_MEMORY", 0)
    monkeypatch.setattr("os.posix_fallocate", full)
    assert read_result(tmp_path / "out.nc").checksum() == expected
    monkeypatch.setattr("roughmdr.storage.memory.available_memory", lambda: (10.0, "the 10 B of this machine"))
    with pytest.raises(rm.StoreError, match=r"takes about .* of memory, with 10 B left"):
        read_result(tmp_path / "out.nc")
