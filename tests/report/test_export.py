"""Exported tables: every format through a plain reader, the law that they hold, what is refused."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from command import roughmdr, said
from exports import header_of, of_abaqus, of_ansys, of_csv, of_json, of_moose
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.storage.labelled import Labelled

PRESSED = {"separation": {"start": "clear", "stop": "0.5 sigma", "steps": 120}, "unload": True}
FAR = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 120}, "unload": True}
DEEP = {"separation": {"start": "clear", "stop": "-0.5 sigma", "steps": 200}, "unload": True}
AREA = 1e-6  # area of the patch [m2]


def expected(**changes: Any) -> dict[str, Any]:
    return scene(**{"adhesion": None, "path": PRESSED, "batch": {"estimator": "expected"}} | changes)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exports")
    rm.run(expected(), folder / "hertz.nc")
    title = f"In ASCII {'界' * 80}\\"  # whose lines end in backslashes
    rm.run(expected(adhesion=scene()["adhesion"], path=DEEP, title=title), folder / "jkr.nc")
    return folder


def exported(file: Path, name: str, **options: Any) -> Path:
    rm.export(file, file.parent / name, **{"error": 5e-3} | options)
    return file.parent / name


def law_of(file: Path, branch: str) -> tuple[np.ndarray, np.ndarray]:
    """Separation and pressure of the steps of a branch."""
    with xr.open_dataset(file) as data:
        there = data.isel(step=np.flatnonzero(data.branch == branch), realization=0)
        return there.separation.to_numpy(), there.force.to_numpy() / AREA


@pytest.mark.parametrize("branch", ["loading", "unloading"])
def test_every_format_holds_the_same_table(files: Path, branch: str) -> None:
    options = {"units": "mm,N,MPa", "branch": branch}
    keyword, x, y = of_abaqus(exported(files / "hertz.nc", "a.inp", to="abaqus", **options))
    assert keyword == "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR"
    assert x[0] == y[0] == 0.0
    assert (np.diff(x) > 0.0).all()
    assert (np.diff(y) > 0.0).all()
    again, *calculix = of_abaqus(exported(files / "hertz.nc", "c.inp", to="calculix", **options))
    assert again == keyword
    kind, *moose = of_moose(exported(files / "hertz.nc", "m.i", to="moose", **options))
    assert kind == "PiecewiseLinear"
    primary, *ansys = of_ansys(exported(files / "hertz.nc", "m.mac", to="ansys", **options))
    assert primary == "GAP"
    frame = of_csv(exported(files / "hertz.nc", "t.csv", to="csv", **options))
    assert list(frame) == ["overclosure [mm]", "pressure [MPa]", "separation [mm]", "standard_error [MPa]"]
    document = of_json(exported(files / "hertz.nc", "t.json", to="json", **options))
    columns = [document["columns"][name] for name in ("overclosure", "pressure")]
    for found in (calculix, moose, ansys, [frame.iloc[:, 0], frame.iloc[:, 1]], columns):
        np.testing.assert_allclose(found, [x, y], rtol=1e-12)
    assert document["units"]["pressure"] == "MPa"


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["hertz", "jkr"])
@pytest.mark.parametrize("branch", ["loading", "unloading"])
def test_lines_between_the_points_are_the_law_within_the_error(files: Path, name: str, branch: str) -> None:
    """At the steps of the path and between them, where a finer run has the law."""
    error = 5e-3
    table = of_csv(exported(files / f"{name}.nc", "law.csv", to="csv", branch=branch, error=error))
    h, p = table["separation [m]"].to_numpy(), table["pressure [Pa]"].to_numpy()
    coarse = law_of(files / f"{name}.nc", "loading")[0]
    fine = np.sort(np.concatenate([coarse, 0.5 * (coarse[1:] + coarse[:-1]), 0.2 * coarse[1:] + 0.8 * coarse[:-1]]))
    path = {"separation": fine[::-1].tolist(), "unload": True}
    changes = {"adhesion": scene()["adhesion"]} if name == "jkr" else {}
    rm.run(expected(path=path, **changes), files / f"{name}-fine.nc", resume=False)
    separation, pressure = law_of(files / f"{name}-fine.nc", branch)
    within = (separation <= h[0]) & (separation >= h[-1])
    assert within.sum() > 150
    found = np.interp(-separation[within], -h, p)
    allowed = error * np.maximum(np.abs(pressure[within]), 0.1 * pressure.max())
    assert (np.abs(found - pressure[within]) <= allowed).all()
    assert len(table) < coarse.size / 2


def test_points_are_steps_of_the_path_and_the_datum_is_told(files: Path) -> None:
    table = of_csv(path := exported(files / "hertz.nc", "exact.csv", to="csv"))
    separation, pressure = law_of(files / "hertz.nc", "loading")
    law = dict(zip(separation.tolist(), pressure.tolist(), strict=True))
    rows = zip(table["separation [m]"], table["pressure [Pa]"], strict=True)
    next(rows)
    for h, p in rows:
        near = min(law, key=lambda each: abs(each - h))
        assert near == pytest.approx(h, rel=1e-14)
        assert law[near] == p
    datum = float(table["separation [m]"][0])
    np.testing.assert_allclose(table["overclosure [m]"], datum - table["separation [m]"], rtol=1e-12)
    header = header_of(path)
    for part in (f"overclosure is {datum:.15g} m minus", "A small scene", "expected law", "roughmdr 0", "model error"):
        assert part in header


def test_the_adhesive_unloading_goes_to_its_deepest_tension_where_a_table_can(files: Path) -> None:
    separation, pressure = law_of(files / "jkr.nc", "unloading")
    table = of_csv(exported(files / "jkr.nc", "off.csv", to="csv", branch="unloading"))
    found = table["pressure [Pa]"].to_numpy()
    assert found[0] == pressure.min() < 0.0
    assert table["separation [m]"][0] == pytest.approx(separation[pressure.argmin()], rel=1e-12)
    assert (np.diff(found) > 0.0).all()
    at_zero = np.interp(0.0, pressure[: pressure.argmin() + 1][::-1], separation[: pressure.argmin() + 1][::-1])
    zero = table["separation [m]"] + table["overclosure [m]"]
    np.testing.assert_allclose(zero, at_zero, rtol=1e-9)
    with pytest.warns(rm.LimitWarning, match="in tension up to"):
        _, x, y = of_abaqus(exported(files / "jkr.nc", "off.inp", to="abaqus", branch="unloading"))
    assert x[0] == y[0] == 0.0


def test_a_loading_begins_at_zero_pressure_and_says_which_tension_it_leaves_out(files: Path) -> None:
    _, pressure = law_of(files / "jkr.nc", "loading")
    with pytest.warns(rm.LimitWarning, match="in tension up to"):
        path = exported(files / "jkr.nc", "on.json", to="json")
    document = of_json(path)
    assert document["columns"]["pressure"][0] == 0.0
    assert "in tension up to" in document["header"]["warning"]
    assert pressure.min() < 0.0


def test_the_mean_of_realisations_with_its_standard_error(tmp_path: Path) -> None:
    for keep in ("curves", "statistics"):
        made = scene(adhesion=None, path=PRESSED, batch={"realizations": 8}, output={"keep": keep})
        rm.run(made, tmp_path / f"{keep}.nc")
    tables = [
        of_csv(exported(tmp_path / f"{keep}.nc", f"{keep}.csv", to="csv", error=1e-2))
        for keep in ("curves", "statistics")
    ]
    np.testing.assert_allclose(tables[0], tables[1], rtol=1e-12)
    with xr.open_dataset(tmp_path / "curves.nc") as data:
        force = data.force.isel(step=slice(0, 120))
        mean, error = force.mean("realization") / AREA, force.std("realization", ddof=1) / 8**0.5 / AREA
        last = tables[0].iloc[-1]
        assert last["pressure [Pa]"] == pytest.approx(float(mean[-1]), rel=1e-12)
        assert last["standard_error [Pa]"] == pytest.approx(float(error[-1]), rel=1e-9)
    assert "mean of 8 realisations" in header_of(tmp_path / "curves.csv")


@pytest.mark.few(1)
@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0])
def test_on_every_scale_the_table_is_the_same_in_its_own_units(size: float, tmp_path: Path) -> None:
    """Heights, radii and patch in proportion: pressures are the same, overclosures in proportion."""
    asperities = {
        **ASPERITIES,
        "patch": 1000.0 * size,
        "height": {"distribution": "normal", "std": size},
        "radius": {"distribution": "lognormal", "mean": 50.0 * size, "std": 5.0 * size},
    }
    path = {"separation": {"start": "clear", "stop": "0.5 sigma", "steps": 120}}
    rm.run(expected(asperities=asperities, path=path), tmp_path / "law.nc")
    table = of_csv(exported(tmp_path / "law.nc", "law.csv", to="csv"))
    micro = expected(path=path)
    rm.run(micro, tmp_path / "micro.nc")
    other = of_csv(exported(tmp_path / "micro.nc", "micro.csv", to="csv"))
    np.testing.assert_allclose(table["pressure [Pa]"], other["pressure [Pa]"], rtol=1e-7)
    np.testing.assert_allclose(table["overclosure [m]"] / size, other["overclosure [m]"] / 1e-6, rtol=1e-7, atol=1e-12)


def with_curve(file: Path, out: Path, name: str, power: float, units: str) -> Path:
    """A result with one more variable over step, a power of the force."""
    with xr.open_dataset(file) as data:
        made = data.load()
    made[name] = (3.0 * np.abs(made.force) ** power).assign_attrs(units=units, long_name=name)
    made.attrs["checksum"] = Labelled.of(made).checksum()
    made.to_netcdf(out)
    return out


@pytest.mark.parametrize(
    ("variable", "option", "ansys"),
    [
        ("thermal_conductance", "*GAP CONDUCTANCE, PRESSURE", "TCC"),
        ("electrical_conductance", "*GAP ELECTRICAL CONDUCTANCE, PRESSURE", "ECC"),
    ],
)
def test_conductances_are_over_the_pressure(files: Path, variable: str, option: str, ansys: str) -> None:
    units = "W K-1" if variable.startswith("thermal") else "S"
    file = with_curve(files / "hertz.nc", files / f"{variable}.nc", variable, 0.95, units)
    asked = {"quantity": "conductance", "units": "mm,N,MPa,W"}
    keyword, p, k = of_abaqus(exported(file, "k.inp", to="abaqus", **asked))
    primary, *table = of_ansys(exported(file, "k.mac", to="ansys", **asked))
    assert keyword == option
    assert f"{variable} per nominal area in {'W/mm^2/K' if variable[0] == 't' else 'S/mm^2'}" in header_of(
        files / "k.inp"
    )
    assert primary == "PRESSURE"
    np.testing.assert_allclose(table, [p, k], rtol=1e-12)
    assert f"ROUGH_{ansys}(1,0)" in (files / "k.mac").read_text()
    force = p[1:] * 1e6 * AREA
    np.testing.assert_allclose(k[1:], 3.0 * force**0.95 / AREA * 1e-6, rtol=1e-11)  # W/m^2/K or S/m^2, over mm^2
    fine = np.geomspace(0.1, 1.0, 500) * p[-1]
    np.testing.assert_allclose(np.interp(fine, p, k), 3.0 * (fine * 1e6 * AREA) ** 0.95, rtol=5e-3)


def test_a_tangential_stiffness_goes_with_the_friction_of_the_scene(files: Path) -> None:
    file = with_curve(files / "hertz.nc", files / "slip.nc", "tangential_stiffness", 0.9, "N m-1")
    asked = {"quantity": "tangential", "units": "mm,N,MPa"}
    table = of_csv(exported(file, "slip.csv", to="csv", **asked))
    with pytest.raises(rm.StoreError, match=r"\[tangential\] friction"):
        rm.export(file, files / "slip.inp", to="abaqus", error=5e-3, **asked)
    assert list(table)[:2] == ["pressure [MPa]", "tangential_stiffness [MPa/mm]"]
    with xr.open_dataset(file) as data:
        made = data.load()
    made.attrs["scene"] += "\n[tangential]\nfriction = '30 %'\n"
    p, k = table.iloc[-1, 0], table.iloc[-1, 1]
    rm.export(made, files / "slip.inp", to="abaqus", error=5e-3, **asked)
    lines = (files / "slip.inp").read_text().splitlines()[-2:]
    assert lines[0].startswith("*FRICTION, ELASTIC SLIP=")
    assert float(lines[0].split("=")[1]) == pytest.approx(0.3 * p / k, rel=1e-11)
    assert float(lines[1]) == 0.3
    rm.export(made, files / "slip.inp", to="calculix", error=5e-3, **asked)
    *_, keyword, numbers = (files / "slip.inp").read_text().splitlines()
    assert keyword == "*FRICTION"
    np.testing.assert_allclose([float(part) for part in numbers.split(",")], [0.3, k], rtol=1e-11)


def test_the_contact_fraction_over_the_overclosure(files: Path) -> None:
    table = of_csv(exported(files / "hertz.nc", "area.csv", to="csv", quantity="area"))
    with xr.open_dataset(files / "hertz.nc") as data:
        largest = float(data.contact_area.max()) / AREA
    assert table["contact_area [1]"].iloc[-1] == pytest.approx(largest, rel=1e-12)


@pytest.mark.large
@pytest.mark.parametrize("mode", ["product", "zip"])
def test_one_cell_of_a_sweep_is_selected(mode: str, tmp_path: Path) -> None:
    sweep = {"mode": mode, "asperities.height.std": ["1 um", "2 um"], "asperities.radius.mean": ["50 um", "80 um"]}
    file = tmp_path / "swept.nc"
    rm.run(expected(path=FAR, sweep=sweep), file)
    with pytest.raises(rm.StoreError, match=r"has \d cells"):
        rm.export(file, tmp_path / "x.csv", to="csv")
    chosen = {"asperities.height.std": "2 um"} | ({} if mode == "zip" else {"asperities_radius_mean": 8e-5})
    table = of_csv(exported(file, "cell.csv", to="csv", select=chosen))
    alone = {
        **ASPERITIES,
        "height": {"distribution": "normal", "std": "2 um"},
        "radius": {**ASPERITIES["radius"], "mean": "80 um"},
    }
    rm.run(expected(path=FAR, asperities=alone), tmp_path / "alone.nc")
    np.testing.assert_array_equal(table, of_csv(exported(tmp_path / "alone.nc", "alone.csv", to="csv")))
    assert "asperities_height_std = 2 um" in header_of(tmp_path / "cell.csv")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"to": "exel"}, "to is 'exel'"),
        (
            {"to": "csv", "quantity": "conductance"},
            "needs the variable 'thermal_conductance' or 'electrical_conductance'",
        ),
        ({"to": "csv", "quantity": "tangential"}, "'tangential_stiffness': add it to \\[output\\] variables"),
        ({"to": "abaqus", "quantity": "area"}, "abaqus has no table of quantity 'area'; moose, c, csv, json have"),
        ({"to": "csv", "units": "mm,N,Pa"}, "are not consistent"),
        ({"to": "csv", "branch": "sideways"}, "branch is 'sideways'"),
        ({"to": "csv", "error": 0.0}, "error is 0.0"),
        (
            {"to": "csv", "error": 1e-6},
            r"known to [\d.e-]+ only: ask for an error of [\d.e-]+, or compute about \d+ steps",
        ),
        ({"to": "csv", "select": {"adhesion.work": 0.05}}, "is not swept"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_written(files: Path, options: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.StoreError, match=says):
        rm.export(files / "hertz.nc", files / "refused.csv", **options)
    assert not (files / "refused.csv").exists()


def test_calculix_is_given_no_steps_that_it_would_widen(files: Path, tmp_path: Path) -> None:
    """Nanometres in metres."""
    asperities = {**ASPERITIES, "patch": "1 um", "height": {"distribution": "normal", "std": "1 nm"}, "radius": "50 nm"}
    rm.run(expected(asperities=asperities), tmp_path / "nano.nc")
    with pytest.raises(rm.StoreError, match="widens those below 1e-10: ask for a smaller unit of length"):
        rm.export(tmp_path / "nano.nc", tmp_path / "nano.inp", to="calculix", error=5e-3)
    _, x, _ = of_abaqus(exported(tmp_path / "nano.nc", "nano.inp", to="calculix", units="um,uN"))
    assert np.diff(x).min() > 1e-6


def test_a_path_that_begins_in_contact_is_refused(tmp_path: Path) -> None:
    for start, says in (("0.5 sigma", "in contact: a table begins where contact does"),):
        rm.run(expected(path={"separation": {"start": start, "stop": "-0.5 sigma", "steps": 50}}), tmp_path / "in.nc")
        with pytest.raises(rm.StoreError, match=says):
            rm.export(tmp_path / "in.nc", tmp_path / "in.csv", to="csv", error=1e-2)
    loaded = expected(path={"force": {"stop": "0.1 mN", "steps": 12}})
    rm.run(loaded, tmp_path / "load.nc")
    with pytest.raises(rm.StoreError, match=r"run the scene with path\.separation"):
        rm.export(tmp_path / "load.nc", tmp_path / "load.csv", to="csv")


def test_an_export_gives_way_to_an_export_and_nothing_else_does(files: Path, tmp_path: Path) -> None:
    shutil.copy(files / "hertz.nc", tmp_path / "law.nc")
    call = ["export", tmp_path / "law.nc", "--error", "5e-3"]
    told = said(*call, "-o", tmp_path / "law.inp", "--to", "abaqus", "--units", "mm,N,MPa")
    assert told.splitlines()[-1] == f"export       {tmp_path / 'law.inp'}"
    first = (tmp_path / "law.inp").read_text()
    rm.export(tmp_path / "law.nc", tmp_path / "law.inp", to="abaqus", error=5e-3, units="mm,N,MPa")
    assert (tmp_path / "law.inp").read_text() == first
    (tmp_path / "notes.csv").write_text("notes")
    for out, says in (("notes.csv", "is no export"), ("law.txt", "must end in .csv"), ("law.nc", "is an input")):
        done = roughmdr(*call, "-o", tmp_path / out, "--to", "csv")
        assert (done.returncode, says in done.stderr) == (2, True), done.stderr
    assert (tmp_path / "notes.csv").read_text() == "notes"
    rm.export(tmp_path / "law.nc", tmp_path / "notes.csv", to="csv", error=5e-3, fresh=True)
    assert len(of_csv(tmp_path / "notes.csv")) > 5


def test_moose_reads_each_point_once_of_few_points_too(files: Path) -> None:
    file = with_curve(files / "hertz.nc", files / "few.nc", "thermal_conductance", 0.95, "W K-1")
    asked = {"quantity": "conductance", "error": 0.03}
    _, x, y = of_moose(exported(file, "few.i", to="moose", **asked))
    assert x.size < 6
    table = of_csv(exported(file, "few.csv", to="csv", **asked))
    np.testing.assert_array_equal([x, y], [table.iloc[:, 0], table.iloc[:, 1]])


def test_nothing_in_a_title_becomes_a_line_of_the_table(files: Path) -> None:
    with xr.open_dataset(files / "hertz.nc") as data:
        made = data.load()
    made.attrs["title"] = "one\n*STEP\nµ \x1b[31m"
    for name, to in (("t.inp", "abaqus"), ("t.csv", "csv"), ("t.json", "json")):
        rm.export(made, files / name, to=to, error=5e-3)
    keyword, *_ = of_abaqus(files / "t.inp")
    assert keyword.startswith("*SURFACE")
    assert "\x1b" not in (files / "t.csv").read_text()
    assert of_json(files / "t.json")["header"]["scene"] == made.attrs["title"]


@pytest.mark.large
def test_contacts_that_yield_have_a_table_of_the_first_loading_and_one_of_what_follows(tmp_path: Path) -> None:
    path = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 150}, "unload": True}
    rm.run(expected(path=path, plasticity={"yield_strength": "30 kPa"}), tmp_path / "yielding.nc")
    for branch, told in (("loading", "this is the first loading"), ("unloading", "this is the elastic law")):
        with pytest.warns(rm.LimitWarning, match=told):
            file = exported(tmp_path / "yielding.nc", f"{branch}.csv", to="csv", branch=branch, error=0.1)
        assert told in file.read_text().replace("\n#     ", " ")
        frame, (separation, pressure) = of_csv(file), law_of(tmp_path / "yielding.nc", branch)
        at = np.interp(-separation, -frame["separation [m]"], frame["pressure [Pa]"])
        np.testing.assert_allclose(at, pressure, atol=0.1 * pressure.max())
    with pytest.raises(rm.StoreError, match=r"scene has \[plasticity\]"):
        exported(tmp_path / "yielding.nc", "nodes.csv", to="csv", quantity="nodes")


_PROGRAM = """
#include <stdio.h>
#include <stdlib.h>
#include "layer.h"
#define ROUGH_PRESSURE unloaded
#include "unloaded.h"
int main(void)
{
    for (double x, k; scanf("%lf", &x) == 1;) {
        const double loaded = rough_pressure(x, &k);
        printf("%.17g %.17g %.17g\\n", loaded, k, unloaded(x, NULL));
    }
    return 0;
}
"""


@pytest.mark.large
@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no compiler of C")
@pytest.mark.parametrize("language", [["c", "-std=c99"], ["c++", "-std=c++11"]])
def test_a_function_in_c_has_the_lines_of_the_table(files: Path, language: list[str]) -> None:
    """Before its first point, at 100 000 between, at each, beyond the last, and where it is asked for no number."""
    table, program = exported(files / "jkr.nc", "layer.csv", to="csv"), files / "program.c"
    exported(files / "jkr.nc", "layer.h", to="c")
    exported(files / "jkr.nc", "unloaded.h", to="c", branch="unloading")
    program.write_text(_PROGRAM)
    options = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-o", f"{files}/a.out"]
    subprocess.run(["cc", "-x", *language, program, *options], check=True)

    x, y = of_csv(table).to_numpy()[:, :2].T
    far, tension = of_csv(exported(files / "jkr.nc", "unloaded.csv", to="csv", branch="unloading")).to_numpy()[0, :2]
    before, between, beyond = np.nextafter(x[0], -1.0), np.linspace(x[0], x[-1], 100_001)[1:], x[-1] + np.ptp(x)
    at = [before, *between, *x, far, np.nextafter(far, -1.0), beyond, np.nan]
    told = subprocess.check_output([files / "a.out"], input="\n".join(map(repr, map(float, at))), text=True)
    found, slope, unloaded = np.array([line.split() for line in told.splitlines()], dtype=float).T
    assert found[:-2] == pytest.approx(np.interp(at[:-2], x, y, left=0.0), abs=1e-13 * y.max())
    assert np.isnan([*found[-2:], *slope[-2:]]).all()
    line = np.clip(np.searchsorted(x, between, side="right"), 1, x.size - 1)
    assert slope[1 : between.size + 1] == pytest.approx((np.diff(y) / np.diff(x))[line - 1], rel=1e-12)
    assert found[0] == slope[0] == unloaded[-3] == 0.0
    assert unloaded[-4] == tension < 0.0  # another function in the same program
