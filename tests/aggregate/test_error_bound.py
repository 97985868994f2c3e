"""``numerical_error`` against the true error of the force, from 50-digit arithmetic; and the order of adding up."""

import math

import numpy as np
import pytest
import xarray as xr
from oracles.jkr import ExactContact, JkrPowerLaw
from oracles.multiprecision import mp
from scenes import ensemble
from studies import asperity_error
from studies.asperity_error import DRAW, ForceError, random_error

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.shapes import SHAPES as EVERY_SHAPE
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
    oracle = JkrPowerLaw(shape, E, work)
    worst, largest = mp.mpf(0), mp.mpf(0)
    for step in range(law.sizes["step"]):
        h = mp.mpf(float(law.separation[step]))
        held = data.height.to_numpy()[: int(law.contact_count[step])]
        force = mp.fsum(oracle.state(oracle.radius("indentation", mp.mpf(z) - h))["force"] for z in held.tolist())
        worst, largest = max(worst, abs(force - float(law.force[step]))), max(largest, abs(force))
    return float(worst / largest)


@pytest.mark.parametrize("work", [0.0, W])
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("datum", [0.0, 1.0])
def test_the_stated_error_holds_up_to_the_fold(kind: str, work: float, datum: float) -> None:
    shape = SHAPES[kind]
    fold = (
        -float(rm.pull_off(shape, effective_modulus=E, work=work, control="displacement").indentation) if work else 1e-6
    )
    offsets = np.array([1.0, 0.4, 0.0]) * fold
    data = ensemble(datum + offsets, shape=kind, **COLUMNS[kind])
    for near in (1e-3, 1e-6, 1e-9):
        path = datum + np.array([2.0, -0.5, 0.3, 1.0, (2.0 if work else 1.0) * (1.0 - near)]) * fold
        law = rm.load_separation(
            data, separation=path, effective_modulus=E, work=work, variables=["force", "contact_count"]
        )
        stated = float(law.numerical_error)
        assert true_error(shape, work, data, law) <= stated
        assert stated < 1e-2 if datum else stated < 1e-6


def test_the_stated_error_is_of_use_on_an_ordinary_ensemble() -> None:
    rng = np.random.default_rng(23)
    data = ensemble(np.sort(rng.normal(0.0, 1e-6, 60))[::-1], radius=5e-5)
    for work in (0.0, W):
        law = rm.load_separation(
            data, separation=np.linspace(2e-6, -1e-6, 8), effective_modulus=E, work=work,
            variables=["force", "contact_count"],
            unload=True,
        )  # fmt: skip
        true = true_error(rm.Paraboloid(5e-5), work, data, law)
        assert true <= float(law.numerical_error) < max(3000.0 * true, 1e-11)


def test_blocks_are_added_without_loss() -> None:
    """A large compression and a large tension that cancel over 2000 blocks: what is left keeps its digits."""
    count = 512_000
    rng = np.random.default_rng(29)
    z = np.sort(rng.uniform(0.0, 1e-6, count))[::-1].copy()
    columns = Columns(*(np.full(count, value) for value in (5e-5, 2.5e-5, 2.0)))
    h = np.array([0.0])
    total, _, _ = loop.sum_over_asperities(
        choose("paraboloid", Adhesion(), columns[2]), z, columns, E, Adhesion(), h, no_memory(h), {totals.FORCE}
    )
    terms = 4.0 / 3.0 * E * math.sqrt(5e-5) * z**1.5
    assert total[totals.FORCE, 0] == pytest.approx(math.fsum(terms), rel=4e-16)


def test_equal_heights_in_any_order_give_the_same_bits() -> None:
    rng = np.random.default_rng(31)
    z = np.repeat(rng.normal(0.0, 1e-6, 40), 25)
    data = ensemble(z, radius=rng.uniform(1e-5, 9e-5, z.size))
    laws = [
        rm.load_separation(
            data.isel(asperity=order), separation=np.linspace(2e-6, -1e-6, 9), effective_modulus=E, work=W
        )
        for order in (np.arange(z.size), rng.permutation(z.size))
    ]
    for name in ("force", "contact_area", "stiffness"):
        np.testing.assert_array_equal(laws[0][name], laws[1][name])


