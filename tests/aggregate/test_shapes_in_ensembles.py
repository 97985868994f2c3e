"""Ensembles of every shape: against one asperity after the other with a memory of its own, and the balance of energy.

The memory here is the slow and plain one: the contact radius of each asperity moves, from step to step, up while the
indentation of its equilibria lies below that of the flat, and down while it lies above.
"""

import math
from typing import Any

import numba
import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from scenes import SCENE, WIDER_SHAPES, ensemble, scene, shapes_of

import roughmdr as rm

E = 4e6
b, S, R = 2e-6, 0.2, 1e-5
VARIABLES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]


def tension(shape: Any, omega: float) -> float:
    """The work of adhesion with dl(width)/rise = omega."""
    width, rise, _ = shape.nondimensional()
    return (omega * rise) ** 2 * E / (2.0 * math.pi * width)


def rough(kind: str, count: int) -> xr.Dataset:
    rng = np.random.default_rng(43)
    columns = {name: rng.uniform(*ends, count) for name, ends in WIDER_SHAPES[kind].items()}
    return ensemble(rng.normal(0.0, 1e-7, count), shape=kind, **columns)


def walk(shape: Any, work: float, deltas: np.ndarray, finest: float) -> np.ndarray:
    """The contact radius at each step, 0 out of contact, by moving along a fine grid of radii."""
    begin = shape.nondimensional()[0] if shape.profile.flat else 0.0
    a = begin + np.concatenate([[0.0], np.geomspace(1e-7, 30.0, 20001)]) * finest
    with np.errstate(invalid="ignore"):
        delta = np.array(shape.g(a)) - np.sqrt(2.0 * math.pi * a * work / E)
    if begin == 0.0:
        delta[0] = 0.0
    at, radii = -1, []
    for target in deltas:
        if at < 0 and target >= 0.0:
            at = 0
        if at >= 0:
            while at + 1 < a.size and delta[at + 1] <= target:
                at += 1
            while at >= 0 and delta[at] > target:
                at -= 1
        if at == 0 and begin == 0.0 and target < 0.0:
            at = -1
        radii.append(a[at] if at >= 0 else 0.0)
    return np.array(radii)


def alone(shape: Any) -> xr.Dataset:
    """One asperity at height 0, of a shape with or without a profile in common."""
    data = xr.Dataset({"height": ("asperity", [0.0])}, attrs={"shape": shape.name})
    columns = getattr(shape, "columns", None)
    for name, value in (columns or shape.parameters).items():
        data[name] = ((shape.dimension,), value) if columns else (("asperity",), [value])
    return data


BRANCHED = {
    "truncated_cone": (rm.TruncatedCone(S, b), (4.6, 6.0)),
    "truncated_paraboloid": (rm.TruncatedParaboloid(R, b), (6.6, 9.0)),
    "rounded_cone": (rm.RoundedCone(S, b), (3.65, 3.8)),
    "capped_paraboloid": (rm.CappedParaboloid(R, 40.0 * R, b), (7.0,)),
    "tabulated": (
        rm.Tabulated(np.array([0, 1, 2, 3, 4, 5, 6, 7, 8]) * 1e-6, np.array([0, 0, 1, 2, 3, 6, 9, 12, 15]) * 1e-7),
        (0.3, 0.6, 1.0, 2.0),
    ),
}


@pytest.mark.few(3)
@pytest.mark.parametrize("case", BRANCHED)
def test_contacts_with_several_branches_on_a_winding_path(case: str) -> None:
    shape, omegas = BRANCHED[case]
    rng = np.random.default_rng(47)
    for omega in omegas:
        work = tension(shape, omega)
        depth = -float(rm.pull_off(shape, effective_modulus=E, work=work, control="displacement").indentation)
        path = -depth * np.concatenate([[-1.5, 0.3], rng.uniform(-1.05, 0.6, 60), [-1.5]])
        data = alone(shape)
        names = [*VARIABLES, "contact_radius_sum"]
        law = rm.load_separation(data, separation=path, effective_modulus=E, work=work, variables=names)
        expected = walk(shape, work, -path, 4.0 * shape.nondimensional()[0])
        held = expected > 0.0
        near = np.abs(law.contact_radius_sum - expected) <= 2e-3 * expected + 1e-6 * shape.nondimensional()[0]
        assert (law.contact_count.to_numpy() == held).mean() > 0.96  # a step may fall between two radii of the walk
        assert near.mean() > 0.95, (omega, law.contact_radius_sum.values, expected)


