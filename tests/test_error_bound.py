"""``numerical_error`` against the true error of the force, from 50-digit arithmetic; and the order of adding up."""

import math

import numpy as np
import pytest
import xarray as xr
from scenes import ensemble
from twins import Twin, mp

import roughmdr as rm
from roughmdr.adhesion import Adhesion
from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.staircase import no_memory
from roughmdr.kernels.laws import choose
from roughmdr.shapes.base import Shape

E, W = 4e6, 0.05
COLUMNS = {"paraboloid": {"radius": 5e-5}, "cone": {"slope": 0.1}, "power_law": {"exponent": 1.5, "coefficient": 30.0}}
SHAPES: dict[str, Shape] = {
    "paraboloid": rm.Paraboloid(5e-5),
    "cone": rm.Cone(0.1),
    "power_law": rm.PowerLaw(1.5, 30.0),
}


def true_error(shape: Shape, work: float, data: xr.Dataset, law: xr.Dataset) -> float:
    """The largest error of the force over its largest magnitude; all asperities alike, held as the law counts them."""
    twin = Twin(shape, E, work)
    worst, largest = mp.mpf(0), mp.mpf(0)
    for step in range(law.sizes["step"]):
        h = mp.mpf(float(law.separation[step]))
        held = data.height.to_numpy()[: int(law.contact_count[step])]
        force = mp.fsum(twin.force(twin.radius("indentation", mp.mpf(z) - h)) for z in held.tolist())
        worst, largest = max(worst, abs(force - float(law.force[step]))), max(largest, abs(force))
    return float(worst / largest)


@pytest.mark.parametrize("work", [0.0, W])
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("datum", [0.0, 1.0])
def test_the_stated_error_holds_up_to_the_fold(kind: str, work: float, datum: float) -> None:
    shape = SHAPES[kind]
    fold = -float(rm.pull_off(shape, modulus=E, work=work).indentation) if work else 1e-6
    offsets = np.array([1.0, 0.4, 0.0]) * fold
    data = ensemble(datum + offsets, shape=kind, **COLUMNS[kind])
    for near in (1e-3, 1e-6, 1e-9):
        path = datum + np.array([2.0, -0.5, 0.3, 1.0, (2.0 if work else 1.0) * (1.0 - near)]) * fold
        law = rm.load_separation(data, separation=path, modulus=E, work=work, variables=["force", "contact_count"])
        stated = float(law.numerical_error)
        assert true_error(shape, work, data, law) <= stated
        assert stated < 1e-2 if datum else stated < 1e-6


def test_the_stated_error_is_of_use_on_an_ordinary_ensemble() -> None:
    rng = np.random.default_rng(23)
    data = ensemble(np.sort(rng.normal(0.0, 1e-6, 60))[::-1], radius=5e-5)
    for work in (0.0, W):
        law = rm.load_separation(
            data, separation=np.linspace(2e-6, -1e-6, 8), modulus=E, work=work, variables=["force", "contact_count"],
            unload=True,
        )  # fmt: skip
        true = true_error(rm.Paraboloid(5e-5), work, data, law)
        assert true <= float(law.numerical_error) < max(3000.0 * true, 1e-11)


def test_blocks_are_added_without_loss() -> None:
    """A large compression and a large tension that cancel over 2000 blocks: what is left keeps its digits."""
    count = 512_000
    rng = np.random.default_rng(29)
    z = np.sort(rng.uniform(0.0, 1e-6, count))[::-1].copy()
    columns = tuple(np.full(count, value) for value in (5e-5, 2.5e-5, 2.0))
    h = np.array([0.0])
    total, _, _ = loop.add_asperities(
        choose("paraboloid", Adhesion(), columns[2]), z, columns, E, Adhesion(), h, no_memory(h), {totals.FORCE}
    )
    terms = 4.0 / 3.0 * E * math.sqrt(5e-5) * z**1.5
    assert total[totals.FORCE, 0] == pytest.approx(math.fsum(terms), rel=4e-16)


def test_equal_heights_in_any_order_give_the_same_bits() -> None:
    rng = np.random.default_rng(31)
    z = np.repeat(rng.normal(0.0, 1e-6, 40), 25)
    data = ensemble(z, radius=rng.uniform(1e-5, 9e-5, z.size))
    laws = [
        rm.load_separation(data.isel(asperity=order), separation=np.linspace(2e-6, -1e-6, 9), modulus=E, work=W)
        for order in (np.arange(z.size), rng.permutation(z.size))
    ]
    for name in ("force", "contact_area", "stiffness"):
        np.testing.assert_array_equal(laws[0][name], laws[1][name])


def test_what_no_float_can_hold_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="not representable"):
        rm.load_separation(ensemble([1e-200], radius=1e-200, area=None), separation=[0.0], modulus=E)
