"""Inputs that once broke something, or that someone will try: refused with a message, or right."""

import os
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from click.testing import CliRunner
from command import ROUGHMDR, roughmdr
from forms import large
from scenes import ASPERITIES, ensemble, scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.cli import main
from roughmdr.errors import FailedRuns
from roughmdr.scene import read
from roughmdr.storage.result_file import read_result

SMALL = {**ASPERITIES, "count": 20}


def wave(path: Path, height: float = 1e-7) -> None:
    x = np.linspace(0.0, 1e-5, 40)
    waves = height * np.outer((1.0 + 1e5 * x) * np.cos(2e6 * x), np.cos(2e6 * x))
    xr.Dataset({"height": (("x", "y"), waves)}, coords={"x": x, "y": x}).to_netcdf(path)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene(asperities=SMALL)))
    for name in ("m1.nc", "m2.nc"):
        wave(tmp_path / name)
    surface = scene(asperities={"source": "surface", "file": "m1.nc"}, batch=None)
    (tmp_path / "surface.toml").write_text(tomli_w.dumps(surface))
    (tmp_path / "maps.toml").write_text(tomli_w.dumps({**surface, "sweep": {"asperities.file": ["m1.nc", "m2.nc"]}}))
    return tmp_path


def test_no_input_is_overwritten(folder: Path) -> None:
    rm.run(folder / "small.toml", folder / "r.nc")
    (folder / "r.nc").rename(folder / "r.png")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for arguments in (
        ["run", "maps.toml", "-o", "m2.nc"],
        ["run", "r.png", "-o", "r.png"],
        ["plot", "r.png", "-o", "r.png"],
        ["generate", "surface.toml", "-o", "m1.nc"],
        ["new", "small.toml"],
    ):
        assert roughmdr(*arguments, cwd=folder).returncode == 2, arguments
    with pytest.raises(rm.StoreError, match="is an input"):
        rm.run(read(folder / "small.toml"), folder / "small.toml")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize("patch", [1e-200, 1e200])
def test_a_patch_without_an_area_is_refused(patch: float) -> None:
    with pytest.raises(rm.SceneError, match=r"asperities\.patch"):
        read(scene(asperities={**SMALL, "patch": patch}))


@pytest.mark.parametrize(
    ("size", "modulus", "area", "says"),
    [
        (1e-98, 1e306, 4e-202, "pressure is not representable on a nominal area of 4e-202 m2"),
        (1e3, 1e9, 1e-310, "contact_fraction is not representable on a nominal area of 1e-310 m2"),
    ],
)
def test_what_no_float_can_hold_over_the_nominal_area_is_refused(
    size: float, modulus: float, area: float, says: str
) -> None:
    """A pressure at a contact of less than the area, and one of far more."""
    asperity = ensemble([size], radius=1e-6 * size, area=area)
    with pytest.raises(rm.OutOfRange, match=says):
        rm.load_separation(asperity, separation=[0.0], effective_modulus=modulus, variables=["pressure"])


def test_a_key_swept_twice_is_refused(folder: Path) -> None:
    text = (folder / "small.toml").read_text()
    (folder / "twice.toml").write_text(f'{text}[sweep]\n"adhesion.work" = [0.01]\n[sweep.adhesion]\nwork = [0.02]\n')
    with pytest.raises(rm.SceneError, match=r"sweep\.adhesion\.work: is given twice"):
        read(folder / "twice.toml")


@pytest.mark.parametrize(
    ("key", "change"),
    [
        ("adhesion.work", 'adhesion={model="jkr",work=0.5}'),
        ("asperities.radius", "asperities.radius.mean=60 um"),
        ("asperities.radius.mean", "asperities.radius=60 um"),
    ],
)
def test_a_change_is_never_ignored_under_a_sweep(key: str, change: str) -> None:
    values = [0.01, 0.02] if key == "adhesion.work" else ["10 um", "20 um"]
    asked = read(scene(sweep={key: values}), [change])
    assert asked.sweep.sizes == {}


