"""Lattices by count or by pitch: every site has its neighbours at one distance, also across the edges of the patch."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES, scene
from scipy.spatial import cKDTree

import roughmdr as rm
from roughmdr.ensemble.lattice import lattice_of
from roughmdr.scene import read

NEIGHBOURS = {"square": 4, "hexagonal": 6}
NAYAK = {"source": "nayak", "patch": "1 mm", "hurst": 0.8, "long_wave": "0.1 mm", "short_wave": "25 um",
         "rms_height": "1 um"}  # fmt: skip


def generate(**changes: Any) -> xr.Dataset:
    table = {**ASPERITIES, "count": None, **changes}
    return rm.generate({key: value for key, value in table.items() if value is not None}, seed=3)


def distances(placed: xr.Dataset, neighbours: int) -> Any:
    """Return the distances to the nearest neighbours in the patch that repeats, [asperity, neighbour]."""
    sides = placed.attrs["patch_x"], placed.attrs["patch_y"]
    points = np.column_stack([placed.x, placed.y])
    assert (points >= 0.0).all()
    assert (points < sides).all()
    return cKDTree(points, boxsize=sides).query(points, k=neighbours + 1)[0][:, 1:]


@pytest.mark.large
@settings(max_examples=40, deadline=None)
@given(kind=st.sampled_from(list(NEIGHBOURS)), pitch=st.floats(1e-9, 1e-3), sites=st.floats(4.0, 40.0))
def test_a_lattice_by_pitch_is_exact(kind: str, pitch: float, sites: float) -> None:
    placed = generate(placement=kind, pitch=pitch, patch=sites * pitch)
    found = distances(placed, NEIGHBOURS[kind])
    np.testing.assert_allclose(found, pitch, rtol=1e-9)
    row = 1.0 if kind == "square" else np.sqrt(0.75)
    area = placed.attrs["patch_x"] * placed.attrs["patch_y"]
    assert placed.sizes["asperity"] * row * pitch**2 == pytest.approx(area, rel=1e-12)
    assert placed.attrs["nominal_area"] == pytest.approx(area, rel=1e-12)
    for side in ("patch_x", "patch_y"):
        assert abs(placed.attrs[side] / pitch - sites) <= 0.5 * (1.0 if side == "patch_x" else 2.0 * row) + 1e-9


@pytest.mark.parametrize(("kind", "count"), [("hexagonal", 3600), ("hexagonal", 56), ("square", 12), ("square", 3600)])
def test_a_lattice_by_count_has_the_area_of_the_patch(kind: str, count: int) -> None:
    placed = generate(placement=kind, count=count)
    assert placed.sizes["asperity"] == count
    found = distances(placed, NEIGHBOURS[kind])
    np.testing.assert_allclose(found, found[0, 0], rtol=1e-9)
    sides = placed.attrs["patch_x"], placed.attrs["patch_y"]
    assert sides[0] * sides[1] == pytest.approx(1e-6, rel=1e-12)
    assert 0.5 < sides[0] / sides[1] < 2.0
    assert "patch" not in placed.attrs


def test_vacancies_are_made_only_if_asked_for() -> None:
    """On 57 x 64 sites of the square patch, as near to a hexagonal lattice as it allows."""
    placed = generate(placement="hexagonal", count=3600, vacancies=True)
    assert placed.attrs["patch"] == 1e-3
    rows = np.unique(placed.y)
    sites = (placed.x / (1e-3 / 57) - 0.25) % 1.0
    assert rows.size == 64
    assert np.all(np.minimum(np.abs(sites - 0.5), np.minimum(sites, 1.0 - sites)) < 1e-9)
    assert 57 * 64 - placed.sizes["asperity"] == 48


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("changes", "unit", "within"),
    [
        ({"placement": "square", "count": 900}, 1.0, 5e-3),
        ({"placement": "hexagonal", "count": 900}, 1e-6, 5e-3),
        ({"placement": "hexagonal", "count": 900, "vacancies": True}, 1e-3, 0.02),
    ],
)
def test_an_empty_disc_stands_for_the_neighbours_that_a_site_lacks(
    changes: dict[str, Any], unit: float, within: float
) -> None:
    """The mean of exp(-r^2/L^2)/r over all others is that of a uniform density from the edge of the disc on."""
    placed = generate(**changes, patch=unit)
    sides = np.array([placed.attrs.get(name, unit) for name in ("patch_x", "patch_y")])
    points, length = np.column_stack([placed.x, placed.y]), 0.15 * unit
    steps = points[None, :, :] - points[:450, None, :]
    images = np.moveaxis(np.mgrid[-1:2, -1:2], 0, -1).reshape(-1, 2) * sides
    r = np.hypot(*np.moveaxis(steps[:, :, None, :] + images, -1, 0))
    others = np.exp(-((r / length) ** 2)) / np.where(r > 0.0, r, np.inf)
    density = 900 / sides.prod()
    disc = np.sqrt(np.pi) * length / 2.0 - others.sum() / len(steps) / (2.0 * np.pi * density)
    assert placed.attrs["exclusion_distance"] == pytest.approx(disc, rel=within)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"placement": "hexagonal", "count": 3601}, "3601 asperities fill no hexagonal lattice on a patch"),
        ({"placement": "square", "count": 1009}, "1009 asperities fill no square lattice .*; 1008 or 1012 do$"),
        ({"placement": "hexagonal", "density": "5 /mm^2"}, "needs count or pitch: a density"),
        ({"placement": "hexagonal", "pitch": "9 um", "count": 9}, "pitch = '9 um': does not go with count"),
        ({"placement": "random", "pitch": "9 um"}, "pitch = '9 um': goes with placement = 'square' or 'hexagonal'"),
        ({"placement": "square", "pitch": "1 nm", "patch": "1 m"}, "puts more than 30000 sites on a side"),
        ({"placement": "square", "pitch": "1 kg"}, "pitch"),
        ({"placement": "square", "pitch": "2 mm", "patch": "1 mm"}, "must be at most the side of the patch, 1 mm"),
        ({"placement": "random", "count": 5, "vacancies": True}, 'vacancies = True: goes with placement = "hexagonal"'),
        ({"placement": "square"}, "needs count, the pitch of a lattice, or a density"),
    ],
)  # fmt: skip
def test_what_fills_no_lattice_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        generate(**changes)


@pytest.mark.parametrize("count", [2, 3600, 999_983 * 2, 10**9])
def test_the_counts_that_are_suggested_fit(count: int) -> None:
    found = lattice_of("hexagonal", count, 1.0)
    assert (found is None) == (count == 999_983 * 2)
    if found is not None:
        assert found.rows * found.columns == count
        assert found.rows % 2 == 0


def test_summits_of_a_surface_fill_a_lattice_where_their_number_does() -> None:
    with pytest.raises(rm.SceneError, match="asperities fill no hexagonal lattice"):
        rm.generate({**NAYAK, "placement": "hexagonal", "patch": "0.9999 mm"}, seed=1)
    assert "patch" in rm.generate({**NAYAK, "placement": "hexagonal", "vacancies": True}, seed=1).attrs


@pytest.mark.parametrize("most", [7, 100, 1000])
def test_a_part_of_a_lattice_is_one_of_the_same_pitch(most: int) -> None:
    whole = read(scene(asperities={**ASPERITIES, "count": 3600, "placement": "hexagonal"})).asperities
    part = whole.limited_to(most)
    assert 0.5 * most < part.expected_count <= most
    found = part.ensemble(1, 0, with_positions=True)
    assert found.height.size == part.expected_count
    lattice = lattice_of("hexagonal", 3600, 1e-6)
    assert lattice is not None
    assert found.attrs["patch_x"] / found.attrs["patch_y"] < 2.0
    assert part.lattice.pitch == pytest.approx(lattice.pitch, rel=1e-12)  # type: ignore[attr-defined]


def test_the_plan_says_what_fits(tmp_path: Any) -> None:
    section = {**ASPERITIES, "placement": "hexagonal", "pitch": "20 um"}
    del section["count"]
    write_scene(tmp_path, scene(asperities=section, batch={"realizations": 1}))
    told = said("plan", "scene.toml", cwd=tmp_path)
    assert "hexagonal lattice, 58 rows of 50, pitch 20 um, patch 1 mm x 1.005 mm" in told
