"""Coupled asperities along a path: against solutions without multipoles; other units, orders, places, extremes."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import ensemble

import roughmdr as rm
from roughmdr.interaction import solve
from roughmdr.numerics.arguments import Floats

FREE = {"model": "pairwise", "boundary": "free"}
SMALL = 1e-4  # δ/R: a0/R is a hundredth, and slopes are small
NAMES = ("force", "contact_area", "contact_count", "contact_radius_sum", "stiffness")
PARABOLOID_PAIRS = {3: 0.828444914, 4: 0.864726367747, 6: 0.905117769443, 10: 0.940605090957, 20: 0.969288185363}
PUNCH_PAIRS = {3: 0.821617209, 4: 0.860924434, 6: 0.903424935, 10: 0.939982879, 20: 0.969127572}
PERIODIC = {20: 1.145247762211, 12: 1.273263599777, 8: 1.489602436784, 6: 1.814344884220, 5: 2.2277808930}


def law(made: xr.Dataset, separation: Any, modulus: float = 1.0, **interaction: Any) -> xr.Dataset:
    asked = {"model": "pairwise"} | interaction
    names = list(NAMES)
    return rm.load_separation(
        made, separation=separation, effective_modulus=modulus, variables=names, interaction=asked
    )


def pair(distance: float, **parameters: Any) -> xr.Dataset:
    """Two asperities on a half-space, at a distance along a line that is no axis."""
    return ensemble([0.0, 0.0], None, x=[0.0, 0.6 * distance], y=[0.0, 0.8 * distance], **parameters)


def random(count: int, seed: int = 1, side: float = 1e-3, **changes: Any) -> xr.Dataset:
    section = {
        "source": "random", "shape": "paraboloid", "count": count, "patch": side,
        "placement": "hard_core", "min_distance": 0.4 * side / count**0.5,
        "height": {"distribution": "normal", "std": 1e-3 * side},
        "radius": {"distribution": "lognormal", "mean": 0.02 * side, "std": 0.005 * side},
    } | changes  # fmt: skip
    if section["placement"] != "hard_core":
        del section["min_distance"]
    return rm.generate(section, seed=seed)


def assert_close(found: xr.Dataset, expected: xr.Dataset, rtol: float) -> None:
    np.testing.assert_array_equal(found.contact_count, expected.contact_count)
    for name in ("force", "contact_area", "contact_radius_sum"):
        np.testing.assert_allclose(found[name], expected[name], rtol=rtol)


@pytest.mark.parametrize(
    ("distance", "order", "error"),
    [
        (3, 1, 1.0e-3), (4, 1, 8.6e-4), (6, 1, 4.0e-4), (10, 1, 1.2e-4), (20, 1, 1.8e-5),
        (3, 2, -8.9e-5), (4, 2, -1.5e-6), (6, 2, 4.2e-6), (10, 2, 7.2e-7), (20, 2, 3.5e-8),
    ],
)  # fmt: skip
def test_two_paraboloids_are_off_as_their_order_is(distance: int, order: int, error: float) -> None:
    """Against boundary integrals of two bodies; the error to the digits that it is known to."""
    made = pair(distance * SMALL**0.5, radius=1.0)
    found = law(made, [-SMALL], boundary="free", order=order, error=1e-9)
    exact = 2.0 * 4.0 / 3.0 * SMALL**1.5 * PARABOLOID_PAIRS[distance]
    assert float(found.force[0]) / exact - 1.0 == pytest.approx(error, rel=0.05, abs=2e-9)


def test_the_error_of_a_pair_falls_with_the_fifth_power_of_its_distance() -> None:
    """Against itself with the parts that are left out, P(5) and so on, fitted: (D/a0)^5 times it goes to 0.16."""
    errors = []
    for distance in (10, 20):
        made = pair(distance * SMALL**0.5, radius=1.0)
        force = float(law(made, [-SMALL], boundary="free", error=1e-9).force[0])
        errors.append(force / (8.0 / 3.0 * SMALL**1.5 * PARABOLOID_PAIRS[distance]) - 1.0)
    assert errors[1] * 20.0**5 == pytest.approx(0.16, abs=0.05)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.8)


@pytest.mark.parametrize(("distance", "exact"), PUNCH_PAIRS.items())
def test_two_flat_punches(distance: int, exact: float) -> None:
    made = pair(distance * 1e-3, radius=1e-3, shape="flat_punch")
    found = [float(law(made, [-1e-5], boundary="free", order=n, error=1e-9).force[0]) / 4e-8 for n in (1, 2)]
    assert abs(found[1] / exact - 1.0) < 0.3 / distance**5 + 2e-9
    assert abs(found[1] - exact) < abs(found[0] - exact)


@pytest.mark.parametrize(("side", "exact"), PERIODIC.items())
def test_a_paraboloid_and_its_images(side: int, exact: float) -> None:
    """Fourth neighbours cancel the most: the error falls faster than with the fifth power of the side."""
    patch = side * SMALL**0.5
    found = law(ensemble(0.0, patch**2, radius=1.0, x=0.3 * patch, y=0.0), [-SMALL], error=1e-9)
    a = float(found.contact_radius_sum[0]) / patch
    assert abs(float(found.force[0]) / (4.0 / 3.0 * SMALL**1.5 * exact) - 1.0) < 5.0 * a**5


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_far_apart_they_are_independent(boundary: str, order: int) -> None:
    rng = np.random.default_rng(1)
    z, radius = rng.normal(0.0, 1e-6, 40), rng.uniform(1e-5, 1e-4, 40)
    x, y = rng.uniform(0.0, 1e6, (2, 40))
    made = ensemble(z, 1e12, radius=radius, x=x, y=y)
    down = np.linspace(2e-6, -1e-6, 5)
    alone = rm.load_separation(made, separation=down, effective_modulus=1.0, variables=NAMES)
    coupled = law(made, down, boundary=boundary, order=order)
    assert_close(coupled, alone, 1e-7)
    np.testing.assert_allclose(coupled.stiffness, alone.stiffness, rtol=1e-6)


@pytest.mark.few(2)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("count", [60, 700])
@pytest.mark.parametrize(("length", "modulus"), [(1e-6, 1e12), (1e3, 1.0)])
def test_other_units_give_the_same_ratios(count: int, length: float, modulus: float, order: int) -> None:
    """Patches of nanometres to a kilometre, solids of 1 Pa to 1 TPa; the crossover of both solvers is between."""
    here, down = random(count), np.array([1e-6, -1e-6])
    there = here.copy(deep=True)
    for name in ("height", "radius", "x", "y"):
        there[name] = here[name] * length
    there.attrs |= {"nominal_area": here.nominal_area * length**2, "patch": here.patch * length}
    first, second = law(here, down, 1e6, order=order), law(there, down * length, modulus, order=order)
    rtol = 2e-6
    np.testing.assert_allclose(second.force / (modulus * length**2), first.force / 1e6, rtol=rtol)
    np.testing.assert_allclose(second.contact_area / length**2, first.contact_area, rtol=rtol)
    np.testing.assert_array_equal(second.contact_count, first.contact_count)
    np.testing.assert_allclose(second.stiffness / (modulus * length), first.stiffness / 1e6, rtol=1e-5)


@pytest.mark.large
@pytest.mark.parametrize("count", [80, 700])
def test_the_order_of_the_asperities_and_the_place_of_the_patch_do_not_matter(count: int) -> None:
    made, down = random(count, placement="random"), [1e-6, 0.0, -5e-7]
    first = law(made, down)
    assert_close(law(made.isel(asperity=np.random.default_rng(2).permutation(count)), down), first, 1e-6)
    moved = made.copy(deep=True)
    moved["x"], moved["y"] = (made.x + 0.37e-3) % 1e-3, (made.y - 12.21e-3) % 1e-3
    assert_close(law(moved, down), first, 1e-6)
    turned = made.assign(x=made.y, y=-made.x)
    assert_close(law(turned, down), first, 1e-6)


@pytest.mark.large
@pytest.mark.parametrize("count", [80, 700])
def test_the_same_bits_twice_and_a_path_has_no_memory(count: int) -> None:
    made, down = random(count), np.linspace(2e-6, -1e-6, 6)
    first = law(made, down)
    xr.testing.assert_identical(first, law(made, down))
    there_and_back = np.concatenate([down, down[::-1]])
    back = law(made, there_and_back)
    for name in NAMES:
        values = back[name].to_numpy()
        np.testing.assert_array_equal(values, values[::-1])
        np.testing.assert_array_equal(values[:6], first[name])
    assert_close(law(made, down[-1:]), first.isel(step=[-1]), 1e-6)


@pytest.mark.large
@pytest.mark.parametrize("boundary", ["free", large("periodic")])
def test_the_mesh_is_as_the_sum_over_pairs(boundary: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made, down = random(600, placement="random"), [1.5e-6, 0.0, -1e-6]
    monkeypatch.setattr(solve, "DENSE_UP_TO", {"periodic": 0, "free": 0})
    on_mesh = {error: law(made, down, boundary=boundary, error=error) for error in (1e-3, 1e-6, 1e-8)}
    monkeypatch.setattr(solve, "DENSE_UP_TO", {"periodic": 10_000, "free": 10_000})
    exact = law(made, down, boundary=boundary, error=1e-9)
    for error, found in on_mesh.items():
        np.testing.assert_allclose(found.force, exact.force, rtol=error)
        assert float(found.numerical_error) <= error


def test_lower_errors_are_met() -> None:
    made, down = random(80, placement="random"), [1e-6, -5e-7]
    exact = law(made, down, error=1e-9)
    for error in (1e-2, 1e-4, 1e-6):
        found = law(made, down, error=error)
        np.testing.assert_allclose(found.force, exact.force, rtol=error)
        assert float(found.numerical_error) <= error


def test_summits_below_a_flank_are_left_out() -> None:
    """In the flank of a paraboloid of R, D away, what is lower than D²/(2R) is no summit."""
    x, y = np.array([0.0, 1e-5, 0.0, 5e-4]), np.array([0.0, 0.0, 2e-5, 5e-4])
    flank = 0.5e-10 / 1e-4, 2e-10 / 1e-4
    z = np.array([0.0, -1.01 * flank[0], -0.99 * flank[1], -1e-7])
    made = ensemble(z, 1e-6, radius=1e-4, x=x, y=y)
    assert_close(law(made, [-3e-6]), law(made.isel(asperity=[0, 2, 3]), [-3e-6]), 1e-12)
    across = made.assign(x=("asperity", (x - 5e-6) % 1e-3))
    assert_close(law(across, [-3e-6]), law(made, [-3e-6]), 1e-6)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_one_position_for_two_is_refused(boundary: str) -> None:
    made = random(30)
    made["x"][17], made["y"][17] = made["x"][4], made["y"][4]
    with pytest.raises(rm.SceneError, match="have the same position"):
        law(made, [0.0], boundary=boundary)


def test_one_position_for_two_on_opposite_edges_is_refused() -> None:
    made = random(30)
    made["x"][17], made["y"][17] = made.x.min() + 1e-3, made.y.min()
    made["x"][4], made["y"][4] = made.x.min(), made.y.min()
    with pytest.raises(rm.SceneError, match="have the same position"):
        law(made, [0.0])


@pytest.mark.large
@pytest.mark.parametrize("high", [5, 20])
def test_low_summits_that_the_others_lift_are_found(high: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A few summits carry a load that lifts the surface between them to those far below the flat."""
    rng = np.random.default_rng(4)
    z = np.concatenate([np.zeros(high), rng.uniform(-3e-6, -2e-6, 3000)])
    x, y = rng.uniform(0.0, 1e-3, (2, z.size))
    radius = np.concatenate([np.full(high, 2e-4), np.full(3000, 1e-5)])
    made = ensemble(z, 1e-6, radius=radius, x=x, y=y)
    down = [-1e-6, -1.95e-6, -2.3e-6]
    found = law(made, down)
    independent = rm.load_separation(made, separation=down, effective_modulus=1.0, variables=NAMES)
    assert float(found.contact_count[1]) > float(independent.contact_count[1])
    monkeypatch.setattr(solve.Candidates, "extend", all_at_once)
    assert_close(found, law(made, down), 2e-6)


