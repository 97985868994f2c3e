"""The laws beside a result: which apply and why not the others, their values, and how they come into a picture."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from command import roughmdr, said
from scenes import ASPERITIES, scene
from scipy import stats

import roughmdr as rm
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.pictures.overlay import Overlay, overlay_expected, overlay_theory
from roughmdr.scene import read
from roughmdr.spectrum import SelfAffine

MODULUS, RADIUS, MEAN, STD, COUNT, AREA = 1e9, 5e-5, 7e-7, 1e-6, 1000, 1e-6
WORK = 0.05
EVERY = ["force", "contact_area", "contact_count", "pressure", "contact_fraction"]
AS_IN_THEORY = ["pressure", "contact_fraction", "contact_density", "pressure", "contact_fraction"]
TIMES = [AREA, AREA, AREA, 1.0, 1.0]
SUMMITS = ASPERITIES | {"radius": RADIUS, "height": {"distribution": "normal", "mean": MEAN, "std": STD}}
WAVES = {"hurst": 0.8, "long_wave": 1e-4, "short_wave": 5e-6, "rms_height": 1e-6}
SURFACE = {"source": "nayak", "patch": 1e-4, **WAVES}
SPECTRUM = SelfAffine.of(**WAVES)
JKR = {"model": "jkr", "work": WORK}
WAY = {"separation": {"start": 4e-6, "stop": -5e-7, "steps": 12}, "unload": True}


def asked(**changes: Any) -> Plan:
    """The plan of equal summits without adhesion, with sections replaced."""
    sections = {"material": {"effective_modulus": MODULUS}, "adhesion": None, "asperities": SUMMITS, "path": WAY}
    return make_plan(read(scene(**(sections | changes))))


def lines_of(found: Overlay, law: str, cell: int = 0) -> dict[str, np.ndarray]:
    return {line.variable: line.values for line in found.lines if (line.label, line.cell) == (law, cell)}


def remarks_on(law: str, plan: Plan, names: list[str] = EVERY) -> list[str]:
    told = (text.partition(": ")[::2] for text in overlay_theory(plan, names).remarks)
    return [remark for laws, remark in told if law in laws.split(", ")]


def check(plan: Plan, law: str, theory: Callable[[str, np.ndarray], np.ndarray], rtol: float = 1e-9) -> None:
    """Hold the lines of a law to what ``theory`` says of a variable of its own at the plan's separations."""
    lines, h = lines_of(overlay_theory(plan, EVERY), law), plan.cells[0].path.separation
    assert list(lines) == EVERY
    for name, own, factor in zip(EVERY, AS_IN_THEORY, TIMES, strict=True):
        values = factor * theory(own, h)
        assert np.ptp(values) > 0.0
        np.testing.assert_allclose(lines[name], values, rtol=rtol, err_msg=name)


def by_hand(**others: Any) -> dict[str, Any]:
    return {"effective_modulus": MODULUS, "radius": RADIUS, "density": COUNT / AREA, "std": STD, **others}


def test_greenwood_and_williamson_count_the_separation_from_the_mean_of_the_heights() -> None:
    law = rm.theory.greenwood_williamson
    check(asked(), "greenwood_williamson", lambda name, h: law(separation=h - MEAN, variable=name, **by_hand()))


def test_fuller_and_tabor_too_in_and_out() -> None:
    law, steps = rm.theory.fuller_tabor, WAY["separation"]["steps"]

    def both_ways(name: str, h: np.ndarray) -> np.ndarray:
        given = by_hand(work=WORK, variable=name)
        way_out = law(separation=h[steps:] - MEAN, turning=h.min() - MEAN, **given)
        return np.append(law(separation=h[:steps] - MEAN, **given), way_out)

    check(asked(adhesion=JKR), "fuller_tabor", both_ways)


