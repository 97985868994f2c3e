"""Hills of height maps: against closed forms and boundary elements; and of one map turned, shifted, in other units."""

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from oracles.gaussian_maps import gaussian_map
from scenes import scene
from scipy.special import ellipe, ellipk
from studies.versus_bem.ensembles import write_map

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.maps.height_map import HeightMap, slope_ratio
from roughmdr.ensemble.maps.hills.contact import area_share, complete_elliptic
from roughmdr.ensemble.maps.hills.find import fill_table, find_hills, points_of
from roughmdr.ensemble.maps.resolution import HILLS_BY_BORDER
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine

SIDE = 1e-4
PAIRS = {"interaction": "pairwise", "effective_modulus": 1e9}


def hills_of(height: Floats, side: float = SIDE, *, periodic: bool = True) -> xr.Dataset:
    spacing = side / height.shape[0]
    surface = HeightMap(height.copy(), spacing, spacing, periodic)
    return find_hills(surface, find_summits(surface)).labelled().to_xarray()


def summits_of(height: Floats, side: float = SIDE) -> xr.Dataset:
    spacing = side / height.shape[0]
    return find_summits(HeightMap(height.copy(), spacing, spacing, True)).labelled().to_xarray()


def rough(seed: int, points: int = 128, hurst: float = 0.8) -> Floats:
    """A map with 8 points a shortest wave."""
    waves = {"long_wave": 0.5 * SIDE, "short_wave": 8.0 * SIDE / points}
    return gaussian_map(SelfAffine.of(hurst=hurst, rms_slope=0.01, **waves), points, SIDE, seed)


def egg_box(points: int, along_x: float, along_y: float) -> Floats:
    """Four waves a side along both axes, of two amplitudes [m]."""
    phase = 2.0 * math.pi * 4.0 * np.arange(points) / points
    return along_x * np.cos(phase)[:, None] + along_y * np.cos(phase)


def test_round_hills_have_the_profile_of_their_waves() -> None:
    """Under a punch of radius a the mean of cos(q x) is sin(q a)/(q a), so that g is the fall of cos(q a)."""
    found = hills_of(egg_box(96, 1e-7, 1e-7))
    q = 2.0 * math.pi * 4.0 / SIDE
    assert found.asperity.size == 16
    np.testing.assert_allclose(found.height, 2e-7, rtol=1e-6)
    a = found.a.values[0]
    small = q * a < 1.2
    assert small.sum() > 8
    np.testing.assert_allclose(
        found.g.values[:, small], np.broadcast_to(2e-7 * (1.0 - np.cos(q * a[small])), (16, small.sum())), rtol=0.01
    )


@pytest.mark.large
@pytest.mark.parametrize("ratio", [1.0, 2.0, 4.0])
def test_small_contacts_of_long_hills_are_those_of_Hertz(ratio: float) -> None:
    """The ellipse on a paraboloid of two curvatures: K. L. Johnson, Contact Mechanics (1985), 4.26 to 4.34."""
    amplitude = 1e-7
    found = hills_of(egg_box(192, amplitude, ratio * amplitude))
    q = 2.0 * math.pi * 4.0 / SIDE
    blunt, sharp = 0.5 * q * q * amplitude, 0.5 * q * q * ratio * amplitude  # of z = A x^2 + B y^2
    shares = np.linspace(1e-6, 0.999, 200000)  # k^2 = 1 - (b/a)^2
    K, E = ellipk(shares), ellipe(shares)
    k2 = shares[np.argmin(np.abs((E / (1.0 - shares) - K) / (K - E) - sharp / blunt))] if ratio > 1.0 else 0.0
    K, E = ellipk(k2), ellipe(k2)
    depth = 0.02 * amplitude
    # delta = 3 P K/(2 pi a E*), A = 3 P (K - E)/(2 pi E* a^3 k^2): the half axis from A = delta (K - E)/(K a^2 k^2)
    part = (K - E) / (K * k2) if k2 > 0.0 else 0.5
    a = math.sqrt(depth * part / blunt)
    force = depth * 2.0 * math.pi * a / (3.0 * K)
    law = rm.load_separation(found, separation=[(1.0 + ratio) * amplitude - depth], effective_modulus=1.0)
    assert float(law.force[0]) / 16.0 == pytest.approx(force, rel=0.01)