def test_what_no_float_can_hold_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="not representable"):
        rm.load_separation(ensemble([1e-200], radius=1e-200, area=None), separation=[0.0], effective_modulus=E)


def outside(kind: str, adhesive: bool, seeds: range) -> list[ForceError]:
    """The asperities whose true error is beyond the stated one."""
    judged = [random_error(kind, adhesive, seed) for seed in seeds]
    return [one for one in judged if not one.error <= one.stated]


@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize("kind", DRAW)
def test_the_stated_error_of_random_asperities_holds_from_1e_12_of_the_fold_on(kind: str, adhesive: bool) -> None:
    assert set(DRAW) == set(EVERY_SHAPE)
    assert not outside(kind, adhesive, range(12 if kind == "tabulated" else 60))


@pytest.mark.large
@pytest.mark.parametrize("group", asperity_error.groups(5_000), ids=str)
def test_the_stated_error_of_very_many_random_asperities_holds(group: asperity_error.Group) -> None:
    assert not outside(*group)


def of_one(shape: Shape, effective_modulus: float, work: float, indentation: float) -> tuple[float, float, float]:
    """True and stated error of a sum over one asperity, over its force, and that of the asperity alone."""
    exact = ExactContact(shape, effective_modulus, work)
    columns = {"exponent": ("term", list(shape.terms)), "terms": ("term", list(shape.terms.values()))}
    data = xr.Dataset({"height": ("asperity", [0.0]), **columns}, attrs={"shape": shape.name})
    law = rm.load_separation(
        data, separation=[0.0, -indentation], effective_modulus=effective_modulus, work=work, variables=["force"]
    )
    alone = rm.indent(shape, effective_modulus=effective_modulus, work=work, indentation=indentation)
    width = shape.nondimensional()[0]
    t = exact.state(mp.mpf(indentation), float(alone.contact_radius) / width, mp.mpf(0), mp.inf)
    force = exact.force(t)
    largest = max(abs(force), abs(float(law.force[0])))
    error = abs(float(law.force[1]) - force) / largest
    return float(error), float(law.numerical_error), float(abs(float(alone.force) - force) / abs(force))


@pytest.mark.large
@pytest.mark.parametrize(
    ("terms", "effective_modulus", "work", "distance"),
    [
        ({0.51: 4.61651885981686e-06, 3: 31560506.062446207}, 118883500.2033251, 4.284641315594834e-05, 2.98e-12),
        ({0.52: 0.007272545523147884, 0.9: 0.00011301377253670167}, 2601093244.77, 0.5764512712935, 3e-6),
        ({0.6: 1e-4, 2: 1e3}, 1e9, 1e-2, 1e-11),
        ({1: 0.1, 2: 1e4}, 1e9, 1e-2, 1e-12),
        ({2: 1e4, 150: 1e300}, 1e7, 0.05, 1e-3),
    ],
)
def test_a_series_near_its_fold(
    terms: dict[float, float], effective_modulus: float, work: float, distance: float
) -> None:
    shape = rm.PowerSeries(terms)
    fold = float(rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="displacement").indentation)
    true, stated, alone = of_one(shape, effective_modulus, work, fold * (1.0 - distance))
    assert true <= stated
    assert stated <= 1e4 * max(true, 1e-15)
    assert alone <= 1e-12 + 3e-16 / math.sqrt(distance)


