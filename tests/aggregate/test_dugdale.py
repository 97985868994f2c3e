"""Ensembles under adhesion of finite range, against a slow and plain walk along Maugis's equations."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from figures import adhesion_range as study
from forms import large
from hypothesis import given, settings, strategies as st
from mpmath import mp
from scenes import ensemble, scene

import roughmdr as rm
from roughmdr.aggregate.tabor import SHIFT
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read

DATA = Path(__file__).parent.parent / "data"
E, W = 4e6, 0.05
VARIABLES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]


def strength_of(tabor: float, radius: float = 5e-5, effective_modulus: float = E, work: float = W) -> float:
    return float(tabor * work / (radius * work**2 / effective_modulus**2) ** (1.0 / 3.0))


class Walk:
    """One paraboloid, its equilibria as a long list: the cohesive radius c rises along it (Maugis 1992)."""

    def __init__(self, radius: float, strength: float) -> None:
        angle = np.concatenate([np.full(30_000, 0.5 * np.pi), np.geomspace(0.5 * np.pi, 3e-3, 170_000)])
        theta, beta, gap = angle, 2.0 * strength / E, W / strength
        sine, cosine = np.sin(theta), np.cos(theta)
        spread = (theta * (sine**2 - cosine**2) + sine * cosine) / radius
        pull = 2.0 * beta * (theta * sine - 1.0 + cosine)
        c = (-pull + np.sqrt(pull**2 + 4.0 * spread * np.pi * gap)) / (2.0 * spread)
        c[:30_000] = np.linspace(0.0, c[30_000], 30_000)
        self.a, m = c * cosine, c * sine
        self.a[:30_000] = 0.0
        self.delta = self.a**2 / radius - beta * m
        self.delta[:30_000] = c[:30_000] ** 2 / (2.0 * radius) - 2.0 / np.pi * beta * c[:30_000] - gap
        self.force = 4.0 / 3.0 * E * self.a**3 / radius - 2.0 * strength * (self.a * m + c**2 * theta)
        self.first, self.at = -gap, -1

    def move(self, delta: float) -> float:
        """The force after the indentation has moved to ``delta``, by way of every place in between."""
        if self.at < 0:
            if delta < self.first:
                return 0.0
            self.at = 0
        while self.at < self.delta.size - 1 and self.delta[self.at] < delta:
            self.at += 1
        while self.at >= 0 and self.delta[self.at] > delta:
            self.at -= 1
        return float(self.force[self.at]) if self.at >= 0 else 0.0


@pytest.mark.large
@pytest.mark.parametrize("tabor", [0.1, 0.6, 1.5, 20.0])
def test_a_winding_path_is_that_of_the_plain_walk(tabor: float) -> None:
    rng = np.random.default_rng(5)
    strength, z, radius = strength_of(tabor), rng.normal(0.0, 3e-8, 12), rng.uniform(3e-5, 8e-5, 12)
    reach = W / strength
    path = np.concatenate([[z.max() + 2.0 * reach + 1e-7], rng.uniform(-5e-8, 8e-8 + reach, 25), [-4e-8, 1e-6 + reach]])
    law = rm.load_separation(
        ensemble(z, radius=radius), separation=path, effective_modulus=E, work=W, adhesion="dugdale", strength=strength
    )
    expected = np.zeros(path.size)
    for height, own in zip(z, radius, strict=True):
        walk = Walk(own, strength)
        expected += [walk.move(height - h) for h in path]
    largest = np.abs(expected).max()
    assert np.mean(np.abs(law.force - expected) < 3e-3 * largest) > 0.9  # the walk's places are no finer
    assert float(law.force[0]) == float(law.force[-1]) == 0.0


def test_attraction_begins_before_touch_and_ends_at_the_fold() -> None:
    tip, strength = rm.Paraboloid(5e-5), strength_of(2.0)
    law = {"effective_modulus": E, "work": W, "adhesion": "dugdale", "strength": strength}
    off, on = float(rm.pull_off(tip, **law, control="displacement").indentation), -W / strength
    assert off < on
    path = -np.array([on * 1.0001, on * 0.9999, 0.0, on, off * 0.9999, off * 1.0001])
    forces = rm.load_separation(ensemble([0.0], radius=5e-5), separation=path, **law).force.to_numpy()
    assert forces[0] == 0.0
    assert (forces[1:5] < 0.0).all()
    assert forces[5] == 0.0
    alone = rm.indent(tip, indentation=-path[1:5], **law)
    np.testing.assert_allclose(forces[1:5], alone.force, rtol=1e-12)


def test_at_small_tabor_numbers_asperities_attract_without_touching() -> None:
    strength = strength_of(0.1)
    law = rm.load_separation(
        ensemble([0.0, 0.0], radius=5e-5),
        separation=[0.5 * W / strength],
        effective_modulus=E,
        work=W,
        adhesion="dugdale",
        strength=strength,
        variables=["force", "contact_count", "contact_area"],
    )
    assert float(law.force[0]) < 0.0
    assert float(law.contact_count[0]) == float(law.contact_area[0]) == 0.0


SHAPES = {
    "paraboloid": (rm.Paraboloid(5e-5), (0.2, 0.9, 5.0)),
    "flat_punch": (rm.FlatPunch(2e-6), (0.3, 5.0)),
    "truncated_cone": (rm.TruncatedCone(0.1, 2e-6), (0.5, 5.0)),
    "rounded_punch": (rm.RoundedPunch(2e-6, 2e-8), (0.5, 7.0)),
}
KINDS = ["paraboloid", "flat_punch", "truncated_cone", pytest.param("rounded_punch", marks=pytest.mark.large)]


@pytest.mark.large
@pytest.mark.parametrize("kind", KINDS)
def test_the_work_of_a_closed_cycle_is_what_the_jumps_dissipate(kind: str) -> None:
    shape, numbers = SHAPES[kind]
    for tabor in numbers:
        strength = tabor / rm.tabor(shape, effective_modulus=E, work=W, strength=1.0)
        law = {"effective_modulus": E, "work": W, "adhesion": "dugdale", "strength": strength}
        far, reach = -float(rm.pull_off(shape, **law, control="displacement").indentation), W / strength
        out = np.linspace(-0.5 * far, reach, 6001)
        before, after = reach * (1.0 + 1e-9), far * (1.0 + 1e-9)
        back = np.linspace(-0.5 * far, far * (1.0 - 1e-9), 9001)
        way = np.concatenate([[1.1 * far, before], out[::-1], back, [after]])
        data = ensemble([0.0], shape=kind, **shape.parameters)
        curve = rm.load_separation(data, separation=way, variables=VARIABLES, **law)
        work = -float(np.trapezoid(curve.force, way))
        spent = float(curve.dissipated_energy[-1])
        scale = float(np.abs(curve.energy).max())
        assert float(curve.energy[-1]) == float(curve.contact_count[-1]) == 0.0
        assert (np.diff(curve.dissipated_energy) >= 0.0).all()
        assert abs(work - spent) < 2e-3 * scale
        moved = np.diff(curve.energy) + np.diff(curve.dissipated_energy)
        done = -0.5 * (curve.force.to_numpy()[1:] + curve.force.to_numpy()[:-1]) * np.diff(way)
        assert np.median(np.abs(moved - done)) < 1e-6 * scale


@pytest.mark.large
@pytest.mark.parametrize("reach", [large(1e-6), large(0.1), 1e10, large(1e20)])
def test_a_range_in_which_a_contact_would_be_lost_is_refused(reach: float) -> None:
    """Else the force of a punch, P/(2 E*) = b delta - beta/2 (a m + b^2 theta), is right to the stated error."""
    b, beta, effective_modulus = 1e-6, 2e-3, 1e9
    strength = 0.5 * beta * effective_modulus
    law = {
        "effective_modulus": effective_modulus,
        "work": reach * strength,
        "adhesion": "dugdale",
        "strength": strength,
    }
    data, way = ensemble([0.0], shape="flat_punch", radius=b), np.linspace(2.0, -1.0, 31) * beta * b
    if reach > 1.0:
        with pytest.raises(rm.OutOfRange, match=r"is lost in its roundings"):
            rm.indent(rm.FlatPunch(b), indentation=-way, **law)
        with pytest.raises(rm.OutOfRange, match="not representable"):
            rm.load_separation(data, separation=way, **law)
        return
    curve = rm.load_separation(data, separation=way, **law)
    m = np.clip(way / beta, 0.0, b)
    a = np.sqrt((b - m) * (b + m))
    pulled = 0.5 * beta * (a * m + b * b * np.arctan2(m, a))
    expected = 2.0 * effective_modulus * (b * np.maximum(-way, 0.0) - pulled)
    assert np.abs(curve.force - expected).max() <= float(curve.numerical_error) * np.abs(expected).max()


def attracting_spheres(radius: float, reach: float, beta: float) -> dict[str, Any]:
    """Return arguments under which the range of adhesion is ``reach`` radii, and 2 strength/E* is ``beta``."""
    strength = 0.5 * beta * E
    return {"effective_modulus": E, "work": reach * radius * strength, "adhesion": "dugdale", "strength": strength}


@pytest.mark.parametrize(("reach", "beta"), [(0.3, 0.1), (0.87, 4.7)])
def test_the_cohesive_zone_ends_with_the_sphere(reach: float, beta: float) -> None:
    """P and k are Maugis's with c = R."""
    radius = 2e-6
    sphere, law = rm.Sphere(radius), attracting_spheres(radius, reach, beta)
    contact = rm.indent(sphere, indentation=np.linspace(1.5, 5.0, 8) * radius, **law)
    a = contact.contact_radius.to_numpy()
    m, theta = np.sqrt((radius - a) * (radius + a)), np.arccos(a / radius)
    np.testing.assert_allclose(contact.cohesive_radius, radius, rtol=1e-15)
    np.testing.assert_allclose(contact.indentation, sphere.g(a) - beta * m, rtol=1e-11)
    pushed = a * sphere.g(a) - sphere.G(a) - 0.5 * beta * (a * m + radius**2 * theta)
    np.testing.assert_allclose(contact.force, 2.0 * E * pushed, rtol=1e-11)
    np.testing.assert_allclose(contact.stiffness, 2.0 * E * a, rtol=1e-11)


