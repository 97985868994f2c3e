"""Tables of laws with jumps between their steps: within their stated errors against eight times as many steps."""

import contextlib
import itertools
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from exports import header_of
from scenes import ASPERITIES, scene
from scipy.ndimage import gaussian_filter

import roughmdr as rm
from roughmdr.report.export.law import QUANTITIES, law_of
from roughmdr.report.export.table import RELATIVE_FROM, table_of
from roughmdr.result.between import CONFIDENCE
from roughmdr.result.view import ResultView

TIMES = 8


def drawn(seed: int, steps: int, **changes: Any) -> dict[str, Any]:
    """A scene with work, modulus, heights and a wide range of radii at random; ``adhesion`` adds to that of JKR."""
    rng = np.random.default_rng(seed)
    adhesion = changes.pop("adhesion", {})
    made = {
        "seed": seed,
        "material": {"modulus": float(10 ** rng.uniform(6.5, 8.0)), "poisson": 0.49},
        "adhesion": {"model": "jkr", "work": float(10 ** rng.uniform(-2.5, -1.0))},
        "asperities": {
            **ASPERITIES,
            "count": 500,
            "height": {"distribution": "normal", "std": float(10 ** rng.uniform(-6.5, -5.5))},
            "radius": {"distribution": "lognormal", "mean": "50 um", "std": f"{rng.choice([5, 15, 30])} um"},
        },
        "conduction": {"conductivity": "400 W/m/K"},
        "path": {"separation": {"start": "clear", "stop": f"{rng.uniform(-0.5, 1.0)} sigma", "steps": steps}},
        "batch": {"realizations": 4},
        "output": {"variables": ["force", "contact_area", "thermal_conductance"]},
    }
    made["path"]["unload"] = True
    made["adhesion"] = None if adhesion is None else made["adhesion"] | adhesion
    return scene(**made | changes)


def coarser(fine: xr.Dataset) -> xr.Dataset:
    half = fine.sizes["step"] // 2
    return fine.isel(step=[*range(0, half, TIMES), *range(half, 2 * half, TIMES)])


def ratio(fine: xr.Dataset, quantity: str, branch: str) -> float | None:
    """The largest error of a table against the finer path over the smallest one that can be asked for; None if none."""
    asked = QUANTITIES[quantity]
    law, exact = (law_of(ResultView(each), asked, branch) for each in (coarser(fine), fine))
    for error in np.geomspace(5e-4, 0.1, 47):
        try:
            table = table_of(law, asked, branch, error=error, with_tension=True)
        except rm.StoreError:
            continue
        there = table.law
        x = there.pressure if asked.over_pressure else there.overclosure - there.datum
        other, value = (exact.pressure, exact.value) if asked.over_pressure else (-exact.separation, exact.value)
        if asked.over_pressure:  # where a load comes by: at pressures above all before, or below all after
            followed = np.maximum.accumulate(other) if branch == "loading" else np.minimum.accumulate(other[::-1])[::-1]
            other, value = other[other == followed], value[other == followed]
        within = (other > x[0]) & (other <= x[-1])
        off = np.abs(np.interp(other[within], x, there.value) - value[within])
        largest = float(np.abs(there.value).max())
        over = off / np.maximum(np.abs(value[within]), RELATIVE_FROM * largest)
        departure = 0.0 if asked.over_pressure else table.law.departure / law.pressure.max()
        assert off.max() / largest <= 1.2 * table.error + departure
        return float(over.max()) / (error + departure / RELATIVE_FROM)
    return None


def judged(seeds: range, **changes: Any) -> list[float]:
    """The ratios of the tables of all quantities and branches that there are, of scenes with 60, 120 or 240 steps."""
    found = []
    for seed in seeds:
        fine = rm.run(drawn(seed, TIMES * (60, 120, 240)[seed % 3] + 1, **changes))
        for quantity, branch in itertools.product(("pressure", "area", "conductance"), ("loading", "unloading")):
            with contextlib.suppress(rm.StoreError):  # in tension all along
                found.append(ratio(fine, quantity, branch))
    return [each for each in found if each is not None]


@pytest.mark.large
def test_sampled_adhesive_tables_are_within_their_error() -> None:
    found = judged(range(1, 4))
    assert len(found) > 9
    assert np.mean(np.array(found) <= 1.0) >= CONFIDENCE
    assert np.median(found) > 0.5  # not within by far


