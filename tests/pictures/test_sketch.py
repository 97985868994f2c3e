"""The small picture of results and fits in a notebook."""

import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.pictures import sketch as module
from roughmdr.pictures.sketch import sketch


def drawn(dataset: xr.Dataset) -> ET.Element:
    text = dataset.roughmdr._repr_html_()
    found = re.search(r"<svg.*</svg>", text)
    assert found, text
    assert len(found[0]) < 40_000
    assert "nan" not in found[0]
    return ET.fromstring(found[0])


def ends(picture: ET.Element) -> list[str]:
    return [str(each.text) for each in picture.iter("text")]


def small(**changes: Any) -> xr.Dataset:
    path = {"separation": {"start": "3 um", "stop": "1 um", "steps": 12}, "unload": True}
    return rm.run(scene(**{"asperities": {**ASPERITIES, "count": 100}, "path": path, **changes}))


@pytest.mark.large
def test_a_law_has_the_ends_of_its_mean() -> None:
    law = small()
    y, x, left, right, low, high = ends(drawn(law))
    assert (x, left, right) == ("separation [µm]", "1", "3")
    mean = law.force.mean("realization")
    size = {"force [mN]": 1e-3, "force [µN]": 1e-6}[y]
    assert (float(low), float(high)) == pytest.approx((float(mean.min()) / size, float(mean.max()) / size), rel=5e-3)
    loading, unloading = (each.get("d", "") for each in list(drawn(law))[1:3])
    points = [
        [float(number) for number in re.split("[ML ]", path.removesuffix("h0"))[1:]] for path in (loading, unloading)
    ]
    assert points[0][-2:] == points[1][:2]  # unloading begins where loading ends
    assert sketch(law.roughmdr.statistics()) == sketch(law)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "changes",
    [
        {"path": {"force": ["1 uN", "10 uN"]}},
        {"path": {"preload": "10 uN", "unload": True}},
        {"path": {"separation": ["1 um"]}, "batch": None},
        {"path": {"separation": "1 um", "lateral": ["0 nm", "5 nm"]}, "tangential": {"friction": 0.3}, "adhesion": None,
         "material": {"modulus": "3 MPa", "poisson": 0.3}},
        {"output": {"variables": ["contact_count"]}},
        {"sweep": {"path.separation.stop": ["1 um", "0.5 um"]},
         "path": {"separation": {"start": "3 um", "steps": 5, "stop": "1 um"}}},
    ],
)  # fmt: skip
def test_every_path_is_drawn(changes: Mapping[str, Any]) -> None:
    assert len(ends(drawn(small(**changes)))) == 6


@pytest.mark.large
def test_of_many_cells_some_are_drawn_and_failed_runs_are_not() -> None:
    works = {"adhesion.work": {"linspace": ["1 mJ/m^2", "50 mJ/m^2"], "num": 9}}
    law = small(sweep=works)
    assert "5 of 9 cells" in ends(drawn(law))[0]
    assert len(list(drawn(law))) == 1 + 2 * 5 + 1
    assert sketch(law.isel(adhesion_work=0)) == sketch(small(adhesion={"model": "jkr", "work": "1 mJ/m^2"}))
    known = law.isel(adhesion_work=0).copy(deep=True)
    known.force[1] = np.nan
    assert sketch(known) == sketch(law.isel(adhesion_work=0, realization=np.arange(known.sizes["realization"]) != 1))
    known.force[:] = np.nan
    assert sketch(known) == ""


def test_a_result_in_chunks_stays_so_and_one_of_too_many_numbers_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    law = small().chunk(realization=2)
    assert sketch(law) == sketch(law.compute())
    assert law.force.chunks is not None
    monkeypatch.setattr(module, "_NUMBERS", 100)
    assert sketch(law) == ""


def test_a_fit_and_what_has_no_picture() -> None:
    table = scene(
        batch={"estimator": "expected"}, adhesion=None, path={"separation": ["2 um", "1.5 um", "1 um", "0 um"]}
    )
    law = rm.run(table)
    fit = rm.fit(law.force.to_dataframe()[["separation", "force"]], table, ["material.modulus"])
    assert drawn(fit)[2].get("d", "").count("h0") == 4
    assert (
        sketch(fit.drop_vars("force_fitted")) == sketch(rm.generate(ASPERITIES, seed=1)) == sketch(xr.Dataset()) == ""
    )


def test_nothing_else_is_loaded_for_it() -> None:
    before = "matplotlib.figure" in sys.modules
    sketch(small())
    assert ("matplotlib.figure" in sys.modules) == before


@pytest.mark.large
def test_a_figure_shows_itself() -> None:
    figure = rm.plot(small(), variables="force")
    assert figure._repr_png_().startswith(b"\x89PNG")
