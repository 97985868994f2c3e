"""Maps of the contacts of a realisation: their numbers, their scale, and what is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from forms import large
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from scenes import scene

import roughmdr as rm
from roughmdr.ensemble import Ensemble
from roughmdr.errors import StoreError
from roughmdr.pictures.map import draw_ensemble, draw_map
from roughmdr.pictures.snapshot import Snapshot
from roughmdr.pictures.style import save
from roughmdr.result.view import ResultView

MACHINE = {"force": {"stop": "0.2 mN", "steps": 5}, "unload": True}


def result(**changes: Any) -> ResultView:
    table = {"path": {"separation": {"start": "3 sigma", "stop": "0.5 sigma", "steps": 6}, "unload": True}}
    return ResultView(rm.run(scene(**{"batch": {"realizations": 2}} | table | changes)))


def asperities(**changes: Any) -> dict[str, Any]:
    table = scene()["asperities"] | {"count": 200} | changes
    return {key: value for key, value in table.items() if value is not None}


def discs(figure: Figure) -> EllipseCollection:
    return next(each for each in figure.axes[0].collections if isinstance(each, EllipseCollection))


@pytest.fixture(scope="module")
def sticky() -> ResultView:
    return result(asperities=asperities())


@pytest.mark.parametrize("step", [None, 3, 9])
@pytest.mark.parametrize("realization", [0, 1])
def test_the_drawn_forces_are_those_of_the_result(sticky: ResultView, step: int | None, realization: int) -> None:
    contacts = discs(draw_map(sticky, realization=realization, step=step))
    force = sticky.variables["force"].values[realization]
    drawn = np.asarray(contacts.get_array())
    shown = force[5 if step is None else step]
    unit = shown / drawn.sum()
    assert unit == pytest.approx(10.0 ** round(np.log10(unit)), rel=1e-11)  # that of the colour bar
    assert drawn.size == sticky.variables["contact_count"].values[realization, 5 if step is None else step]


def test_contacts_are_drawn_to_scale(sticky: ResultView) -> None:
    figure = draw_map(sticky)
    figure.draw_without_rendering()
    contacts, now = discs(figure), Snapshot.of(sticky, None, placed=True)
    radius = np.sort(now.contacts.radius[now.contacts.active])
    drawn = np.sort(np.asarray(contacts.get_widths())) / 2.0  # in mm
    seen = radius > 2e-6
    assert seen.sum() > 20
    np.testing.assert_allclose(drawn[seen], radius[seen] / 1e-3, rtol=1e-12)
    path = np.asarray(contacts.get_transforms())[int(np.argmax(contacts.get_widths()))]
    assert path[0, 0] == pytest.approx(drawn[-1], rel=1e-12)  # of a circle of radius 1, in units of the axes


def test_contacts_lie_where_the_asperities_are(sticky: ResultView) -> None:
    table = asperities(placement="random")
    ensemble = rm.generate(table, seed=7, realization=1)
    at = np.asarray(discs(draw_map(sticky, realization=1)).get_offsets())
    everywhere = np.column_stack([ensemble.x, ensemble.y]) / 1e-3
    assert all(np.abs(everywhere - one).max(axis=1).min() < 1e-12 for one in at)


def test_without_adhesion_the_colours_begin_at_zero() -> None:
    contacts = discs(draw_map(result(adhesion=None, asperities=asperities())))
    assert contacts.norm.vmin == 0.0
    assert np.asarray(contacts.get_array()).min() > 0.0


def test_a_machine_stands_where_the_result_says() -> None:
    moved = result(path=MACHINE, asperities=asperities())
    separation = moved.variables["separation"].values[0]
    now = Snapshot.of(moved, None, placed=True)
    assert now.separation == np.nanmin(separation)
    assert now.contacts.force.sum() == pytest.approx(2e-4, rel=1e-9)
    before = Snapshot.of(moved, None, step=2, placed=True)
    assert before.contacts.force.sum() == pytest.approx(1e-4, rel=1e-9)


def test_cells_of_a_sweep_are_told_apart() -> None:
    swept = result(asperities=asperities(), sweep={"adhesion.work": ["10 mJ/m^2", "80 mJ/m^2"]})
    force = swept.variables["force"].values
    for cell in ((0,), (1,)):
        now = Snapshot.of(swept, None, cell=cell, step=8, placed=False)
        assert now.contacts.force.sum() == pytest.approx(force[(*cell, 0, 8)], rel=1e-12)
    with pytest.raises(StoreError, match=r"cell is \(2,\); it must be an index of the swept keys, up to \(1\)"):
        draw_map(swept, cell=(2,))


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ({"realization": 2}, "realization is 2; the result has realisations 0 to 1"),
        ({"step": 12}, "step is 12; the path of the result has steps 0 to 11"),
        ({"step": -1}, "step is -1"),
        ({"cell": (0,)}, r"cell is \(0,\)"),
    ],
)
def test_other_places_are_refused(sticky: ResultView, where: dict[str, Any], message: str) -> None:
    with pytest.raises(StoreError, match=message):
        draw_map(sticky, **where)


def test_an_expected_law_has_no_asperities() -> None:
    with pytest.raises(StoreError, match="expected law, which has no asperities"):
        draw_map(result(batch={"estimator": "expected"}, asperities=asperities()))


def test_other_asperities_than_those_of_the_result_are_refused(sticky: ResultView) -> None:
    other = ResultView(sticky.dataset.assign(force=1.01 * sticky.dataset.force))
    with pytest.raises(StoreError, match="run the scene again"):
        draw_map(other)


def test_statistics_of_separations_are_enough_and_of_loads_are_not() -> None:
    kept = result(asperities=asperities(), output={"keep": "statistics"})
    assert discs(draw_map(kept, realization=1)) is not None
    with pytest.raises(StoreError, match=r"output\.keep = 'curves'"):
        draw_map(result(path=MACHINE, asperities=asperities(), output={"keep": "statistics"}))


def test_an_ensemble_is_drawn_by_its_heights(tmp_path: Path) -> None:
    ensemble = Ensemble.from_dataset(rm.generate(asperities(placement="random"), seed=1))
    figure = draw_ensemble(ensemble, "An ensemble")
    assert np.asarray(figure.axes[0].collections[0].get_array()).size == 200
    without = Ensemble.from_dataset(rm.generate(asperities(), seed=1))
    with pytest.raises(StoreError, match=r"no x and y.*asperities.placement"):
        draw_ensemble(without, "An ensemble")


def test_a_height_map_lies_below_its_contacts(tmp_path: Path) -> None:
    x = np.arange(48) * 1e-6
    height = 0.4e-6 * np.sin(2 * np.pi * x[:, None] / 24e-6) * np.cos(2 * np.pi * x / 16e-6)
    height += 1e-8 * np.cos(2 * np.pi * (x[:, None] + 2 * x) / 48e-6)
    units = {"units": "m"}
    data = xr.Dataset({"height": (("x", "y"), height, units)}, {"x": ("x", x, units), "y": ("y", x, units)})
    data.to_netcdf(tmp_path / "map.nc")
    table = {"source": "surface", "file": str(tmp_path / "map.nc")}
    path = {"separation": {"start": "3 sigma", "stop": "0.3 um", "steps": 4}}
    figure = draw_map(result(asperities=table, adhesion=None, path=path, batch=None))
    assert figure.axes[0].images[0].get_extent() == pytest.approx([0.0, 48.0, 0.0, 48.0])
    at = np.asarray(discs(figure).get_offsets())
    heights = np.asarray(figure.axes[0].images[0].get_array())  # over y and x
    rows, columns = np.floor(at[:, 1]).astype(int) % 48, np.floor(at[:, 0]).astype(int) % 48
    assert (heights[rows, columns] > 0.8 * heights.max()).all()


@pytest.mark.parametrize("kind", [large("png"), "svg", large("pdf")])
def test_a_map_is_written_alike_each_time(sticky: ResultView, tmp_path: Path, kind: str) -> None:
    written = []
    for name in ("one", "two"):
        save(draw_map(sticky), tmp_path / f"{name}.{kind}")
        written.append((tmp_path / f"{name}.{kind}").read_bytes())
    assert written[0] == written[1]


@pytest.mark.large
def test_a_result_by_boundary_elements_is_said_to_be_one() -> None:
    coupled = {"model": "pairwise", "beyond": "boundary_elements"}
    crowd = asperities(count=40, patch="0.1 mm")
    path = {"separation": ["2 um", "0.5 um"]}
    found = result(asperities=crowd, adhesion=None, interaction=coupled, path=path, batch=None)
    by_elements = bool(found.variables["grid_points"].values[0] > 0.0)
    assert by_elements
    assert "by boundary elements" in Snapshot.of(found, None, placed=True).place


def test_the_step_of_the_pull_off(sticky: ResultView) -> None:
    way = {"start": "clear", "stop": "0.5 sigma", "steps": 40}
    made = rm.run(scene(asperities=asperities(), batch={"realizations": 2}, path={"separation": way, "unload": True}))
    for realization in (0, 1):
        figure = rm.plot(made, kind="map", step="pull-off", realization=realization)
        place = float(made.pull_off_separation[realization])
        step = 40 + int(np.argmin(np.abs(made.separation.values[40:] - place)))
        assert f"step {step} of 80 (unloading)" in figure.get_suptitle().replace("\n", " ")
    with pytest.raises(StoreError, match="must be a number from 0, or 'pull-off'"):
        rm.plot(made, kind="map", step="pulloff")
    up_and_no_further = rm.run(scene(asperities=asperities(), batch=None, path={"separation": ["3 um", "1 um"]}))
    with pytest.raises(StoreError, match="give its number"):
        rm.plot(up_and_no_further, kind="map", step="pull-off")


def test_a_step_without_an_equilibrium_is_passed_over(sticky: ResultView) -> None:
    changed = sticky.dataset.copy(deep=True)
    changed.force[0, 5:7] = np.nan  # the closest approach, which the unloading repeats
    assert "step 4 of 12" in draw_map(ResultView(changed)).get_suptitle().replace("\n", " ")
