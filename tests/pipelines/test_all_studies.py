"""The report of all studies: how long each took, what its reduced form leaves out, and which failed."""

from pathlib import Path

import pytest
import study
import xarray as xr
from click.testing import CliRunner
from studies.left_out import STUDY
from study import MODULES, Done, main


def reported(monkeypatch: pytest.MonkeyPatch, folder: Path, *options: str) -> list[str]:
    """Run two studies, of which the first is not there, and return the lines of the report."""
    monkeypatch.setattr(study, "TOGETHER", ("no_such_study", "left_out"))
    done = CliRunner().invoke(main, ["all", "-o", str(folder), *options])
    assert done.exit_code == 1
    assert "failed: no_such_study" in done.output
    return (folder / "report.md").read_text().splitlines()


def test_times_and_what_is_left_out_stand_at_the_head(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def run(name: str, output: Path, quick: bool) -> Done:
        text = "## What leaving out saves\n\nReduced form: 6 of 144 cases.\n\nNothing.\n"
        if not quick:
            text = text.replace("Reduced form: 6 of 144 cases.\n\n", "")
        return Done(name, 3.4, text) if name == "left_out" else Done(name, 0.2, "")

    monkeypatch.setattr(study, "run", run)
    quick, full = (reported(monkeypatch, tmp_path, *options) for options in (["--quick"], []))
    assert quick[2] == "4 s, in reduced forms; `make studies-full` carries out all of each."
    assert quick[4:8] == [
        "| study | s | carried out |", "| --- | --- | --- |", "| no_such_study | 0 | failed |",
        "| left_out | 3 | 6 of 144 cases. |",
    ]  # fmt: skip
    assert quick.count("Reduced form: 6 of 144 cases.") == 1
    assert full[2] == "4 s, in full."
    assert full[7] == "| left_out | 3 | all |"
    assert full[9:16:2] == ["## no_such_study", "failed", "## What leaving out saves", "Nothing."]


@pytest.mark.large
def test_a_study_that_fails_keeps_no_other_from_the_report(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    report = reported(monkeypatch, tmp_path, "--quick")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["left_out.nc", "report.md"]
    assert f"Reduced form: {STUDY.reduced}." in report
    assert any(line.startswith("| no_such_study |") and line.endswith("| failed |") for line in report)
    with xr.open_dataset(tmp_path / "left_out.nc") as result:
        assert result.attrs["comment"] == f"Reduced form: {STUDY.reduced}."


@pytest.mark.parametrize("name", MODULES)
def test_every_study_says_what_its_reduced_form_leaves_out(name: str) -> None:
    assert study.study(name).name == name
    assert len(study.study(name).reduced) > 10


def test_every_module_with_a_study_is_named() -> None:
    folder = Path(study.__file__).parent
    holders = (path for path in folder.rglob("*.py") if "\nSTUDY = " in path.read_text())
    names = (path.parent if path.stem == "__init__" else path.with_suffix("") for path in holders)
    assert {".".join(path.relative_to(folder).parts) for path in names} == set(MODULES.values())