def test_maugis_too_where_the_tabor_number_is_small() -> None:
    plan = asked(adhesion={"model": "dugdale", "work": 1e-3, "strength": 1e5}, material={"effective_modulus": 1e12})
    law, given = rm.theory.dmt_maugis, by_hand(effective_modulus=1e12, work=1e-3)
    check(plan, "dmt_maugis", lambda name, h: law(separation=h - MEAN, variable=name, **given))


def test_a_density_in_place_of_a_count_is_that_of_the_law() -> None:
    given = {key: value for key, value in SUMMITS.items() if key != "count"}
    lines = lines_of(
        overlay_theory(asked(asperities=given | {"density": 3.0 * COUNT / AREA}), ["force"]), "greenwood_williamson"
    )
    once = lines_of(overlay_theory(asked(), ["force"]), "greenwood_williamson")
    np.testing.assert_allclose(lines["force"], 3.0 * once["force"], rtol=1e-13)


@pytest.mark.parametrize("adhesion", [None, JKR], ids=["greenwood_williamson", "fuller_tabor"])
@pytest.mark.parametrize(
    ("height", "heights"),
    [
        ({"distribution": "normal", "mean": MEAN, "std": STD}, stats.norm(MEAN, STD)),
        ({"distribution": "uniform", "loc": -1e-6, "scale": 4e-6}, stats.uniform(-1e-6, 4e-6)),
        ({"distribution": "gumbel_r", "loc": 3e-7, "scale": 5e-7}, stats.gumbel_r(3e-7, 5e-7)),
        ({"distribution": "normal", "std": STD, "min": -5e-7, "max": 2e-6}, stats.truncnorm(-0.5, 2.0, 0.0, STD)),
    ],
    ids=["normal", "uniform", "gumbel", "cut"],
)
def test_named_law_and_expected_law_agree(adhesion: Any, height: dict[str, Any], heights: Any) -> None:
    name = "fuller_tabor" if adhesion else "greenwood_williamson"
    plan = asked(adhesion=adhesion, asperities=SUMMITS | {"height": height})
    named, expected = lines_of(overlay_theory(plan, EVERY), name), lines_of(overlay_expected(plan, EVERY), "expected")
    for variable in EVERY:
        largest = np.abs(expected[variable]).max()
        np.testing.assert_allclose(named[variable], expected[variable], rtol=0.0, atol=1e-9 * largest)
    if not adhesion:
        check(
            plan,
            name,
            lambda own, h: rm.theory.greenwood_williamson(
                separation=h, variable=own, **by_hand(std=None, heights=heights)
            ),
        )


def test_the_elliptic_law_of_greenwood_is_the_expected_one_of_a_gaussian_surface() -> None:
    plan = asked(asperities=SURFACE)
    section = plan.cells[0].scene.asperities
    rounded = section.expected_count / (section.summits.density * section.nominal_area)
    named, expected = overlay_theory(plan, EVERY), overlay_expected(plan, EVERY)
    for name, values in lines_of(expected, "expected").items():
        np.testing.assert_allclose(lines_of(named, "greenwood_elliptic")[name] * rounded, values, rtol=1e-8)


def test_the_laws_of_a_gaussian_surface_by_hand() -> None:
    plan = asked(asperities=SURFACE)
    found, h = overlay_theory(plan, ["force", "contact_fraction"]), plan.cells[0].path.separation
    moments = {"effective_modulus": MODULUS, **SPECTRUM.moments._asdict()}
    bush = lines_of(found, "bush_gibson_thomas")
    pressure = rm.theory.bush_gibson_thomas(separation=h, **moments)
    np.testing.assert_allclose(bush["force"], 1e-8 * pressure, rtol=1e-12)
    of_load = {"effective_modulus": MODULUS, "rms_slope": SPECTRUM.rms_slope}
    asymptote = lines_of(found, "bush_gibson_thomas_asymptote")
    np.testing.assert_allclose(
        asymptote["contact_fraction"], rm.theory.bush_gibson_thomas_asymptote(pressure=pressure, **of_load), rtol=1e-12
    )
    loads = lines_of(found, "persson_separation")["force"] / 1e-8
    touching = h <= 0.0
    assert 0 < touching.sum() < h.size
    assert np.isnan(loads[touching]).all()
    gaps = rm.theory.persson_separation(pressure=loads[~touching], effective_modulus=MODULUS, spectrum=SPECTRUM)
    np.testing.assert_allclose(gaps, h[~touching], rtol=1e-11)
    np.testing.assert_allclose(
        lines_of(found, "persson_contact_fraction")["contact_fraction"][~touching],
        rm.theory.persson_contact_fraction(pressure=loads[~touching], **of_load),
        rtol=1e-12,
    )
    assert [list(lines_of(found, law)) for law in ("bush_gibson_thomas_asymptote", "persson_separation")] == [
        ["contact_fraction"],
        ["force"],
    ]