@pytest.mark.large
def test_a_steep_series_without_adhesion_is_found_to_the_last_digit_of_its_value() -> None:
    shape = rm.PowerSeries({100.0: 1.0, 150.0: 1.0})
    for indentation in np.geomspace(1e-3, 1e2, 40):
        contact = rm.indent(shape, effective_modulus=E, indentation=float(indentation))
        exact = ExactContact(shape, E, 0.0)
        t = exact.state(mp.mpf(float(indentation)), float(contact.contact_radius), mp.mpf(0), mp.inf)
        assert abs(float(contact.force) / exact.force(t) - 1) < 400 * 2.0**-53


@pytest.mark.large
@pytest.mark.parametrize("exponent", [0.51, 0.52, 0.55, 0.6, 0.7, 0.76, 0.8])
def test_the_bound_asks_nothing_of_how_the_stiffness_goes(exponent: float) -> None:
    """Below n = 0.768 k falls along a part of the branch; where k or P is 0, their terms are not."""
    e = 2.0 * exponent - 1.0
    shape = rm.PowerLaw(exponent=exponent, width=1e-6, rise=1e-8)
    oracle = JkrPowerLaw(shape, 1e9, 1e-3)
    fold = oracle.fold("indentation")
    k = []
    for log_tau in [*np.linspace(0.01, 4.0, 60) / e, math.log(3.0) / e, math.log(2.0 * exponent + 2.0) / e]:
        a = fold * mp.exp(2 * mp.mpf(log_tau))
        k.append(float(oracle.state(a)["stiffness"] / a))
        indentation = float(oracle.state(a)["indentation"])
        if not abs(indentation) < 1e290:
            continue
        columns = Columns(*(np.array([number]) for number in (1e-6, 1e-8, exponent)))
        h = np.array([-indentation]) if indentation > 0.0 else np.array([0.0, -indentation])
        total, _, _ = loop.sum_over_asperities(
            choose("power_law", Adhesion(1e-3), columns[2]), np.zeros(1), columns, 1e9, Adhesion(1e-3), h,
            staircase(h), {totals.FORCE, totals.ERROR},
        )  # fmt: skip
        exact = oracle.state(oracle.radius("indentation", mp.mpf(indentation)))["force"]
        assert abs(total[totals.FORCE, -1] - exact) <= total[totals.ERROR, -1]
        assert total[totals.ERROR, -1] > 0.0


@pytest.mark.large
def test_the_stated_error_of_a_sum_of_unlike_asperities_holds() -> None:
    rng = np.random.default_rng(37)
    for _ in range(20):
        radius, z = 10.0 ** rng.uniform(-7.0, -4.0, 12), rng.normal(0.0, 1e-7, 12)
        flat = 10.0 ** rng.uniform(-8.0, -6.0, 12)
        for kind, columns in (
            ("rounded_punch", {"flat_radius": flat, "edge_radius": radius}),
            ("sphere", {"radius": radius}),
            ("rounded_cone", {"slope": 10.0 ** rng.uniform(-3.0, 0.0, 12), "blend_radius": flat}),
        ):
            data = ensemble(z, area=None, shape=kind, **columns)
            shapes = [rm.shapes.SHAPES[kind](**{name: float(c[i]) for name, c in columns.items()}) for i in range(12)]
            h = float(z.min() - 1e-9)
            law = rm.load_separation(data, separation=[h], effective_modulus=1e8, work=1e-2, variables=["force"])
            exact = mp.mpf(0)
            for shape, height in zip(shapes, z.tolist(), strict=True):
                depth = float(mp.mpf(height) - mp.mpf(h))
                a = float(rm.indent(shape, effective_modulus=1e8, work=1e-2, indentation=depth).contact_radius)
                width, _, params = shape.nondimensional()
                own = ExactContact(shape, 1e8, 1e-2)
                begin = shape.profile.t_of_radius(a, width, [params])
                exact += own.force(own.state(mp.mpf(height) - mp.mpf(h), begin, mp.mpf(0), mp.inf))
            largest = abs(float(law.force[0]))
            assert abs(float(law.force[0]) - exact) / largest <= float(law.numerical_error) < 1e-9
