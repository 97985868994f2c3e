"""Progress of a running batch as it is shown: counts, and the steps of long runs."""

import threading
import time

import numpy as np
import pytest
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.numerics import underway
from roughmdr.numerics.underway import each_step, filling, steps_done
from roughmdr.runner import progress

_PATIENCE = 60.0  # seconds, on a busy machine


def wait_for(text: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Wait until a text is printed on the standard error stream, and return all that is."""
    said, began = "", time.monotonic()
    while text not in said and time.monotonic() - began < _PATIENCE:
        said += capsys.readouterr().err
        time.sleep(0.01)
    assert text in said
    return said


def test_a_run_that_lasts_tells_its_steps(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Before any run is done, and without a line where nothing has changed."""
    monkeypatch.setattr(progress, "_SECONDS_BETWEEN_LINES", 0.01)
    with progress.progress("A batch", quiet=False) as display:
        display.add(total=2)
        for step in each_step(range(40)):
            if step == 7:
                said = wait_for("A batch: 0 of 2 runs; step 7 of 40\n", capsys)
                assert said.count("step 7 of 40") == 1
        display.add(done=1)
        said = wait_for("A batch: 1 of 2 runs\n", capsys)
    assert capsys.readouterr().err.splitlines()[-1:] == ["A batch: 1 of 2 runs"]
    assert not [thread for thread in threading.enumerate() if thread.name == "roughmdr-progress"]


def test_steps_of_parts_and_of_compiled_loops_are_those_of_their_thread() -> None:
    seen, values = [], np.zeros(5)
    for _ in each_step("ab"):
        with filling(values):
            values[:3] = 1.0
            seen.append(steps_done())
    assert seen == [[(3, 5)]] * 2
    for _ in each_step("abc"):
        for _ in each_step("xyz"):
            pass
        seen.append(steps_done())
    assert seen[2:] == [[(0, 3)], [(1, 3)], [(2, 3)]]
    assert steps_done() == []


def test_a_part_that_outlives_its_whole_leaves_nothing() -> None:
    """A loop that is left is closed when it is collected, perhaps after the one around it."""
    whole, part = each_step("ab"), each_step("xyz")
    next(whole)
    next(part)
    whole.close()  # type: ignore[attr-defined]
    assert steps_done() == [(0, 3)]
    part.close()  # type: ignore[attr-defined]
    assert steps_done() == []


@pytest.mark.parametrize("changes", [
    {"path": {"preload": "0.1 mN", "machine_stiffness": "100 N/m", "steps": 9, "unload": True}},
    {"interaction": {"model": "pairwise"}, "adhesion": None},
    {"interaction": {"model": "pairwise"}},
], ids=["machine", "pairs", "adhesive pairs"])  # fmt: skip
def test_runs_that_may_last_note_their_steps(changes: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    noted, note = list[int](), underway._Computation

    def noting(done: object, steps: int) -> object:
        noted.append(steps)
        return note(done, steps)  # type: ignore[arg-type]

    monkeypatch.setattr(underway, "_Computation", noting)
    asperities = {**ASPERITIES, "count": 20, "patch": "1 mm"}
    rm.run(scene(asperities=asperities, batch=None, path={"separation": ["2 um", "1 um", "0 um"]}) | changes)
    assert noted
    assert max(noted) >= 3