@pytest.mark.parametrize(
    "change", ['asperities={source="surface",file="m2.nc"}', 'sweep={"asperities.file"=["m2.nc"]}']
)
def test_files_in_a_change_are_found_again(folder: Path, change: str, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "inside").mkdir()
    monkeypatch.chdir(folder)
    Path("inside/scene.toml").write_text(Path("surface.toml").read_text())
    first = rm.run(read("inside/scene.toml", [change]) if "sweep" not in change else read("surface.toml", [change]))
    assert str(folder / "m2.nc") in first.attrs["scene"]


@pytest.mark.parametrize("change", ["sweep.adhesion={work=[0.01,0.02]}", "sweep={adhesion={work=[0.01,0.02]}}"])
def test_a_change_may_spell_a_sweep_in_any_way(change: str) -> None:
    assert read(scene(), [change]).sweep.sizes == {"adhesion_work": 2}
    with pytest.raises(rm.SceneError, match="sweep is not a table"):
        read(scene(), ["sweep=5", "sweep.adhesion.work=[1]"])


def test_a_distribution_is_swept_with_its_own_parameter() -> None:
    table = scene(sweep={"asperities.height.distribution": ["weibull"], "asperities.height.c": [1.5, 2.0]})
    assert read(table).sweep.sizes == {"asperities_height_distribution": 1, "asperities_height_c": 2}


def test_a_scene_in_python_takes_arrays_tuples_and_numpy_numbers() -> None:
    table = scene(
        seed=np.int64(7), sweep={"adhesion.work": np.array([0.01, 0.02]), "asperities.count": (5, np.int32(6))}
    )
    asked = read(table)
    assert asked.sweep.sizes == {"adhesion_work": 2, "asperities_count": 2}
    assert read(asked) is asked


@pytest.mark.parametrize(
    "shape",
    [rm.Paraboloid(radius=1), large(rm.Cone(slope=1)), large(rm.PowerLaw(exponent=2, width=1, rise=1))],
    ids=str,
)
def test_whole_numbers_are_numbers(shape: rm.Paraboloid) -> None:
    whole = rm.indent(shape, effective_modulus=1_000_000, work=1, indentation=1)
    floats = type(shape)(**{name: float(value) for name, value in shape.parameters.items()})
    assert whole.equals(rm.indent(floats, effective_modulus=1e6, work=1.0, indentation=1.0))


def test_one_mistake_is_said_once_and_counted() -> None:
    table = scene(sweep={"asperities.height": [0.0, 1e-6, 2e-6], "adhesion.work": {"linspace": [0.0, 1.0], "num": 50}})
    with pytest.raises(rm.SceneError, match=r"in 150 cells, first where asperities\.height = 0\.0") as caught:
        read(table)
    assert len(caught.value.faults) == 1


def test_a_run_that_cannot_be_computed_says_which() -> None:
    table = scene(sweep={"asperities.radius": ["50 um", "1e300 m"]}, batch=None)
    with pytest.warns(FailedRuns, match="1 of 2 failed"):
        found = rm.run(table)
    np.testing.assert_array_equal(found.status, [[0], [1]])
    assert "OutOfRange: " in found.remark.item(1)
    assert np.isnan(found.force[1]).all()
    alone = scene(asperities={**ASPERITIES, "radius": "1e300 m"}, batch={"realizations": 2})
    with pytest.raises(rm.OutOfRange, match=r"^realisation 0: "):
        rm.run(alone)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "content",
    [
        f"seed = 0x{'F' * 5000}\n",
        f"{'x.' * 3000}y = 1\n",
        f"[sweep]\n{'x.' * 3000}y = [1]\n",
        '[sweep]\n"\\u001b[31mx\\ny" = [1]\n',
        '"\\u001b[31mx\\ny" = 1\n',
        "modulus = 3 MPa\n",
        "a = 2001-01-01\n",
    ],
)
def test_odd_texts_are_refused_in_words(folder: Path, content: str) -> None:
    (folder / "odd.toml").write_text(content + (folder / "small.toml").read_text() * ("sweep" not in content))
    done = CliRunner().invoke(main, ["run", str(folder / "odd.toml"), "-o", str(folder / "out.nc")], color=True)
    assert done.exit_code == 2
    assert isinstance(done.exception, SystemExit)
    assert "\x1b[31mx" not in done.output
    if "MPa" in content:
        assert 'a number with a unit stands in quotes: "3 MPa"' in done.output


