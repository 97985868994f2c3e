"""The diagnostic that CONTRIBUTING.md adds, as it stands there: two lines, and every result has it."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import interrupted
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch import tasks
from roughmdr.batch.resume.store import store_folder
from roughmdr.batch.task_result import merge_rows, row_of
from roughmdr.storage.result_file import read_result
from roughmdr.variables import DONE, FAILED, NOT_RUN, RUN_DIAGNOSTICS, Diagnostic

GUIDE = (Path(__file__).parent.parent.parent / "CONTRIBUTING.md").read_text()
DECLARED, COMPUTED = re.findall(
    r"```python\n(.*?)```", GUIDE[GUIDE.index("## A new diagnostic of a run") :], flags=re.DOTALL
)[:2]
RUNS = 9


def few(keep: str, **changes: Any) -> dict[str, Any]:
    asperities = {**ASPERITIES, "count": 30}
    path = {"separation": ["2 um", "1 um", "0 um"]}
    output = {"keep": keep, "variables": ["force"]}
    return scene(
        **{"asperities": asperities, "path": path, "output": output, "batch": {"realizations": RUNS}} | changes
    )


@pytest.fixture
def visit_count(monkeypatch: pytest.MonkeyPatch) -> Diagnostic:
    """The diagnostic of the guide."""
    declared = eval(DECLARED, {"Diagnostic": Diagnostic})
    diagnostics_of = tasks.diagnostics_of

    def more(result: Any, *others: Any) -> dict[str, object]:
        return diagnostics_of(result, *others) | eval(f"{{{COMPUTED}}}", {"result": result})

    monkeypatch.setitem(RUN_DIAGNOSTICS, declared.name, declared)
    monkeypatch.setattr(tasks, "diagnostics_of", more)
    return declared


@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_the_diagnostic_of_the_guide_is_in_every_result(
    visit_count: Diagnostic, keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, table = tmp_path / "out.nc", few(keep, sweep={"adhesion.work": [0.01, 0.05]})
    fresh = rm.run(table)
    assert fresh.visit_count.attrs == visit_count.attrs
    assert fresh.visit_count.dims == fresh.numerical_error.dims
    assert (fresh.visit_count > 0.0).all()
    if keep == "statistics":
        single = rm.run(few("curves", sweep={"adhesion.work": [0.01, 0.05]})).visit_count
        np.testing.assert_array_equal(fresh.visit_count, single.sum("realization"))
    interrupted(table, out, 4, monkeypatch)
    resumed = rm.run(table, out)
    assert not store_folder(out).exists()
    for found in (
        resumed,
        read_result(out).to_xarray(),
        xr.load_dataset(out),
        rm.run({**table, "title": "Another"}, out),
    ):
        np.testing.assert_array_equal(found.visit_count, fresh.visit_count)
    if keep == "curves":
        more = rm.run({**table, "batch": {"realizations": RUNS + 2}}, out).visit_count
        np.testing.assert_array_equal(more[:, :RUNS], fresh.visit_count)
        assert more.shape == (2, RUNS + 2)


def test_a_file_without_it_is_reused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    """Results and checkpoints from before the diagnostic was declared: there it is not known."""
    out, other, table = tmp_path / "out.nc", tmp_path / "other.nc", few("curves")
    rm.run(table, out)
    interrupted(table, other, 2, monkeypatch)
    request.getfixturevalue("visit_count")
    found = rm.run({**table, "batch": {"realizations": RUNS + 2}}, out)
    np.testing.assert_array_equal(found.visit_count.isnull(), [True] * RUNS + [False] * 2)
    resumed = rm.run(table, other)
    assert resumed.visit_count.isnull().sum() == 4
    np.testing.assert_array_equal(resumed.force, found.force[:RUNS])


def test_diagnostics_are_merged_as_declared() -> None:
    one = row_of(run_time=1.0, numerical_error=1e-9, edge_slope=0.1, status=DONE, tabor_number=5.0, adhesion_law=1)
    two = row_of(run_time=2.0, numerical_error=1e-8, edge_slope=0.2, status=DONE, tabor_number=3.0, adhesion_law=2)
    both = merge_rows([one, two | {"remark": "steep"}])
    assert (both["run_time"], both["numerical_error"], both["edge_slope"]) == (3.0, 1e-8, 0.2)
    assert (both["status"], both["tabor_number"], both["adhesion_law"], both["remark"]) == (DONE, 3.0, 2, "steep")
    failed = merge_rows([one, row_of(run_time=1.0, status=FAILED, remark="out of range")])
    assert (failed["status"], failed["remark"]) == (FAILED, "out of range")
    assert (failed["numerical_error"], failed["tabor_number"]) == (1e-9, 5.0)
    assert np.isnan(failed["edge_slope"])  # the largest is not known
    assert row_of()["status"] == NOT_RUN
    with pytest.raises(AssertionError, match="not declared in RUN_DIAGNOSTICS: visit_count"):
        row_of(visit_count=1.0)
