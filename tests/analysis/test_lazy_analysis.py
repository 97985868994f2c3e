"""Nothing of a file that is opened in chunks is computed before it is asked for; then the bits are the same."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from dask.callbacks import Callback
from scenes import ASPERITIES, scene

import roughmdr as rm

_CALLS: dict[str, Callable[[Any], xr.Dataset]] = {
    "pull_off": lambda of: of.pull_off(),
    "hysteresis": lambda of: of.hysteresis(),
    "at_force": lambda of: of.at_force([1e-4, 3e-4], branch="unloading"),
    "at_pressure": lambda of: of.at_pressure("100 Pa"),
    "at_contact_fraction": lambda of: of.at_contact_fraction(0.01),
    "at_separation": lambda of: of.at_separation(["2 um", "3 um"]),
    "normalise": lambda of: of.normalise("gw"),
    "fit_power_law": lambda of: of.fit_power_law("stiffness", "force"),
    "statistics": lambda of: of.statistics(),
    "trust": lambda of: of.trust(),
}


class NoCurve(Callback):
    """Fails where something over both swept keys, realisations and steps is loaded."""

    def _posttask(self, key: Any, result: Any, dsk: Any, state: Any, worker_id: Any) -> None:
        assert np.ndim(result) < 4, f"{key} was loaded"


@pytest.fixture(scope="module")
def opened(curves: xr.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Iterator[xr.Dataset]:
    path = tmp_path_factory.mktemp("lazy") / "out.nc"
    curves.to_netcdf(path)
    with xr.open_dataset(path, chunks={"realization": 2, "step": 50}) as dataset:
        yield dataset


@pytest.mark.few(1)
@pytest.mark.parametrize("method", _CALLS)
def test_it_stays_lazy_and_computes_to_the_same_bits(method: str, curves: xr.Dataset, opened: xr.Dataset) -> None:
    call = _CALLS[method]
    with NoCurve():
        lazy = call(opened.roughmdr)
        repr(opened.roughmdr)
    if method not in ("pull_off", "trust"):
        assert any(array.chunks is not None for array in lazy.data_vars.values())
    eager, computed = call(curves.roughmdr), lazy.compute()
    assert list(eager.data_vars) == list(computed.data_vars)
    for name in eager.data_vars:
        np.testing.assert_array_equal(computed[name].values, eager[name].values, err_msg=str(name))
        assert computed[name].attrs.keys() == eager[name].attrs.keys()


def test_contacts_that_yield_are_read_in_chunks_too() -> None:
    path = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 20}, "unload": True}
    sections = {"asperities": {**ASPERITIES, "count": 100}, "plasticity": {"yield_strength": "50 MPa"}}
    result = rm.run(scene(path=path, adhesion=None, batch={"realizations": 2}, **sections))
    read = result.chunk(realization=1, step=7).roughmdr.at_force("20 uN", branch="unloading")
    assert read.stiffness.chunks is not None
    xr.testing.assert_identical(read.compute(), result.roughmdr.at_force("20 uN", branch="unloading"))


_MEASURE = """
import sys
import roughmdr, xarray, dask.array
from scipy import special
from roughmdr.analysis import accessor, statistics, hysteresis, power_law
from roughmdr.result import interpolation
from roughmdr.storage.memory import peak_memory
with xarray.open_dataset(sys.argv[1], chunks={"realization": 500}) as result:
    of = result.roughmdr
    for found in (of.at_force([1e-5, 1e-4]), of.statistics(), of.hysteresis(), of.fit_power_law("stiffness", "force")):
        found.compute(scheduler="threads", num_workers=2)
print(peak_memory() / 1e9)
"""


@pytest.mark.large
def test_ten_thousand_curves_take_less_than_a_gigabyte(tmp_path: Path) -> None:
    path = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 200}, "unload": True}
    few = rm.run(scene(path=path, batch={"realizations": 100}))
    few.isel(realization=np.tile(np.arange(100), 100)).to_netcdf(tmp_path / "many.nc")
    done = subprocess.run(
        [sys.executable, "-c", _MEASURE, str(tmp_path / "many.nc")], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) < 1.0  # GB