@pytest.mark.large
@pytest.mark.parametrize(("reach", "beta"), [(0.3, 0.1), (0.87, 4.7)])
def test_the_work_done_on_a_sphere_to_its_last_zone_is_energy_stored_and_lost(reach: float, beta: float) -> None:
    radius = 2e-6
    sphere, law = ensemble([0.0], shape="sphere", radius=radius), attracting_spheres(radius, reach, beta)
    way = -np.linspace(-1.01 * reach, 3.0, 4001) * radius
    curve = rm.load_separation(sphere, separation=way, variables=VARIABLES, **law)
    assert (np.diff(curve.dissipated_energy) >= 0.0).all()
    moved = np.diff(curve.energy) + np.diff(curve.dissipated_energy)
    done = -0.5 * (curve.force.to_numpy()[1:] + curve.force.to_numpy()[:-1]) * np.diff(way)
    scale = float(np.abs(curve.energy).max())
    assert np.sort(np.abs(moved - done))[-2] < 1e-6 * scale  # but for the step in which the attraction begins


@settings(deadline=None, max_examples=30)
@given(
    tabor=st.floats(0.01, 100.0),
    length=st.floats(1e-9, 1e-1),
    stiff=st.floats(1e3, 1e12),
    heights=st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=5),
)
def test_the_same_physics_in_other_units(tabor: float, length: float, stiff: float, heights: list[float]) -> None:
    """Lengths times l and moduli times e, work of adhesion times l e: forces times e l^2."""
    l, e = length / 5e-5, stiff / E
    path = np.array([20.0, 3.0, 0.5, -1.0, 1.0, 4.0, 0.0, 30.0]) * 1e-8 / min(tabor, 1.0)
    z = np.array(heights) * 1e-8
    one, other = (
        rm.load_separation(
            ensemble(z * factor, area=None, radius=5e-5 * factor),
            separation=path * factor,
            effective_modulus=E * hard,
            work=W * factor * hard,
            adhesion="dugdale",
            strength=strength_of(tabor) * hard,
            variables=["force", "contact_count"],
        )
        for factor, hard in ((1.0, 1.0), (l, e))
    )
    scale = np.pi * W * 5e-5 * len(heights)
    np.testing.assert_allclose(other.force / (e * l * l), one.force, rtol=1e-9, atol=1e-10 * scale)