@pytest.mark.few(1)
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="22 000 steps take a minute")
@pytest.mark.parametrize("case", BRANCHED)
def test_their_energy_balance_closes(case: str) -> None:
    """The work over a closed cycle, by a fine trapezoidal rule, is what the jumps dissipate."""
    shape, omegas = BRANCHED[case]
    for omega in omegas:
        work = tension(shape, omega)
        depth = -float(rm.pull_off(shape, effective_modulus=E, work=work, control="displacement").indentation)
        way = depth * np.concatenate([np.linspace(0.5, -0.5, 2001), np.linspace(-0.5, 1.1, 20_001)])
        data = alone(shape)
        way = np.concatenate([way, np.linspace(way[-1], 0.02 * depth, 9), np.linspace(0.02 * depth, way[-1], 9)])
        law = rm.load_separation(data, separation=way, effective_modulus=E, work=work, variables=VARIABLES)
        done = -float(np.trapezoid(law.force[:22_002], way[:22_002]))
        spent = float(law.dissipated_energy[22_001])
        assert float(law.contact_count[-1]) == 0.0
        assert abs(done - spent) <= 2e-3 * spent, (omega, done, spent)
        assert (np.diff(law.dissipated_energy) >= 0.0).all()


@large_where_compiled
@pytest.mark.parametrize("kind", WIDER_SHAPES)
@pytest.mark.parametrize("work", [0.0, 1e-3])
def test_the_sum_is_that_of_its_asperities(kind: str, work: float) -> None:
    data = rough(kind, 12)
    path = np.concatenate([np.linspace(3e-7, -2e-7, 9), np.linspace(-1.9e-7, 9e-7, 9)])
    law = rm.load_separation(data, separation=path, effective_modulus=E, work=work, variables=VARIABLES)
    totals = {name: np.zeros(path.size) for name in ("force", "contact_area", "stiffness")}
    for height, shape in zip(data.height.to_numpy().tolist(), shapes_of(data), strict=True):
        delta = height - path
        one = rm.indent(shape, effective_modulus=E, work=work, indentation=delta)
        touched = np.maximum.accumulate(delta >= 0.0) if work else delta > 0.0
        for name, total in totals.items():
            totals[name] = total + np.where(touched, one[name], 0.0)
    for name, total in totals.items():
        np.testing.assert_allclose(law[name], total, rtol=1e-9, atol=1e-11 * np.max(np.abs(total)), err_msg=name)
    assert float(law.numerical_error) < 1e-9


def any_shape(kind: str, rng: np.random.Generator) -> Any:
    size, slope, ratio = 10.0 ** rng.uniform((-9.0, -2.5, 0.0), (-3.0, 0.0, 2.0))
    return {
        "power_law": lambda: rm.PowerLaw(exponent=0.52 + ratio, width=size, rise=slope * size),
        "sphere": lambda: rm.Sphere(size),
        "truncated_cone": lambda: rm.TruncatedCone(slope, size),
        "truncated_paraboloid": lambda: rm.TruncatedParaboloid(size / slope, size),
        "rounded_cone": lambda: rm.RoundedCone(slope, size),
        "capped_paraboloid": lambda: rm.CappedParaboloid(size / slope, ratio * size / slope, size),
        "rounded_punch": lambda: rm.RoundedPunch(size, size / slope),
    }[kind]()