def all_at_once(candidates: solve.Candidates, lowest: float) -> bool:
    """Every asperity is a candidate."""
    if candidates.count:
        return False
    candidates.system = candidates._system(candidates.height.size)
    return True


@pytest.mark.few(1)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("placement", ["hard_core", "random"])
@pytest.mark.parametrize("count", [60, 500])
def test_the_stiffness_is_the_slope_of_the_force(count: int, placement: str, order: int) -> None:
    made, step = random(count, placement=placement), 2e-10
    for h in (1e-6, -5e-7):
        found = law(made, [h + step, h, h - step], order=order, error=1e-9)
        force, stiffness = found.force.to_numpy(), found.stiffness.to_numpy()
        kink = 1e-3 * stiffness[1] * (found.contact_count[0] != found.contact_count[2])
        assert (force[2] - force[0]) / (2.0 * step) == pytest.approx(stiffness[1], rel=2e-5, abs=float(kink))


def test_a_free_patch_needs_no_patch() -> None:
    made, down = random(50), [1e-6, -5e-7]
    bare = made.drop_attrs().assign_attrs(shape="paraboloid")
    first = law(made, down, boundary="free")
    assert_close(law(bare, down, boundary="free"), first, 1e-12)
    assert np.isnan(float(law(bare, down, boundary="free").largest_contact_fraction))
    with pytest.raises(rm.SceneError, match="needs the patch"):
        law(bare, down)


