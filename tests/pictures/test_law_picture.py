"""Pictures of laws: the numbers in them, how they are told apart, and that they can be read."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from legible import assert_legible, unit_of
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.model_error.at_force import RELEASING
from roughmdr.pictures.curves import Quantity, curves_of
from roughmdr.pictures.style import BRANCH_COLOURS, new_figure, set_title
from roughmdr.result.view import ResultView

FEW = {**ASPERITIES, "count": 100}
CLEAR = {"separation": {"start": "clear", "stop": {"contact_fraction": 0.02}, "steps": 40}, "unload": True}
LONG = "A title that is much longer than any picture is wide, " * 4


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return rm.run(scene(asperities=FEW, path=CLEAR, title=LONG))


@pytest.fixture(scope="module")
def without_adhesion() -> xr.Dataset:
    return rm.run(scene(asperities=FEW, path=CLEAR, adhesion=None))


def line(figure: Any, panel: int, branch: str) -> np.ndarray:
    """The thick line of a branch in a panel, in SI."""
    lines = [each for each in figure.axes[panel].get_lines() if each.get_color() == BRANCH_COLOURS[branch]]
    units = unit_of(figure.axes[panel].get_xlabel()), unit_of(figure.axes[panel].get_ylabel())
    return np.asarray(max(lines, key=lambda each: each.get_linewidth()).get_xydata()) * units


@pytest.mark.large
def test_the_mean_is_drawn_in_the_unit_of_the_axis(result: xr.Dataset) -> None:
    figure = rm.plot(result, variables="force")
    assert figure.axes[0].get_ylabel() == "force [mN]"
    assert figure.axes[0].get_xlabel() == "separation [µm]"
    loading = result.isel(step=result.branch == "loading")
    drawn = line(figure, 0, "loading")
    np.testing.assert_allclose(drawn[:, 0], loading.separation, rtol=1e-12)
    np.testing.assert_allclose(drawn[:, 1], loading.force.mean("realization"), rtol=1e-9, atol=1e-15)
    assert_legible(figure)


@pytest.mark.few(1)
@pytest.mark.parametrize("title", ["Short", "", LONG])
def test_a_title_and_its_notes_take_one_line_where_they_fit(title: str) -> None:
    figure, note = new_figure(10.0, 4.0), "model: force within about 1 %"
    set_title(figure, title, ["8 realisations", note])
    lines = str(figure.get_suptitle()).splitlines()
    if title is LONG:
        assert " ".join(lines[:-2]) == title.strip()
        assert lines[-1] == note
    else:
        assert lines == [f"{title}; 8 realisations; {note}".removeprefix("; ")]
    assert figure.texts[0].get_window_extent().width < figure.bbox.width


@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_a_variable_over_another_and_per_area(keep: str) -> None:
    output = {"variables": ["force", "contact_area", "contact_count"], "keep": keep}
    made = rm.run(scene(asperities=FEW, output=output))
    figure = rm.plot(made, variables="contact_area", x="force", per_area=True)
    assert [figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()] == ["pressure [kPa]", "contact fraction"]
    mean = made if keep == "statistics" else made.mean("realization")
    force, area = (mean.get(f"{name}_mean", mean.get(name)) for name in ("force", "contact_area"))
    loading = (made.branch == "loading").values
    drawn = line(figure, 0, "loading")
    np.testing.assert_allclose(drawn[:, 0], force[loading] / made.nominal_area, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(drawn[:, 1], area[loading] / made.nominal_area, rtol=1e-9, atol=1e-15)
    counts = rm.plot(made, variables="contact_count", per_area=True)
    assert counts.axes[0].get_ylabel() == "contacts per area [/mm²]"


@pytest.mark.large
@pytest.mark.parametrize("changes", [{}, {"sweep": {"adhesion.work": [0.01, 0.05]}}])
def test_the_pull_off_is_marked_per_area(changes: dict[str, Any]) -> None:
    made = rm.run(scene(asperities=FEW, path=CLEAR, **changes))
    figure = rm.plot(made, variables="force", per_area=True)
    marks = [each for each in figure.axes[0].get_lines() if each.get_marker() == "o" and len(each.get_xydata()) == 1]
    expected = np.ravel(made.pull_off_force.mean("realization") / made.nominal_area)
    drawn = [float(each.get_ydata()[0]) * unit_of(figure.axes[0].get_ylabel()) for each in marks]
    np.testing.assert_allclose(drawn, expected, rtol=1e-9)


@pytest.mark.large
def test_an_exponential_law_has_a_logarithmic_axis_and_one_with_tension_none(
    result: xr.Dataset, without_adhesion: xr.Dataset
) -> None:
    assert rm.plot(without_adhesion, variables="force").axes[0].get_yscale() == "log"
    assert rm.plot(without_adhesion, variables="force", log=False).axes[0].get_yscale() == "linear"
    assert rm.plot(result, variables="force").axes[0].get_yscale() == "linear"
    assert rm.plot(result, variables="force", log=True).axes[0].get_yscale() == "log"


def test_the_pull_off_is_marked_where_it_is(result: xr.Dataset) -> None:
    figure = rm.plot(result, variables="force")
    (marks,) = figure.axes[0].containers
    (x,), (y,) = marks.lines[0].get_data()
    np.testing.assert_allclose(x, 1e6 * result.pull_off_separation.mean(), rtol=1e-9)
    np.testing.assert_allclose(y, 1e3 * result.pull_off_force.mean(), rtol=1e-9)
    assert "pull-off" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_separations_beyond_trust_are_grey_and_the_legend_says_so() -> None:
    deep = rm.run(scene(asperities=FEW, batch=None))
    figure = rm.plot(deep, variables="force")
    assert "beyond the range of trust" in [text.get_text() for text in figure.legends[0].get_texts()]
    spans = [patch.get_x() + patch.get_width() for patch in figure.axes[0].patches if hasattr(patch, "get_width")]
    np.testing.assert_allclose(spans, [1e6 * deep.trusted_separation.max()], rtol=1e-9)


def test_the_stiffness_where_contacts_detach_is_a_median_with_a_band() -> None:
    made = rm.run(scene(asperities=FEW, batch={"realizations": 40}))
    drawn = line(rm.plot(made, variables="stiffness"), 0, "unloading")
    unloading = made.isel(step=made.branch == "unloading")
    np.testing.assert_allclose(drawn[:, 1], unloading.stiffness.median("realization"), rtol=1e-9)
    assert np.abs(np.diff(drawn[:, 1])).max() < np.abs(unloading.stiffness.mean("realization").diff("step")).max()


def test_many_realisations_are_a_band_and_some_lines(result: xr.Dataset) -> None:
    many = xr.concat([result] * 7, "realization", data_vars="minimal", coords="minimal", compat="override")
    few, crowd = (len(rm.plot(each, variables="force").axes[0].get_lines()) for each in (result, many))
    assert crowd < few + 20
    assert len(rm.plot(many, variables="force").axes[0].collections) > len(
        rm.plot(result, variables="force").axes[0].collections
    )


@pytest.mark.large
@pytest.mark.parametrize("count", [3, 12])
def test_few_cells_are_named_and_more_have_a_colour_bar(count: int) -> None:
    sweep = {"adhesion.work": {"linspace": ["10 mJ/m^2", "90 mJ/m^2"], "num": count}}
    made = rm.run(scene(asperities=FEW, batch={"realizations": 2}, sweep=sweep))
    figure = rm.plot(made, kind="law", variables="force")
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    bars = [ax.get_ylabel() for ax in figure.axes if ax.get_ylabel().startswith("adhesion work")]
    assert (len(labels), bars) == ((3, []) if count == 3 else (0, ["adhesion work [mJ/m²]"]))
    assert_legible(figure)


@pytest.mark.large
def test_many_cells_of_several_keys_are_drawn_along_one_and_select_chooses() -> None:
    sweep = {"adhesion.work": [0.01, 0.02, 0.05], "asperities.height.std": {"linspace": [1e-6, 2e-6], "num": 4}}
    made = rm.run(scene(asperities=FEW, batch={"realizations": 2}, sweep=sweep))
    figure = rm.plot(made, kind="law", variables="force")
    assert "adhesion_work = 20 mJ/m^2; select chooses other cells" in figure.get_suptitle()
    chosen = rm.plot(made, kind="law", variables="force", select={"adhesion.work": "50 mJ/m^2"})
    by_hand = rm.plot(made.sel(adhesion_work=0.05), variables="force")
    for one, other in zip(chosen.axes[0].get_lines(), by_hand.axes[0].get_lines(), strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())


@pytest.mark.large
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_one_result_gives_the_same_file(result: xr.Dataset, tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        rm.plot(result, tmp_path / f"{name}.{suffix}", variables="force")
    assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


@pytest.mark.large
def test_a_style_changes_the_picture_and_is_left_behind(result: xr.Dataset) -> None:
    from matplotlib import rcParams

    before = dict(rcParams)
    dark = rm.plot(result, variables="force", style="dark_background", with_expected=True)
    assert dark.get_facecolor() == (0.0, 0.0, 0.0, 1.0)
    assert dict(rcParams) == before


@pytest.mark.large
@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"kind": "swep"}, "did you mean 'sweep'"),
        ({"style": "dark_backgrund"}, "did you mean 'dark_background'"),
        ({"x": "forse"}, "did you mean 'force'"),
        ({"at": {"force": 1.0}}, "at does not go with kind 'law'"),
        ({"select": {"adhesion.work": 0.05}}, "is not swept"),
        ({"x": "remote", "with_expected": True}, "which are over its variables"),
    ],
)
def test_options_that_are_refused(result: xr.Dataset, options: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.StoreError, match=says):
        rm.plot(result, **options)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "sets no parameter"),
        (b"lines.linewidth = 3\n", "is no style of matplotlib: Missing colon"),
        (b"lines.linewidth: wide\n", "Bad value"),
        (b"lines.width: 3\n", "Bad key lines.width"),
        (b"\x89PNG\r\n\x1a\n\xff", "cannot be read as a style"),
        (b"text.usetex: True\ntext.latex.preamble: \\\\no_such_command\n", "cannot draw with it here"),
    ],
)
def test_a_file_that_is_no_style_or_needs_what_is_not_there(
    result: xr.Dataset, tmp_path: Path, content: bytes, says: str
) -> None:
    from matplotlib import rcParams

    before, style, picture = dict(rcParams), tmp_path / "own.mplstyle", tmp_path / "a.png"
    style.write_bytes(content)
    with pytest.raises(rm.StoreError, match=says):
        rm.plot(result, picture, variables="force", style=str(style))
    assert dict(rcParams) == before
    assert [path.name for path in tmp_path.iterdir()] == ["own.mplstyle"]


def test_a_result_without_an_area_has_nothing_per_area(result: xr.Dataset) -> None:
    with pytest.raises(rm.StoreError, match="no nominal_area"):
        rm.plot(result.drop_vars("nominal_area"), per_area=True)


@pytest.mark.large
def test_a_picture_loads_no_more_numbers_than_it_draws_and_the_command_makes_it(tmp_path: Path) -> None:
    made = rm.run(scene(asperities=FEW, batch={"realizations": 3}), tmp_path / "out.nc")
    done = CliRunner().invoke(
        main,
        ["plot", str(tmp_path / "out.nc"), "-o", str(tmp_path / "a.svg"), "--variable", "stiffness", "--x", "force"],
    )
    assert done.exit_code == 0, done.output
    rm.plot(made, tmp_path / "b.svg", variables="stiffness", x="force")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.large
@pytest.mark.parametrize(
    "path",
    [
        {"force": {"stop": "0.2 mN", "steps": 20}, "unload": True},
        {"remote": {"stop": "0 um", "steps": 20}, "machine_stiffness": "1 kN/m", "unload": True},
        {"preload": "0.2 mN", "steps": 20, "unload": True},
    ],
)
def test_paths_of_machines_are_drawn(path: dict[str, Any]) -> None:
    made = rm.run(scene(asperities=FEW, batch={"realizations": 4}, path=path))
    assert_legible(rm.plot(made))
    assert ResultView(made).sizes["step"] in (40, 41)


def test_a_path_that_turns_without_a_repeated_step_is_drawn_whole() -> None:
    path = {"separation": ["3 um", "1 um", "2 um", "0.5 um", "1.5 um"]}
    made = rm.run(scene(asperities=FEW, path=path))
    figure = rm.plot(made, variables="contact_area")
    drawn = [each.get_xdata() for each in figure.axes[0].get_lines() if each.get_linewidth() > 2.0]
    assert [np.round(each, 9).tolist() for each in drawn] == [[3.0, 1.0], [1.0, 2.0], [2.0, 0.5], [0.5, 1.5]]


def test_a_single_step_is_a_point() -> None:
    figure = rm.plot(rm.run(scene(asperities=FEW, path={"separation": ["1 um"]})), variables="force")
    assert any(each.get_marker() == "o" for each in figure.axes[0].get_lines())


@pytest.mark.large
def test_the_legend_of_a_narrow_picture_is_not_cut_off() -> None:
    sweep = {"mode": "zip", "adhesion.work": [0.01, 0.05], "asperities.height.std": ["1 um", "2 um"]}
    assert_legible(rm.plot(rm.run(scene(asperities=FEW, sweep=sweep)), variables="force"))


def test_a_stiffness_of_few_steps_is_not_smoothed_over_all_of_them() -> None:
    made = rm.run(scene(asperities=FEW, path={"separation": ["2 um", "0.5 um"], "unload": True}))
    drawn = line(rm.plot(made, variables="stiffness"), 0, "unloading")
    unloading = made.stiffness[:, made.branch == "unloading"]
    np.testing.assert_allclose(drawn[:, 1], unloading.median("realization"), rtol=1e-9)


def test_no_pull_off_is_named_where_a_logarithmic_axis_cannot_show_it(result: xr.Dataset) -> None:
    figure = rm.plot(result, variables="force", log=True)
    assert "pull-off" not in [each.get_text() for each in figure.legends[0].get_texts()]


def test_two_values_of_one_key_are_refused(tmp_path: Path) -> None:
    made = tmp_path / "out.nc"
    rm.run(scene(asperities=FEW, sweep={"adhesion.work": [0.01, 0.05]}), made)
    chosen = ["--select", "adhesion.work=0.01", "--select", "adhesion.work=0.05"]
    run = CliRunner().invoke(main, ["plot", str(made), "-o", str(tmp_path / "out.png"), *chosen])
    assert (run.exit_code, (tmp_path / "out.png").exists()) == (2, False)
    assert "adhesion.work has a value already, 0.01" in run.output


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("hills", [False, True])
def test_the_band_of_the_model_error_is_over_the_largest_force_where_the_error_is(
    hills: bool, keep: str, tmp_path: Path
) -> None:
    """That of hills by JKR is there before touch, where the force is 0."""
    one = {"height": 0.0, "radius": 1e3, "x": 0.2, "y": 0.5}
    surface = xr.Dataset(
        {name: ("asperity", [value], {"units": "m"}) for name, value in one.items()},
        attrs={"shape": "paraboloid", "patch": 1.0, **({"asperity_model": "hills"} if hills else {})},
    )
    surface.to_netcdf(tmp_path / "one.nc")
    made = rm.run(
        scene(
            asperities={"source": "file", "file": str(tmp_path / "one.nc")},
            material={"effective_modulus": "1 GPa"}, adhesion={"model": "jkr", "work": "10 mJ/m^2"},
            interaction={"model": "pairwise"}, path={"separation": ["1 um", "0.5 um", "-1 um", "0.5 um"]},
            output={"variables": ["force", "model_error_curve"], "keep": keep}, batch={"realizations": 1},
        )
    )  # fmt: skip
    result = ResultView(made)
    curves = list(curves_of(result, Quantity.of(result, "force"), Quantity.of(result, "separation")))
    error = made.model_error_curve if keep == "curves" else made.model_error_curve_mean
    down, back, error = curves[0].model_error, curves[-1], error.values.ravel()
    largest = max(np.abs(each.middle).max() for each in curves)
    assert (down[:2] > 0.0).tolist() == [False, hills]
    forces = [float(curves[0].middle[2]), float(back.middle[-1])]
    of_range = float(made.adhesion_range_error.max())
    for force, at, drawn in zip(forces, error[2:], (down[2], back.model_error[-1]), strict=True):
        by_jkr = at if hills else of_range
        assert by_jkr > 0.0
        own, tension = at - by_jkr, max(-each.middle.min() for each in curves)
        expected = max(abs(force), tension) * own / (1.0 - min(own, 0.9)) + largest * by_jkr
        expected += (RELEASING - 1.0) * largest * of_range if force < 0.0 else 0.0
        assert drawn == pytest.approx(expected, rel=1e-12)
    earlier = ResultView(made.drop_vars(["asperity_origin", "border_error"]))  # by a version that did not know these
    same = list(curves_of(earlier, Quantity.of(earlier, "force"), Quantity.of(earlier, "separation")))
    for one, other in zip(curves, same, strict=True):
        np.testing.assert_array_equal(other.model_error, one.model_error)


@pytest.mark.large
def test_the_stiffness_of_contacts_that_yield_does_not_rise_from_the_turn() -> None:
    path = {"separation": {"start": "3 sigma", "stop": "1 sigma", "steps": 8}, "unload": True}
    asked = scene(asperities=FEW, path=path, adhesion=None, plasticity={"yield_strength": "1 kPa"})
    asked["output"] = {"variables": ["stiffness", "force"]}
    run = rm.run(asked)
    figure = rm.plot(run)
    up = run.isel(step=slice(8, None))
    np.testing.assert_allclose(line(figure, 0, "unloading")[:, 0], up.separation, rtol=1e-12)
    np.testing.assert_allclose(line(figure, 1, "unloading")[0, 0], run.separation.min(), rtol=1e-12)
    once = rm.run(asked | {"path": {"separation": [3e-6, 2e-6, 1e-6, 1.01e-6, 3e-6]}})  # the turn is not repeated
    np.testing.assert_allclose(line(rm.plot(once), 0, "unloading")[:, 0], once.separation[3:], rtol=1e-12)