@pytest.mark.parametrize("name", KINDS)
def test_the_bound_on_the_error_holds(name: str) -> None:
    """Against forces of 25 digits along a retraction, the asperity many times over at heights of its own."""
    for case in json.loads((DATA / f"dugdale_{name}.json").read_text())["cases"]:
        rows = [row for row in case["rows"] if "displacement" in row["answers"]]
        rows.sort(key=lambda row: -mp.mpf(row["indentation"]))
        law = {"effective_modulus": case["modulus"], "work": case["work"], "strength": case["strength"]}
        for height in (0.0, 3e-7, -7e-5):
            data = ensemble(np.full(40, height), None, name, **case["parameters"])
            path = [height - float(row["indentation"]) for row in rows]
            got = rm.load_separation(data, separation=path, adhesion="dugdale", **law)
            largest = float(np.abs(got.force).max())
            for i, row in enumerate(rows):
                # The force at the separation as it was rounded; the slope of the branch is right for so small a way.
                moved = mp.mpf(height) - mp.mpf(path[i]) - mp.mpf(row["indentation"])
                exact = 40 * (mp.mpf(row["force"]) + mp.mpf(row["stiffness"]) * moved)
                assert abs(mp.mpf(float(got.force[i])) - exact) <= float(got.numerical_error) * largest, (name, row)
            assert float(got.numerical_error) < 1e-6


