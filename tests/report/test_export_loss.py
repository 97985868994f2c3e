"""Energy lost over the overclosure that loops reach: against other paths, finer ones, and the jumps' own account."""

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from command import roughmdr
from exports import header_of, of_csv, of_json
from scenes import scene

import roughmdr as rm

FAR = 6.0
STOPS = [1.0, 0.5, 0.0]


def swept() -> dict[str, Any]:
    path = {"separation": {"start": f"{FAR} sigma", "stop": "0 sigma", "steps": 120}, "unload": True}
    sweep = {"path.separation.stop": [f"{stop} sigma" for stop in STOPS]}
    return scene(path=path, batch={"estimator": "expected"}, sweep=sweep)


def through(*turns: float, steps: int = 120) -> dict[str, Any]:
    """A path with each turning point once."""
    legs = [np.linspace(begin, end, steps)[1:] for begin, end in pairwise(turns)]
    return {"separation": [f"{each} sigma" for each in np.concatenate([turns[:1], *legs])]}


def looped(*depths: float) -> dict[str, Any]:
    return through(FAR, *(each for deep in depths for each in (deep, FAR)))


def losses(result: "xr.Dataset | Path", out: Path, **options: Any) -> pd.DataFrame:
    rm.export(result, out, to="csv", quantity="loss", **options)
    return of_csv(out)


def test_a_sweep_of_the_closest_separation_gives_a_row_each(tmp_path: Path) -> None:
    result = rm.run(swept(), tmp_path / "loops.nc")
    table = losses(result, tmp_path / "loss.csv")
    assert [*table] == [
        "overclosure [m]",
        "energy_lost [N m]",
        "energy_lost_error [N m]",
        "standard_error [N m]",
        "work_of_loading [N m]",
        "start [m]",
    ]
    own = result.isel(realization=0).roughmdr.hysteresis()
    np.testing.assert_allclose(table["overclosure [m]"], -result.separation.min("step"), rtol=1e-12)
    np.testing.assert_allclose(table["energy_lost [N m]"], own.energy_lost, rtol=1e-12)
    assert (table["energy_lost_error [N m]"] >= own.energy_lost_interpolation_error).all()
    np.testing.assert_allclose(table["start [m]"], -result.separation.max("step"), rtol=1e-12)
    np.testing.assert_allclose(table["work_of_loading [N m]"], own.work_of_loading, rtol=1e-12)
    assert np.isnan(table["standard_error [N m]"]).all()
    one = losses(result, tmp_path / "one.csv", select={"path.separation.stop": 0.5})
    np.testing.assert_array_equal(one.to_numpy()[:, [0, 1, 2, 4, 5]], table.to_numpy()[1:2, [0, 1, 2, 4, 5]])


@pytest.mark.large
def test_loops_of_one_path_lose_what_paths_of_their_own_do(tmp_path: Path) -> None:
    """So does the header of a table of forces, which tells the loss of each; what is not undone has none yet."""
    alone = losses(rm.run(swept()), tmp_path / "alone.csv")
    result = rm.run(scene(path=looped(*STOPS[::-1]), batch={"estimator": "expected"}))
    together = losses(result, tmp_path / "together.csv")
    names = [name for name in alone if not name.startswith("energy_lost_error")]
    np.testing.assert_allclose(together[names], alone[names], rtol=1e-6)
    half = rm.run(scene(path=through(FAR, 0.5, FAR, 0.0, 1.0), batch={"estimator": "expected"}))
    for name, each, lost in (
        ("all", result, alone["energy_lost [N m]"]),
        ("half", half, alone["energy_lost [N m]"][1:2]),
    ):
        rm.export(each, tmp_path / f"{name}.table", to="lammps", quantity="force", error=0.05, distance=10e-6)
        told = re.findall(r"(\S+) N m to \S+ m within \S+ \(loading takes", header_of(tmp_path / f"{name}.table"))
        np.testing.assert_allclose(np.sort([float(loss) for loss in told]), np.sort(lost), rtol=1e-3)