def test_an_ellipse_as_stiff_as_a_circle() -> None:
    for q in (0.0, 0.2, 0.9):
        whole = float(ellipk(1.0 - math.exp(-4.0 * q)))
        assert complete_elliptic(math.exp(-2.0 * q)) == pytest.approx(whole, rel=1e-14)
        angle = 0.7
        share = area_share(q * np.array([math.cos(angle), math.sin(angle), 0.0, 0.0]))
        assert share == pytest.approx((2.0 / math.pi * whole * math.exp(-q)) ** 2, rel=1e-13)


def test_the_table_is_the_slope_of_the_convex_hull() -> None:
    radius = np.geomspace(0.1, 2.0, 12)
    points, g = points_of(radius), np.empty(12)
    assert fill_table(radius, 5.0 - radius**2 / 3.0, 5.0, points, g)  # of a paraboloid: G = a^3/3
    np.testing.assert_allclose(g, points**2, rtol=1e-12)
    dented = 5.0 - radius**2 / 3.0
    dented[5] -= 0.2  # a mean below those of its neighbours changes nothing but the resolution
    other = np.empty(12)
    assert fill_table(radius, dented, 5.0, points, other)
    assert (np.diff(other) > 0.0).all()
    np.testing.assert_allclose(other[[0, 1, 2, 3, 9, 10, 11]], g[[0, 1, 2, 3, 9, 10, 11]], rtol=1e-12)
    assert not fill_table(radius, np.full(12, 5.0), 5.0, points, g)


@pytest.mark.large
def test_hills_turn_shift_and_scale_with_their_map() -> None:
    height = rough(1)
    found = hills_of(height)
    turned, shifted, larger = (
        hills_of(height.T.copy()),
        hills_of(np.roll(height, (17, 40), (0, 1))),
        hills_of(1e-3 * height, 1e-3 * SIDE),
    )
    for other, unit in ((turned, 1.0), (shifted, 1.0), (larger, 1e-3)):
        np.testing.assert_allclose(other.height, unit * found.height, rtol=1e-7)
        assert np.median(np.abs(other.g / (unit * found.g) - 1.0)) < 0.01
        assert other.attrs["wavelength"] == pytest.approx(unit * found.attrs["wavelength"])
    np.testing.assert_allclose(shifted.x, (found.x + 17.0 * SIDE / 128) % SIDE, atol=0.01 * SIDE / 128)
    np.testing.assert_allclose(larger.g, 1e-3 * found.g, rtol=1e-6)


def force_of_elements(height: Floats, separation: Floats) -> tuple[Floats, Floats]:
    elements = BoundaryElements(height / SIDE, np.array([1.0, 1.0]))
    found = []
    for h in separation:
        force = elements.press(h / SIDE) * SIDE * SIDE * 1e9
        found.append((force, elements.patches().area))
    force, fraction = np.array(found).T
    return force, fraction


@pytest.mark.large
@pytest.mark.parametrize(("seed", "hurst"), [(21, 0.8), (22, 0.5)])
def test_coupled_hills_press_as_boundary_elements_do(seed: int, hurst: float) -> None:
    height = rough(seed, hurst=hurst)
    separation = np.std(height) * np.array([2.0, 1.5, 1.1, 0.8, 0.5])
    force, fraction = force_of_elements(height, separation)
    assert fraction[0] < 0.02
    assert 0.1 < fraction[-1] < 0.3
    found, coarse = (
        rm.load_separation(
            e, separation=separation, **PAIRS, variables=("force", "contact_fraction", "model_error_curve")
        )
        for e in (hills_of(height), summits_of(height))
    )
    error = np.abs(found.force / force - 1.0)
    assert (error <= found.model_error_curve).all()
    assert float(np.sqrt(np.mean(error**2))) < 0.5 * float(np.sqrt(np.mean((coarse.force / force - 1.0) ** 2)))
    assert (np.abs(found.contact_fraction / fraction - 1.0) < 0.35).all()