def test_on_a_wide_free_patch_the_nearest_count() -> None:
    """Two pairs a kilometre apart are two pairs alone; four on a line have no area."""
    x = np.array([0.0, 3e-4, 1e3, 1e3 + 3e-4])
    four = law(ensemble(np.zeros(4), None, radius=1e-3, x=x, y=0.0), [-1e-6], boundary="free")
    two = law(ensemble(np.zeros(2), None, radius=1e-3, x=x[:2], y=0.0), [-1e-6], boundary="free")
    assert float(four.force[0]) == pytest.approx(2.0 * float(two.force[0]), rel=2e-6)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("count", [1, 2, 3, 300, 301])
def test_any_number_of_asperities(count: int, boundary: str) -> None:
    made = random(count)
    found = law(made, [1.0, -2e-6], boundary=boundary)
    assert float(found.force[0]) == float(found.stiffness[0]) == 0.0
    assert float(found.force[1]) > 0.0
    assert float(found.numerical_error) <= 1e-6
    assert found.marked_steps == 0 or float(found.largest_contact_fraction) > 0.1


def balance(made: xr.Dataset, found: xr.Dataset) -> None:
    """All is finite, forces grow and the solver keeps to its error."""
    for name in NAMES:
        assert np.isfinite(found[name]).all(), name
    assert (np.diff(found.force) > 0.0).all()
    assert float(found.numerical_error) <= 1e-6
    assert (found.contact_count <= made.sizes["asperity"]).all()


