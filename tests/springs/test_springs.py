"""The row of springs: its order against the closed forms, its memory, profiles given as functions, and refusals."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from figures import springs as study
from scipy.special import gamma

import roughmdr as rm
from roughmdr.springs import Springs
from roughmdr.springs.profile import FunctionProfile, mdr_transform
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf

_TABLE = np.linspace(0.0, 3.1e-4, 12)
# Shape, E* [Pa], w [J/m^2], from nanometres to metres; the order of the force without adhesion.
CASES = [
    (rm.FlatPunch(radius=2.3e-9), 4.1e9, 0.07, math.inf),
    (rm.Cone(slope=0.27), 3.3e6, 0.05, 2.0),
    (rm.Paraboloid(radius=3.7e-8), 6.1e10, 0.8, 2.0),
    (rm.Sphere(radius=1.3), 2.9e4, 0.9, 2.0),
    (rm.PowerLaw(exponent=0.7, width=2.7e-6, rise=1.9e-6), 3.3e6, 0.05, 1.7),  # g' of the tip is infinite
    (rm.PowerSeries({1.2: 0.5, 2.0: 3e4, 6.0: 1e24}), 3.3e6, 0.05, 2.0),
    (rm.TruncatedCone(slope=0.31, flat_radius=2.1e-6), 3.3e6, 0.05, 1.5),  # as that of the flank
    (rm.TruncatedParaboloid(radius=0.6, flat_radius=0.013), 7.3e3, 4.0, 1.5),
    (rm.RoundedCone(slope=0.31, blend_radius=4.3e-6), 3.3e6, 0.05, 2.0),
    (rm.CappedParaboloid(radius=1.1e-7, cap_radius=2.7e-7, blend_radius=1.9e-8), 1.7e9, 0.09, 1.5),
    (rm.RoundedPunch(flat_radius=2.1e-5, edge_radius=1.1e-4), 8.7e5, 0.05, 2.0),
    (rm.Tabulated(_TABLE, 0.03 * _TABLE + _TABLE**2 / 2.2e-3), 8.7e5, 0.05, 2.0),
]
NAMES = [shape.name for shape, *_ in CASES]
COUNTS = 100 * 2 ** np.arange(6)
DISTANCES = np.geomspace(0.37, 17.0, 16)  # above the fold, over its depth
METHOD = "springs"


def onset(shape: rm.Paraboloid, effective_modulus: float, work: float, control: str) -> float:
    """Minus the control's value at pull-off."""
    kind = "force" if control == "force" else "displacement"
    return -float(rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control=kind)[control])


def slope(errors: list[float]) -> float:
    return -float(np.polyfit(np.log(COUNTS), np.log(errors), 1)[0])


@pytest.mark.few(6)
@pytest.mark.parametrize("control", ["indentation", "force"])
@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize(("shape", "effective_modulus", "work", "order"), CASES, ids=NAMES)
def test_the_order_of_convergence(
    shape: rm.Paraboloid, effective_modulus: float, work: float, order: float, adhesive: bool, control: str
) -> None:
    other = "force" if control == "indentation" else "indentation"
    values = onset(shape, effective_modulus, work, control) * (DISTANCES - (1.0 if adhesive else 0.0))
    scale = onset(shape, effective_modulus, work, other)
    law = {"effective_modulus": effective_modulus, "work": work if adhesive else 0.0, control: values}
    exact = rm.indent(shape, **law)
    sizes = {
        other: np.abs(exact[other]) + scale,
        "contact_radius": exact.contact_radius,
        "stiffness": np.abs(exact.stiffness) + 2.0 * effective_modulus * exact.contact_radius,  # it passes through 0
    }
    errors: dict[str, list[float]] = {name: [] for name in sizes}
    for count in COUNTS:
        coarse = rm.indent(shape, **law, method=METHOD, springs=int(count))
        assert tuple(coarse.variables) == tuple(exact.variables)
        for name, found in errors.items():
            found.append(float(np.sqrt((((coarse[name] - exact[name]) / sizes[name]) ** 2).mean())))
    if isinstance(shape, rm.FlatPunch):
        assert max(map(max, errors.values())) < 1e-14
        return
    expected = {other: 1.0 if adhesive else order, "contact_radius": 1.0, "stiffness": 1.0}
    for name, found in errors.items():
        below = 0.4 if name == "stiffness" else 0.25
        assert expected[name] - below < slope(found) < expected[name] + 0.35, name
    assert errors["contact_radius"][-1] < 2e-3
    assert errors[other][-1] < (2e-3 if adhesive else 2e-6)