@pytest.mark.large
def test_noise_moves_hills_less_than_summits() -> None:
    """Noise of 3 % of the r.m.s. height, over several maps."""
    moved: dict[Any, list[float]] = {hills_of: [], summits_of: []}
    for seed in range(23, 27):
        height = rough(seed, hurst=0.5)
        noise = np.random.default_rng(seed).standard_normal(height.shape)
        separation = np.std(height) * np.array([1.2, 0.9, 0.6])
        for find, changes in moved.items():
            clean, noisy = (
                rm.load_separation(find(h), separation=separation, **PAIRS).force.values
                for h in (height, height + 0.03 * np.std(height) * noise)
            )
            changes.extend((noisy / clean - 1.0).tolist())
    of_hills, of_summits = (float(np.sqrt(np.mean(np.square(changes)))) for changes in moved.values())
    assert of_hills < 0.6 * of_summits


def test_slopes_along_and_across() -> None:
    x = 2.0 * math.pi * np.arange(64) / 64
    for height, ratio in (
        (np.cos(4 * x)[:, None] + 2.0 * np.cos(4 * x), 2.0),
        (np.cos(4 * (x[:, None] + x)) + np.cos(4 * (x[:, None] - x)), 1.0),
    ):
        for periodic in (True, False):
            assert slope_ratio(HeightMap(height, 1e-6, 1e-6, periodic)) == pytest.approx(ratio, rel=0.05)
    turned = np.cos(4 * (x[:, None] + x)) + 0.2 * np.cos(4 * (x[:, None] - x))
    assert slope_ratio(HeightMap(turned, 1e-6, 1e-6, True)) == pytest.approx(5.0, rel=0.03)


def test_maps_with_gaps_edges_and_few_points(tmp_path: Path) -> None:
    height = rough(5)[:90, :70].copy()
    whole = hills_of(height, 90.0 / 128.0 * SIDE, periodic=False)
    height[40:44, 30:33] = np.nan
    with_gap = hills_of(height, 90.0 / 128.0 * SIDE, periodic=False)
    assert np.isfinite(with_gap.g).all()
    assert 0 < with_gap.asperity.size <= whole.asperity.size
    assert set(np.round(with_gap.height.values[:5], 12)) <= set(np.round(whole.height.values, 12))
    assert ((with_gap.x >= 0.0) & (with_gap.x <= 90.0 / 128.0 * SIDE)).all()
    hill = np.array([[0.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 0.0]]) * 1e-7
    assert hills_of(hill, 3e-6, periodic=False).asperity.size == 1
    section = {"source": "surface", "model": "hills", "detrend": "none"}
    np.savetxt(tmp_path / "flat.csv", np.zeros((8, 8)), delimiter=",")
    with pytest.raises(rm.SceneError, match="it is flat"):
        rm.generate({**section, "file": str(tmp_path / "flat.csv"), "size": "8 um", "unit": "um"}, seed=0)


@pytest.fixture(scope="module")
def map_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("hills") / "map.nc"
    write_map(rough(6, 64), SIDE, path)
    return path


def of_hills(file: Path, **changes: Any) -> dict[str, Any]:
    section = {"source": "surface", "model": "hills", "file": str(file)}
    path = {"separation": {"start": "2 sigma", "stop": "0.5 sigma", "steps": 5}}
    return scene(asperities=section, batch=None, path=path, adhesion=None, **changes)