@pytest.mark.parametrize("separation", [np.array([2e-6, 1e-9, 1e-6]), np.array(5e-7), np.array([])])
def test_pressure_and_gap_of_persson_are_inverse(separation: np.ndarray) -> None:
    pressure = rm.theory.persson_pressure(separation=separation, effective_modulus=MODULUS, spectrum=SPECTRUM)
    assert pressure.shape == separation.shape
    again = rm.theory.persson_separation(pressure=pressure, effective_modulus=MODULUS, spectrum=SPECTRUM)
    np.testing.assert_allclose(again, separation, rtol=1e-12)


@pytest.mark.parametrize("separation", [0.0, -1e-6, 1.0])
def test_a_gap_without_pressure_is_refused(separation: float) -> None:
    with pytest.raises(rm.OutOfRange, match=r"separation is from .* it must be above .* and below"):
        rm.theory.persson_pressure(separation=separation, effective_modulus=MODULUS, spectrum=SPECTRUM)


CUT_BACK = {"separation": [2e-6, 0.0, 2e-6, 1e-6]}
GW, FT, DMT = "greenwood_williamson", "fuller_tabor", "dmt_maugis"


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("law", "changes", "reason"),
    [
        (GW, {"asperities": SURFACE}, "asperities.source is 'nayak', not 'random'"),
        (GW, {"asperities": {**SUMMITS, "shape": "sphere"}}, "asperities.shape is 'sphere', not 'paraboloid'"),
        (GW, {"asperities": {**SUMMITS, "second": {"share": 0.5}}}, "there are two populations of asperities"),
        (GW, {"asperities": ASPERITIES}, "radii differ"),
        (GW, {"asperities": {**SUMMITS, "height": 1e-6}}, "all heights are the same"),
        (GW, {"adhesion": JKR}, "the scene has adhesion"),
        (GW, {"asperities": {**SUMMITS, "height": {"distribution": "cauchy", "loc": 0, "scale": 1e-6}}}, "too heavy"),
        (FT, {}, "the scene has no adhesion"),
        (FT, {"adhesion": {**JKR, "model": "dugdale", "strength": 1e6}}, "of finite range, not that of JKR"),
        (FT, {"adhesion": {**JKR, "model": "auto", "strength": 1e3}}, "of finite range, not that of JKR"),
        (FT, {"adhesion": JKR, "path": CUT_BACK}, "the path is not one loading and one unloading"),
        (DMT, {}, "the scene has no adhesion"),
        (DMT, {"adhesion": JKR}, "neither strength nor range of the adhesion is given"),
        (DMT, {"adhesion": {**JKR, "strength": 1e9}}, "not below 0.1"),
        ("bush_gibson_thomas", {}, "asperities.source is 'random', not 'nayak' or 'surface'"),
        ("greenwood_elliptic", {"asperities": SURFACE, "adhesion": JKR}, "the scene has adhesion"),
        (
            "persson_separation",
            {"asperities": {"source": "nayak", "patch": 1e-3, "m0": 1e-12, "m2": 1e-2, "m4": 1e9}},
            "it needs a self-affine spectrum, but the scene gives m0, m2 and m4",
        ),
        (
            "persson_contact_fraction",
            {"asperities": SURFACE, "path": {"separation": [1.0, 1e-6]}},
            "separation is from 1e-06 to 1 m; it must be above",
        ),
    ],
)
def test_a_law_that_does_not_apply_says_why(law: str, changes: dict[str, Any], reason: str) -> None:
    plan = asked(**changes)
    (remark,) = remarks_on(law, plan)
    assert remark.startswith("not drawn: ")
    assert reason in remark
    assert not lines_of(overlay_theory(plan, EVERY), law)


