"""The study of hills: its maps, and what it finds in its quick form."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from carried_out import CarriedOut, carried_out
from studies.comparison import rms
from studies.hills import METHODS, PERSSON, STUDY, dataset_of, errors_of, groups, within
from studies.hills.convergence import FINEST, SCALES, by_noise, by_points, by_scales
from studies.hills.maps import FILES, FOLDER, QUANTITIES, MapCase, by_elements, by_persson, press_files, square

SHARED = Path(__file__).parents[3] / "shared" / "surfaces"


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CarriedOut]:
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv(FOLDER, raising=False)
        with carried_out(STUDY, tmp_path_factory.mktemp("hills")) as made:
            yield made


def test_a_map_is_the_same_on_every_grid() -> None:
    case = MapCase(0.5, 8, 3)
    np.testing.assert_allclose(case.height(8)[::2, ::2], case.height(4), atol=1e-12 * case.height(4).max())


@pytest.mark.large
def test_hills_are_better_than_summits(studied: CarriedOut) -> None:
    for own in groups(studied.result).values():
        for quantity in ("force", "stiffness"):
            errors = errors_of(own, quantity)
            hills, summits = (rms(errors.sel(solver=name)) for name in ("hills", "summits in pairs"))
            assert hills < 0.7 * summits


@pytest.mark.large
def test_every_method_has_errors_of_every_quantity(studied: CarriedOut) -> None:
    for name, own in groups(studied.result).items():
        for quantity in QUANTITIES:
            found = {method: rms(errors_of(own, quantity).sel(solver=method)) for method in METHODS}
            known = {method for method, error in found.items() if np.isfinite(error)}
            assert known == set(METHODS) - (set(PERSSON) if name == "4:1" else set())
            assert all(found[method] > 0.0 for method in known)


def test_stiffness_is_minus_the_slope_of_the_force() -> None:
    height = MapCase(0.8, 8, 11).height(4)
    h = 1.2 * float(height.std())
    nearby = h * (1.0 + np.array([0.05, 0.0, -0.05]))
    for pressed in (by_elements(square(height), nearby), by_persson(square(height), nearby, 0.45)):
        slope = (pressed.force[2] - pressed.force[0]) / (0.1 * h)
        assert pressed.stiffness[0] < 1.02 * slope
        assert pressed.stiffness[0] == pytest.approx(slope, rel=0.3)


@pytest.mark.large
def test_theory_is_better_the_more_is_in_contact(studied: CarriedOut) -> None:
    errors = errors_of(groups(studied.result)["isotropic"])
    for name in PERSSON:
        own = errors.sel(solver=name)
        assert rms(within(own, (0.05, 0.2))) < 0.3 * rms(within(own, (0.003, 0.01)))
    assert rms(within(errors.sel(solver=next(iter(PERSSON))), (0.05, 0.2))) < 0.1


@pytest.mark.large
def test_the_error_falls_with_the_points_of_the_map(studied: CarriedOut) -> None:
    found = by_points(studied.result)
    for name in ("error", "lacking", "stated"):
        values = found[name].to_numpy()
        assert (np.diff(values[:4]) < 0.0).all(), name
    lacking, stated = (found[name].sel(points=[2, 3, 4]).to_numpy() for name in ("lacking", "stated"))
    assert ((stated > 0.8 * lacking) & (stated < 3.0 * lacking)).all()  # as on the maps that it was measured on
    assert abs(float(found["lacking"].sel(points=12))) < 0.002
    assert f"against {FINEST} points" in studied.text


@pytest.mark.large
def test_more_contact_radii_than_the_default_change_little(studied: CarriedOut) -> None:
    force, of_scales = studied.result["trial_force_by_scales"], by_scales(studied.result)
    assert list(of_scales["scales"].to_numpy()) == list(SCALES)
    change = {n: rms(force.sel(scales=n) / force.sel(scales=40) - 1.0) for n in (5, 10, 20)}
    assert change[5] > change[10] > change[20]
    assert change[20] < 0.01


@pytest.mark.large
def test_noise_moves_hills_less_than_summits(studied: CarriedOut) -> None:
    moved = by_noise(studied.result)
    assert (moved.sel(asperities="hills") < 0.8 * moved.sel(asperities="summits in pairs")).all()
    assert (moved.diff("noise") > 0.0).all()


@pytest.mark.large
def test_it_reports_each_method_and_draws(studied: CarriedOut) -> None:
    for method in METHODS:
        assert f"| {method} |" in studied.text
    for name in ("hills", "hills_convergence"):
        assert (Path(studied.folder) / f"{name}.png").stat().st_size > 5000


@pytest.mark.large
def test_the_elements_that_all_is_held_against_have_converged(studied: CarriedOut) -> None:
    elements = studied.result["trial_elements"]
    errors = elements.isel(grid=0) / elements.isel(grid=-1) - 1.0
    for quantity, most in (("force", 0.01), ("stiffness", 0.05), ("contact_fraction", 0.1)):
        assert 0.0 < rms(errors.sel(quantity=quantity)) < most, quantity


@pytest.mark.large
def test_it_says_that_measured_maps_are_left_out(studied: CarriedOut) -> None:
    assert FOLDER in studied.text
    assert set(groups(studied.result)) == {"isotropic", "4:1"}


@pytest.mark.large
@pytest.mark.skipif(not (SHARED / FILES[0]).exists(), reason="the measured surfaces are not here")
def test_a_measured_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / FILES[0]).write_bytes((SHARED / FILES[0]).read_bytes())
    monkeypatch.setenv(FOLDER, str(tmp_path))
    ((name, pressed),) = press_files(quick=True)
    assert name.startswith(FILES[0])
    assert name.endswith("points a wavelength")
    errors = errors_of(dataset_of([(name, pressed)]))
    assert rms(errors.sel(solver="hills")) < 0.2 * rms(errors.sel(solver="summits in pairs"))
