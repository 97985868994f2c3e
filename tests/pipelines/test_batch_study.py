"""The study of the batch engine in its quick form: what it counts, never what it times."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scenes import scene

from roughmdr.scene import read

SCRIPT = Path(__file__).parents[2] / "pipelines" / "study.py"
MEGABYTE = 1e6


@pytest.mark.large
def test_the_batch_study_in_its_quick_form(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, SCRIPT, "batch", "-o", tmp_path, "--quick"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["batch.nc"]
    with xr.open_dataset(tmp_path / "batch.nc") as result:
        assert result.cell_runs == result.attrs["cells"]
        assert set(result.scheduler.to_numpy()) == {"threads", "processes", "distributed"}
        assert np.isfinite(result.task_overhead).all()
        assert result.attrs["large_runs"] == 1_000_000
        few, many = result.realizations.to_numpy()
        growth = float(result.peak_memory.sel(realizations=many) - result.peak_memory.sel(realizations=few))
        assert growth < 50.0 * MEGABYTE, f"{many - few} more realisations"
        assert (result.peak_memory < 500.0 * MEGABYTE).all()
        assert 40.0 < result.asperity_memory < 400.0
    assert "extrapolated" in done.stdout


def test_cells_with_the_same_swept_values_have_their_sections_in_common() -> None:
    swept = {"adhesion.work": [0.01, 0.02, 0.03], "asperities.radius": ["40 um", "50 um"]}
    cells = read(scene(adhesion={"model": "jkr"}, sweep=swept)).cells
    assert len({id(cell.adhesion) for cell in cells}) == 3
    assert len({id(cell.asperities) for cell in cells}) == 2
    assert len({id(cell.path) for cell in cells}) == 1
    assert [cell.work for cell in cells] == [0.01, 0.01, 0.02, 0.02, 0.03, 0.03]
