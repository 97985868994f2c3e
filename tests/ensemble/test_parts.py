"""Parts of ensembles: fewer asperities, as many of them per area."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.gaussian_maps import gaussian_map
from pydantic import TypeAdapter
from scenes import ASPERITIES
from scipy.spatial import cKDTree

import roughmdr as rm
from roughmdr.ensemble import Asperities, Source
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.interaction.placed import part_of, sides_of
from roughmdr.spectrum import SelfAffine

NAYAK = {
    "source": "nayak", "patch": "1 mm", "hurst": 0.8, "long_wave": "100 um", "short_wave": "25 um", "rms_slope": 0.1
}  # fmt: skip


def section(**changes: Any) -> Source:
    return TypeAdapter[Source](Asperities).validate_python({**ASPERITIES, **changes})


@pytest.mark.parametrize("changes", [{}, {"count": None, "density": "1000 /mm^2"}])
@pytest.mark.parametrize("count", [1, 7, 300, 10**6])
def test_a_source_limited_to_a_count_keeps_its_density(changes: dict[str, Any], count: int) -> None:
    table = {key: value for key, value in {**ASPERITIES, **changes}.items() if value is not None}
    whole = TypeAdapter[Source](Asperities).validate_python(table)
    part = whole.limited_to(count)
    assert part.expected_count == pytest.approx(min(count, 1000), rel=1e-12)
    assert part.expected_count / part.nominal_area == pytest.approx(1e9, rel=1e-12)


def test_a_part_of_placed_asperities_is_dense_and_holds_neighbours() -> None:
    whole = section(count=4000, placement="hard_core", min_distance="8 um").ensemble(1, 0, with_positions=True)
    part = part_of(whole, 500)
    assert part.height.size == 500
    assert (np.diff(part.height) <= 0.0).all()
    assert part.nominal_area == pytest.approx(whole.nominal_area / 8.0)
    assert sides_of(part) == pytest.approx((1e-3 / 8.0**0.5,) * 2)
    for values in part.positions.values():
        assert np.ptp(values) == pytest.approx(1e-3 / 8.0**0.5, rel=0.05)
    by_height = dict(zip(whole.height, whole.positions["x"], strict=True))
    assert [by_height[height] for height in part.height] == part.positions["x"].tolist()
    assert part_of(whole, 4000) is whole


def test_a_part_without_a_patch_or_at_one_place() -> None:
    at_one_place = {"x": np.zeros(10), "y": np.zeros(10)}
    whole = Ensemble("paraboloid", np.linspace(1.0, 0.0, 10), {"radius": np.ones(10)}, None, at_one_place)
    assert part_of(whole, 3).height.size == 3
    assert sides_of(part_of(whole, 3)) is None
    assert sides_of(replace(whole, nominal_area=4.0)) == (2.0, 2.0)
    assert sides_of(replace(whole, attrs={"patch_x": 2.0, "patch_y": 3.0})) == (2.0, 3.0)


def nearest(x: Any, y: Any, size: float) -> float:
    """The mean distance to the nearest neighbour, over the mean spacing."""
    places = np.column_stack([x, y]) % size
    return float(cKDTree(places, boxsize=size).query(places, k=2)[0][:, 1].mean() * len(places) ** 0.5 / size)


def test_summits_of_a_gaussian_surface_are_placed_about_as_far_apart_as_those_of_maps() -> None:
    placed = rm.generate({**NAYAK, "placement": "hard_core"}, seed=1)
    size = placed.attrs["patch"]
    places = np.column_stack([placed.x, placed.y])
    least = cKDTree(places, boxsize=size).query(places, k=2)[0][:, 1].min()
    assert 0.5 <= least * placed.attrs["density"] ** 0.5 < 0.52
    spectrum = SelfAffine.of(hurst=0.8, long_wave=64.0, short_wave=16.0, rms_height=1.0)
    summits = find_summits(HeightMap(gaussian_map(spectrum, 1024, 1024.0, 1), 1.0, 1.0, periodic=True))
    of_map = nearest(summits.positions["x"], summits.positions["y"], 1024.0)
    assert nearest(placed.x, placed.y, size) == pytest.approx(of_map, rel=0.05)


def test_summits_get_positions_only_where_they_are_asked_for_and_another_placement_is_taken() -> None:
    assert "x" not in rm.generate(NAYAK, seed=1)
    wider = rm.generate({**NAYAK, "min_distance": "30 um"}, seed=1)
    assert nearest(wider.x, wider.y, 1e-3) > nearest(*_xy({**NAYAK, "placement": "hard_core"}), 1e-3)
    assert nearest(*_xy({**NAYAK, "placement": "hexagonal", "vacancies": True}), 1e-3) > 0.95
    assert nearest(*_xy({**NAYAK, "placement": "random"}), 1e-3) < 0.6


def _xy(table: dict[str, Any]) -> tuple[Any, Any]:
    made = rm.generate(table, seed=1)
    return made.x, made.y