def test_auto_that_takes_jkr_is_as_jkr() -> None:
    path = {"separation": [4e-6, 1e-6]}
    plan = asked(adhesion={**JKR, "model": "auto", "strength": 1e12}, path=path)
    taken = lines_of(overlay_theory(plan, ["force"]), FT)["force"]
    jkr = lines_of(overlay_theory(asked(adhesion=JKR, path=path), ["force"]), FT)["force"]
    np.testing.assert_array_equal(taken, jkr)


def test_a_law_says_which_variables_it_has_not() -> None:
    assert remarks_on(GW, asked(), ["stiffness", "energy"]) == ["not drawn: it gives no stiffness or energy"]
    assert list(lines_of(overlay_theory(asked(), ["stiffness", "force"]), GW)) == ["force"]


def test_the_expected_line_is_the_run_with_that_estimator() -> None:
    names = ["force", "stiffness", "dissipated_energy"]
    table = scene(output={"variables": names})
    lines = lines_of(overlay_expected(make_plan(read(table)), names), "expected")
    run = rm.run(table | {"batch": {"estimator": "expected"}})
    for name in names:
        np.testing.assert_array_equal(lines[name], run[name].values[0])


def test_beside_pairs_the_expected_line_is_that_of_independent_asperities() -> None:
    independent = {"adhesion": None, "output": {"variables": ["force"]}}
    pairs = scene(**independent, interaction={"model": "pairwise"}, sweep={"material.modulus": ["3 MPa", "6 MPa"]})
    found = overlay_expected(make_plan(read(pairs)), ["force"])
    assert found.remarks == ["drawn; of independent asperities"]
    run = rm.run(scene(**independent, batch={"estimator": "expected"}))
    for line, modulus in zip(found.lines, (1.0, 2.0), strict=True):
        assert line.label == "expected, independent"
        np.testing.assert_allclose(line.values, modulus * run.force.values[0], rtol=1e-12)
    first, models = {"model": "mean_field", "boundary": "free"}, ["mean_field", "pairwise"]
    both = scene(**independent, interaction=first, sweep={"interaction.model": models})
    lines = overlay_expected(make_plan(read(both)), ["force"]).lines
    assert [line.label for line in lines] == ["expected", "expected, independent"]
    np.testing.assert_allclose(lines[1].values, run.force.values[0], rtol=1e-12)
    assert (lines[0].values < lines[1].values).all()


@pytest.mark.parametrize(
    ("asperities", "reason"),
    [
        ({**SUMMITS, "radius": 1e-300, "height": {"distribution": "normal", "std": 1e300}}, "not drawn: "),
    ],
)
def test_where_there_is_no_expected_law(asperities: dict[str, Any], reason: str) -> None:
    found = overlay_expected(asked(asperities=asperities), ["force"])
    assert not found.lines
    assert found.remarks[0].startswith(reason)


def test_a_sweep_has_lines_of_every_cell_to_which_a_law_applies() -> None:
    works = [0.0, 0.02, WORK]
    plan = asked(adhesion=JKR, sweep={"adhesion.work": works})
    found = overlay_theory(plan, ["force"])
    assert sorted({(line.label, line.cell) for line in found.lines}) == [(FT, 1), (FT, 2), (GW, 0)]
    assert remarks_on(GW, plan, ["force"]) == [
        "drawn (in 1 of 3 cells)",
        "not drawn: the scene has adhesion (in 2 of 3 cells)",
    ]
    last = lines_of(overlay_theory(asked(adhesion=JKR), ["force"]), FT)
    np.testing.assert_array_equal(lines_of(found, FT, 2)["force"], last["force"])
    expected = overlay_expected(plan, ["force"])
    assert [line.cell for line in expected.lines] == [0, 1, 2]
    assert expected.remarks == ["drawn"]