@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize(("shape", "effective_modulus", "work", "order"), CASES[1:], ids=NAMES[1:])
def test_a_given_radius_is_the_length_of_the_row(
    shape: rm.Paraboloid, effective_modulus: float, work: float, order: float, adhesive: bool
) -> None:
    fold = float(
        rm.pull_off(shape, effective_modulus=effective_modulus, work=work, control="displacement").contact_radius
    )
    radii = fold * np.array([1.07, 1.9, 0.0, 1.3])
    law = {"effective_modulus": effective_modulus, "work": work if adhesive else 0.0, "contact_radius": radii}
    exact, coarse = rm.indent(shape, **law), rm.indent(shape, **law, method=METHOD, springs=3000)
    np.testing.assert_array_equal(coarse.contact_radius, radii)
    np.testing.assert_allclose(coarse.indentation, exact.indentation, rtol=1e-12)
    np.testing.assert_allclose(coarse.force, exact.force, rtol=1e-4, atol=1e-6 * float(abs(exact.force).max()))
    np.testing.assert_allclose(coarse.stiffness, exact.stiffness, rtol=1e-2)


@pytest.mark.few(10)
@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize(("shape", "effective_modulus", "work", "order"), CASES, ids=NAMES)
def test_loading_and_unloading(
    shape: rm.Paraboloid, effective_modulus: float, work: float, order: float, adhesive: bool
) -> None:
    """On at first touch, off at the fold, and the exact law between; again after it let go."""
    count = 4000
    fold, scale = onset(shape, effective_modulus, work, "indentation"), onset(shape, effective_modulus, work, "force")
    path = fold * np.array([-2.0, -0.5, -1e-6, 0.0, 0.3, 2.1, 1.3, 0.1, -0.4, -0.99, -1.01, -0.5, 0.2, -0.7])
    out = [0, 1, 2, 10, 11] if adhesive else np.flatnonzero(path <= 0.0)
    law = {"effective_modulus": effective_modulus, "work": work if adhesive else 0.0}
    coarse = Springs.of(shape, *law.values(), count).follow(path)
    exact = rm.indent(shape, **law, indentation=path)
    for name, size in (("contact_radius", 0.0), ("force", scale)):
        expected = exact[name].to_numpy().copy()
        expected[out] = 0.0
        np.testing.assert_allclose(coarse[name], expected, rtol=0.01, atol=0.01 * size, err_msg=name)
        np.testing.assert_array_equal(coarse[name][out], 0.0)
    np.testing.assert_allclose(coarse["force"][5], exact.force[5], rtol=2e-3)


def test_the_springs_let_go_where_the_fold_is() -> None:
    """Pull-off converges: in depth to second order (a minimum), to first where it is pinned to an edge."""
    counts = np.array([50, 100, 200, 400, 800])
    for shape, length, expected in (
        (rm.Paraboloid(radius=3.7e-8), 1.9, 2.0),
        (rm.FlatPunch(radius=2.3e-9), 1.0, 1.0),
    ):
        off = rm.pull_off(shape, effective_modulus=6.1e10, work=0.8, control="displacement")
        errors = []
        for count in counts:
            coarse = Springs.of(shape, 6.1e10, 0.8, int(count)).row(length * float(off.contact_radius))
            errors.append(abs(float(coarse.release_indentation[:-1].min() / off.indentation) - 1.0))
        assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(expected, abs=0.5)


def test_every_contact_has_springs_enough_however_small() -> None:
    tip = rm.Paraboloid(radius=1e-5)
    depth = np.geomspace(1e-15, 1e-6, 10)
    coarse = rm.indent(tip, effective_modulus=1e9, indentation=depth, method=METHOD, springs=500)
    exact = rm.indent(tip, effective_modulus=1e9, indentation=depth)
    np.testing.assert_allclose(coarse.contact_radius, exact.contact_radius, rtol=1.2e-3)
    np.testing.assert_allclose(coarse.force, exact.force, rtol=3e-6)
    one = rm.indent(tip, effective_modulus=1e9, indentation=float(depth[3]), method=METHOD, springs=500)
    xr.testing.assert_equal(one, coarse.isel(indentation=3))
    none = rm.indent(tip, effective_modulus=1e9, work=0.05, indentation=[-1.0, -1e-6], method=METHOD, springs=500)
    for name in ("force", "contact_radius", "contact_area", "stiffness"):
        np.testing.assert_array_equal(none[name], 0.0)