NO_RESULTS: dict[str, Any] = {
    "one variable": lambda ds: ds[["force"]],
    "one realisation": lambda ds: ds.isel(realization=0),
    "their mean": lambda ds: ds.mean("realization", keep_attrs=True),
    "no branch": lambda ds: ds.drop_vars("branch"),
    "no separation": lambda ds: ds.drop_vars("separation"),
    "no step": lambda ds: ds.isel(step=slice(0, 0)),
    "transposed": lambda ds: ds.transpose("step", ...),
    "no title": lambda ds: ds.assign_attrs(title=1),
    "a number": lambda ds: ds.assign_attrs(left_out=3),
}


@pytest.mark.parametrize("change", NO_RESULTS)
def test_a_result_that_was_changed_is_refused_or_shown(folder: Path, change: str) -> None:
    result = rm.run(folder / "small.toml")
    NO_RESULTS[change](result).to_netcdf(folder / "changed.nc")
    for arguments in (["info", "changed.nc"], ["plot", "changed.nc", "-o", "x.png"]):
        done = CliRunner().invoke(main, [a if "." not in a else str(folder / a) for a in arguments])
        assert done.exit_code == 2, done.output
        assert "not a result as roughmdr writes it" in done.output


@pytest.mark.large
def test_a_result_with_more_in_it_is_shown(folder: Path) -> None:
    result = rm.run(folder / "small.toml")
    result.assign(foo=2.0 * result.force).to_netcdf(folder / "more.nc")
    for arguments in (["info", "more.nc"], ["plot", "more.nc", "-o", "x.png"]):
        done = CliRunner().invoke(main, [a if "." not in a else str(folder / a) for a in arguments])
        assert done.exit_code == 0, done.output
    assert "foo" in read_result(folder / "more.nc").variables


def test_long_and_odd_names_of_files(folder: Path) -> None:
    long = "n" * 247 + ".nc"
    assert roughmdr("run", "small.toml", "-o", long, "--quiet", cwd=folder).returncode == 0
    assert (folder / long).exists()
    too_long = "n" * 300 + ".nc"
    for arguments in (
        ["run", "small.toml", "-o", too_long],
        ["info", too_long],
        ["plot", too_long, "-o", "x.png"],
        ["plot", long, "-o", too_long],
        ["new", too_long],
        ["run", too_long, "-o", "x.nc"],
        ["run", "small.toml", "-o", "x.nc", "--set", 'asperities={source="surface",file="' + too_long + '"}'],
        ["plot", long, "-o", "x.pgf"],
    ):
        done = roughmdr(*arguments, cwd=folder)
        assert done.returncode == 2, (arguments, done.stderr)
        assert "Traceback" not in done.stderr


@pytest.mark.large
def test_nobody_needs_to_listen(folder: Path) -> None:
    command = " ".join(["'" + part.replace("'", "'\\''") + "'" for part in [*ROUGHMDR, "run", "small.toml", "-o"]])
    for name, redirection in (("a.nc", "2>&-"), ("b.nc", "2>/dev/full")):
        done = subprocess.run(
            ["sh", "-c", f"{command} {name} {redirection}"], cwd=folder, capture_output=True, check=False
        )
        assert done.returncode == 0
        assert (folder / name).exists()