@pytest.mark.large
def test_a_picture_names_its_laws_and_the_command_says_the_rest(tmp_path: Path) -> None:
    result, picture = tmp_path / "out.nc", tmp_path / "out.svg"
    rm.run(scene(asperities=SUMMITS, batch={"realizations": 2}, path=WAY), result)
    plain = said("plot", result, "-o", picture)
    assert plain == f"picture      {picture}\n"
    assert "<!-- expected -->" not in picture.read_text()
    lines = said("plot", result, "-o", picture, "--with-expected", "--with-theory").splitlines()
    assert lines[:3] == [
        "expected     drawn",
        "theory       greenwood_williamson: not drawn: the scene has adhesion",
        "theory       fuller_tabor: drawn",
    ]
    assert lines[-1] == plain.strip()
    drawn = picture.read_text()
    assert [drawn.count(f"<!-- {law} -->") for law in ("expected", FT, GW)] == [1, 1, 0]


def test_a_picture_of_a_sweep_names_cells_and_laws(tmp_path: Path) -> None:
    result, picture = tmp_path / "out.nc", tmp_path / "out.svg"
    rm.run(scene(asperities=SUMMITS, batch=None, path=WAY, sweep={"adhesion.work": [0.0, 0.05]}), result)
    told = said("plot", result, "-o", picture, "--variable", "force", "--with-theory")
    assert "theory       greenwood_williamson, fuller_tabor: drawn (in 1 of 2 cells)\n" in told
    drawn = picture.read_text()
    assert [drawn.count(f"<!-- {text} -->") for text in (GW, FT, "adhesion_work = 50 mJ/m^2")] == [1, 1, 1]


def test_asperities_that_are_not_drawn_have_no_expected_law(tmp_path: Path) -> None:
    ensemble, result = tmp_path / "saved.nc", tmp_path / "out.nc"
    rm.generate(SUMMITS, seed=1).to_netcdf(ensemble)
    saved = {"source": "file", "file": str(ensemble)}
    rm.run(scene(asperities=saved, batch=None, path=WAY), result)
    told = said("plot", result, "-o", tmp_path / "out.png", "--with-expected", "--with-theory")
    assert "expected     not drawn: nothing of source 'file' is drawn\n" in told
    assert f" {FT}, {DMT}: not drawn: asperities.source is 'file', not 'random' or 'surface'\n" in told


@pytest.mark.parametrize("path", [{"preload": "1 mN", "unload": True}, {"force": {"stop": "1 mN", "steps": 5}}])
def test_over_loads_there_is_no_theory(tmp_path: Path, path: dict[str, Any]) -> None:
    rm.run(scene(asperities=SUMMITS, batch=None, path=path), tmp_path / "out.nc")
    done = roughmdr("plot", tmp_path / "out.nc", "-o", tmp_path / "out.png", "--with-theory")
    assert done.returncode == 2
    assert "need path.separation; this is a path of loads, of a preload or behind a spring" in done.stderr


@pytest.mark.parametrize(
    "change", [lambda ds: ds.isel(step=slice(5)), lambda ds: ds.assign_coords(separation=ds.separation + 1e-8)]
)
def test_a_result_that_is_not_of_its_scene_is_refused(
    tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset]
) -> None:
    changed, picture = tmp_path / "changed.nc", tmp_path / "out.png"
    change(rm.run(scene(batch=None, path=WAY))).to_netcdf(changed)
    done = roughmdr("plot", changed, "-o", picture, "--with-expected")
    assert done.returncode == 2
    assert "its separations are not those of the scene in it" in done.stderr
    assert not picture.exists()
