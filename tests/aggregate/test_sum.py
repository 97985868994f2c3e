"""The sum against a plain Python twin that remembers each contact, and what it may not depend on."""

import gc

import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st
from numba.core.dispatcher import Dispatcher
from scenes import ensemble, shapes_of

import roughmdr as rm
from roughmdr.aggregate import LoadingPath, compute, loop, totals
from roughmdr.aggregate.problem import Problem
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.variables import CURVE_VARIABLES

E, W = 4e6, 0.05
_OWN = ("energy", "error")  # these have their own
ALL = tuple(name for name in CURVE_VARIABLES if not any(part in name for part in _OWN))


def twin(data: xr.Dataset, path: np.ndarray, effective_modulus: float, work: float) -> dict[str, np.ndarray]:
    """One asperity after the other, one step after the other, with a memory of its own."""
    totals = {
        name: np.zeros(path.size)
        for name in ("force", "contact_area", "contact_count", "stiffness", "contact_radius_sum")
    }
    for z, shape in zip(data.height.to_numpy().tolist(), shapes_of(data), strict=True):
        contacts = rm.indent(shape, effective_modulus=effective_modulus, work=work, indentation=z - path)
        fold = float(
            rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="displacement").indentation
        )
        held = False
        for m, delta in enumerate(z - path):
            held = (delta >= 0.0 or (held and delta > fold)) if work else delta > 0.0
            if held:
                for name in ("force", "contact_area", "stiffness"):
                    totals[name][m] += float(contacts[name][m])
                totals["contact_radius_sum"][m] += float(contacts.contact_radius[m])
                totals["contact_count"][m] += 1.0
    return totals


def check(data: xr.Dataset, path: np.ndarray, work: float, effective_modulus: float = E) -> None:
    area = data.attrs["nominal_area"]
    law = rm.load_separation(data, separation=path, effective_modulus=effective_modulus, work=work, variables=ALL)
    expected = twin(data, path, effective_modulus, work)
    expected["conductance_radius"] = expected["contact_radius_sum"]
    expected |= {"pressure": expected["force"] / area, "contact_fraction": expected["contact_area"] / area}
    for name in ALL:
        scale = np.max(np.abs(expected[name])) or 1.0
        np.testing.assert_allclose(law[name], expected[name], rtol=1e-9, atol=1e-11 * scale, err_msg=name)


@pytest.mark.parametrize("work", [0.0, W])
@pytest.mark.parametrize(
    ("shape", "parameters"),
    [
        ("paraboloid", {"radius": [3e-5, 8e-5]}),
        ("cone", {"slope": [0.02, 0.2]}),
        ("power_law", {"exponent": [1.2, 4.0], "width": [2e-5, 6e-5], "rise": [1e-6, 3e-6]}),
        ("power_law", {"exponent": [1.6, 2.4], "coefficient": [1e3, 1e4]}),
    ],
)
def test_equals_the_twin_on_a_crooked_path(shape: str, parameters: dict[str, list[float]], work: float) -> None:
    rng = np.random.default_rng(3)
    data = ensemble(
        rng.normal(0.0, 1e-6, 23), shape=shape, **{name: rng.uniform(*ends, 23) for name, ends in parameters.items()}
    )
    path = np.array([3, 1, 0.2, 1.5, 0.9, -0.3, 0.4, 0.1, 0.8, 2.5, 0.6, 4.0, 1.0]) * 1e-6
    check(data, path, work)


@settings(deadline=None, max_examples=60)
@given(
    path=st.lists(st.integers(-8, 12), min_size=1, max_size=14),
    heights=st.lists(st.integers(-10, 10), min_size=1, max_size=6),
    unit=st.sampled_from([1e-9, 1e-6, 1e-3]),
    adhesive=st.booleans(),
)
def test_equals_the_twin_on_any_path_at_any_scale(
    path: list[int], heights: list[int], unit: float, adhesive: bool
) -> None:
    # Half-integer heights keep clear of ties between a fold and a step, which rounding may decide either way.
    data = ensemble((np.array(heights) + 0.5) * unit, area=1e6 * unit**2, radius=50.0 * unit)
    check(data, np.array(path) * unit, W * unit / 1e-6 if adhesive else 0.0)


