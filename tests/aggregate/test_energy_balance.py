"""Energy and dissipated energy of ensembles: the balance with the work of the force, which knows neither."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import detachment_depths, ensemble

import roughmdr as rm

E, W = 4e6, 0.05
VARIABLES = ["force", "contact_count", "energy", "dissipated_energy"]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
COLUMNS = {
    "paraboloid": {"radius": [3e-5, 8e-5]},
    "cone": {"slope": [0.05, 0.2]},
    "power_law": {"exponent": [1.2, 4.0], "width": [2e-5, 3e-5], "rise": [1e-6, 2e-6]},
}


def rough(kind: str, count: int) -> xr.Dataset:
    rng = np.random.default_rng(41)
    columns = {name: rng.uniform(*ends, count) for name, ends in COLUMNS[kind].items()}
    return ensemble(rng.normal(0.0, 1e-6, count), shape=kind, **columns)


def down(stops: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Gauss-Legendre nodes and weights between the separations at which contacts are made, in the root of the distance
    to the last: there P is smooth.
    """
    for a, b in pairwise(stops):
        s = np.sqrt(a - b) * (1.0 + NODES) / 2.0
        yield a - s * s, -WEIGHTS * np.sqrt(a - b) * s


def up(stops: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield nodes between losses of contacts, in the root of the distance to the next: P is smooth in it."""
    for a, b in pairwise(stops):
        s = np.sqrt(b - a) * (1.0 - NODES) / 2.0
        yield b - s * s, WEIGHTS * np.sqrt(b - a) * s


@pytest.mark.parametrize("kind", COLUMNS)
def test_the_work_of_a_closed_load_cycle_is_what_the_jumps_dissipate(kind: str) -> None:
    """∮ F d(-h), with panels between all jumps: the force between them is integrated to rounding error."""
    data = rough(kind, 40)
    z, lowest = data.height.to_numpy(), -0.3e-6
    made = np.sort(z[z > lowest])[::-1]
    lost = np.sort((z + detachment_depths(data, effective_modulus=E, work=W))[z >= lowest])
    pieces = [*down(np.array([*made, lowest])), *up(np.array([lowest, *lost]))]
    path = np.concatenate([*(h for h, _ in pieces), [lost[-1] * 1.001]])
    weights = np.concatenate([*(w for _, w in pieces), [0.0]])
    law = rm.load_separation(data, separation=path, effective_modulus=E, work=W, variables=VARIABLES)
    work = -float(np.sum(law.force * weights))
    assert float(law.contact_count[-1]) == float(law.energy[-1]) == 0.0
    assert abs(work / float(law.dissipated_energy[-1]) - 1.0) < 1e-12


@pytest.mark.parametrize("kind", COLUMNS)
def test_without_adhesion_nothing_is_dissipated_and_the_energy_is_the_work(kind: str) -> None:
    data = rough(kind, 40)
    z = np.sort(data.height.to_numpy())[::-1]
    whole = np.concatenate([h for h, _ in down(np.array([*z, -3e-6]))])
    weights = np.concatenate([w for _, w in down(np.array([*z, -3e-6]))])
    law = rm.load_separation(data, separation=[*whole, -3e-6], effective_modulus=E, variables=VARIABLES)
    assert float(law.energy[-1]) == pytest.approx(-float(np.sum(law.force[:-1] * weights)), rel=1e-7)
    back = rm.load_separation(data, separation=[-1e-6, 5e-6], effective_modulus=E, variables=VARIABLES)
    assert back.energy.to_numpy()[1] == 0.0
    assert not back.dissipated_energy.any()
    assert not law.dissipated_energy.any()


@settings(deadline=None, max_examples=60)
@given(
    path=st.lists(st.integers(-8, 12), min_size=1, max_size=14),
    heights=st.lists(st.integers(-10, 10), min_size=1, max_size=6),
    unit=st.sampled_from([1e-9, 1e-6, 1e-3]),
)
def test_every_jump_is_counted_once_on_any_path(path: list[int], heights: list[int], unit: float) -> None:
    data = ensemble((np.array(heights) + 0.5) * unit, area=None, radius=50.0 * unit)
    way, work = np.array(path) * unit, W * unit / 1e-6
    law = rm.load_separation(data, separation=way, effective_modulus=E, work=work, variables=VARIABLES)
    fold = -float(
        rm.pull_off(rm.Paraboloid(50.0 * unit), effective_modulus=E, work=work, control="displacement").indentation
    )
    a0 = (2.0 * np.pi * work * (50.0 * unit) ** 2 / E) ** (1.0 / 3.0)
    on, off = 0.6 * np.pi * work * a0**2, 0.4 * 4.0 ** (-4.0 / 3.0) * np.pi * work * a0**2
    spent, held, expected = 0.0, np.zeros(data.sizes["asperity"], dtype=bool), []
    z = data.height.to_numpy()
    for h in way:
        now = (z >= h) | (held & (z - h > -fold))
        spent += on * (now & ~held).sum() + off * (held & ~now).sum()
        held = now
        expected.append(spent)
    np.testing.assert_allclose(law.dissipated_energy, expected, rtol=1e-12)


def test_a_coarse_path_dissipates_as_much_as_a_fine_one() -> None:
    data = rough("paraboloid", 700)
    ends = []
    for steps in (3, 30, 3000):
        law = rm.load_separation(
            data,
            separation=np.linspace(4e-6, -1e-6, steps),
            effective_modulus=E,
            work=W,
            unload=True,
            variables=VARIABLES,
        )
        assert (np.diff(law.dissipated_energy) >= 0.0).all()
        ends.append(float(law.dissipated_energy[-1]))
    assert ends[0] == pytest.approx(ends[2], rel=1e-14)
    assert ends[1] == pytest.approx(ends[2], rel=1e-14)


def test_an_energy_that_no_float_can_hold_is_refused_only_where_it_is_asked_for() -> None:
    data = ensemble([1e-160], radius=1e-160, area=None)
    law = {"separation": [0.0], "effective_modulus": 1e30}
    assert float(rm.load_separation(data, **law, variables=["force"]).force[0]) > 0.0
    with pytest.raises(rm.OutOfRange, match="not representable"):
        rm.load_separation(data, **law, variables=["energy"])