@pytest.mark.large
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"adhesion": {"model": "dugdale", "strength": "2 MPa"}},
        {"adhesion": None},
        {"batch": {"estimator": "expected"}},
        {"batch": {"realizations": 4, "estimator": "stratified"}},
        {"batch": {"realizations": 32}, "output": {"variables": ["force", "contact_area"], "keep": "statistics"}},
    ],
    ids=["jkr", "dugdale", "none", "expected", "stratified", "statistics"],
)
def test_tables_of_all_kinds_are_within_their_error(changes: dict[str, Any]) -> None:
    found = judged(range(1, 21), **changes)
    assert len(found) > 60
    assert np.mean(np.array(found) <= 1.0) >= CONFIDENCE
    assert np.median(found) > 0.5


def correlated(seed: int, steps: int, **changes: Any) -> dict[str, Any]:
    """Radii that follow from the heights: there is no expected law."""
    made = drawn(seed, steps, **changes)
    made["asperities"] |= {"correlation": {"radius": 1.0}}
    return made


def on_map(file: Path, steps: int, **changes: Any) -> dict[str, Any]:
    """The summits of one map of 1 mm, rough by 1 um over 30 um, which is made here."""
    rough = gaussian_filter(np.random.default_rng(1).standard_normal((128, 128)), 4.0, mode="wrap")
    at = (np.arange(128) + 0.5) / 128 * 1e-3
    data = xr.Dataset({"height": (("x", "y"), 1e-6 * rough / rough.std())}, coords={"x": at, "y": at})
    data.assign_attrs(periodic=1).to_netcdf(file)
    path = {"separation": {"start": "clear", "stop": "1 um", "steps": steps}, "unload": True}
    return (
        drawn(1, steps) | {"asperities": {"source": "surface", "file": str(file)}, "path": path, "batch": {}} | changes
    )


def tip(steps: int) -> dict[str, Any]:
    """One tip, whose jumps are beyond what a load can follow."""
    made = drawn(1, steps, batch={"estimator": "expected"}, material={"modulus": "1 MPa", "poisson": 0.5})
    made["asperities"] = ASPERITIES | {"count": 1, "height": 0, "radius": "10 um", "patch": "100 um"}
    made["path"]["separation"] |= {"start": "0.5 um", "stop": "-1 um"}
    return made


REFUSED = {
    "expected": (lambda folder: drawn(1, 60, batch={"estimator": "expected"}), "or compute about"),
    "sampled": (lambda folder: drawn(6, 60), "take the expected law, which has no such jumps"),
    "no expected law": (lambda folder: correlated(4, 40), "steps and [0-9]+ realisations"),
    "hertz": (lambda folder: drawn(1, 30, adhesion=None), "take the expected law"),
    "map": (lambda folder: on_map(folder / "map.nc", 40, adhesion=None), "or compute about [0-9]+ steps$"),
    "tip": (lambda folder: tip(20), "or compute about [0-9]+ steps$"),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", REFUSED)
def test_a_refused_table_is_written_once_what_is_asked_for_is_done(kind: str, tmp_path: Path) -> None:
    make, says = REFUSED[kind]
    table = make(tmp_path)
    few = rm.run(table)
    out = tmp_path / "law.csv"
    asked = {"to": "csv", "quantity": "area" if kind == "map" else "pressure", "branch": "unloading", "error": 0.005}
    with pytest.raises(rm.StoreError, match=says) as refused:
        rm.export(few, out, **asked)
    assert not out.exists()
    text = str(refused.value)
    if larger := re.search("ask for an error of (.*?), or", text):
        rm.export(few, out, **asked | {"error": float(larger[1])})
    steps, runs = re.search(r"about (\d+) steps(?: and (\d+) real)?", text).groups()
    table["path"]["separation"]["steps"] = int(steps)
    if runs:
        table["batch"] = {"realizations": int(runs)}
    elif "expected law" in text:
        table["batch"] = {"estimator": "expected"}
    assert int(steps) < 20 * few.sizes["step"]
    rm.export(rm.run(table), out, **asked)
    assert "jumps between the steps included: estimated from the steps, which holds in 97 % of cases" in header_of(out)


def test_more_steps_are_not_asked_for_where_contacts_of_one_map_jump(tmp_path: Path) -> None:
    few = rm.run(on_map(tmp_path / "map.nc", 60, adhesion={"model": "jkr", "work": "50 mJ/m^2"}))
    with pytest.raises(
        rm.StoreError, match=r"take a larger surface, whose contacts jump by less.*more steps do not help"
    ):
        rm.export(few, tmp_path / "law.csv", to="csv", error=1e-3)


def test_of_three_steps_nothing_is_known_between() -> None:
    few = rm.run(drawn(1, 3))
    with pytest.raises(
        rm.StoreError, match="the loading has 2 steps in contact: what is between them is known of 4 or more"
    ):
        rm.export(few, "few.csv", to="csv", error=0.1)
