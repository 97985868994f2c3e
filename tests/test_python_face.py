"""Small things that a session in Python meets: units, misspelt keywords, tab completion, pickles and merges."""

import inspect
import pickle
import pydoc
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import BaseModel
from scenes import ensemble, scene

import roughmdr as rm
from roughmdr.scene import read
from roughmdr.schema.keywords import named_keywords
from roughmdr.shapes import SHAPES, Shape

EXAMPLES = [kind(**kind.example()) for kind in SHAPES.values()]
IDS = list(SHAPES)
FUNCTIONS = [
    *(getattr(rm, name) for name in dir(rm) if inspect.isfunction(getattr(rm, name))),
    *(getattr(rm.theory, name) for name in rm.theory.__all__ if inspect.isfunction(getattr(rm.theory, name))),
    rm.spectrum.SelfAffine.of,
]


@pytest.mark.parametrize("shape", EXAMPLES, ids=IDS)
def test_shapes_unpickle_equal(shape: Shape) -> None:
    """Also those of arrays, whose parameters stay read-only; a shape of other parameters is another one."""
    again = pickle.loads(pickle.dumps(shape))
    assert again == shape
    assert hash(again) == hash(shape)
    assert len({again, shape}) == 1
    scale = 2.0
    other = type(shape)(
        **{
            name: {n: scale * c for n, c in value.items()} if isinstance(value, dict) else scale * np.asarray(value)[()]
            for name, value in shape.parameters.items()
        }
    )
    assert other != shape
    assert shape != 1.0
    for value in again.parameters.values():
        assert not isinstance(value, np.ndarray) or not value.flags.writeable


def test_an_unpickled_table_is_computed_to_the_same_bits() -> None:
    radii = np.linspace(0.0, 3e-6, 9)
    table = rm.Tabulated(radii, radii**2 / 2e-5)
    again = pickle.loads(pickle.dumps(table))
    for name in ("f", "g", "G"):
        assert np.array_equal(getattr(again, name)(0.7 * radii), getattr(table, name)(0.7 * radii))


@pytest.mark.large
def test_contacts_of_an_unpickled_table_are_computed_to_the_same_bits() -> None:
    radii = np.linspace(0.0, 3e-6, 9)
    table = rm.Tabulated(radii, radii**2 / 2e-5)
    again = pickle.loads(pickle.dumps(table))
    contacts = [rm.indent(each, effective_modulus="1 GPa", indentation=["10 nm", "100 nm"]) for each in (table, again)]
    assert contacts[0].identical(contacts[1])


@pytest.mark.few(3)
@pytest.mark.parametrize("shape", EXAMPLES, ids=IDS)
def test_profiles_take_units(shape: Shape) -> None:
    """Strings with units are lengths of contact radii, numbers metres; another dimension is refused."""
    for function in (shape.f, shape.df, shape.g, shape.G):
        assert function("500 mm") == function(0.5)
        assert np.array_equal(function(["200 mm", "0.5 m"]), function([0.2, 0.5]))
        with pytest.raises(rm.OutOfRange, match=r"is '1 N': 'N' is a unit of N"):
            function("1 N")
        with pytest.raises(rm.OutOfRange, match=r"-0\.001 m; it must be finite and at least 0"):
            function("-1 mm")


@pytest.mark.parametrize("kind", [rm.Tabulated, rm.MdrTable])
def test_tables_take_units(kind: Any) -> None:
    (first, x), (second, y) = kind.example().items()
    given = {first: [f"{1e6 * value:g} um" for value in x], second: [f"{1e3 * value:g} mm" for value in y]}
    assert kind(**given) == kind(**kind.example())
    with pytest.raises(rm.ShapeError, match=f"{second} is '1 s'"):
        kind(**{**given, second: ["1 s"] * len(y)})


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__qualname__)
def test_a_misspelt_keyword_is_named_before_anything_else(function: Any) -> None:
    parameters = inspect.signature(function).parameters
    named = [name for name, each in parameters.items() if each.kind != each.VAR_KEYWORD]
    name = max(named, key=len)
    misspelt = name[:-2] + name[-1]
    with pytest.raises(
        TypeError, match=rf"\w+\(\) got an unexpected keyword argument '{misspelt}'; did you mean '\w+'"
    ):
        function(**{misspelt: 1.0})
    with pytest.raises(TypeError, match=r"unexpected keyword argument 'zzzz'; it can be [\w, ]*"):
        function(zzzz=1.0)


@pytest.mark.parametrize(
    ("function", "misspelt", "meant"),
    [
        (rm.indent, "machine_stifness", "machine_stiffness"),
        (rm.pull_off, "efective_modulus", "effective_modulus"),
        (rm.load_separation, "strenght", "strength"),
        (rm.theory.greenwood_williamson, "heigths", "heights"),
        (rm.plot, "with_expectd", "with_expected"),
        (rm.export, "quantitiy", "quantity"),
        (rm.Paraboloid, "raduis", "radius"),
        (rm.TruncatedCone, "flat_radus", "flat_radius"),
    ],
)
def test_keywords_that_a_function_passes_on_are_known(function: Any, misspelt: str, meant: str) -> None:
    with pytest.raises(TypeError, match=f"unexpected keyword argument '{misspelt}'; did you mean '{meant}'"):
        function(**{misspelt: 1.0})


def test_named_keywords_change_nothing_else() -> None:
    @named_keywords
    def added(first: float, *, second: float = 1.0) -> float:
        """Add."""
        return first + second

    assert added(1.0) == 2.0
    assert added(first=1.0, second=2.0) == 3.0
    assert added.__doc__ == "Add."
    assert list(inspect.signature(added).parameters) == ["first", "second"]