def test_the_same_physics_in_other_units() -> None:
    rng = np.random.default_rng(5)
    z, radius = rng.normal(0.0, 1e-6, 500), rng.uniform(3e-5, 8e-5, 500)
    path = np.linspace(3e-6, -1e-6, 30)
    base = rm.load_separation(ensemble(z, radius=radius), separation=path, effective_modulus=E, work=W, unload=True)
    length, force = 2.0**20, 2.0**-13  # powers of two: only the cube root and pi/E* round differently
    scaled = rm.load_separation(
        ensemble(z * length, area=1e-4 * length**2, radius=radius * length),
        separation=path * length,
        effective_modulus=E * force / length**2,
        work=W * force / length,
        unload=True,
    )
    factors = {"force": force, "contact_area": length**2, "contact_count": 1.0, "stiffness": force / length}
    for name, factor in factors.items():
        scale = float(np.abs(base[name]).max())
        np.testing.assert_allclose(scaled[name] / factor, base[name], rtol=1e-10, atol=1e-13 * scale)


@pytest.mark.parametrize("work", [0.0, W])
def test_order_and_asperities_out_of_reach_change_no_bit(work: float) -> None:
    rng = np.random.default_rng(11)
    data = ensemble(rng.normal(0.0, 1e-6, 1500), radius=rng.uniform(3e-5, 8e-5, 1500))
    path = np.linspace(3e-6, 0.0, 25)

    def law(asperities: xr.Dataset) -> xr.Dataset:
        return rm.load_separation(
            asperities, separation=path, effective_modulus=E, work=work, unload=True, variables=ALL
        )

    whole = law(data)
    assert float(whole.force.max()) > 0.0
    shuffled = law(data.isel(asperity=rng.permutation(1500)))
    low = ensemble(rng.uniform(-9e-6, -1e-9, 700), radius=rng.uniform(3e-5, 8e-5, 700))
    more = law(xr.concat([data, low], "asperity", combine_attrs="override"))
    for name in ALL:
        np.testing.assert_array_equal(shuffled[name], whole[name])
        np.testing.assert_array_equal(more[name], whole[name])


@pytest.mark.parametrize("work", [0.0, W])
def test_only_asperities_within_reach_are_visited(work: float) -> None:
    rng = np.random.default_rng(17)
    data = ensemble(rng.normal(0.0, 1e-6, 1000), radius=5e-5)
    fold = -float(rm.pull_off(rm.Paraboloid(5e-5), effective_modulus=E, work=work, control="displacement").indentation)
    way_in = np.linspace(4e-6, 0.0, 50)
    route = LoadingPath.along(way_in, unload=True, adhesive=work > 0.0)
    asperities = Ensemble.from_dataset(data)
    result = compute(Problem(asperities, E, Adhesion(work)), route, ["force", "contact_count"])
    z = asperities.height
    needed = sum(int((z > h).sum()) for h in way_in) + sum(int(((z > h - fold) & (z >= 0.0)).sum()) for h in way_in)
    assert result.visits == needed
    if work:
        assert result.visits == int(result.variables["contact_count"].sum())


def compiled_signatures() -> int:
    return sum(len(each.signatures) for each in gc.get_objects() if isinstance(each, Dispatcher))


def test_no_form_of_an_array_is_compiled_again() -> None:
    z, path = np.random.default_rng(3).normal(0.0, 1e-6, 50), np.linspace(3e-6, 0.0, 20)
    fixed, fixed_path = z.copy(), path.copy()
    fixed.flags.writeable = fixed_path.flags.writeable = False

    def law(height: np.ndarray, separation: object) -> float:
        data = ensemble(height, radius=5e-5)
        made = rm.load_separation(data, separation=separation, effective_modulus=E, work=W)  # type: ignore[arg-type]
        return float(made.force[-1])

    force, before = law(z, path), compiled_signatures()
    for height in (z, fixed, np.repeat(z, 2)[::2], z[::-1]):
        for separation in (path, fixed_path, np.sort(path)[::-1], np.repeat(path, 3)[::3], path.tolist()):
            assert law(height, separation) == force
    assert compiled_signatures() == before


def test_only_the_asked_totals_are_computed() -> None:
    asperities = Ensemble.from_dataset(ensemble([1e-6, 2e-6], radius=5e-5))
    route = LoadingPath.along(np.array([0.0]), unload=False, adhesive=True)
    columns = asperities.columns
    law = choose("paraboloid", Adhesion(W), columns[2])
    total, _, _ = loop.sum_over_asperities(
        law, asperities.height, columns, E, Adhesion(W), *route, rows={totals.RADIUS}
    )
    assert total[totals.RADIUS, 0] > 0.0
    others = [row for row in range(totals.ROWS) if row != totals.RADIUS]
    assert not total[others].any()


