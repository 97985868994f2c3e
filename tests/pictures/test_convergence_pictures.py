"""Pictures of how means over realisations converge."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from forms import large
from matplotlib.axes import Axes
from scenes import scene

import roughmdr as rm
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.convergence import draw_convergence
from roughmdr.pictures.style import save
from roughmdr.result.view import ResultView


def result(**changes: Any) -> ResultView:
    path = {"separation": {"start": "5 um", "stop": "0.5 sigma", "steps": 6}, "unload": True}
    asperities = scene()["asperities"] | {"count": 200}
    return ResultView(rm.run(scene(**{"path": path, "asperities": asperities} | changes)))


def curve(ax: Axes, number: int) -> tuple[Floats, Floats]:
    """The points of a line."""
    x, y = (np.asarray(each) for each in ax.lines[number].get_data())
    return x, y


@pytest.fixture(scope="module")
def sixteen() -> ResultView:
    return result()


def test_the_running_error_is_that_of_numpy(sixteen: ResultView) -> None:
    figure = draw_convergence(sixteen)
    force = sixteen.variables["force"].values
    largest = force[:, int(np.abs(force.mean(axis=0)).argmax())]
    pull_off = sixteen.variables["pull_off_force"].values
    assert np.isfinite(pull_off).all()
    for ax, values in zip(figure.axes, (largest, pull_off), strict=True):
        counts, errors = curve(ax, 0)
        assert counts.tolist() == list(range(2, 17))
        for count, error in zip(counts.tolist(), errors, strict=True):
            some = values[:count]
            expected = np.std(some, ddof=1) / math.sqrt(count) / abs(some.mean())
            assert error == pytest.approx(expected, rel=1e-13)


def test_the_last_error_is_on_the_line_of_the_square_root(sixteen: ResultView) -> None:
    ax = draw_convergence(sixteen).axes[0]
    n, line = curve(ax, 1)
    assert line[0] * math.sqrt(2.0 / 16.0) == pytest.approx(curve(ax, 0)[1][-1], rel=1e-12)
    assert line[0] * math.sqrt(n[0]) == pytest.approx(line[1] * math.sqrt(n[1]))


def test_the_note_says_how_many_realisations_an_error_takes(sixteen: ResultView) -> None:
    force = sixteen.variables["force"].values
    largest = force[:, int(np.abs(force.mean(axis=0)).argmax())]
    needed = float(f"{(100.0 * np.std(largest, ddof=1) / largest.mean()) ** 2:.1e}")
    assert f"largest force: 1 % takes about {needed:.0f}, 0.1 % takes" in draw_convergence(sixteen).get_suptitle()


@pytest.mark.large
def test_levels_are_those_of_the_result() -> None:
    asked = result(accuracy={"relative": 0.05, "max_realizations": 40, "method": "sampled"})
    figure = draw_convergence(asked)
    levels = {str(line.get_label()): np.asarray(line.get_ydata()) for line in figure.axes[0].lines}
    model = float(np.nanmax(asked.variables["model_error"].values))
    assert levels["accuracy.relative, as asked: 0.05"][0] == 0.05
    assert next(value[0] for label, value in levels.items() if "by the model" in label) == model


@pytest.mark.large
@pytest.mark.parametrize(("number", "bands"), [(3, 0), (8, 1)])
def test_few_cells_are_lines_and_many_a_band(number: int, bands: int) -> None:
    works = [f"{10 + 5 * i} mJ/m^2" for i in range(number)]
    figure = draw_convergence(result(batch={"realizations": 4}, sweep={"adhesion.work": works}))
    assert len(figure.axes[0].collections) == bands
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert ("adhesion_work = 20 mJ/m^2" in labels) == (not bands)


def test_realisations_without_a_contact_at_first_have_no_error_yet() -> None:
    runs = result()
    runs.variables["force"].values[:3] = 0.0
    ax = draw_convergence(runs).axes[0]
    errors = curve(ax, 0)[1]
    assert np.isnan(errors[:2]).all()
    assert np.isfinite(errors[2:]).all()
    assert 0.0 < ax.get_ylim()[0] < errors[2:].min()


def test_under_a_dead_load_the_separation_converges() -> None:
    figure = draw_convergence(result(path={"force": {"stop": "1 mN", "steps": 5}}, adhesion=None))
    assert [ax.get_title() for ax in figure.axes] == ["separation at the largest load, over its range"]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"output": {"keep": "statistics"}}, r"output\.keep = 'curves'"),
        ({"batch": {"realizations": 1}}, r"a larger batch\.realizations"),
        ({"batch": {"estimator": "expected"}}, r"batch\.estimator = 'sampled'"),
    ],
)
def test_results_without_realisations_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(StoreError, match=message):
        draw_convergence(result(**changes))


@pytest.mark.large
@pytest.mark.parametrize("kind", [large("png"), "svg", large("pdf")])
def test_convergence_is_written_alike_each_time(sixteen: ResultView, tmp_path: Path, kind: str) -> None:
    written = []
    for name in ("one", "two"):
        save(draw_convergence(sixteen), tmp_path / f"{name}.{kind}")
        written.append((tmp_path / f"{name}.{kind}").read_bytes())
    assert written[0] == written[1]


@pytest.mark.large
def test_with_a_preload_the_separation_converges() -> None:
    path = {"preload": "1 mN", "steps": 5, "unload": True}
    titles = [ax.get_title() for ax in draw_convergence(result(path=path)).axes]
    assert titles == ["separation at the largest load, over its range", "pull-off force"]


def test_lines_of_cells_are_seen_on_a_dark_ground() -> None:
    from matplotlib import style
    from matplotlib.colors import to_rgb

    from roughmdr.pictures.style import colours

    with style.context("dark_background"):
        assert all(sum(to_rgb(each)) > 1.0 for each in colours(5))


def test_the_numbers_of_many_realisations_do_not_overlap(sixteen: ResultView) -> None:
    many = ResultView(sixteen.dataset.isel(realization=np.arange(8000) % 16))
    ax = draw_convergence(many).axes[0]
    assert [each for each in ax.get_xticks() if 2.0 <= each <= 16000.0] == [10.0, 100.0, 1000.0, 10000.0]