def test_the_cheapest_law_that_is_right_enough_is_taken() -> None:
    """ "auto" is JKR's to the last bit, or Dugdale's; where it is JKR's it is as near to Dugdale as was asked for."""
    taken = set()
    for strength, error in (("1 GPa", 0.02), ("30 MPa", 0.02), ("30 MPa", 1e-4), ("1 MPa", 0.02)):
        known = {"work": "50 mJ/m^2", "strength": strength}
        batch = {"realizations": 2}
        made = rm.run(scene(adhesion={"model": "auto", "error": error, **known}, batch=batch))
        both = {model: rm.run(scene(adhesion={"model": model, **known}, batch=batch)) for model in ("jkr", "dugdale")}
        for i in range(2):
            model = made.adhesion_law.attrs["flag_meanings"].split()[int(made.adhesion_law[i])]
            taken.add(model)
            assert np.array_equal(made.force[i], both[model].force[i])
            off = np.abs(made.force[i] - both["dugdale"].force[i]).max() / np.abs(both["dugdale"].force[i]).max()
            assert float(off) <= error
            assert float(made.tabor_number[i]) == float(both["jkr"].tabor_number[i])
    assert taken == {"jkr", "dugdale"}


def test_jkr_of_a_small_tabor_number_warns_with_the_number() -> None:
    tip, strength = rm.Paraboloid(5e-5), strength_of(0.5)
    number = rm.tabor(tip, effective_modulus=E, work=W, strength=strength)
    assert number == pytest.approx(0.5, rel=1e-12)
    with pytest.warns(rm.LimitWarning, match=r"a Tabor number of 0\.5: "):
        rm.indent(tip, effective_modulus=E, work=W, strength=strength, indentation=0.0)
    with pytest.warns(rm.LimitWarning, match=r"a Tabor number of 0\.5: "):
        rm.load_separation(
            ensemble([0.0], radius=5e-5), separation=[0.0], effective_modulus=E, work=W, strength=strength
        )
    adhesion = {"model": "jkr", "work": W, "range": W / strength}
    asked = scene(adhesion=adhesion, batch=None)
    assert "a Tabor number of 0." in rm.run(asked).attrs["warnings"]
    assert "Tabor" not in rm.run(scene(batch=None)).attrs.get("warnings", "")