def test_names_are_no_mathematics_in_a_picture(folder: Path) -> None:
    wave(folder / "c$_{$.nc")
    swept = ["--set", "sweep.asperities.file=['m1.nc','c$_{$.nc']"]
    assert roughmdr("run", "surface.toml", "-o", "out.nc", *swept, cwd=folder).returncode == 0
    done = roughmdr("plot", "out.nc", "-o", "out.png", cwd=folder)
    assert done.returncode == 0, done.stderr


@pytest.mark.large
def test_a_plan_is_not_disturbed_by_files_in_the_folder(folder: Path) -> None:
    (folder / "numpy.py").write_text("raise ImportError('mine')")
    (folder / "roughmdr").mkdir()
    command = [*ROUGHMDR[:1], "-P", *ROUGHMDR[1:], "plan", "small.toml"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.large
def test_a_huge_batch_is_planned_at_once() -> None:
    huge = {"batch": {"realizations": 1_000_000_000}, "output": {"keep": "statistics"}}
    plan = make_plan(read(scene(**huge, asperities={**ASPERITIES, "count": 1})))
    tasks = [task.ranges[0] for task in split_into_tasks(plan, Rounds(plan).begin(), ["force"], workers=2)]
    assert len(tasks) < 100_000
    assert tasks[0].first == 0
    assert tasks[-1].last == 1_000_000_000
    assert all(a.last == b.first for a, b in pairwise(tasks))


def test_a_wrong_name_of_a_section_hides_nothing_behind_it(folder: Path) -> None:
    (folder / "many.toml").write_text(
        '[material]\neffective_modulus = "3 MPa"\n[asperities]\nsource = "randm"\nshaep = "paraboloid"\ncount = 1.5\n'
        'patch = "1 s"\nheight = { distribution = "norml", std = "1 um" }\n'
        'radius = { distribution = "lognormal", sdt = 1 }\n'
        '[path]\nseparation = [0]\n[sweep]\n"asperities.raduis" = [1]\n"material.effective_modulus" = 3\n'
    )
    with pytest.raises(rm.SceneError) as caught:
        read(folder / "many.toml")
    expected = [
        (4, "asperities.source = 'randm': not available; did you mean 'random'?"),
        (5, "asperities.shaep: unknown key; did you mean 'shape'?"),
        (6, "asperities.count = 1.5: expected a whole number"),
        (7, "asperities.patch = '1 s': 's' is a unit of s; expected a unit of m"),
        (8, "asperities.height.distribution = 'norml': not known; did you mean 'normal'"),
        (9, "asperities.radius.sdt = 1: lognormal has no such parameter"),
        (13, "sweep.asperities.raduis: is no number or name"),
        (14, "sweep.material.effective_modulus = 3: must be a list"),
    ]
    assert len(caught.value.faults) == len(expected), str(caught.value)
    for fault, (line, text) in zip(caught.value.faults, expected, strict=True):
        assert str(fault).startswith(f"{folder / 'many.toml'}:{line}: {text}")


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("hurst", 0.8, "unknown key; it can be correlation, count, density"),
        ("source", "RANDOM", "not available; did you mean 'random'?"),
        ("source", "nonsens", "not available; it can be random, nayak, spectrum, surface, file"),
        ("Shape", "cone", "unknown key; did you mean 'shape'?"),
    ],
)
def test_a_fault_is_told_alone(key: str, value: object, says: str) -> None:
    """A key of another source is no key of this one, and no source is guessed at."""
    with pytest.raises(rm.SceneError) as caught:
        read(scene(asperities={**ASPERITIES, key: value}))
    (fault,) = caught.value.faults
    assert fault.key == f"asperities.{key}"
    assert fault.message.startswith(says)


