"""Many curves at once: each as if it were alone, in whatever form they are given; one that fails is told."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import tomli_w
import xarray as xr
from command import roughmdr
from tips import MODULUS, OFFSET, WORK, Tip

import roughmdr as rm
from roughmdr.errors import StoreError
from roughmdr.fitting.columns import read_columns
from roughmdr.fitting.curves import _EACH
from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.stored import read_fit

FREE = [MODULUS, OFFSET]
TIP = Tip("hertz", 1e-7, 1e6)
LENGTHS = {"a.csv": 60, "b.csv": 40, "c.csv": 60}


@cache
def curves() -> dict[str, pd.DataFrame]:
    """Curves of unlike length on bodies of unlike modulus, then one that is too short."""
    found = {}
    for i, (name, size) in enumerate(LENGTHS.items()):
        tip = TIP._replace(modulus=(1.0 + 0.2 * i) * 1e6)
        noisy = tip.measure(np.random.default_rng(i), 60, ("constant", 0.005), 2e-8)
        found[name] = noisy[["separation", "force"]].iloc[60 - size :]
    return {**found, "short.csv": found["a.csv"].iloc[:3]}


@cache
def together() -> xr.Dataset:
    with pytest.warns(rm.LimitWarning, match="1 of 4 curves failed: failure says why"):
        return rm.fit(curves(), TIP.scene(), FREE)


def same(one: xr.Dataset, other: xr.Dataset) -> None:
    for name in {*one.variables, *other.variables} - {"run_time"}:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=str(name))


@pytest.mark.parametrize("name", LENGTHS)
def test_each_curve_is_fitted_as_if_it_were_alone(name: str) -> None:
    alone = rm.fit(curves()[name], TIP.scene(), FREE)
    of_many = together().sel(curve=name).dropna("point")
    same(alone, of_many.drop_vars(["curve", "failure", "remark"]))
    assert of_many.remark.item() == alone.attrs.get("warnings", "")


def test_a_curve_that_fails_is_told_and_lost_from_no_table() -> None:
    fit = together()
    assert fit.failure.values.tolist() == [""] * 3 + ["measured: has 3 rows; at least 5 are needed"]
    numbers = [fit[name].sel(curve="short.csv") for name in fit.data_vars]
    assert all(np.isnan(array).all() for array in numbers)
    assert fit.sizes == {"curve": 4, "point": 60, "parameter": 2, "parameter_2": 2}
    said = rm.info(fit)
    assert "failed       short.csv: measured: has 3 rows" in said
    assert f"material.modulus  {float(fit.material_modulus.median()) / 1e6:.4g} ±" in said


def as_frame() -> pd.DataFrame:
    return pd.concat([each.assign(curve=name) for name, each in curves().items()])


def as_dataset() -> xr.Dataset:
    padded = {
        key: [np.pad(each[key], (0, 60 - len(each)), constant_values=np.nan) for each in curves().values()]
        for key in ("separation", "force")
    }
    over = {key: (("curve", "row"), np.array(each)) for key, each in padded.items()}
    return xr.Dataset(over, coords={"curve": list(curves())})


def as_files(folder: Path) -> list[str]:
    for name, each in curves().items():
        each.to_csv(folder / name, index=False)
    return list(curves())


@pytest.mark.parametrize("form", ["frame", "dataset", "files", "column"])
def test_every_form_is_read_alike(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    monkeypatch.chdir(tmp_path)
    measured: Any = {"frame": as_frame, "dataset": as_dataset}.get(form, lambda: as_files(tmp_path))()
    if form == "column":
        as_frame().to_csv("all.csv", index=False)
        measured = "all.csv"
    fit = rm.fit(measured, TIP.scene(), FREE)
    same(fit.drop_vars("failure"), together().drop_vars("failure"))
    assert "3 rows" in fit.failure.values[-1]


@pytest.mark.parametrize("missing", [np.nan, None, pd.NA, ""])
def test_a_row_without_a_curve_is_refused(tmp_path: Path, missing: Any) -> None:
    rows = as_frame().astype({"curve": object}).reset_index(drop=True)
    rows.loc[7, "curve"] = missing
    with pytest.raises(rm.StoreError, match=r"measured: row 7: curve = .*: names no curve"):
        rm.fit(rows, TIP.scene(), FREE)
    rows.to_csv(tmp_path / "all.csv", index=False)
    with pytest.raises(rm.StoreError, match=r"all\.csv: line 9: curve = '': names no curve"):
        rm.fit(tmp_path / "all.csv", TIP.scene(), FREE)


@pytest.mark.large
@pytest.mark.parametrize("curves_a_process", [1, pytest.param(_EACH, marks=pytest.mark.large)])
def test_the_numbers_are_the_same_for_any_number_of_workers(
    monkeypatch: pytest.MonkeyPatch, curves_a_process: int
) -> None:
    monkeypatch.setattr("roughmdr.fitting.curves._EACH", curves_a_process)
    tip, rng = Tip("jkr", 1e-7, 1e6), np.random.default_rng(1)
    measured = [tip.measure(rng, 60, ("constant", 0.005), 2e-8) for _ in range(curves_a_process + 1)]
    one, two = (rm.fit(measured, tip.scene(), [MODULUS, WORK, OFFSET], workers=workers) for workers in (1, 2))
    same(one, two)


@pytest.mark.parametrize(
    ("measured", "free", "kind", "message"),
    [
        ([], FREE, rm.StoreError, "measured: has no curve; it needs at least one"),
        (["a.csv", "a.csv"], FREE, rm.StoreError, "curve 'a.csv' is given twice; .*, each with a name of its own"),
        (dict(curves()["a.csv"]), FREE, rm.StoreError, "measured is a dict of columns; give a DataFrame"),
        ({"separation": [2e-7, 0.0], "force": [0.0, 1e-8]}, FREE, rm.StoreError, "is a dict of columns"),
        ([curves()["short.csv"]], FREE, rm.StoreError, "has 3 rows"),
        (as_dataset().drop_vars("separation"), FREE, rm.StoreError, "measured: needs one column separation, remote"),
        (as_dataset()[[]].assign(x=("curve", [1.0] * 4)), FREE, rm.StoreError, "neither among no columns"),
        (
            as_dataset().drop_vars("separation").assign(separation=("other", np.arange(9.0))),
            FREE,
            rm.StoreError,
            "has the dimensions .*; all must have the same one alone",
        ),
        (curves(), ["material.modlus"], rm.SceneError, "free: material.modlus: is no number"),
        (
            {"a": curves()["a.csv"].assign(force=lambda own: -1e-9 - abs(own.force))},
            FREE,
            rm.OutOfRange,
            "no curve can be fitted; a: free:",
        ),
    ],
)
def test_what_is_wrong_with_all_curves_is_raised(measured: Any, free: Any, kind: type, message: str) -> None:
    with pytest.raises(kind, match=message):
        rm.fit(measured, TIP.scene(), free)


def test_curves_over_another_control_are_not_fitted_beside_the_first() -> None:
    other = curves()["a.csv"].rename(columns={"separation": "remote"})
    fit = rm.fit({"a": curves()["a.csv"], "b": other}, TIP.scene(), FREE)
    assert fit.failure.values.tolist() == ["", "measured: must have separation and force, as the first"]
    with pytest.raises(rm.RoughmdrError, match="workers is 0; it must be a whole number"):
        rm.fit(curves(), TIP.scene(), FREE, workers=0)


def test_each_file_has_its_own_cantilever() -> None:
    curve = read_measured(curves()["a.csv"].rename(columns={"separation": "remote"}), 2)._replace(stiffness=2.0)
    for path, expected in (({}, [2.0, 3.0]), *(({"machine_stiffness": own}, [own, own]) for own in (5.0, 2.0))):
        model = Model(*scene_to_fit(TIP.scene(path=path), {}, curve, FREE), FREE)
        every = [model, model.along(curve._replace(stiffness=3.0))]
        assert [each.start.path.machine_stiffness for each in every] == expected
    model = Model(*scene_to_fit(TIP.scene(), {}, curve, FREE), FREE)
    with pytest.raises(rm.StoreError, match=r"tells no spring constant, as the first does; set path\.machine_stiff"):
        model.along(curve._replace(stiffness=None))


@pytest.mark.large
def test_fits_are_measured_again_on_the_cantilevers_of_their_files(tmp_path: Path) -> None:
    remote = tmp_path / "remote.csv"
    curves()["c.csv"].rename(columns={"separation": "remote"}).to_csv(remote, index=False)
    files = {name: read_columns(remote)._replace(stiffness=constant) for name, constant in (("a", 2.0), ("b", 3.0))}
    fits = rm.fit(files, TIP.scene(), FREE)
    assert fits.spring_constant.values.tolist() == [2.0, 3.0]
    again = rm.fit(fits, TIP.scene(), FREE)
    same(fits.drop_vars("evaluation_count"), again.drop_vars("evaluation_count"))
    assert float(rm.fit(fits.isel(curve=1), TIP.scene(), FREE).offset) == float(fits.offset[1])
    fits.to_netcdf(tmp_path / "fits.nc")
    assert read_fit(tmp_path / "fits.nc").variables["spring_constant"].attrs["units"] == "N m-1"


@pytest.mark.large
def test_the_command_with_several_files(tmp_path: Path) -> None:
    as_files(tmp_path)
    (tmp_path / "tip.toml").write_text(tomli_w.dumps(TIP.scene()))
    call = "fit", *LENGTHS, "short.csv", "tip.toml", "-o", "fits.nc", "--free", ",".join(FREE)
    done = roughmdr(*call, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "in parentheses from 5 to 95 % of the curves" in done.stdout
    assert "fit: 4 of 4 curves" in done.stderr
    assert "failed       short.csv: short.csv: has 3 rows" in done.stdout
    same(read_fit(tmp_path / "fits.nc").to_xarray().drop_vars("failure"), together().drop_vars("failure"))
    for command in (("info", "fits.nc"), ("cite", "fits.nc"), ("plot", "fits.nc", "-o", "fits.png")):
        told = roughmdr(*command, cwd=tmp_path)
        assert told.returncode == 0, told.stderr
    refused = roughmdr(*(each for each in call if each != "b.csv"), cwd=tmp_path)
    assert refused.returncode == 2
    assert "holds a fit of b.csv too" in refused.stderr
    assert roughmdr(*call, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("of_one", [False, True])
def test_the_scene_of_the_start_is_not_taken_for_that_of_a_curve(tmp_path: Path, of_one: bool) -> None:
    fits = together().isel(curve=0) if of_one else together()
    fits.to_netcdf(tmp_path / "fits.nc")
    with pytest.raises(rm.SceneError, match=r"fits\.nc: has fits of many curves, each of another scene"):
        rm.run(tmp_path / "fits.nc")
    told = roughmdr("plan", "fits.nc", cwd=tmp_path)
    assert told.returncode == 2
    assert "fit one alone to have its own" in told.stderr


@pytest.mark.parametrize("lost", ["failure", "remark", "branch", "offset_low", "residual", "curve"])
def test_a_file_that_lacks_something_is_refused(lost: str) -> None:
    with pytest.raises(StoreError, match=r"not as roughmdr\.fit returns it"):
        rm.info(together().drop_vars(lost))


def test_numbers_that_no_fit_has_are_refused() -> None:
    fit = together()
    with pytest.raises(StoreError, match="outside its own interval"):
        rm.info(fit.assign(offset=fit.offset + 1.0))
    with pytest.raises(StoreError, match="residual_rms is not finite"):
        rm.info(fit.assign(residual_rms=fit.residual_rms * np.nan))
    with pytest.raises(StoreError, match="none of its curves could be fitted"):
        rm.info(fit.isel(curve=[3]))


def test_one_curve_of_many_is_drawn_as_one_and_all_as_histograms() -> None:
    assert len(rm.plot(together()).axes) == 3
    one = rm.plot(together().sel(curve="b.csv").dropna("point"))
    assert [axis.get_ylabel() for axis in one.axes] == ["force [nN]", "residual [pN]"]