@pytest.mark.parametrize("count", [100, 600])
@pytest.mark.parametrize(
    "changes",
    [
        {"radius": {"distribution": "lognormal", "mean": 1e-5, "std": 2e-4}},
        {"height": {"distribution": "normal", "std": 1e-12}},
        {"height": {"distribution": "normal", "std": 1e-8}, "radius": 1e-2},
        {"placement": "random", "radius": 1e-4},
        {"placement": "hexagonal"},
    ],
    ids=["wide radii", "level", "nearly flat", "overlapping", "hexagonal"],
)
def test_stiff_ensembles(count: int, changes: dict[str, Any]) -> None:
    made = random(count, **changes)
    std = float(made.height.std()) or 1e-9
    down = float(made.height.max()) - std * np.array([0.5, 1.0, 2.0])
    balance(made, law(made, down))


def test_radii_over_six_decades() -> None:
    rng = np.random.default_rng(6)
    made = random(200).assign(radius=("asperity", 10.0 ** rng.uniform(-9.0, -3.0, 200)))
    balance(made, law(made, [1e-6, 0.0, -5e-7]))


def test_nearly_all_in_contact() -> None:
    made = random(500, height={"distribution": "uniform", "std": 1e-9}, radius=2e-5)
    found = law(made, float(made.height.min()) + np.array([2e-10, -2e-9]))
    balance(made, found)
    assert float(found.contact_count[-1]) > 0.9 * 500


