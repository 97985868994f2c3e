"""Results and fits of which each array and attribute in turn is removed, renamed, or of another type or value."""

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from foreign import undefined
from foreign_commands import RESULTS
from forms import large
from measurements import CASES, noise_of
from scenes import ASPERITIES, CONDUCTION, scene
from tips import MODULUS, Tip

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.errors import RoughmdrError
from roughmdr.fitting.stored import as_fit
from roughmdr.fitting.words import describe_fit
from roughmdr.report.cite import describe_papers
from roughmdr.report.export.write import Export, document_of
from roughmdr.report.page import error_rows
from roughmdr.report.result_document import result_table
from roughmdr.report.summary import describe
from roughmdr.result.view import ResultView
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.result_form import forms_of
from roughmdr.storage.result_validation import as_result
from roughmdr.variables import RESULT_ATTRIBUTES, STATED

FEW = {**ASPERITIES, "count": 6, "patch": "0.3 mm", "placement": "hard_core", "min_distance": "20 um"}
PATH = {"separation": {"start": "2.5 um", "stop": "0 um", "steps": 4}, "unload": True}
SCENES = {
    "curves": RESULTS["curves"],
    "statistics": RESULTS["statistics"],
}
LARGE = {
    "accuracy": RESULTS["accuracy"],
    "conducting": scene(
        asperities={**ASPERITIES, "count": 5},
        adhesion=None,
        conduction=CONDUCTION,
        path={"separation": {"start": "3 um", "stop": "0 um", "steps": 4}},
        output={"variables": ["force", "contact_area", "thermal_conductance"]},
        batch={"realizations": 2},
    ),
    "pairs": scene(asperities=FEW, path=PATH, interaction={"model": "pairwise"}, batch={"realizations": 2}),
    "lateral": scene(
        asperities={**ASPERITIES, "count": 20},
        adhesion=None,
        tangential={"friction": 0.3},
        path={"separation": "1 sigma", "lateral": ["0 nm", "40 nm", "-20 nm"]},
        output={"variables": ["tangential_force", "friction_energy", "force"]},
        batch={"realizations": 2},
    ),
    "differentiated": scene(
        asperities={**ASPERITIES, "count": 20},
        path=PATH,
        output={"variables": ["force"], "derivatives": ["material.modulus", "asperities.height.std"]},
        batch={"estimator": "expected"},
    ),
    "elements": scene(
        asperities={**ASPERITIES, "count": 4, "patch": "100 um"},
        adhesion=None,
        reference={"model": "boundary_elements", "error": 0.3},
        path={"separation": ["0.5 um", "0 um"]},
        batch=None,
    ),
}
OTHER_VALUES = (None, 5, "text")
NUMBERS = (np.nan, np.inf, -1.0, 0.0, 1e300)
READERS: dict[str, Callable[[ResultView], object]] = {
    "info": lambda data: describe(data, None, cells=False),
    "cells": lambda data: describe(data, None, cells=True),
    "json": lambda data: bool(result_table(data, None)),
    "cite": lambda data: describe_papers(data.attrs["scene"], data, bibtex=False),
    "errors": lambda data: str(list(error_rows(data))),
    "export": lambda data: str(document_of(data, None, Export(to="json", error=0.1))[0].header),
}


def made(name: str) -> Labelled:
    with warnings.catch_warnings(action="ignore"):
        return Labelled.of(rm.run((SCENES | LARGE)[name]))


def alterations(data: Labelled) -> Iterator[tuple[str, Labelled]]:
    """All single changes of the arrays and attributes that are there."""
    for place in ("variables", "coordinates"):
        arrays: dict[str, Array] = getattr(data, place)
        for name, array in arrays.items():
            others = {key: each for key, each in arrays.items() if key != name}

            def placed(new: dict[str, Array], place: str = place) -> Labelled:
                return data._replace(**{place: new})

            yield f"no {name}", placed(others)
            yield f"{name} renamed", placed({**others, "renamed": array})
            for change, other in _others(array):
                yield f"{name} {change}", placed({**others, name: other})
            for key in {*array.attrs, "units"}:
                kept = {each: value for each, value in array.attrs.items() if each != key}
                for value in OTHER_VALUES:
                    attrs = kept if value is None else {**kept, key: value}
                    yield f"{name}.{key} = {value!r}", placed({**others, name: array._replace(attrs=attrs)})
    for key in {*data.attrs, *STATED}:
        kept = {each: value for each, value in data.attrs.items() if each != key}
        for value in OTHER_VALUES:
            yield f"{key} = {value!r}", data._replace(attrs=kept if value is None else {**kept, key: value})