def test_a_loop_of_the_path_dissipates_and_its_memory_fades() -> None:
    """Paths that differ only in an inner loop, later wiped out by a closer approach, end alike."""
    rng = np.random.default_rng(19)
    data = ensemble(rng.normal(0.0, 1e-6, 300), radius=5e-5)
    straight = np.array([3.0, 0.0, 2.0]) * 1e-6
    looped = np.array([3.0, 1.0, 1.6, 0.9, 0.0, 2.0]) * 1e-6
    last = [
        rm.load_separation(data, separation=path, effective_modulus=E, work=W).isel(step=-1)
        for path in (straight, looped)
    ]
    assert float(last[0].force) == float(last[1].force)
    way = rm.load_separation(data, separation=np.linspace(4e-6, -1e-6, 400), effective_modulus=E, work=W, unload=True)
    inward, outward = way.force[:400], way.force[400:][::-1]
    assert float((inward - outward).mean()) > 0.0


def test_branches_of_a_crooked_path() -> None:
    data = ensemble([0.0], radius=1e-5)
    law = rm.load_separation(data, separation=[3.0, 2.0, 2.0, 3.0, 3.0, 1.0], effective_modulus=E)
    assert law.branch.to_numpy().tolist() == ["loading", "loading", "unloading", "unloading", "loading", "loading"]
    law = rm.load_separation(data, separation=[3.0, 2.0], effective_modulus=E, unload=True)
    assert law.branch.to_numpy().tolist() == ["loading", "loading", "unloading", "unloading"]
    assert law.separation.to_numpy().tolist() == [3.0, 2.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (ensemble([1.0], shape="blob", radius=1.0), "shape is 'blob'"),
        (ensemble([1.0]), "paraboloid: got nothing; it takes radius"),
        (ensemble([np.nan], radius=1.0), "height is nan at asperity 0"),
        (ensemble([1.0, 2.0], radius=[1.0, -1.0]), "radius is -1 at asperity 1"),
        (ensemble([1.0], radius=1.0).drop_vars("height"), "'height' is missing"),
        (ensemble([1.0], radius=1.0).isel(asperity=slice(0, 0)), "no asperity"),
        (ensemble([1.0], radius=1.0, area=-1.0), "nominal_area is -1"),
        (ensemble([1.0], radius=1.0, area=None), "nominal_area is missing"),
        (ensemble([1.0], radius=1.0).assign(height=("asperity", [1.0], {"units": "kg"})), "unknown unit 'kg'"),
    ],
)
def test_a_wrong_ensemble_is_refused(data: xr.Dataset, says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        rm.load_separation(data, separation=[0.0], effective_modulus=E, variables=["pressure"])


def test_an_ensemble_may_come_in_other_units() -> None:
    plain = ensemble([1e-6, 2e-6], radius=[3e-5, 4e-5])
    other = ensemble([1.0, 2.0], radius=[30.0, 40.0])
    for name in ("height", "radius"):
        other[name].attrs["units"] = "um"
    laws = [rm.load_separation(data, separation=[0.0], effective_modulus=E, work=W) for data in (plain, other)]
    assert float(laws[0].force[0]) == pytest.approx(float(laws[1].force[0]), rel=1e-14)


@large_where_compiled
def test_an_attraction_that_reaches_around_a_sphere_is_refused() -> None:
    """No contact of it has a natural depth, compiled or not."""
    sphere = ensemble([1e-6], shape="sphere", radius=2e-5)
    with pytest.raises(rm.OutOfRange, match="not representable: dugdale_sphere"):
        rm.load_separation(
            sphere, separation=[0.0], effective_modulus=4e6, work=0.05, adhesion="dugdale", strength=0.05 / 2.4e-5
        )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"separation": [np.nan]}, "separation"),
        ({"separation": []}, "separation"),
        ({"effective_modulus": -1.0}, "modulus is -1"),
        ({"work": -1.0}, "work is -1"),
        ({"variables": ["forc"]}, "'forc' is not available"),
        ({"adhesion": "dmt"}, "adhesion is 'dmt'"),
        ({"effective_modulus": 1e-300, "work": 1e300}, "not representable"),
    ],
)
def test_a_wrong_argument_is_refused(arguments: dict[str, object], says: str) -> None:
    asked = {"separation": [0.0], "effective_modulus": E, **arguments}
    with pytest.raises(rm.RoughmdrError, match=says):
        rm.load_separation(ensemble([1e-6], radius=1e-5), **asked)  # type: ignore[arg-type]
