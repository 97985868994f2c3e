"""Work on a height map in blocks takes little memory, and the size of the blocks makes no difference."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from forms import large
from hypothesis import given, settings, strategies as st

import roughmdr as rm
from roughmdr.ensemble.maps import height_map
from roughmdr.ensemble.maps.detrend import remove_short_waves, remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap, map_statistics
from roughmdr.ensemble.maps.summits import find_summits

POINTS = 1024


@pytest.fixture(scope="module")
def maps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files with one and the same waves, some of them with gaps."""
    folder = tmp_path_factory.mktemp("maps")
    along = 2.0 * np.pi * np.arange(POINTS) / 32.0
    height = 1e-7 * np.outer(np.cos(along), np.cos(along + 1.0))
    np.save(folder / "whole.npy", height)
    np.savez(folder / "whole.npz", height=height)
    at = (np.arange(POINTS) + 0.5) * 1e-8
    for name, dims in (("whole.nc", ("x", "y")), ("turned.nc", ("y", "x"))):
        xr.Dataset({"height": (dims, height)}, coords={"x": at, "y": at}).to_netcdf(folder / name)
    height[100:104, 200:300] = np.nan
    np.save(folder / "gaps.npy", height)
    data = xr.Dataset({"height": (("x", "y"), height)}, coords={"x": at, "y": at})
    packed = {"dtype": "int32", "scale_factor": 1e-16, "_FillValue": -(2**31), "zlib": True, "chunksizes": (60, 500)}
    data.to_netcdf(folder / "packed.nc", encoding={"height": packed})
    return folder


@pytest.mark.large
@pytest.mark.parametrize(
    ("name", "keys", "most"),
    [
        ("whole.npy", {}, 1.5),
        large("whole.npz", {}, 1.5),
        ("whole.nc", {}, 1.5),
        large("turned.nc", {}, 1.5),
        large("gaps.npy", {}, 1.5),
        large("packed.nc", {}, 1.5),
        large("whole.npy", {"periodic": True}, 1.5),
        large("whole.npy", {"cutoff": "60 nm"}, 1.5),
        large("whole.npy", {"cutoff": "60 nm", "periodic": True}, 2.0),
        large("gaps.npy", {"cutoff": "60 nm"}, 2.5),
    ],
)
def test_a_map_takes_little_extra_memory(
    maps: Path, name: str, keys: dict[str, object], most: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    section = {"source": "surface", "file": str(maps / name), **({} if ".nc" in name else {"size": "10.24 um"}), **keys}
    first = rm.generate(section, seed=0)  # and all that is imported for it
    monkeypatch.setattr(height_map, "BLOCK_SIZE", 2**14)
    tracemalloc.start()
    try:
        again = rm.generate(section, seed=0)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < most * 8 * POINTS**2
    assert again.sizes == first.sizes
    np.testing.assert_allclose(again.height, first.height, rtol=1e-12)


@pytest.mark.large
@given(rows=st.integers(1, 10**5), columns=st.integers(1, 10**8), together=st.integers(1, 10**4))
def test_blocks_are_all_rows_in_turn(rows: int, columns: int, together: int) -> None:
    parts = list(height_map.blocks(rows, columns, together))
    assert [row for part in parts for row in (part.start, part.stop)][1:-1:2] == [part.start for part in parts[1:]]
    assert (parts[0].start, parts[-1].stop) == (0, rows)
    for part in parts:
        assert part.start % together == 0
        assert (part.stop - part.start - together) * columns < height_map.BLOCK_SIZE


@settings(deadline=None, max_examples=60)
@given(
    shape=st.tuples(st.integers(3, 40), st.integers(3, 40)),
    together=st.integers(1, 500),
    periodic=st.booleans(),
    share=st.sampled_from([0.0, 0.05]),
    seed=st.integers(0, 10**6),
)
def test_the_block_size_makes_no_difference(
    shape: tuple[int, int], together: int, periodic: bool, share: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    rough = rng.normal(size=shape)
    rough[rng.random(shape) < (0.0 if periodic else share)] = np.nan
    if np.isfinite(rough).sum() < 9:
        return
    found = []
    for size in (2**20, together):
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(height_map, "BLOCK_SIZE", size)
            surface = HeightMap(rough.copy(), 0.5, 0.7, periodic)
            try:
                summits = find_summits(surface)
                columns = [summits.height, *summits.parameters.values(), *summits.positions.values()]
                bits = [column.tobytes() for column in columns], summits.attrs["saddles"], summits.nominal_area
            except rm.SceneError as error:
                bits = str(error)
            numbers = map_statistics(surface)
            remove_trend(surface.height, "quadratic")
            if 2 * 0.7 <= 1.5 <= min(shape[0] * 0.5, shape[1] * 0.7):
                remove_short_waves(surface, 1.5)
            found.append((bits, numbers, surface.height))
    (bits, numbers, height), (other_bits, other_numbers, other) = found
    assert other_bits == bits
    assert other_numbers == pytest.approx(numbers, rel=1e-12, abs=0.0)
    np.testing.assert_allclose(other, height, atol=1e-13)