def test_a_run_of_hills_states_its_error(map_file: Path, tmp_path: Path) -> None:
    result = rm.run(of_hills(map_file, interaction={"model": "pairwise"}), tmp_path / "out.nc")
    assert 0.05 < float(result.model_error.squeeze()) < 0.12
    ensemble = rm.generate({"source": "surface", "model": "hills", "file": str(map_file)}, seed=0)
    assert ensemble.attrs["asperity_model"] == "hills"
    ensemble.to_netcdf(tmp_path / "hills.nc")
    saved = {"source": "file", "file": str(tmp_path / "hills.nc")}
    again = rm.run({**of_hills(map_file, interaction={"model": "pairwise"}), "asperities": saved})
    np.testing.assert_array_equal(again.force, result.force)
    np.testing.assert_array_equal(again.model_error, result.model_error)


@pytest.mark.large
def test_hills_that_are_not_coupled_say_so(map_file: Path) -> None:
    with pytest.warns(rm.LimitWarning, match=r'ask for \[interaction\] model = "pairwise"'):
        result = rm.run(of_hills(map_file))
    assert float(result.model_error.squeeze()) > 0.5
    beyond = {"model": "pairwise", "beyond": "boundary_elements"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(rm.RoughmdrError, match="does not go with hills"):
            rm.run(of_hills(map_file, interaction=beyond))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"model": "peaks"}, "asperities.model"),
        ({"shape": "paraboloid"}, "asperities.shape = 'paraboloid': is not that of .*: mdr_table; leave it out"),
    ],
)
def test_what_is_no_hill_is_refused(map_file: Path, changes: dict[str, Any], says: str) -> None:
    section = {"source": "surface", "model": "hills", "file": str(map_file), **changes}
    with pytest.raises(rm.SceneError, match=says):
        rm.generate(section, seed=0)


@pytest.mark.large
def test_adhesive_hills_are_coupled_and_part(map_file: Path) -> None:
    """To 4 % of contact: where more of them overlap, no equilibrium may be found."""
    ensemble = rm.generate({"source": "surface", "model": "hills", "file": str(map_file)}, seed=0)
    spread = float(ensemble.height.std())
    h = spread * np.concatenate([np.linspace(3.0, 2.2, 8), np.linspace(2.2, 6.0, 20)])
    work = 0.05 * 1e9 * spread**2 / float(ensemble.attrs["wavelength"])
    asked = ("force", "contact_count", "dissipated_energy", "model_error_curve")
    law = rm.load_separation(ensemble, separation=h, work=work, variables=asked, **PAIRS)
    loading, unloading = (float(law.model_error_curve[leg].max()) for leg in (slice(8), slice(9, None)))
    plain = rm.load_separation(ensemble, separation=h[:8], variables=["force"], **PAIRS)
    assert float(plain.model_error) < unloading < loading == float(law.model_error)
    assert np.isfinite(law.force).all()
    assert float(law.contact_count.max()) > 3.0
    assert float(law.force.min()) < 0.0
    assert float(law.contact_count[-1]) == 0.0
    assert (np.diff(law.dissipated_energy) >= 0.0).all()


def test_what_is_said_of_hills(map_file: Path, tmp_path: Path) -> None:
    result = rm.run(of_hills(map_file, interaction={"model": "pairwise"}), tmp_path / "out.nc")
    assert np.isnan(result.trusted_separation).all()
    told = said("info", tmp_path / "out.nc")
    assert "hills of a map are coupled in pairs: force along the path within" in told
    assert "the map resolves its hills" in told
    write_scene(tmp_path, of_hills(map_file))
    saved = said("generate", "scene.toml", "-o", "hills.nc", cwd=tmp_path)
    assert "each has the profile of its best contacts" in saved
    assert "none" in said("generate", "scene.toml", "--cutoffs", "20 um", cwd=tmp_path)


