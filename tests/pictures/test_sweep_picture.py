"""Pictures of sweeps: points over one key, colour maps over two, panels for three."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from legible import assert_legible, unit_of
from scenes import ASPERITIES, scene

import roughmdr as rm

FEW = {**ASPERITIES, "count": 100}
PATH = {"separation": {"start": "clear", "stop": {"contact_fraction": 0.02}, "steps": 30}, "unload": True}
WORK = {"linspace": ["10 mJ/m^2", "50 mJ/m^2"], "num": 3}
STD = {"logspace": ["0.3 um", "3 um"], "num": 4}
RADIUS = ["30 um", "60 um"]


def swept(sweep: dict[str, Any], realizations: int = 4, **changes: Any) -> xr.Dataset:
    return rm.run(scene(asperities=FEW, path=PATH, batch={"realizations": realizations}, sweep=sweep, **changes))


@pytest.fixture(scope="module")
def two() -> xr.Dataset:
    return swept({"adhesion.work": WORK, "asperities.height.std": STD})


@pytest.mark.large
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_the_pull_off_over_one_key_with_its_error(keep: str) -> None:
    made = swept({"asperities.height.std": STD}, output={"keep": keep, "variables": ["force"]})
    figure = rm.plot(made, kind="sweep", log=False)
    ax = figure.axes[0]
    assert (ax.get_xscale(), ax.get_xlabel()) == ("log", "asperities.height.std [µm]")
    ((points, _, (bars,)),) = ax.containers
    if keep == "curves":
        mean = made.pull_off_force.mean("realization")
        error = made.pull_off_force.std("realization", ddof=1) / 2.0
    else:
        mean, error = made.pull_off_force_mean, made.pull_off_force_sem
    scale = 1.0 / unit_of(ax.get_ylabel())
    np.testing.assert_allclose(points.get_xdata(), 1e6 * made.asperities_height_std, rtol=1e-12)
    np.testing.assert_allclose(points.get_ydata(), scale * mean, rtol=1e-9)
    lengths = [abs(np.diff(segment[:, 1])[0]) for segment in bars.get_segments()]
    np.testing.assert_allclose(lengths, 4.0 * scale * error, rtol=1e-9)
    assert_legible(figure)


@pytest.mark.large
def test_two_keys_are_a_colour_map_of_each_cell(two: xr.Dataset) -> None:
    figure = rm.plot(two, kind="sweep", log=False)
    ax, bar = figure.axes
    assert bar.get_ylabel() == "pull-off force [µN]"
    values = ax.collections[0].get_array()
    np.testing.assert_allclose(values, 1e6 * two.pull_off_force.mean("realization").T, rtol=1e-9)
    written = [text.get_text() for text in ax.texts]
    assert len(written) == 12
    assert all("±" in text for text in written)
    assert_legible(figure)
    other = rm.plot(two, kind="sweep", log=False, x="asperities.height.std")
    np.testing.assert_array_equal(other.axes[0].collections[0].get_array(), values.T)


@pytest.mark.large
def test_three_keys_are_panels_with_one_colour_bar() -> None:
    made = swept({"adhesion.work": WORK, "asperities.height.std": STD, "asperities.radius.mean": RADIUS}, 2)
    figure = rm.plot(made, log=False)
    panels = [ax for ax in figure.axes if ax.collections and ax.get_title()]
    assert [ax.get_title() for ax in panels] == [f"asperities.radius.mean = {r} µm" for r in (30, 60)]
    for number, ax in enumerate(panels):
        mean = made.pull_off_force.isel(asperities_radius_mean=number).mean("realization")
        drawn = ax.collections[0].get_array()
        np.testing.assert_allclose(drawn / drawn.min(), (mean / mean.min()).T, rtol=1e-9)
        assert ax.collections[0].norm is panels[0].collections[0].norm
    assert_legible(figure)


@pytest.mark.large
def test_names_are_told_apart_without_a_scale() -> None:
    made = swept({"asperities.height.distribution": ["normal", "logistic", "gumbel_r"]})
    ax = rm.plot(made, kind="sweep").axes[0]
    assert sorted(label.get_text() for label in ax.get_xticklabels()) == ["gumbel_r", "logistic", "normal"]


@pytest.mark.large
def test_keys_swept_together_are_drawn_over_one_of_them() -> None:
    sweep = {"mode": "zip", "adhesion.work": [0.01, 0.03, 0.05], "asperities.radius.mean": [3e-5, 6e-5, 9e-5]}
    made = swept(sweep)
    for key, label in (("adhesion.work", "adhesion.work [mJ/m²]"), ("asperities.radius.mean", None)):
        figure = rm.plot(made, kind="sweep", x=key)
        assert figure.axes[0].get_xlabel() == (label or "asperities.radius.mean [µm]")


@pytest.mark.large
def test_a_law_at_a_force_and_at_its_largest(two: xr.Dataset) -> None:
    figure = rm.plot(two, kind="sweep", variables="contact_area", at={"force": "1 uN"})
    assert "where loading reaches force 1 uN" in figure.get_suptitle()
    by_hand = two.roughmdr.at_force("1 uN").contact_area.mean("realization")
    drawn = figure.axes[0].collections[0].get_array()
    np.testing.assert_allclose(drawn / np.nanmax(drawn), by_hand.T / by_hand.max(), rtol=1e-9)
    largest = rm.plot(two, kind="sweep", variables="force", per_area=True)
    mean = two.force.mean("realization").max("step") / two.nominal_area
    drawn = largest.axes[0].collections[0].get_array()
    np.testing.assert_allclose(drawn / drawn.max(), mean.T / mean.max(), rtol=1e-9)


@pytest.mark.large
def test_diagnostics_are_numbers_too(two: xr.Dataset) -> None:
    for name in ("model_error", "tabor_number", "run_time"):
        if name in two:
            assert_legible(rm.plot(two, kind="sweep", variables=name))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"variables": ["force", "stiffness"]}, "a sweep is drawn of one"),
        ({"variables": "stiffness", "at": {"force": 1.0, "pressure": 1.0}}, "at names force, pressure"),
        ({"variables": "pull_of_force"}, "did you mean 'pull_off_force'"),
        ({"at": {"forse": 1.0}, "variables": "stiffness"}, "did you mean 'force'"),
        ({"at": {"force": "1 um"}, "variables": "stiffness"}, "at force = 1 um"),
        ({"x": "adhesion.wrk"}, "did you mean 'adhesion_work'"),
        ({"select": {"adhesion.work": "11 mJ/m^2"}}, "is not in the result; it has 0.01, 0.03, 0.05"),
        ({"variables": "pull_off_force", "at": {"force": 1.0}}, "which is no curve"),
    ],
)
def test_sweeps_that_are_refused(two: xr.Dataset, options: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.StoreError, match=says):
        rm.plot(two, kind="sweep", **options)


def test_without_a_sweep_there_is_none() -> None:
    with pytest.raises(rm.StoreError, match="nothing was swept"):
        rm.plot(rm.run(scene(asperities=FEW, batch=None)), kind="sweep")


def test_four_keys_need_a_choice() -> None:
    sweep = {
        "adhesion.work": [0.01, 0.02], "asperities.height.std": [1e-6, 2e-6], "asperities.radius.mean": [3e-5, 5e-5],
        "material.modulus": [1e6, 2e6],
    }  # fmt: skip
    made = rm.run(scene(asperities=FEW, batch=None, sweep=sweep))
    with pytest.raises(rm.StoreError, match="choose a value of"):
        rm.plot(made)
    assert_legible(rm.plot(made, select={"material.modulus": "2 MPa"}))


def test_numbers_over_decades_have_a_logarithmic_axis_and_tensions_are_turned_round(two: xr.Dataset) -> None:
    figure = rm.plot(two, kind="sweep")
    lowest = two.pull_off_force.mean("realization")
    assert float(lowest.min() / lowest.max()) > 100.0
    assert figure.axes[1].get_ylabel() == "minus pull-off force [µN]"
    values = figure.axes[0].collections[0].get_array()
    np.testing.assert_allclose(values, -1e6 * lowest.T, rtol=1e-9)


@pytest.fixture(scope="module")
def together() -> xr.Dataset:
    return swept({"mode": "zip", "adhesion.work": [0.01, 0.05], "asperities.height.std": ["1 um", "2 um"]})


def test_what_is_swept_together_is_named(together: xr.Dataset) -> None:
    figure = rm.plot(together, kind="sweep")
    assert "asperities.height.std changes along with it" in figure.axes[0].get_title() + str(figure.get_suptitle())


def test_numbers_of_both_signs_have_no_logarithm(together: xr.Dataset) -> None:
    changed = together.assign(pull_off_force=together.pull_off_force * [[-1.0], [1.0]])
    with pytest.raises(rm.StoreError, match="some are not above 0"):
        rm.plot(changed, kind="sweep", log=True)


def test_at_a_force_another_variable_is_drawn(together: xr.Dataset) -> None:
    assert "contact area" in rm.plot(together, kind="sweep", at={"force": "10 uN"}).axes[0].get_ylabel()
    with pytest.raises(rm.StoreError, match="does not go with force itself"):
        rm.plot(together, kind="sweep", variables="force", at={"force": "10 uN"})


@pytest.mark.large
def test_options_choose_the_kind_of_picture() -> None:
    few = swept({"adhesion.work": [0.01, 0.05]}, 2)
    for options in ({"variables": "pull_off_force"}, {"at": {"force": "1 uN"}}, {"x": "adhesion.work"}):
        assert rm.plot(few, **options).axes[0].get_xlabel() == "adhesion.work [mJ/m²]"
    assert rm.plot(few, variables="force").axes[0].get_xlabel() == "separation [µm]"
    many = swept({"adhesion.work": {"linspace": [0.01, 0.05], "num": 9}}, 2)
    assert rm.plot(many, variables="contact_area", x="force").axes[0].get_xlabel().startswith("force")


def test_a_pressure_that_the_result_does_not_hold_at_a_contact_fraction(two: xr.Dataset) -> None:
    drawn = rm.plot(two, variables="pressure", at={"contact_fraction": "1 %"}, log=False).axes[0]
    by_hand = two.roughmdr.at_contact_fraction(0.01).pressure.mean("realization")
    values = drawn.collections[0].get_array()
    np.testing.assert_allclose(values / values.max(), by_hand.T / by_hand.max(), rtol=1e-9)
    with pytest.raises(rm.StoreError, match="no loading reaches it"):
        rm.plot(two, variables="pressure", at={"contact_fraction": "90 %"})
    with pytest.raises(rm.StoreError, match="must be at most 1"):
        rm.plot(two, variables="pressure", at={"contact_fraction": 2.0})


def test_the_message_about_another_kind_of_file_is_a_sentence(together: xr.Dataset) -> None:
    with pytest.raises(rm.StoreError, match="kind 'fit' is drawn from a fit, and this is a result"):
        rm.plot(together, kind="fit")