def test_clusters() -> None:
    rng = np.random.default_rng(7)
    centre = rng.uniform(0.0, 1e-3, (2, 10)).repeat(40, axis=1)
    x, y = centre + rng.normal(0.0, 1e-5, (2, 400))
    made = ensemble(rng.normal(0.0, 1e-6, 400), 1e-6, radius=1e-6, x=x, y=y)
    found = law(made, [1e-6, 0.0, -5e-7])
    balance(made, found)
    assert float(found.overlap_count) > 0.0


SHAPES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": 1e-4},
    "cone": {"slope": 0.02},
    "power_law": {"exponent": 1.4, "width": 1e-5, "rise": 1e-6},
    "flat_punch": {"radius": 1e-6},
    "sphere": {"radius": 1e-4},
    "truncated_cone": {"slope": 0.02, "flat_radius": 2e-6},
    "truncated_paraboloid": {"radius": 1e-4, "flat_radius": 2e-6},
    "rounded_cone": {"slope": 0.02, "blend_radius": 2e-6},
    "capped_paraboloid": {"radius": 8e-5, "cap_radius": 2e-4, "blend_radius": 3e-6},
    "rounded_punch": {"flat_radius": 2e-6, "edge_radius": 4e-5},
}


@pytest.mark.few(3)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_without_adhesion(shape: str, order: int) -> None:
    """Coupled a little: the first-order part is the sum over pairs of what each alone would do, at any shape."""
    rng = np.random.default_rng(8)
    z, (x, y) = rng.normal(0.0, 1e-7, 60), rng.uniform(0.0, 1e-3, (2, 60))
    made = ensemble(z, 1e-6, shape, x=x, y=y, **SHAPES[shape])
    down = [1e-7, -1e-7]
    found = law(made, down, order=order)
    balance(made, found)
    assert float(found.marked_steps) == 0.0
    alone = rm.load_separation(made, separation=down, effective_modulus=1.0, variables=NAMES)
    assert (np.abs(found.force / alone.force - 1.0) < 0.4).all()
    wide = made.assign(x=made.x * 1e5, y=made.y * 1e5).assign_attrs(nominal_area=1e4)
    assert_close(law(wide, down, order=order), alone, 2e-6)


@settings(deadline=None, max_examples=25)
@given(
    st.integers(1, 12),
    st.integers(0, 2**32 - 1),
    st.sampled_from(["free", "periodic"]),
    st.sampled_from([1, 2]),
    st.floats(-2.0, 2.0),
    st.floats(0.05, 5.0),
)
def test_any_small_ensemble(count: int, seed: int, boundary: str, order: int, h: float, radius: float) -> None:
    """A value with its error, or a mark; more load the nearer the flat."""
    rng = np.random.default_rng(seed)
    z, (x, y) = rng.normal(0.0, 1e-6, count), rng.uniform(0.0, 1e-3, (2, count))
    made = ensemble(z, 1e-6, radius=radius * 1e-3, x=x, y=y)
    found = law(made, 1e-6 * (h - np.arange(3.0)), boundary=boundary, order=order)
    force: Floats = found.force.to_numpy()
    solved = np.isfinite(force)
    assert float(found.marked_steps) >= np.count_nonzero(~solved)
    assert (np.diff(force[solved]) >= 0.0).all()
    if float(found.marked_steps) == 0.0:
        assert float(found.numerical_error) <= 1e-6