def test_the_error_by_the_border_falls_with_the_side_and_is_a_part_of_the_model_error() -> None:
    height = rough(3)
    inside, alone = hills_of(height), hills_of(height, periodic=False)
    assert inside.attrs["border_error"] == 0.0
    share = min(4.0 * float(alone.attrs["wavelength"]) / SIDE, 1.0)
    assert alone.attrs["border_error"] == pytest.approx(HILLS_BY_BORDER * share)
    assert summits_of(height).attrs["border_error"] == 0.0
    of_many = find_summits(HeightMap(np.tile(height, (2, 2)), SIDE / 128, SIDE / 128, False)).border_error
    of_one = find_summits(HeightMap(height, SIDE / 128, SIDE / 128, False)).border_error
    assert of_many == pytest.approx(0.5 * of_one, rel=0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        law = rm.load_separation(alone, separation=float(alone.height.max()) * 0.5, **PAIRS)
    assert float(law.border_error) == alone.attrs["border_error"]
    assert float(law.model_error) >= float(law.border_error)


@pytest.mark.few(1)
@pytest.mark.parametrize(("row", "column"), [(0, 64), (-4, 64), (6, 64), (0, 0), (5, 5)])
def test_a_hill_that_the_border_cuts_bears_what_is_left_of_it(row: int, column: int) -> None:
    """A hill with its top on the border, beyond it, beside it, or at a corner; a low one is far from it on the map."""
    x, y = np.arange(128)[:, None], np.arange(128)
    height = np.exp(-((x - row) ** 2 + (y - column) ** 2) / (2.0 * 32.0**2))
    height += 0.02 * np.exp(-((x - 122) ** 2 + (y - 122) ** 2) / 3.0)
    alone = {"model": "pairwise", "boundary": "free"}
    separation = float(height.max()) - np.array([0.05, 0.1, 0.2, 0.4])
    found = hills_of(height * 0.01, 1.0, periodic=False)
    law = rm.load_separation(found, separation=0.01 * separation, effective_modulus=1.0, interaction=alone)
    grid = BoundaryElements(height * 0.01, np.ones(2), periodic=False)
    error = 0.2 if row == column else 0.12  # the pressure of what is left of an ellipse differs most at a corner
    np.testing.assert_allclose(law.force, [grid.press(0.01 * h) for h in separation], rtol=error)


def test_what_a_border_cuts_off_a_map_is_counted() -> None:
    """The highest hill of a map lies on the border of the part that is pressed alone."""
    height = rough(7)
    row, column = np.unravel_index(np.argmax(height), height.shape)
    cut = np.roll(height, (-row, 32 - column), axis=(0, 1))[:96, :96]
    side = 0.75 * SIDE
    found, top = hills_of(cut, side, periodic=False), float(cut.max())
    separation = top * np.array([0.95, 0.9, 0.8])
    asked = {"interaction": {"model": "pairwise", "boundary": "free"}, "variables": ["force", "model_error_curve"]}
    law = rm.load_separation(found, separation=separation, effective_modulus=1.0, **asked)
    grid = BoundaryElements(cut / side, np.ones(2), periodic=False)
    true = np.array([grid.press(h) for h in (separation / side).tolist()]) * side**2
    assert (np.abs(law.force / true - 1.0) < 2.0 * law.model_error_curve).all()


def test_hills_far_from_the_border_are_those_of_the_map_that_repeats() -> None:
    height = rough(11)
    inside, alone = hills_of(height), hills_of(height, periodic=False)
    deep = 1.5 * float(inside.attrs["wavelength"])  # beyond the largest contact, which is 1.2 across
    shared = 0
    for each in range(inside.asperity.size):
        one = inside.isel(asperity=each)
        if min(one.x, one.y, SIDE - one.x, SIDE - one.y) > deep:
            other = alone.isel(asperity=int(np.abs(alone.height - one.height).values.argmin()))
            np.testing.assert_allclose(other.g / one.g, 1.0, rtol=0.05)  # at radii that go with the wavelength
            shared += 1
    assert shared > 0
