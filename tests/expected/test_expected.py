"""The expected law: plain quadrature and draws as references, its error bound, memory and energy, other units."""

import math
from itertools import pairwise

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from numpy.polynomial.legendre import leggauss
from scenes import ensemble

import roughmdr as rm
from roughmdr.aggregate import LoadingPath
from roughmdr.asperity.contact import Contact
from roughmdr.expected import converge, split_rules as panels
from roughmdr.expected.intervals import contact_intervals
from roughmdr.expected.table import AdaptiveTable
from roughmdr.kernels.adhesion import Adhesion

UM = 1e-6
NORMAL = {"distribution": "normal", "std": "1 um"}
LOGNORMAL = {"distribution": "lognormal", "mean": "50 um", "std": "5 um"}
EVERY = ["force", "contact_area", "contact_count", "contact_radius_sum", "energy", "dissipated_energy"]
LOAD_AND_UNLOAD = {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 40}, "unload": True}


def scene(asperities: dict[str, object], adhesion: dict[str, object] | None, **more: object) -> dict[str, object]:
    section = {"source": "random", "count": 2000, "patch": "1 mm", "height": NORMAL, **asperities}
    return {
        "material": {"effective_modulus": 4e6},
        **({} if adhesion is None else {"adhesion": adhesion}),
        "asperities": {key: entry for key, entry in section.items() if entry is not None},
        "path": LOAD_AND_UNLOAD,
        "output": {"variables": EVERY},
        **more,
    }


def jkr_mean(
    path: np.ndarray, lowest: np.ndarray, effective_modulus: float, work: float, radii: np.ndarray
) -> np.ndarray:
    """Return the mean JKR force [radius, step] over normal heights of std 1 um from ``lowest``, over contact radius."""
    nodes, weights = leggauss(60)
    R, h = radii[:, None, None], path[None, :, None]
    fold = (math.pi * work * R * R / (8.0 * effective_modulus)) ** (1.0 / 3.0)

    def indentation(a: np.ndarray) -> np.ndarray:
        return a * a / R - np.sqrt(2.0 * math.pi * a * work / effective_modulus)

    def radius(delta: np.ndarray) -> np.ndarray:
        low, high = fold + 0.0 * delta, 5.0 * fold + np.sqrt(R * np.maximum(delta, 0.0))
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = indentation(middle) < delta
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return high

    first = lowest[..., None] - h
    ends = [radius(np.maximum(first, k * UM - h)) for k in (-6, -4, -2.5, -1.5, -0.5, 0.5, 1.5, 2.5, 4, 6, 9)]
    total = np.zeros(lowest.shape)
    for low, high in pairwise([radius(first), *ends]):
        a = low + 0.5 * (high - low) * (1.0 + nodes)
        force = 4.0 * effective_modulus * a**3 / (3.0 * R) - np.sqrt(8.0 * math.pi * effective_modulus * work * a**3)
        slope = 2.0 * a / R - 0.5 * np.sqrt(2.0 * math.pi * work / effective_modulus / a)
        density = np.exp(-0.5 * ((h + indentation(a)) / UM) ** 2) / (UM * math.sqrt(2.0 * math.pi))
        total += 0.5 * (high - low)[..., 0] * ((force * density * slope) @ weights)
    return total


@pytest.mark.large
def test_jkr_loading_and_unloading_against_plain_quadrature() -> None:
    """Also at steps at which only some asperities are still in contact with their lowest summits."""
    effective_modulus, work = 4e6, 0.05
    path = np.array([2.0, 0.5, -0.5, -0.3, -0.2, -0.09, -0.08, -0.07, -0.06, 0.5, 2.0]) * UM
    asked = scene({"shape": "paraboloid", "radius": LOGNORMAL}, {"model": "jkr", "work": work})
    got = rm.run({**asked, "path": {"separation": path}, "batch": {"estimator": "expected"}})
    variance = math.log1p(0.01)
    scores, step = np.linspace(-8.0, 8.0, 1001, retstep=True)
    shares = np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi) * step
    radii = 50.0 * UM * np.exp(math.sqrt(variance) * scores - 0.5 * variance)
    depth = 3.0 * (math.pi * work / (8.0 * effective_modulus)) ** (2.0 / 3.0) * radii ** (1.0 / 3.0)
    closest = np.minimum.accumulate(path)
    lowest = np.where(path == closest, path, np.maximum(closest, path - depth[:, None]))
    attached = (lowest == closest).mean(axis=0)
    assert ((attached > 0.0) & (attached < 1.0)).sum() >= 2  # steps at which only some are still in contact
    parts = np.array_split(np.arange(scores.size), 40)
    force = sum(shares[part] @ jkr_mean(path, lowest[part], effective_modulus, work, radii[part]) for part in parts)
    largest = float(np.abs(got.force).max())
    np.testing.assert_allclose(got.force[0], 2000 * force, rtol=0.0, atol=1e-8 * largest)
    assert float(got.numerical_error[0]) < 1e-10