@pytest.mark.few(4)
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
@pytest.mark.parametrize("kind", ["power_law", *list(WIDER_SHAPES)[1:]])
def test_a_block_finds_what_a_contact_alone_finds(kind: str) -> None:
    """Few steps for many at once, against a search that is held: any shape, from the fold to 1e4 times its depth."""
    rng = np.random.default_rng([53, *kind.encode()])
    for _ in range(20):
        shape, effective_modulus = any_shape(kind, rng), 10.0 ** rng.uniform(5.0, 12.0)
        work = tension(shape, 10.0 ** rng.uniform(-4.0, 2.5)) * effective_modulus / E
        off = rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="displacement")
        depth, holds = (
            -float(off.indentation),
            -float(rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="force").force),
        )
        X = 10.0 ** np.sort(rng.uniform(-9.0, 4.0, 60))[::-1]
        alone = rm.indent(shape, effective_modulus=effective_modulus, work=work, indentation=depth * (X - 1.0))
        columns = {name: [value] for name, value in shape.parameters.items() if value is not None}
        law = rm.load_separation(
            ensemble([0.0], area=None, shape=kind, **columns),
            separation=depth * (1.0 - X),
            effective_modulus=effective_modulus,
            work=work,
        )
        bound = 1e-12 + 3e-15 / np.sqrt(X)
        assert (law.contact_count == 1.0).all()
        assert (np.abs(law.force.values - alone.force) <= bound * np.maximum(holds, np.abs(alone.force))).all(), shape
        assert (np.abs(np.sqrt(law.contact_area.values / alone.contact_area) - 1.0) <= bound).all(), shape


PARAMETERS: dict[str, dict[str, Any]] = {
    **{kind: {name: sum(ends) / 2.0 for name, ends in columns.items()} for kind, columns in WIDER_SHAPES.items()},
    "power_series": {"terms": {"2": 1e4, "4": 1e14}},
    "tabulated": {"r": [0.0, "2 um", "4 um", "9 um"], "f": [0.0, "0.1 um", "0.5 um", "3 um"]},
}


@pytest.mark.few(5)
@pytest.mark.parametrize("shape", PARAMETERS)
def test_a_scene_of_any_shape_is_its_ensemble_pressed(shape: str) -> None:
    kept = {name: value for name, value in SCENE["asperities"].items() if name != "radius"}
    section = {**kept, "count": 40, "shape": shape, **PARAMETERS[shape]}
    result = rm.run({**SCENE, "asperities": section, "batch": {"realizations": 2}})
    data = rm.generate(section, seed=SCENE["seed"], realization=1)
    half = result.separation.to_numpy()[:40]
    effective_modulus = rm.effective_modulus(3e6, 0.49)
    law = rm.load_separation(data, separation=half, effective_modulus=effective_modulus, work=0.05, unload=True)
    for name in law.data_vars:
        if name != "numerical_error":
            np.testing.assert_array_equal(result[name].isel(realization=1, missing_dims="ignore"), law[name])
    assert float(result.force.max()) > 0.0 > float(result.force.min())


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="Python floats raise where compiled ones are NaN")
@pytest.mark.parametrize("shape", PARAMETERS)
@pytest.mark.parametrize("work", [0.0, 0.05])
def test_realisations_without_asperities_have_no_force(shape: str, work: float) -> None:
    """A Poisson number may be 0."""
    section = {
        "source": "random",
        "shape": shape,
        "density": 1e3,
        "patch": "1 mm",
        "height": SCENE["asperities"]["height"],
    }
    adhesion = {"model": "jkr", "work": work} if work else None
    table = scene(adhesion=adhesion, asperities={**section, **PARAMETERS[shape]}, batch={"realizations": 3})
    made = rm.run(table)
    assert not made.contact_count.any()
    assert not made.force.any()
    assert not made.model_error.any()
    assert not made.pull_off_force.any()


@large_where_compiled
def test_a_common_profile_is_stored_and_read_back(tmp_path: Any) -> None:
    for shape in ("power_series", "tabulated"):
        kept = {name: value for name, value in SCENE["asperities"].items() if name != "radius"}
        data = rm.generate({**kept, "shape": shape, **PARAMETERS[shape], "count": 5}, seed=3)
        data.to_netcdf(tmp_path / f"{shape}.nc")
        with xr.open_dataset(tmp_path / f"{shape}.nc") as back:
            laws = [rm.load_separation(each, separation=[0.0, -1e-6], effective_modulus=E) for each in (data, back)]
        xr.testing.assert_identical(*laws)