SERIES = rm.PowerSeries({1.5: 3.0, 3.0: 2e9})
FUNCTIONS: list[tuple[Callable[[np.ndarray], np.ndarray], rm.PowerSeries]] = [
    (lambda r: 3.0 * r**1.5 + 2e9 * r**3, SERIES),
    (lambda r: r * r / 2.6e-5, rm.Paraboloid(radius=1.3e-5)),
    (lambda r: 1.3e-5 - np.sqrt(1.3e-5**2 - r * r), rm.Sphere(radius=1.3e-5)),
    (lambda r: 0.3 * np.maximum(r - 2e-6, 0.0), rm.TruncatedCone(slope=0.3, flat_radius=2e-6)),
]


@pytest.mark.few(2)
@pytest.mark.parametrize("work", [0.0, 0.05], ids=["elastic", "jkr"])
@pytest.mark.parametrize(("f", "shape"), FUNCTIONS, ids=lambda value: getattr(value, "name", ""))
def test_a_function_is_as_good_as_a_shape(
    f: Callable[[np.ndarray], np.ndarray], shape: rm.PowerSeries, work: float
) -> None:
    for control in ("indentation", "contact_radius", *(("force",) if shape is SERIES else ())):
        if control == "contact_radius":
            values = float(
                rm.pull_off(shape, effective_modulus=3e6, work=0.05, control="displacement").contact_radius
            ) * np.array([1.2, 2.3])
        else:
            values = onset(shape, 3e6, 0.05, control) * np.array([0.3, 3.7])
        law = {"effective_modulus": 3e6, "work": work, control: values}
        exact, coarse = rm.indent(shape, **law), rm.indent(f, **law, method=METHOD, springs=2000)
        rough = 2e-3 if work else 1e-5
        for name in ("force", "indentation"):
            scale = onset(shape, 3e6, 0.05, name)
            np.testing.assert_allclose(coarse[name], exact[name], rtol=rough, atol=rough * scale, err_msg=name)
        np.testing.assert_allclose(coarse.contact_radius, exact.contact_radius, rtol=1e-3)
        assert "warnings" not in coarse.attrs


@pytest.mark.parametrize(("n", "expected"), [(0.7, 1.7), (1.5, 2.4), (3.3, 2.5)])
def test_the_order_of_the_profile_that_is_made_of_a_function(n: float, expected: float) -> None:
    kappa = math.sqrt(math.pi) / 2 * n * gamma(n / 2) / gamma((n + 1) / 2)
    counts = np.array([100, 400, 1600, 6400])
    errors = []
    for count in counts:
        g = mdr_transform((np.arange(count + 1) / count) ** n)
        errors.append(abs(g.mean() - np.mean(kappa * ((np.arange(count) + 0.5) / count) ** n)))
        assert (np.diff(g) > 0.0).all()
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(expected, abs=0.25)


@pytest.mark.parametrize("n", [1.0, 2.0])
@pytest.mark.parametrize("count", [10, 63, 64, 65, 191, 300, 5000])
def test_cones_and_paraboloids_are_exact_for_any_number_of_springs(n: float, count: int) -> None:
    x = np.arange(count) + 0.5
    factor = {1.0: math.pi / 2, 2.0: 2.0}[n]
    np.testing.assert_allclose(mdr_transform(np.arange(count + 1.0) ** n), factor * x**n, rtol=1e-11)


TIP = rm.Paraboloid(radius=1e-6)