@pytest.mark.parametrize(
    ("adhesion", "says"),
    [
        ({"model": "dugdale", "work": W}, "needs strength, the stress of the attraction, or its range"),
        ({"model": "dugdale", "work": W, "strength": "1 MPa", "range": "1 nm"}, "takes strength or range, not both"),
        ({"model": "jkr", "work": W, "error": 0.1}, "takes error only with model 'auto'"),
        ({"model": "dugdale", "work": W, "strength": "1 nm"}, "adhesion.strength = '1 nm': 'nm' is a unit of m"),
        ({"model": "dugdale", "work": 5e-324, "range": 1e20}, "work over range is 0 Pa; it must be a finite number"),
        ({"model": "auto", "work": 1e10, "range": 1e-300}, "work over range is inf Pa; it must be a finite number"),
    ],
)
def test_what_does_not_go_together_is_refused(adhesion: dict[str, object], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        read(scene(adhesion=adhesion))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"adhesion": "dugdale"},
            "adhesion model 'dugdale' needs strength, the stress of the attraction, or its range",
        ),
        ({"adhesion": "auto"}, "adhesion model 'auto' needs strength"),
        ({"adhesion": "auto", "strength": 1e6, "range": 1e-9}, "adhesion takes strength or range, not both"),
        ({"adhesion": "dugdale", "strength": 1e6, "error": 0.1}, "adhesion takes error only with model 'auto'"),
        ({"adhesion": "dugdale", "range": "1 Pa"}, "range is '1 Pa': 'Pa' is a unit of Pa; expected a unit of m"),
        ({"adhesion": "dugdale", "range": 1e-320}, "work over range is inf Pa; it must be a finite number"),
        ({"adhesion": "auto", "strength": 1e6, "error": -0.1}, "error is -0.1; it must be a number above 0 and at"),
        ({"adhesion": "dugdale", "strength": 0.0}, "strength is 0 Pa; it must be a finite number above 0"),
        ({"adhesion": "maugis", "strength": 1e6}, "adhesion is 'maugis'; it must be 'jkr', 'dugdale' or 'auto'"),
        ({"adhesion": "dugdale", "strength": 1e6, "contact_radius": 0.0}, "there can be attraction|attract each other"),
    ],
)
def test_one_asperity_refuses(changes: dict[str, object], says: str) -> None:
    control = {} if "contact_radius" in changes else {"indentation": 0.0}
    with pytest.raises(rm.RoughmdrError, match=says):
        rm.indent(rm.Paraboloid(1e-6), effective_modulus=1e9, work=W, **control, **changes)


@pytest.mark.parametrize("radius", [2.068411851025195, 2.104768134310386, 3.096157246512134])
def test_next_to_the_fold_every_float_has_its_contact(radius: float) -> None:
    """There the indentation is all roundings, along which Newton's method would creep."""
    tip, law = rm.Paraboloid(radius), {"effective_modulus": 251837.4456117847, "work": 0.09166012584432522}
    cohesion = {"adhesion": "dugdale", "strength": 240.14722117573052}
    fold = rm.pull_off(tip, **law, **cohesion, control="displacement")
    near = float(fold.indentation) + np.arange(3000) * np.spacing(abs(float(fold.indentation)))
    force = rm.indent(tip, **law, **cohesion, indentation=near).force
    np.testing.assert_allclose(force, float(fold.force), rtol=1e-4)


def test_a_sweep_over_the_range_from_the_command_line(tmp_path: Path) -> None:
    adhesion = {"model": "auto", "work": "50 mJ/m^2", "range": "1 nm"}
    table = scene(adhesion=adhesion, sweep={"adhesion.range": ["0.1 nm", "1 um"]}, batch=None)
    write_scene(tmp_path, table)
    told = said("run", "scene.toml", "-o", "out.nc", cwd=tmp_path)
    assert "adhesion     jkr in 1, dugdale in 1 of 2; smallest Tabor number" in told
    with xr.open_dataset(tmp_path / "out.nc") as result:
        assert result.adhesion_law.to_numpy().ravel().tolist() == [1, 2]
    assert any("range of the adhesion" in line for line in make_plan(read(table)).left_out)


@pytest.mark.large
def test_the_study_goes_from_dmt_to_jkr(tmp_path: Path) -> None:
    result = study.measure(quick=True)
    force = -result.pull_off_force / (np.pi * study.WORK * study.RADIUS)
    assert result.tabor.to_numpy() == pytest.approx([1e-3, 1.0, 1e3])
    assert force.sel(control="force").to_numpy()[[0, 2]] == pytest.approx([2.0, 1.5], rel=1e-3)
    assert float(force.sel(control="displacement")[2]) == pytest.approx(5.0 / 6.0, rel=1e-6)
    pressed = result.jkr_error.sel(stop=-1.0, roughness=[0.1, 0.3, 1.0, 3.0])
    assert (pressed <= SHIFT / pressed.roughness / pressed.rough_tabor).all()
    study.draw(result).savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 20_000
