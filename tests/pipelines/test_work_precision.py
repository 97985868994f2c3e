"""The study of error against run time in its quick form: errors and counted work, never what it times."""

import numpy as np
import pytest
import xarray as xr
from studies import work_precision
from studies.comparison import cases_of
from studies.work_precision import TARGETS, cheapest, report
from studies.work_precision.points import QUANTITIES, Method, Point
from studies.work_precision.surface import SURFACES, simulate
from studies.work_precision.tip import DEPTHS


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    """The numbers of the quick form without the root finder on surfaces, which takes half of the time."""
    tips, surfaces = work_precision.PARTS
    surfaces = surfaces._replace(methods=tuple(each for each in surfaces.methods if each.name != "brentq"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(work_precision, "PARTS", (tips, surfaces))
        return work_precision.measure(True)


def points(result: xr.Dataset, scene: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """Errors [point, quantity] and evaluations of a method."""
    own = cases_of(result, scene=scene, method=method)
    return own.error.to_numpy(), own.evaluations.to_numpy()


def slope(error: np.ndarray, evaluations: np.ndarray) -> float:
    return float(np.polyfit(np.log(evaluations), np.log(error), 1)[0])


TIP, HERTZ, JKR = "paraboloid, JKR", "Hertz, lognormal radii", "JKR, equal radii"


@pytest.mark.large
def test_closed_forms_are_exact_with_an_evaluation_for_each_state(result: xr.Dataset) -> None:
    error, evaluations = points(result, TIP, "closed forms")
    assert (error < 1e-12).all()
    assert evaluations == [DEPTHS.size + 1]


@pytest.mark.large
def test_springs_come_nearer_in_proportion_to_their_number(result: xr.Dataset) -> None:
    error, evaluations = points(result, TIP, "springs")
    for quantity in range(len(QUANTITIES)):
        assert slope(error[:, quantity], evaluations) == pytest.approx(-1.0, abs=0.1)


@pytest.mark.large
def test_root_finders_come_nearer_with_every_decade_of_tolerance(result: xr.Dataset) -> None:
    for method, finest in (("brentq", 1e-12), ("Abel quadrature", 1e-12), ("plain NumPy", 1e-2)):
        error, evaluations = points(result, TIP, method)
        assert (np.diff(evaluations) >= 0.0).all()
        assert error[-1, 0] < finest < error[0, 0]


@pytest.mark.large
@pytest.mark.parametrize("scene", [HERTZ, JKR])
def test_draws_come_nearer_as_the_root_of_their_number_and_even_ones_begin_nearer(
    result: xr.Dataset, scene: str
) -> None:
    sampled, visits = points(result, scene, "sampled")
    even, even_visits = points(result, scene, "stratified")
    for error, count in ((sampled, visits), (even, even_visits)):
        assert slope(error[:, 0], count) == pytest.approx(-0.5, abs=0.3)
    assert (even[:, 0] < sampled[:, 0] / 4.0).all()
    np.testing.assert_allclose(even_visits, visits, rtol=0.02)  # no more work
    own, own_visits = points(result, scene, "plain NumPy")
    assert own[0, 0] == pytest.approx(sampled[0, 0], rel=0.7)  # the same draws, but for their seeds
    assert own_visits[0] == pytest.approx(visits[0], rel=0.05)


@pytest.mark.large
@pytest.mark.parametrize("scene", [HERTZ, JKR])
def test_the_expected_law_is_exact_for_less_than_one_realisation(result: xr.Dataset, scene: str) -> None:
    error, evaluations = points(result, scene, "expected")
    known = error[~np.isnan(error)]
    assert (known < 1e-11).all()
    assert evaluations[0] < simulate(SURFACES[scene], "sampled").evaluations


@pytest.mark.large
def test_errors_that_are_asked_for_are_met(result: xr.Dataset) -> None:
    for scene in (HERTZ, JKR):
        for method in ("sampled", "stratified", "auto"):
            own = cases_of(result, scene=scene, method=f"{method}, error asked for")
            assert (own.error.sel(quantity="force") <= 2.0 * own.setting).all()  # of two runs each


@pytest.mark.large
def test_the_cheapest_comes_to_the_error_and_is_no_dearer_than_any_other(result: xr.Dataset) -> None:
    found = 0
    for scene in (TIP, HERTZ, JKR):
        for quantity in QUANTITIES:
            for error in TARGETS:
                best = cheapest(result, scene, quantity, error)
                if best is None:
                    continue
                found += 1
                own = result.isel(point=np.flatnonzero((result.scene == scene) & (result.competes == 1)))
                enough = own.error.sel(quantity=quantity) <= error
                assert float(best.error.sel(quantity=quantity)) <= error
                assert float(best.seconds) == float(own.seconds[enough.to_numpy()].min())
    assert found >= 24
    assert cheapest(result, TIP, "force", 0.0) is None


def test_a_method_joins_by_one_entry(monkeypatch: pytest.MonkeyPatch) -> None:
    """That gives exact numbers for nothing, and so is the cheapest at once."""

    def exact_for_nothing(scene: object, exact: object, quick: bool) -> list[Point]:
        return [Point(1.0, (0.0, 0.0, 0.0), 0.0, 0.0)]

    part = work_precision.PARTS[0]._replace(methods=(Method("an oracle", "-", exact_for_nothing), *part_methods()))
    monkeypatch.setattr(work_precision, "PARTS", (part,))
    told = report(work_precision.measure(True))
    assert f"| {TIP} | an oracle: 0 ms (0) | an oracle" in told


def part_methods() -> tuple[Method, ...]:
    return tuple(method for method in work_precision.PARTS[0].methods if method.name == "closed forms")