def test_warnings_are_those_of_the_line_that_called() -> None:
    """However deep in the package they come from."""
    needle = rm.Paraboloid(radius="1 nm")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rm.indent(needle, effective_modulus="4 mPa", contact_radius="2 nm")
        rm.load_separation(ensemble([0.0], radius=1e-9), separation=-2e-9, effective_modulus=1e9)
    assert len(caught) >= 3
    assert {each.filename for each in caught} == {__file__}


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("material.modulus", "4 mPa", "material.modulus = '4 mPa': mPa are millipascals"),
        ("material.modulus", 4e-3, "effective modulus 5.264 mPa: no solid is so soft"),
        ("material.modulus", "4 MPa", ""),
        (
            "path.separation.stop",
            {"pressure": "1 mPa"},
            "path.separation.stop.pressure = '1 mPa': mPa are millipascals",
        ),
    ],
)
def test_millipascals_are_doubted(key: str, value: Any, told: str) -> None:
    """In a scene as in Python, where megapascals are mostly meant; kilopascals are not."""
    table = scene(batch=None, adhesion=None)
    *outer, last = key.split(".")
    section = table
    for part in outer:
        section = section[part]
    section[last] = value
    doubts = read(table).doubts
    assert len(doubts) == bool(told)
    assert all(told in text for text in doubts)


def test_a_modulus_in_millipascals_is_warned_of() -> None:
    with pytest.warns(rm.LimitWarning, match="modulus is '4 mPa': mPa are millipascals, 1e-3 Pa"):
        assert rm.effective_modulus("4 mPa", 0.0) == pytest.approx(4e-3)
    with pytest.warns(rm.LimitWarning, match="material.modulus = '4 mPa'"):
        result = rm.run(scene(material={"modulus": "4 mPa", "poisson": 0.49}, adhesion=None, batch=None))
    assert "write MPa" in result.attrs["warnings"]


def test_completion_offers_nothing_of_others() -> None:
    one = read(scene())
    for listed in (dir(one), dir(rm.Scene), dir(one.asperities), dir(one.material)):
        offered = [name for name in listed if not name.startswith("_")]
        assert offered
        assert not set(offered) & set(dir(BaseModel))
    assert {"material", "asperities", "effective_modulus", "cells"} <= set(dir(one))
    assert {"modulus", "poisson"} <= set(dir(one.material))
    assert {"run", "fit", "Paraboloid", "theory", "OutOfRange"} < set(dir(rm))
    assert dir(rm.theory) == sorted(rm.theory.__all__)
    assert dir(rm.spectrum) == sorted(rm.spectrum.__all__)


def test_help_of_the_package_is_short_and_names_what_is_there() -> None:
    text = pydoc.plain(pydoc.render_doc(rm))
    assert len(text.splitlines()) < 100
    named = re.findall(r"^ +(\w+)\((\w+)", text, re.MULTILINE)
    assert len(named) >= 10
    for name, first in named:
        assert first in inspect.signature(getattr(rm, name)).parameters


def short(**changes: Any) -> xr.Dataset:
    path = {"separation": ["3 um", "1 um"]}
    return rm.run(scene(**{"adhesion": None, "batch": {"realizations": 2}, "path": path, **changes}))


def test_runs_of_one_scene_merge_though_they_took_other_times() -> None:
    """All that is not of the clock must agree; a difference in it is a conflict as before."""
    first, second = short(), short(output={"variables": ["contact_radius_sum", "stiffness"]})
    first.run_time[:] = second.run_time + 1.0  # two clocks never agree
    merged = xr.merge([first, second], compat="no_conflicts")
    assert set(merged) == set(first) | set(second)
    assert merged.run_time.equals(first.run_time)
    assert pickle.loads(pickle.dumps(first)).identical(first)
    assert first.merge(second, compat="no_conflicts").identical(merged)
    other = short(material={"modulus": "4 MPa", "poisson": 0.49})
    with pytest.raises(xr.MergeError, match="conflicting values for variable 'force'"):
        xr.merge([first, other], compat="no_conflicts")


def test_results_in_files_merge_without_their_clocks(tmp_path: Path) -> None:
    """In files ``run_time`` is a variable like any other, as the guide says."""
    parts = []
    for name, variable in (("one", "force"), ("two", "contact_radius_sum")):
        short(output={"variables": [variable]}).to_netcdf(tmp_path / f"{name}.nc")
        parts.append(xr.load_dataset(tmp_path / f"{name}.nc"))
    parts[0]["run_time"] = parts[1].run_time + 1.0
    merged = parts[0].merge(parts[1], compat="no_conflicts", overwrite_vars="run_time")
    assert {"force", "contact_radius_sum"} <= set(merged)
    with pytest.raises(xr.MergeError, match="'run_time'"):
        parts[0].merge(parts[1], compat="no_conflicts")


def test_sweeps_that_share_cells_merge() -> None:
    works = [["10 mJ/m^2", "20 mJ/m^2"], ["20 mJ/m^2", "30 mJ/m^2"]]
    adhesion = {"model": "jkr", "work": "10 mJ/m^2"}
    parts = [short(adhesion=adhesion, sweep={"adhesion.work": each}) for each in works]
    merged = xr.merge(parts, compat="no_conflicts", join="outer")
    assert merged.adhesion_work.values.tolist() == [0.01, 0.02, 0.03]
    assert merged.force.sel(adhesion_work=0.03).equals(parts[1].force.sel(adhesion_work=0.03))
    assert np.isfinite(merged.run_time).all()