@pytest.mark.parametrize(
    ("error", "text", "changed"),
    [
        (rm.RoughmdrError, "method is 'spring'", {"method": "spring"}),
        (rm.RoughmdrError, "springs is 100; it goes with method='springs' only", {"method": "exact"}),
        (rm.RoughmdrError, "springs is None; .* a whole number from 10 to 10000000", {"springs": None}),
        (rm.RoughmdrError, "springs is 9;", {"springs": 9}),
        (rm.RoughmdrError, "springs is 10000001;", {"springs": 10_000_001}),
        (rm.RoughmdrError, "springs is 100.0;", {"springs": 100.0}),
        (rm.RoughmdrError, "springs is True;", {"springs": True}),
        (rm.RoughmdrError, "adhesion is 'dugdale'", {"adhesion": "dugdale", "work": 0.05}),
        (rm.OutOfRange, "modulus is -1 Pa", {"effective_modulus": -1.0}),
        (rm.OutOfRange, "work is nan", {"work": math.nan}),
        (rm.ShapeError, "shape is 3; it must be a shape", {"shape": 3}),
        (rm.ShapeError, "a function f", {"shape": rm.Paraboloid}),
        (rm.RoughmdrError, "10 to 1000000 for a function", {"shape": lambda r: r, "springs": 1_000_001}),
        (rm.ShapeError, "function f.r. goes with", {"shape": lambda r: r, "method": "exact", "springs": None}),
        (rm.ShapeError, "is 1 m at r = 0", {"shape": lambda r: r + 1.0}),
        (rm.ShapeError, "is nan at r = .*finite", {"shape": lambda r: np.where(r < 1e-10, r, np.nan)}),
        (rm.ShapeError, "falls to .*lowest", {"shape": lambda r: -r}),
        (rm.ShapeError, "does not take an array", {"shape": lambda r: "no"}),
        (rm.ShapeError, "returns the shape", {"shape": lambda r: 0.0}),
        (rm.OutOfRange, "so concave", {"shape": lambda r: np.minimum(r, 3e-9 + 1e-3 * r), "indentation": 5e-9}),
        (rm.OutOfRange, "exponent is 0.45", {"shape": rm.PowerLaw(exponent=0.45, coefficient=1e-3), "work": 0.05}),
        (rm.OutOfRange, "force is -1.0 N; .* pull-off force, 0.0", {"indentation": None, "force": -1.0}),
        (rm.OutOfRange, "pull-off force, -2.3", {"indentation": None, "force": [0.0, -1.0], "work": 0.05}),
        (rm.OutOfRange, "contact_radius is -1 m", {"indentation": None, "contact_radius": -1.0}),
        (
            rm.ShapeError,
            "flat punch",
            {"shape": rm.FlatPunch(radius=1.0), "indentation": None, "contact_radius": 1.0},
        ),
        (
            rm.ShapeError,
            "on the flat",
            {"shape": rm.TruncatedCone(0.1, 1.0), "indentation": None, "contact_radius": 0.5},
        ),
    ],
)
def test_refusals(error: type[rm.RoughmdrError], text: str, changed: dict[str, object]) -> None:
    given = {"shape": TIP, "effective_modulus": 1e9, "indentation": 1e-9, "method": METHOD, "springs": 100, **changed}
    with pytest.raises(error, match=text):
        rm.indent(given.pop("shape"), **given)


def test_a_profile_that_does_not_rise_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roughmdr.springs._LENGTH_NUMBER_MAX", 480)  # 2^60 m are enough
    with pytest.raises(rm.OutOfRange, match="grows without end"):
        rm.indent(lambda r: np.minimum(r, 1e-10), effective_modulus=1e9, indentation=1e-9, method=METHOD, springs=20)


@pytest.mark.large
def test_the_study_and_its_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "SHAPES", {name: study.SHAPES[name] for name in ("flat punch", "paraboloid")})
    result = study.measure(quick=True)
    drawn = result.sel(stage="last contact")
    stretch = math.sqrt(2 * math.pi * study.WORK / study.MODULUS)
    held = result.spring_end.to_numpy()[result.stage.to_numpy() == "last contact"][0]
    outer = np.flatnonzero(held)[-1]
    assert held[outer] == pytest.approx(stretch * math.sqrt(float(drawn.spring_position[outer])), rel=1e-2)
    assert np.isnan(result.force_order.sel(shape="flat punch")).all()
    assert float(result.force_order.sel(shape="paraboloid", adhesion="none")) == pytest.approx(2.0, abs=0.4)
    for name, array in result.variables.items():
        assert array.attrs["long_name"], name
        assert "units" in array.attrs or array.dtype.kind == "U", name
    write_netcdf(Labelled.of(result), tmp_path / "springs.nc")
    with xr.open_dataset(tmp_path / "springs.nc") as read:
        xr.testing.assert_equal(read.load(), result)
    study.draw_row(result).savefig(tmp_path / "one.png", dpi=30)
    assert (tmp_path / "one.png").stat().st_size > 3000


@pytest.mark.parametrize("power", [1.0, 2.0, 3.5])
def test_the_profile_of_a_function_converges_in_second_order(power: float) -> None:
    """g and its integral G of f = r^n, at any radius: both ends of the row count as they should."""
    profile, x = FunctionProfile(lambda r: r**power), np.array([0.37, 2.6])
    kappa = 0.5 * math.sqrt(math.pi) * power * gamma(0.5 * power) / gamma(0.5 * (power + 1.0))
    exact = kappa * x**power, kappa * x ** (power + 1.0) / (power + 1.0)
    errors = []
    for springs in (50, 100, 200, 400):
        found = profile.at(x, springs)
        errors.append([np.abs(each / one - 1.0).max() for each, one in zip(found, exact, strict=True)])
    assert max(errors[-1]) < 1e-4
    for coarse, fine in pairwise(errors):
        assert fine[0] < 0.3 * coarse[0] + 1e-13
        assert fine[1] < 0.3 * coarse[1] + 1e-13