def _others(array: Array) -> Iterator[tuple[str, Array]]:
    values = array.values
    yield "over one dimension more", Array(("odd", *array.dims), values[None], array.attrs)
    if values.dtype.kind in "OU":
        yield "of numbers", array._replace(values=np.zeros(values.shape))
        return
    yield "of texts", array._replace(values=np.full(values.shape, "text", dtype=object))
    for kind in {"f8", "f4", "i8"} - {values.dtype.str[1:]}:
        yield f"of {kind}", array._replace(values=np.nan_to_num(values).astype(kind))
    for number in NUMBERS if values.dtype.kind == "f" else (0, 1, 7, -1):
        yield f"all {number}", array._replace(values=np.full_like(values, number))


def read(data: Labelled, of: Callable[[Labelled], Labelled], readers: dict[str, Callable[[Any], object]]) -> None:
    """Whatever is accepted is told by every reader, or refused in words, without a number that is none."""
    for change, altered in alterations(data):
        try:
            accepted = of(altered)
        except RoughmdrError:
            continue
        for name, reader in readers.items():
            try:
                said = str(reader(accepted))
            except RoughmdrError:
                continue
            except Exception as error:
                raise AssertionError(f"{name} of a file with {change}") from error
            assert not undefined(said), (change, name)


@pytest.mark.large
@pytest.mark.parametrize("name", ["curves", *(large(name) for name in SCENES | LARGE if name != "curves")])
def test_every_array_and_attribute_in_turn(name: str) -> None:
    data = made(name)
    assert as_result(data) == data
    readers = {name: lambda accepted, reader=reader: reader(ResultView(accepted)) for name, reader in READERS.items()}
    read(data, as_result, readers)


