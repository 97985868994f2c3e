"""Results, ensembles and scenes describe themselves in a few lines, in a terminal and in a notebook."""

import re

import numpy as np
import xarray as xr
from scenes import scene

import roughmdr as rm
from roughmdr.scene import read


def lines(thing: object) -> dict[str, str]:
    text = repr(thing)
    assert len(text.splitlines()) <= 12
    return {line[:12].strip(): line[13:] for line in text.splitlines()}


def test_a_single_result() -> None:
    said = lines(rm.run(scene(batch=None, path={"separation": ["6 um", "2 um", "6 um"]})).roughmdr)
    assert said["result"] == "A small scene"
    assert said["runs"] == "1 realisation, 3 steps"
    assert said["path"] == "separation 6 to 2 um, loading and unloading"
    assert re.fullmatch(r"-[\d.]+ [um]N", said["pull-off"])
    assert said["trust"].startswith("force within about")


def test_a_sweep_and_its_statistics(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    text = repr(curves.roughmdr)
    assert "sweep        adhesion_work 20 to 50 mJ/m^2 (2 values)" in text
    assert re.search(r"pull-off     -[\d.]+ to -[\d.]+ uN, in 4 of 4 cells", text)
    assert lines(curves.roughmdr)["runs"] == "5 realisations, 120 steps"
    assert lines(curves.roughmdr)["path"] == "separation 13.12 to 1 um, loading and unloading"
    assert lines(statistics.roughmdr)["runs"] == "statistics of 5 realisations, 120 steps"
    scaled = lines(curves.roughmdr.normalise("gw").roughmdr)
    assert re.fullmatch(r"separation [\d.]+ to [\d.]+, loading and unloading", scaled["path"])
    assert re.fullmatch(r"-[\d.e-]+ to -[\d.e-]+, in 4 of 4 cells", scaled["pull-off"])
    few = curves.isel(asperities_height_std=0).roughmdr
    assert re.fullmatch(r"-\S+ ± \S+ [um]N; -\S+ ± \S+ [um]N", lines(few)["pull-off"])


def test_an_ensemble() -> None:
    said = lines(rm.generate(scene()["asperities"], seed=3).roughmdr)
    assert said["ensemble"] == "1000 asperities of shape paraboloid"
    assert (said["area"], said["seed"]) == ("1 mm^2", "3")
    assert re.fullmatch(r"mean [\d.]+ um, [\d.]+ to [\d.]+ um", said["radius"])


def test_a_law_of_load_and_separation_and_another_dataset() -> None:
    asperities = xr.Dataset({"height": ("asperity", np.zeros(2)), "radius": ("asperity", np.full(2, 5e-5))})
    law = rm.load_separation(asperities.assign_attrs(shape="paraboloid"), separation=[1e-6, 0.0], effective_modulus=1e9)
    assert lines(law.roughmdr)["runs"] == "one realisation, 2 steps"
    assert lines(law.roughmdr)["pull-off"] == "none: no unloading"
    assert "neither a result" in repr(xr.Dataset().roughmdr)


def test_a_scene() -> None:
    swept = read(scene(sweep={"adhesion.work": ["1 mJ/m^2", "2 mJ/m^2"]}))
    said = lines(swept)
    assert said["asperities"] == "1000 of shape paraboloid, source random"
    assert said["adhesion"] == "jkr, work 50 mJ/m^2"
    assert said["path"] == "separation from 3 sigma to -0.5 sigma in 40 steps, and back"
    assert said["sweep"] == "adhesion.work 1 to 2 mJ/m^2 (2 values)"
    assert said["runs"] == "2 cells x 16 realisations, seed 7"
    path = {"separation": {"stop": {"contact_fraction": 0.02}, "steps": 9}, "hold": 3}
    assert lines(read(scene(path=path)))["path"] == (
        "separation from clear to a contact fraction of 0.02 in 9 steps, held for 3"
    )
    assert lines(read(scene(path={"preload": "1 mN"})))["path"] == "preload 1 mN in 200 steps"
    assert lines(read(scene(path={"force": ["1 mN", "2 mN"]})))["path"] == "force in 2 steps"


def test_a_page_shows_markup_as_text_and_has_no_colours() -> None:
    page = read(scene(title="<b>&"))._repr_html_()
    assert "&lt;b&gt;&amp;" in page
    assert "<b>" not in page
    result = rm.run(scene(title="<script>", batch=None, path={"separation": ["3 um", "2 um"]}))
    result.attrs["title"] += "\x1b[31m"
    assert "\x1b" not in repr(result.roughmdr)
    page = result.roughmdr._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert not re.search(r"#[0-9a-f]{3}|rgb|black|white", page)


def test_a_path_is_told_from_where_it_begins_and_values_from_the_least() -> None:
    """A path has no number of values; swept ones that fall are told as those that rise."""
    falls, rises = ["3 um", "2 um", "1 um"], ["1 um", "2 um", "3 um"]
    for separation, said in ((falls, "3 to 1 um, loading"), (rises, "1 to 3 um, loading and unloading")):
        law = rm.run(scene(batch=None, path={"separation": separation}))
        assert lines(law.roughmdr)["path"] == f"separation {said}"
    for works in (["10 mJ/m^2", "20 mJ/m^2", "50 mJ/m^2"], ["50 mJ/m^2", "20 mJ/m^2", "10 mJ/m^2"]):
        swept = rm.run(scene(batch=None, path={"separation": falls}, sweep={"adhesion.work": works}))
        assert lines(swept.roughmdr)["sweep"] == "adhesion_work 10 to 50 mJ/m^2 (3 values)"
    path = {"separation": {"start": "3 um", "stop": "1 um", "steps": 4}}
    stops = rm.run(scene(batch=None, path=path, sweep={"path.separation.stop": ["1 um", "0.5 um"]}))
    assert lines(stops.roughmdr)["path"] == "separation 3 to 0.5 um, loading"


def test_a_fit() -> None:
    table = scene(batch=None, adhesion=None, path={"separation": ["2 um", "1.5 um", "1 um", "0.5 um", "0 um"]})
    measured = rm.run(table | {"batch": {"estimator": "expected"}}).force.to_dataframe()[["separation", "force"]]
    fit = rm.fit(measured, table, ["material.modulus"], set={"material.modulus": "2 MPa"})
    assert re.fullmatch(r"material\.modulus 3 ± \S+ MPa .*", lines(fit.roughmdr)["fitted"])
    assert "<table" in fit.roughmdr._repr_html_()