@pytest.mark.parametrize("title", ["\ud800", "a\x00b", "\x1b[31mred", "two\nlines", 3])
def test_a_title_is_one_line_that_can_be_printed(title: object) -> None:
    with pytest.raises(rm.SceneError, match=r"title = .*: must be a text on one line"):
        read(scene(title=title))


@pytest.mark.large
def test_a_scene_in_a_file_with_an_odd_name_or_a_byte_order_mark(folder: Path) -> None:
    text = tomli_w.dumps(scene(title=None, asperities=SMALL))
    raw = os.fsencode(folder) + b"/a\xff.toml"
    with open(raw, "w") as file:
        file.write(text)
    done = subprocess.run([*ROUGHMDR, "run", raw, "-o", "x.nc"], cwd=folder, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert read_result(folder / "x.nc").attrs["title"] == "a?"
    (folder / "mark.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert read(folder / "mark.toml").title == "mark"


def test_lines_are_counted_as_toml_counts_them(folder: Path) -> None:
    (folder / "odd.toml").write_text("# \u2028 \u0085\n[material]\nmodulus = 3\npoisson = 0.7\n", encoding="utf-8")
    with pytest.raises(rm.SceneError, match=r"odd\.toml:4: material\.poisson"):
        read(folder / "odd.toml")


def test_a_part_of_a_swept_range_can_be_changed() -> None:
    table = scene(sweep={"adhesion.work": {"linspace": [0.01, 0.02], "num": 3}})
    assert read(table, ["sweep.adhesion.work.num=5"]).sweep.sizes == {"adhesion_work": 5}
    ends = read(table, ["sweep.adhesion.work.logspace=[0.01, 0.04]"]).sweep.axes[0].values
    np.testing.assert_allclose(ends, [0.01, 0.02, 0.04])
    both = ["sweep.adhesion.work.linspace=[0.1,0.2]", "sweep.adhesion.work.num=2"]
    assert read(scene(), both).sweep.sizes == {"adhesion_work": 2}


def test_a_map_without_summits_is_named(folder: Path) -> None:
    wave(folder / "flat.nc", 0.0)
    for height in (0.0, 1e300, 1e-300):
        wave(folder / "flat.nc", height)
        done = roughmdr(
            "run", "maps.toml", "-o", "x.nc", "--set", "sweep.asperities.file=['m1.nc','flat.nc']", cwd=folder
        )
        assert done.returncode == 2
        assert "flat.nc: the map has no summit" in done.stderr
        assert "Warning" not in done.stderr


def test_sets_and_paths_in_a_scene_in_python(folder: Path) -> None:
    surface = {"source": "surface", "file": folder / "m1.nc"}
    result = rm.run(scene(asperities=surface, output={"variables": {"force", "energy"}}, batch=None))
    assert {"force", "energy"} <= set(result.data_vars)


@pytest.mark.parametrize("unit", ["meters", "metres", "micrometers", "microns", " m "])
def test_units_of_a_map_as_others_spell_them(folder: Path, unit: str) -> None:
    with xr.open_dataset(folder / "m1.nc") as data:
        data["height"].attrs["units"] = unit
        data.to_netcdf(folder / "spelt.nc")
    asked = read(scene(asperities={"source": "surface", "file": str(folder / "spelt.nc")}, batch=None))
    assert asked.asperities.expected_count > 0


def test_statistics_of_cells_that_are_far_apart_are_those_of_single_runs() -> None:
    base = {"adhesion": None, "output": {"keep": "statistics"}, "batch": {"realizations": 5}}
    values = [1e-200, 1.0, 1e200]
    swept = rm.run(scene(material={"effective_modulus": 1}, sweep={"material.effective_modulus": values}, **base))
    for i, effective_modulus in enumerate(values):
        alone = rm.run(scene(material={"effective_modulus": effective_modulus}, **base))
        for name in ("force_mean", "force_sem", "stiffness_sem"):
            np.testing.assert_array_equal(swept[name][i], alone[name])