def test_an_expected_law_is_no_more_right_than_the_kernels_that_it_integrates() -> None:
    """Though the integral over equal paraboloids changes by less with the number of nodes."""
    asked = scene({"shape": "paraboloid", "radius": 50.0 * UM}, None)
    law = rm.run({**asked, "path": {"separation": ["2 um", "0 um"]}, "batch": {"estimator": "expected"}})
    assert 2e-13 < float(law.numerical_error[0]) < 1e-11


LAWS = [
    ({"shape": "paraboloid", "radius": LOGNORMAL}, None),
    ({"shape": "paraboloid", "radius": LOGNORMAL, "correlation": {"radius": -0.6}}, {"model": "jkr", "work": 0.05}),
    (
        {
            "shape": "paraboloid",
            "radius": LOGNORMAL,
            "count": None,
            "density": "2000 /mm^2",
            "second": {"share": 0.3, "height": {"distribution": "weibull", "c": 2.0, "std": "1 um"}, "radius": "9 um"},
        },
        {"model": "jkr", "work": 0.05},
    ),
    (
        {
            "shape": "truncated_cone",
            "slope": 0.1,
            "patch": "0.1 m",
            "flat_radius": {"distribution": "uniform", "loc": UM, "scale": UM},
        },
        {"model": "jkr", "work": 0.05},
    ),
    ({"shape": "paraboloid", "radius": LOGNORMAL}, {"model": "dugdale", "work": 0.05, "strength": 3e5}),
    (
        {"source": "nayak", "count": None, "height": None, "m0": "1 um^2", "m2": 0.02, "m4": "5e9 /m^2"},
        {"model": "jkr", "work": 0.05},
    ),
]


@pytest.mark.few(1)
@pytest.mark.parametrize(("asperities", "adhesion"), [*LAWS[:3], *(large(*law) for law in LAWS[3:])])
def test_the_mean_of_draws_is_the_expected_law(
    asperities: dict[str, object], adhesion: dict[str, object] | None
) -> None:
    """Every variable in loading and unloading, within the scatter of the draws; stratified draws are nearer."""
    asked = scene(asperities, adhesion)
    expected = rm.run({**asked, "batch": {"estimator": "expected"}}).isel(realization=0)
    draws = rm.run({**asked, "batch": {"realizations": 48}})
    even = rm.run({**asked, "batch": {"realizations": 4, "estimator": "stratified"}})
    for name in EVERY:
        law, scale = expected[name], float(np.abs(expected[name]).max())
        mean, spread = draws[name].mean("realization"), draws[name].std("realization", ddof=1) / np.sqrt(48)
        off = np.abs(mean - law) / (spread + max(1e-4 * scale, 1e-300))
        assert float(off.max()) < 5.0, name
        if scale > 0.0:
            assert float(np.abs(even[name].mean("realization") - law).max()) < 0.03 * scale, name
    assert float(expected.numerical_error) < 1e-3


KINKED: list[dict[str, object]] = [
    {"distribution": "gamma", "a": 2.0, "loc": 0.0, "scale": "30 um"},
    {"distribution": "invgamma", "a": 4.0, "loc": 0.0, "scale": "100 um"},
]