def test_the_stated_errors_hold_of_the_mean_of_realisations(tmp_path: Path) -> None:
    """The jumps dissipate what a loop loses."""
    path = {"separation": {"start": f"{FAR} sigma", "stop": "0 sigma", "steps": 120}, "unload": True}
    made = {"batch": {"realizations": 30}, "path": path, "output": {"variables": ["force", "dissipated_energy"]}}
    result = rm.run(scene(**made))
    (row,) = losses(result, tmp_path / "loss.csv").to_numpy()
    dissipated = result.dissipated_energy.isel(step=-1)
    assert abs(row[1] - float(dissipated.mean())) <= row[2]
    runs = result.roughmdr.hysteresis().energy_lost
    assert row[3] == pytest.approx(float(runs.std(ddof=1)) / 30**0.5, rel=1e-9)
    assert row[1] == pytest.approx(float(runs.mean()), rel=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("turns", "rows"),
    [
        ((2.0, 6.0, 0.0, 6.0), [(0.0, 6.0)]),  # up first
        ((6.0, 0.0, 2.0, 1.0, 2.0, 0.0, 6.0), [(1.0, 2.0), (0.0, 2.0)]),  # an inner loop, and on from there
        ((6.0, 0.0, 3.0, -0.5, 6.0), [(-0.5, 3.0)]),  # beyond where the loading began
        ((6.0, 1.0, 6.0 - 1e-14, 0.0, 6.0), [(1.0, 6.0), (0.0, 6.0)]),  # to roundings
    ],
)
def test_loops_of_any_path_hold_to_the_stated_error(
    tmp_path: Path, turns: tuple[float, ...], rows: list[tuple[float, float]]
) -> None:
    """A loop closes in separation; energy that contacts hold at its ends is within the error."""
    expected = {"batch": {"estimator": "expected"}}
    found = losses(rm.run(scene(**expected, path=through(*turns, steps=60))), tmp_path / "coarse.csv").to_numpy()
    fine = losses(rm.run(scene(**expected, path=through(*turns, steps=591))), tmp_path / "fine.csv").to_numpy()
    np.testing.assert_allclose(-found[:, [0, 5]] / 1e-6, rows, atol=1e-9)
    assert (np.abs(found[:, 1] - fine[:, 1]) <= found[:, 2]).all()
    for row, (closest, start) in zip(found, rows, strict=True):
        if start == FAR:
            result = rm.run(scene(**expected, path=through(start, closest, start, steps=591)))
            assert abs(row[1] - result.roughmdr.hysteresis().energy_lost.item()) <= row[2]


def test_what_contacts_hold_at_the_ends_is_in_the_error(tmp_path: Path) -> None:
    path = {"separation": {"start": "2 sigma", "stop": "0 sigma", "steps": 60}, "unload": True}
    made = {"batch": {"realizations": 4}, "path": path, "output": {"variables": ["force", "dissipated_energy"]}}
    result = rm.run(scene(**made))
    (row,) = losses(result, tmp_path / "in.csv").to_numpy()
    missed = abs(row[1] - float(result.dissipated_energy.isel(step=-1).mean()))
    assert 0.05 * row[1] < missed <= row[2]


def test_ends_of_the_path_are_swept_in_any_form(tmp_path: Path) -> None:
    path = {"separation": {"start": "6 sigma", "stop": {"contact_fraction": 0.01}, "steps": 60}, "unload": True}
    sweep = {"path.separation.stop.contact_fraction": [0.01, 0.02]}
    table = losses(rm.run(scene(path=path, batch={"estimator": "expected"}, sweep=sweep)), tmp_path / "f.csv")
    assert table["energy_lost [N m]"].is_monotonic_increasing
    path = {"separation": {"start": "6 sigma", "stop": "0 sigma", "steps": 60}, "unload": True}
    zipped = {
        "mode": "zip",
        "path.separation.start": ["6 sigma", "5 sigma"],
        "path.separation.stop": ["1 sigma", "0 sigma"],
    }
    table = losses(rm.run(scene(path=path, batch={"estimator": "expected"}, sweep=zipped)), tmp_path / "z.csv")
    np.testing.assert_allclose(table["start [m]"], [-6e-6, -5e-6])


def test_units_formats_and_the_command(tmp_path: Path) -> None:
    rm.run(swept(), tmp_path / "loops.nc")
    si = losses(tmp_path / "loops.nc", tmp_path / "si.csv")
    told = roughmdr(
        *("export", tmp_path / "loops.nc", "-o", tmp_path / "um.json", "--to", "json"),
        *("--quantity", "loss", "--units", "um,nN,kPa"),
    )
    assert "points       3 loops" in told.stdout
    table = of_json(tmp_path / "um.json")
    assert table["units"]["energy_lost"] == "nN um"
    np.testing.assert_allclose(table["columns"]["energy_lost"], si["energy_lost [N m]"] / 1e-15, rtol=1e-12)
    np.testing.assert_allclose(table["columns"]["overclosure"], si["overclosure [m]"] / 1e-6, rtol=1e-12)
    assert "energy_lost_error is by the steps, jumps included" in header_of(tmp_path / "si.csv")