@large_where_compiled
def test_what_leaves_the_theory_is_said_with_its_numbers() -> None:
    with pytest.warns(rm.LimitWarning, match=r"slopes of up to 1 at the edge"):
        rm.indent(rm.Cone(1.0), effective_modulus=1e9, indentation=1e-9)
    with pytest.warns(rm.LimitWarning, match=r"1\.41 times the radius"):
        deep = rm.indent(rm.Paraboloid(1e-6), effective_modulus=1e9, indentation=[1e-9, 2e-6])
    assert "1.41 times" in deep.attrs["warnings"]
    assert "slopes of up to 1.41" in deep.attrs["warnings"]
    with pytest.warns(rm.LimitWarning, match=r"slopes of up to 1\.8e\+308"):  # a is R to the last digit
        rm.indent(rm.Sphere(1e-5), effective_modulus=1e6, work=0.01, indentation=0.3)
    table = rm.Tabulated([0.0, 1e-6, 2e-6], [0.0, 1e-8, 4e-8])
    with pytest.warns(rm.LimitWarning, match=r"times the radius where the profile"):
        rm.indent(table, effective_modulus=1e9, indentation=1e-6)
    data = ensemble([0.0, -1e-6], radius=1e-6)
    with pytest.warns(rm.LimitWarning, match="slopes"):
        law = rm.load_separation(data, separation=[1e-6, -1e-6, 1e-6], effective_modulus=1e9)
    assert "warnings" in law.attrs
    assert "warnings" not in rm.indent(rm.Paraboloid(1e-6), effective_modulus=1e9, indentation=1e-9).attrs


@large_where_compiled
def test_what_a_shape_cannot_do_is_refused() -> None:
    with pytest.raises(rm.ShapeError, match="flat punch"):
        rm.indent(rm.FlatPunch(1e-6), effective_modulus=1e9, contact_radius=1e-6)
    with pytest.raises(rm.ShapeError, match="on the flat"):
        rm.indent(rm.TruncatedCone(0.1, 1e-6), effective_modulus=1e9, contact_radius=0.5e-6)
    with pytest.raises(rm.OutOfRange, match=r"exponent is 0\.4"):
        rm.indent(rm.PowerSeries({0.4: 1e-3, 2.0: 1.0}), effective_modulus=1e9, work=0.1, indentation=0.0)
    with pytest.raises(rm.OutOfRange, match="representable"):
        rm.indent(rm.Sphere(1e-6), effective_modulus=1e9, contact_radius=1e-6)


@large_where_compiled
def test_a_tip_without_a_slope_out_of_contact() -> None:
    """r^0.7 is upright at its tip, where the summits are that the flat does not reach."""
    data = ensemble([1e-6, -1e-3], shape="power_series").assign(
        exponent=("term", [0.7, 2.0]), terms=("term", [1e-3, 10.0])
    )
    law = rm.load_separation(data, separation=[1e-5, 0.0], effective_modulus=1e9, work=1e-9)
    np.testing.assert_array_equal(law.contact_count, [0.0, 1.0])
    assert np.isinf(rm.PowerSeries({0.7: 1e-3}).df([0.0]))


def test_a_contact_that_reaches_the_equator_has_a_slope_that_a_float_holds() -> None:
    asperities = {"source": "random", "shape": "sphere", "count": 1, "patch": 1.0, "radius": 1e-60, "height": 0.0}
    scene = {**SCENE, "asperities": asperities, "path": {"separation": [0.0]}, "batch": {"realizations": 1}}
    with pytest.warns(rm.LimitWarning, match="slopes of up to"):
        result = rm.run({**scene, "material": {"effective_modulus": 1e3}, "adhesion": {"model": "jkr", "work": 1e3}})
    assert np.isfinite(result.edge_slope).all()
    assert result.edge_slope.item() > 1e300


@large_where_compiled
def test_a_form_that_no_float_holds_is_refused_and_nothing_else() -> None:
    """b^2 over the radius of the edge, which numpy would warn of."""
    parameters = {"flat_radius": 1.0, "edge_radius": 5e-324}
    with pytest.raises(rm.OutOfRange):
        rm.indent(rm.RoundedPunch(**parameters), effective_modulus=1e3, work=1.0, indentation=0.1)
    with pytest.raises(rm.OutOfRange):
        rm.load_separation(
            ensemble([0.0], shape="rounded_punch", **parameters), separation=[-0.1], effective_modulus=1e3, work=1.0
        )