@pytest.mark.large
@pytest.mark.parametrize("radius", KINKED)
def test_the_error_bound_holds_where_contacts_detach(
    radius: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each step makes a kink over the radius, under heights with an end; the reference has many more nodes, at other
    radii.
    """
    heights = {"distribution": "exponential", "scale": "1 um"}
    asked = scene({"radius": radius, "shape": "paraboloid", "height": heights}, {"model": "jkr", "work": 3e-3})
    asked["path"] = {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 60}, "unload": True}
    asked["batch"] = {"estimator": "expected"}
    law = rm.run(asked)
    monkeypatch.setattr(converge, "WARNED_ERROR", 0.0)
    monkeypatch.setattr(converge, "_RTOL_KINKED", 1e-9)
    monkeypatch.setattr(panels, "_ORDER", 14)
    fine = rm.run(asked)
    largest = float(np.abs(fine.force).max())
    stated, left = float(law.numerical_error[0]), float(fine.numerical_error[0])
    assert left < 0.01 * stated < 1e-5
    assert float(np.abs(law.force - fine.force).max()) <= (stated + left) * largest


@pytest.mark.large
@pytest.mark.parametrize("m4", [7.5e8, 1e9, 5e9, 4e12])
def test_summits_of_a_gaussian_surface_are_greenwoods(m4: float) -> None:
    """Two independent computations of one integral, alpha from 1.9 to 10 000."""
    moments = {"m0": 1e-12, "m2": 0.02, "m4": m4}
    asked = scene({"source": "nayak", "count": None, "height": None, **moments}, None)
    path = {"separation": {"start": "4 um", "stop": "2 um", "steps": 9}}
    output = {"variables": ["pressure", "contact_fraction"]}
    got = rm.run({**asked, "path": path, "output": output, "batch": {"estimator": "expected"}}).isel(realization=0)
    density = m4 / 0.02 / (6.0 * math.pi * math.sqrt(3.0))
    for name in output["variables"]:
        law = rm.theory.greenwood_elliptic(separation=got.separation, effective_modulus=4e6, variable=name, **moments)
        law *= round(density * 1e-6) / (density * 1e-6)  # the patch holds a whole number
        assert float(np.abs(got[name] - law).max()) <= 2.0 * float(got.numerical_error) * law.max()
    assert float(got.numerical_error) < (1e-9 if m4 >= 1e9 else 1e-2)


@pytest.mark.parametrize("adhesion", [None, {"model": "jkr", "work": "50 mJ/m^2"}])
def test_the_same_physics_in_other_units(adhesion: dict[str, object] | None) -> None:
    """Lengths and modulus a million times as large and the work in proportion: forces scale by 1e18."""
    small = scene({"shape": "paraboloid", "radius": LOGNORMAL}, adhesion, batch={"estimator": "expected"})
    large = scene(
        {
            "shape": "paraboloid",
            "patch": "1000 m",
            "height": {"distribution": "normal", "std": 1.0},
            "radius": {"distribution": "lognormal", "mean": 50.0, "std": 5.0},
        },
        None if adhesion is None else {"model": "jkr", "work": 0.05 * 1e12},
        batch={"estimator": "expected"},
        material={"effective_modulus": 4e12},
    )
    one, other = rm.run(small), rm.run(large)
    for name, factor in (("force", 1e18), ("contact_area", 1e12), ("contact_count", 1.0), ("energy", 1e24)):
        scale = float(np.abs(one[name]).max())
        np.testing.assert_allclose(other[name] / factor, one[name], rtol=0.0, atol=1e-11 * scale)


def test_energy_is_conserved_on_average() -> None:
    """Over a closed cycle the work of the expected force is the energy lost in jumps; to the order of its steps."""
    asked = scene({"shape": "paraboloid", "radius": "50 um"}, {"model": "jkr", "work": 0.05})
    off = []
    for steps in (200, 400):
        path = {"separation": {"start": "8 sigma", "stop": "0 sigma", "steps": steps}, "unload": True}
        law = rm.run({**asked, "path": path, "batch": {"estimator": "expected"}}).isel(realization=0)
        work = -np.trapezoid(law.force, law.separation)
        off.append(abs(work / float(law.dissipated_energy[-1]) - 1.0))
    assert off[1] < 2e-3
    assert off[0] / off[1] > 2.5  # second order where the force is smooth, a little less at kinks


@pytest.mark.large
@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-1.0, 2.0), min_size=1, max_size=6), st.booleans())
def test_intervals_remember_what_asperities_do(turns: list[float], corners: bool) -> None:
    """At each step of any path the intervals hold as many heights as the sum over the asperities counts."""
    shape, work, heights = rm.Paraboloid(radius=50 * UM), 0.05, np.linspace(-2.0, 2.0, 101) * UM
    if corners:
        shape, work = rm.TruncatedCone(slope=0.1, flat_radius=0.25 * UM), 0.02  # two branches
    path = np.array(turns) * UM
    in_contact, _ = contact_intervals(
        Contact.of(shape, 4e6, Adhesion(work)), LoadingPath.along(path, unload=False, adhesive=True)
    )
    inside = (heights > in_contact.begin[:, None]) & (heights < in_contact.end[:, None])
    counted = np.zeros(path.size)
    np.add.at(counted, in_contact.step, inside.sum(axis=1))
    data = ensemble(heights, shape=shape.name, **shape.parameters)
    law = rm.load_separation(data, separation=path, effective_modulus=4e6, work=work, variables="contact_count")
    edge = np.isin(np.round(heights / UM, 12), np.round(path / UM, 12)).any()
    np.testing.assert_allclose(counted, law.contact_count, atol=2.0 if edge else 0.0)


@pytest.mark.parametrize(
    ("function", "worst"),
    [(np.sqrt, 1e-7), (np.cos, 1e-14), (lambda x: np.where(x < 0.3, 1.0, 2.0), 1e-14), (lambda x: x**3.3, 1e-13)],
)
def test_a_table_is_as_right_as_its_error_bound(function: object, worst: float) -> None:
    table = AdaptiveTable.of(
        lambda x: function(x)[None],
        np.array([0.0, 4.0]),
        np.array([1e-13]),
        lambda low, high: np.full_like(low, 2.0**-40),
        lambda low, high, _: (high - low) / high,
    )
    np.testing.assert_array_equal(table.low[1:], table.high[:-1])
    points = np.random.default_rng(1).uniform(0.0, 4.0, 2000)
    piece = np.searchsorted(table.high, points)
    u = (2.0 * points - table.low[piece] - table.high[piece]) / (table.high[piece] - table.low[piece])
    values = [np.polynomial.chebyshev.chebval(at, table.coefficients[i, 0]) for at, i in zip(u, piece, strict=True)]
    off = np.abs(np.array(values) - function(points))
    assert (off <= 20.0 * table.error_bound[piece, 0] + 4e-15 * np.abs(function(points))).all()
    assert off.max() <= worst * np.abs(function(points)).max()
    assert table.low.size < 200


def test_a_kink_at_the_end_of_a_piece_is_seen() -> None:
    """A kink between the last node of a piece and its end is seen by no node."""
    for kink in (0.999, 0.9999):
        table = AdaptiveTable.of(
            lambda x, kink=kink: (x**3 + np.maximum(x - kink, 0.0))[None],
            np.array([0.0, 1.0]),
            np.array([1e-13]),
            lambda low, high: np.full_like(low, 2.0**-40),
            lambda low, high, _: (high - low) / high,
        )
        u = 2.0 * (1.0 - table.low[-1]) / (table.high[-1] - table.low[-1]) - 1.0
        at_end = np.polynomial.chebyshev.chebval(u, table.coefficients[-1, 0])
        assert abs(at_end - (2.0 - kink)) <= table.error_bound[-1, 0] + 1e-15


@pytest.mark.large
def test_cohesive_contacts_that_begin_to_touch_in_loading() -> None:
    """Where they do, the force has a kink."""
    stiff = {"shape": "paraboloid", "radius": 2e-5, "height": {"distribution": "expon", "std": "1.4 nm"}}
    asked = scene(stiff, {"model": "dugdale", "work": 10.0, "strength": 6.7e6}, material={"effective_modulus": 8e10})
    asked |= {"path": {"separation": [2.7e-9, 2.6e-10]}, "output": {"variables": ["force"]}}
    law = rm.run({**asked, "batch": {"estimator": "expected"}}).isel(realization=0)
    mean, error = stratified_draws(asked)
    assert (np.abs(mean - law.force) <= 5.0 * error + 1e-6 * float(np.abs(law.force).max())).all()


def stratified_draws(asked: dict[str, object]) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean force of stratified draws, and its standard error."""
    force = rm.run({**asked, "batch": {"estimator": "stratified", "realizations": 64}}).force
    return force.mean("realization").to_numpy(), force.std("realization", ddof=1).to_numpy() / 8.0


@pytest.mark.large
@pytest.mark.parametrize("height", [0, {"distribution": "normal", "std": "3 nm"}])
def test_heights_narrow_beside_the_depths_of_the_folds(height: object) -> None:
    """Which contacts detach depends on their radii, not on their heights: the rule over the radii is split there."""
    narrow = {"shape": "paraboloid", "radius": LOGNORMAL, "height": height}
    path = {"separation": ["1 um", "-1 um", "315 nm", "317 nm", "319 nm", "321 nm", "323 nm", "400 nm"]}
    asked = {**scene(narrow, {"model": "jkr", "work": 0.05}), "path": path, "output": {"variables": ["force"]}}
    law = rm.run({**asked, "batch": {"estimator": "expected"}}).isel(realization=0)
    mean, error = stratified_draws(asked)
    force = law.force.to_numpy()
    assert (np.abs(mean - force) <= 5.0 * error + 1e-6 * np.abs(force).max()).all()
    assert float(law.numerical_error) < 1e-6
    assert abs(force[-1]) < 1e-9 * np.abs(force).max()


@pytest.mark.large
def test_a_large_error_is_stated_and_warned_of() -> None:
    """Poles in two shape parameters at once: no rule over both is right to 1e-3."""
    poles = {
        "shape": "truncated_paraboloid",
        "radius": {"distribution": "beta", "a": 0.05, "b": 0.05, "loc": "20 um", "scale": "80 um"},
        "flat_radius": {"distribution": "beta", "a": 0.05, "b": 0.05, "loc": "0.1 um", "scale": "3 um"},
    }
    path = {"separation": ["1 um", "0 um", "-1 um"], "unload": True}
    asked = scene(poles, {"model": "jkr", "work": 0.05}, output={"variables": ["force"]})
    asked["path"] = path
    law = rm.run({**asked, "batch": {"estimator": "expected"}}).isel(realization=0)
    mean, error = stratified_draws(asked)
    stated = float(law.numerical_error)
    assert (np.abs(mean - law.force) - 4.0 * error).max() <= stated * float(np.abs(law.force).max())
    assert stated > 1e-3
    assert "an expected law that is right only to" in law.attrs["warnings"]


def test_areas_converge_too_where_the_force_did_immediately() -> None:
    """The force of flat punches is linear in b, which every rule integrates exactly; their area is quadratic."""
    low, high = 1e-6, 3e-6
    asperities = {
        "source": "random",
        "shape": "flat_punch",
        "count": 10,
        "patch": "1 mm",
        "height": {"distribution": "uniform", "loc": "1 um", "scale": "1 um"},
        "radius": {"distribution": "uniform", "loc": low, "scale": high - low},
    }
    asked = {**scene(asperities, None), "path": {"separation": [0.0]}, "output": {"variables": ["contact_area"]}}
    area = float(rm.run({**asked, "batch": {"estimator": "expected"}}).contact_area.item())
    assert area == pytest.approx(10 * math.pi * (high**3 - low**3) / (3.0 * (high - low)), rel=1e-9, abs=0.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("coefficient", [1e-300, 1e300])
def test_contacts_that_overflow_or_underflow_are_refused(coefficient: float) -> None:
    """Areas of blunt cones overflow, those of sharp cones underflow; numpy does not warn."""
    cones = {"shape": "power_law", "exponent": 1.0, "coefficient": coefficient}
    asked = {**scene(cones, None), "path": {"separation": [0.0]}, "batch": {"estimator": "expected"}}
    with pytest.raises(rm.OutOfRange, match="is not representable"):
        rm.run(asked)


@pytest.mark.parametrize(
    "adhesion", [{"model": "jkr", "work": 0.05}, {"model": "dugdale", "work": 1.0, "strength": 1e8}]
)
def test_heights_beyond_all_tables_are_refused_immediately(adhesion: dict[str, object]) -> None:
    """To tabulate that far would take minutes."""
    heights = {"distribution": "lognorm", "s": 60.0, "scale": 1.0}
    asked = scene({"shape": "paraboloid", "radius": 1.0, "height": heights}, adhesion, batch={"estimator": "expected"})
    with pytest.raises(
        rm.OutOfRange, match=r"the heights reach .* times the natural depth of Paraboloid\(radius=1\.0\)"
    ):
        rm.run({**asked, "path": {"separation": [1.0]}})


@pytest.mark.parametrize(
    ("family", "a", "b"),
    [
        ({"distribution": "arcsine"}, 0.5, 0.5),
        ({"distribution": "beta", "a": 2.0, "b": 0.7}, 2.0, 0.7),
        ({"distribution": "gamma", "a": 0.5}, 0.5, math.inf),
    ],
)
@pytest.mark.parametrize("datum", [0.0, 1e-2])
def test_heights_whose_density_has_a_pole_at_an_end(
    family: dict[str, object], a: float, b: float, datum: float
) -> None:
    """The force of Hertzian contacts is known from moments; the pole lies where contacts begin, or end."""
    height = {**family, "loc": datum, "scale": 2e-6}
    asked = scene({"shape": "paraboloid", "radius": 1e-4, "height": height}, None, batch={"estimator": "expected"})
    law = rm.run({**asked, "path": {"separation": [datum + 2e-6, datum]}, "output": {"variables": ["force"]}})
    moment = math.gamma(a + 1.5) / math.gamma(a)
    if b < math.inf:
        moment *= math.gamma(a + b) / math.gamma(a + b + 1.5)
    exact = 2000 * 4.0 / 3.0 * 4e6 * math.sqrt(1e-4) * 2e-6**1.5 * moment
    assert abs(float(law.force[0, -1]) - exact) <= float(law.numerical_error[0]) * exact
    assert float(law.numerical_error[0]) < 1e-4