def test_a_cell_that_was_not_computed_is_shown_as_unknown(tmp_path: Path) -> None:
    result = rm.run(swept())
    whole = losses(result, tmp_path / "whole.csv").to_numpy()
    result.force[1], result.status[1] = np.nan, 2
    table = losses(result, tmp_path / "missing.csv").to_numpy()
    np.testing.assert_array_equal(table[[0, 2]], whole[[0, 2]])
    np.testing.assert_array_equal(table[1, [0, 5]], whole[1, [0, 5]])
    assert np.isnan(table[1, 1:5]).all()
    result.force[:], result.status[:] = np.nan, 2
    with pytest.raises(rm.StoreError, match="the force is not known at all steps of any loop"):
        losses(result, tmp_path / "none.csv")


def test_cells_with_other_numbers_of_runs_are_told(tmp_path: Path) -> None:
    sweep = {"path.separation.stop": ["1 sigma", "0 sigma"]}
    path = {"separation": {"start": f"{FAR} sigma", "stop": "0 sigma", "steps": 20}, "unload": True}
    result = rm.run(scene(path=path, sweep=sweep, batch={"realizations": 3}))
    result.force[1, 2], result.status[1, 2] = np.nan, 2
    assert np.isfinite(losses(result, tmp_path / "loss.csv").to_numpy()).all()
    assert "law: mean of 2 to 3 realisations" in header_of(tmp_path / "loss.csv")
    result.force[0], result.status[0] = np.nan, 2
    losses(result, tmp_path / "loss.csv")
    assert "law: mean of 2 realisations" in header_of(tmp_path / "loss.csv")


def test_a_loop_of_few_steps_has_no_known_error(tmp_path: Path) -> None:
    found = losses(rm.run(scene(path=through(FAR, 0.0, FAR, steps=3), batch={"realizations": 1})), tmp_path / "l.csv")
    assert np.isnan(found["energy_lost_error [N m]"]).all()
    assert np.isfinite(found["energy_lost [N m]"]).all()


def test_contacts_that_yield_remember_loops_before(tmp_path: Path) -> None:
    yields = {"adhesion": None, "plasticity": {"yield_strength": "50 kPa"}, "batch": {"realizations": 2}}
    made = rm.run(scene(**yields, path=looped(1.0, 1.0)))
    first, again = losses(made, tmp_path / "twice.csv")["energy_lost [N m]"]
    assert first > 0.0
    assert again <= 1e-9 * first
    assert "memory: contacts yield: of several loops of one path" in header_of(tmp_path / "twice.csv")


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"path": {"separation": ["3 um", "2 um"]}}, "no unloading of the path goes back to where its loading began"),
        (
            {"path": {"separation": ["3 um", "2 um", "2.5 um"]}},
            "no unloading of the path goes back to where its loading began",
        ),
        ({"path": {"force": {"start": "0 N", "stop": "1 mN", "steps": 3}, "unload": True}}, "over the separation; run"),
        ({"sweep": {"adhesion.work": ["10 mJ/m^2", "20 mJ/m^2"]}}, "has 2 cells, over adhesion_work: select one"),
        ({"output": {"variables": ["contact_area"]}}, "needs the force over the separation"),
    ],
)
def test_what_has_no_loop_is_refused(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    path = {"separation": {"start": "3 um", "stop": "2 um", "steps": 4}, "unload": True}
    result = rm.run(scene(**{"path": path, "batch": {"realizations": 1}} | changes))
    with pytest.raises(rm.StoreError, match=says):
        losses(result, tmp_path / "none.csv")


def test_codes_and_a_branch_are_refused(tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match="lammps has no table of quantity 'loss'; csv, json have"):
        rm.export("none.nc", tmp_path / "none.table", to="lammps", quantity="loss")
    with pytest.raises(rm.StoreError, match="branch is 'unloading'; a loss is that of a loading and"):
        rm.export("none.nc", tmp_path / "none.csv", to="csv", quantity="loss", branch="unloading")
    with pytest.raises(rm.StoreError, match=re.escape("error is 0.01; a loss is a row for each loop")):
        rm.export("none.nc", tmp_path / "none.csv", to="csv", quantity="loss", error=0.01)
