"""Sizes that are foreseen: of files, and of memory as the system tells it."""

from pathlib import Path

import numpy as np
import pytest

from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.memory import _read_sizes, peak_memory
from roughmdr.storage.netcdf_store import max_file_size, write_netcdf


@pytest.mark.parametrize("count", [1, 5000])
@pytest.mark.parametrize("text", ["", "u", "µm of a remark that is longer than others"])
def test_a_file_is_no_larger_than_foreseen(tmp_path: Path, count: int, text: str) -> None:
    texts = np.array([f"{text}{k}" if text else "" for k in range(count)], dtype=object)
    data = Labelled({"force": Array(("step",), np.zeros(count), {})}, {"remark": Array(("step",), texts, {})}, {})
    write_netcdf(data, tmp_path / "file.nc")
    assert (
        (tmp_path / "file.nc").stat().st_size <= max_file_size(data) < 2**16 + 5 * (tmp_path / "file.nc").stat().st_size
    )


def test_sizes_of_the_system_are_in_bytes(tmp_path: Path) -> None:
    (tmp_path / "status").write_text("Name:\tpython\nVmHWM:\t    2000 kB\nThreads:\t3\n")
    assert _read_sizes(str(tmp_path / "status")) == {"VmHWM": 2_048_000.0}
    assert _read_sizes(str(tmp_path / "none")) == {}
    assert peak_memory() > 2**24  # of this interpreter with NumPy