@pytest.fixture(scope="module", params=["adhesive", large("with draws")])
def fit(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file, case, tip = tmp_path_factory.mktemp("fit") / "fit.nc", CASES["adhesive"], Tip("hertz", 1e-7, 1e6)
    if request.param == "adhesive":
        force = case.force()
        rm.fit(case.measure(noise_of("constant", force), force), case.scene, case.true, out=file)
    else:
        measured = tip.measure(np.random.default_rng(0), 40, ("constant", 0.01), 0.0)
        rm.fit(measured, tip.scene(), [MODULUS], out=file, posterior=True)
    return file


@pytest.mark.large
def test_every_array_and_attribute_of_a_fit_in_turn(fit: Path) -> None:
    with xr.open_dataset(fit) as stored:
        data = Labelled.of(stored.load())
    cite = {"cite": lambda each: describe_papers(each.attrs["scene"], None, bibtex=False)}
    read(data, as_fit, {"info": describe_fit, **cite})
    required = ("no trust", "no kind", "no material_modulus_low", "no residual")
    altered = dict(alterations(data)) | {f"no {name}": each for name, each in _without_attributes(data)}
    for change in required:
        with pytest.raises(RoughmdrError, match=f"it has {change}"):
            as_fit(altered[change])


def _without_attributes(data: Labelled) -> Iterator[tuple[str, Labelled]]:
    for name in data.attrs:
        yield name, data._replace(attrs={key: value for key, value in data.attrs.items() if key != name})


def test_all_that_is_declared_has_a_form() -> None:
    """Every variable and attribute of a result is declared, with its unit, so that another is not read as its own."""
    data = made("curves")
    assert set(data.attrs) <= set(RESULT_ATTRIBUTES)
    forms = forms_of(data.variables["status"].dims)
    assert set(data.variables) <= set(forms)
    for name, array in data.variables.items():
        assert array.attrs.get("units", "") == forms[name].units


@pytest.mark.few(2)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("estimator", ["sampled", "expected"])
@pytest.mark.parametrize("adhesion", [None, {"model": "jkr", "work": "1 nJ/m^2"}])
def test_a_loop_that_ends_without_tension_is_read(
    adhesion: dict[str, str] | None, estimator: str, keep: str, tmp_path: Path
) -> None:
    table = scene(
        asperities={**ASPERITIES, "count": 9, "patch": "0.3 mm", "placement": "square"},
        adhesion=adhesion,
        path={"separation": {"start": "clear", "stop": "0 um", "steps": 4}, "unload": True},
        output={"keep": keep},
        batch={"estimator": estimator} if estimator == "expected" else {"realizations": 2},
    )
    data = Labelled.of(rm.run(table, tmp_path / "out.nc"))
    assert set(data.attrs) - {"checksum"} <= set(RESULT_ATTRIBUTES)
    assert as_result(data) == data
    told = CliRunner().invoke(main, ["info", str(tmp_path / "out.nc")])
    assert told.exit_code == 0, told.stderr
    assert not told.stderr


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda data: data["material_modulus"].__imul__(1000.0), "outside its own interval"),
        (lambda data: data["material_modulus"].attrs.update(units="GPa"), "not those that were written"),
        (lambda data: [data[f"material_modulus{end}"].__imul__(2.0) for end in ("", "_high")], "not those that were"),
        (lambda data: data.attrs.update(trust="force within about 0.1 %"), "not those that were written"),
    ],
)
def test_a_fit_is_held_to_its_checksum(fit: Path, tmp_path: Path, change: Callable[[Any], None], says: str) -> None:
    with xr.open_dataset(fit) as stored:
        data = stored.load()
    change(data)
    data.to_netcdf(tmp_path / "fit.nc")
    for command in ("info", "cite", "plot"):
        picture = ["-o", str(tmp_path / "a.png")] if command == "plot" else []
        assert says in CliRunner().invoke(main, [command, str(tmp_path / "fit.nc"), *picture]).stderr
    unchanged = CliRunner().invoke(main, ["info", str(fit)])
    assert unchanged.exit_code == 0
    assert not unchanged.stderr


@pytest.mark.large
def test_what_users_do_with_xarray_is_read(tmp_path: Path) -> None:
    """A copy is as it was written, notes of one's own included; a part is read, and is said to be another."""
    out, copy = tmp_path / "out.nc", tmp_path / "copy.nc"
    rm.run(RESULTS["accuracy"], out)
    changed = {
        "copy": (lambda data: data, ""),
        "note": (lambda data: data.assign_attrs(note="of sample 3", title="Sample 3", history="ncks"), ""),
        "cell": (lambda data: data.isel(cell=[0]), "not those that were written"),
        "realisation": (lambda data: data.isel(realization=[0], cell=0), "not those that were written"),
        "steps": (lambda data: data.isel(step=slice(3)), "not those that were written"),
        "factor": (lambda data: data.assign(force=2.0 * data.force), "not those that were written"),
        "more": (lambda data: data.assign(own=data.force**2), "not those that were written"),
    }
    for name, (change, says) in changed.items():
        with xr.open_dataset(out) as stored:
            change(stored.load()).to_netcdf(copy)
        done = CliRunner().invoke(main, ["info", str(copy)])
        assert done.exit_code == 0, (name, done.output)
        assert says in done.stderr, name
        assert bool(says) == bool(done.stderr), name


def test_the_difference_of_two_laws_is_read_and_that_of_errors_refused() -> None:
    """Areas and forces of a difference are negative; an error is not."""
    one, other = (rm.run(RESULTS["curves"], set={"seed": seed}) for seed in (1, 2))
    laws = ["force", "contact_area"]
    for first, second in ((one, other), (other, one)):
        difference = {name: first[name].copy(data=first[name] - second[name]) for name in laws}
        assert rm.info(first.assign(difference))
    assert any((one[name] < other[name]).any() and (one[name] > other[name]).any() for name in laws)
    with pytest.raises(RoughmdrError, match="model_error must be at least 0"):
        rm.info(one.assign(model_error=-one.model_error))
