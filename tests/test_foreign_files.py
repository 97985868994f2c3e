"""Files as anyone may have written or changed them: every command reads them, or refuses them in words."""

import copy
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
import tomli_w
import xarray as xr
from click.testing import CliRunner, Result
from foreign import CHANGES, ODD, Content, Variable, content_of, control_characters, undefined, write
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import ASPERITIES, scene
from test_cli import ROUGHMDR

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.errors import FailedRuns
from roughmdr.netcdf import load

TEXT = ODD.replace("\x00", "")  # which ends a text in a file
EXAMPLES = int(os.environ.get("ROUGHMDR_EXAMPLES", "60"))
FEW = {**ASPERITIES, "count": 5}
SCENE = scene(
    asperities=FEW,
    batch={"realizations": 2},
    path={"separation": {"start": "2 um", "stop": "-1 um", "steps": 6}, "unload": True},
)
TABLE = {
    **{key: value for key, value in FEW.items() if key != "radius"},
    **{"shape": "tabulated", "r": [0, "1 um", "3 um"], "f": [0, "10 nm", "100 nm"]},
}
RESULTS = {
    "curves": SCENE,
    "statistics": {**SCENE, "output": {"keep": "statistics"}},
    "sweep": {**SCENE, "sweep": {"adhesion.work": [0.01, 0.02], "asperities.radius": ["50 um", "1e300 m"]}},
    "accuracy": {
        **SCENE,
        "adhesion": {"model": "auto", "work": 0.05, "strength": 1e6},
        "batch": {},
        "accuracy": {"relative": 0.5, "max_realizations": 8},
        "sweep": {"mode": "zip", "adhesion.work": [0.01, 0.02]},
    },
}
OF_RESULT = (
    "info changed.nc",
    "info changed.nc --cells",
    "plot changed.nc -o picture.png",
    "plot changed.nc -o picture.png --with-expected --with-theory",
    "generate changed.nc -o made.nc",
    "run {}.toml -o changed.nc",
    "run changed.nc -o again.nc",
)
OF_INPUT = ("generate {}.toml -o made.nc", "run {}.toml -o again.nc")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A file of each kind, and scenes that read ``changed.nc``."""
    made = tmp_path_factory.mktemp("foreign")
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(made)
        for name, table in RESULTS.items():
            Path(f"{name}.toml").write_text(tomli_w.dumps(table))
            with pytest.warns(FailedRuns) if name == "sweep" else pytest.MonkeyPatch.context():
                rm.run(f"{name}.toml", f"{name}.nc")
        rm.generate(FEW, seed=1).to_netcdf("ensemble.nc")
        rm.generate(TABLE, seed=1).to_netcdf("table.nc")
        at, rough = np.arange(12) * 1e-6, 1e-7 * np.random.default_rng(0).normal(size=(12, 12))
        data = xr.Dataset({"height": (("x", "y"), rough)}, coords={"x": at, "y": at}, attrs={"periodic": 1})
        data.to_netcdf("map.nc")
        for name, source in (("ensemble", "file"), ("table", "file"), ("map", "surface")):
            section = {"source": source, "file": "changed.nc"}
            Path(f"{name}.toml").write_text(tomli_w.dumps({**SCENE, "asperities": section, "batch": {}}))
        yield made


def called(command: str) -> Result:
    return CliRunner().invoke(main, command.split())


def checked(command: str) -> Result:
    """A command that must end as it should."""
    done = called(command)
    assert isinstance(done.exception, SystemExit | None), (command, done.exception)
    assert done.exit_code in (0, 1, 2), (command, done.output)
    assert "Traceback" not in done.output
    assert not control_characters(done.output), (command, done.output)
    if done.exit_code == 0:
        assert not undefined(done.output), (command, done.output)
    return done


def put(content: Content, *, believed: bool) -> bool:
    """Put it at ``changed.nc``, with a checksum of its own where it is to be ``believed``; whether that can be."""
    Path("again.nc").unlink(missing_ok=True)
    shutil.rmtree("changed.nc.parts", ignore_errors=True)
    try:
        write(content, Path("changed.nc"))
    except Exception:  # netCDF itself refuses what was made up
        return False
    if believed:
        try:
            checksum = load(Path("changed.nc")).checksum()
        except ValueError:  # it cannot even be read, or holds what no text is
            return True
        with netCDF4.Dataset("changed.nc", "a") as file:
            file.checksum = checksum
    return True


@settings(deadline=None, max_examples=EXAMPLES)
@given(
    name=st.sampled_from(sorted(RESULTS)),
    changed=st.lists(CHANGES, min_size=1, max_size=3),
    command=st.sampled_from(OF_RESULT),
    believed=st.booleans(),
)
def test_no_change_of_a_result_leads_to_a_traceback(
    folder: Path, name: str, changed: list[Callable[[Content], None]], command: str, believed: bool
) -> None:
    content = copy.deepcopy(content_of(Path(f"{name}.nc")))
    for change in changed:
        change(content)
    if put(content, believed=believed):
        checked(command.format(name))


@settings(deadline=None, max_examples=EXAMPLES)
@given(
    name=st.sampled_from(["ensemble", "table", "map"]),
    changed=st.lists(CHANGES, min_size=1, max_size=3),
    which=st.integers(0, 1),
)
def test_no_change_of_an_ensemble_or_a_map_leads_to_a_traceback(
    folder: Path, name: str, changed: list[Callable[[Content], None]], which: int
) -> None:
    content = copy.deepcopy(content_of(Path(f"{name}.nc")))
    for change in changed:
        change(content)
    if put(content, believed=False):
        checked(OF_INPUT[0 if name == "table" else which].format(name))


def attribute(name: str, value: Any) -> Callable[[Content], None]:
    return lambda content: content.attrs.update({name: value})


def without(name: str) -> Callable[[Content], None]:
    return lambda content: content.attrs.pop(name)


def values(name: str, value: Any) -> Callable[[Content], None]:
    return lambda content: content.variables[name].values.fill(value)


def all_failed(content: Content) -> None:
    runs = content.variables["status"].dims
    content.variables["status"].values[...] = 1
    for name, (dims, values, _) in content.variables.items():
        if (
            dims in (runs, (*runs, "step"))
            and values.dtype.kind == "f"
            and name not in ("separation", "realization_count")
        ):
            values[...] = np.nan


def remarked(content: Content) -> None:
    dims, status = content.variables["status"][:2]
    remarks = np.full(status.shape, "OutOfRange: no", dtype=object)
    content.variables["remark"] = Variable(dims, remarks, {})


def only(*names: str) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        for name in names:
            del content.variables[name]

    return change


DEEP = f"{'x.' * 200}y = 1"
KNOWN: list[tuple[str, list[Callable[[Content], None]], str, str]] = [
    ("ensemble", [attribute("patch", "1 mm")], OF_INPUT[0], "attribute patch is '1 mm'; it must be a finite number"),
    ("ensemble", [attribute("patch", 1e200), without("nominal_area")], OF_INPUT[0], "patch, squared, is inf"),
    ("ensemble", [attribute("warnings", 3)], OF_INPUT[0], "attribute warnings is "),
    ("ensemble", [attribute("shape", ["cone"] * 2)], OF_INPUT[0], "attribute shape is "),
    ("map", [attribute("periodic", "yes")], OF_INPUT[0], "periodic is 'yes'; it must be 0 or 1"),
    *[("curves", [attribute("scene", DEEP)], command, "nested too deeply") for command in OF_RESULT],
    *[("curves", [attribute("scene", "[" * 5000)], command, "not valid TOML") for command in OF_RESULT],
    ("curves", [attribute("scene", "batch = 3")], OF_RESULT[0], "batch in its scene is no table"),
    ("curves", [attribute("scene", "sweep = 3")], OF_RESULT[5], "sweep in its scene is no table"),
    ("curves", [attribute("seed", "one")], OF_RESULT[0], "seed is no whole number"),
    ("curves", [attribute("accuracy", 1.0)], OF_RESULT[0], "the attribute accuracy is no text"),
    ("curves", [values("branch", "sideways")], OF_RESULT[2], "branch must be loading or unloading"),
    ("curves", [values("force", np.nan)], OF_RESULT[0], "force is not finite, and status says that it was computed"),
    ("curves", [values("status", 7)], OF_RESULT[0], "status must be 0, 1 or 2"),
    ("curves", [only("force", "contact_area", "contact_count", "stiffness")], OF_RESULT[2], "it holds none of force"),
    ("statistics", [only("force_sem")], OF_RESULT[0], "it holds force_mean but no force_sem"),
    ("statistics", [values("realization_count", np.nan)], OF_RESULT[0], "realization_count must be at least 0"),
    ("accuracy", [values("accuracy_method", 7)], OF_RESULT[1], "accuracy_method holds a number that is none of its"),
    *[
        ("curves", [all_failed, remarked], command, "nothing to draw: no run was computed")
        for command in OF_RESULT[2:4]
    ],
]


@pytest.mark.parametrize(("name", "changed", "command", "says"), KNOWN)
def test_what_is_wrong_is_said(
    folder: Path, name: str, changed: list[Callable[[Content], None]], command: str, says: str
) -> None:
    content = content_of(Path(f"{name}.nc"))
    for change in changed:
        change(content)
    assert put(content, believed=True)
    done = checked(command.format(name))
    assert done.exit_code == 2
    assert says in done.output


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_all_of_whose_runs_failed_is_told(folder: Path, name: str) -> None:
    content = content_of(Path(f"{name}.nc"))
    all_failed(content)
    remarked(content)
    assert put(content, believed=True)
    done = checked("info changed.nc")
    assert done.exit_code == 0, done.output
    for text in ("failed (OutOfRange: no)", "not known: no run was computed"):
        assert text in done.output
    assert "done" not in checked("info changed.nc --cells").output


def odd(content: Content) -> None:
    """All that is in words, and that no command takes for more than words, holds what a terminal acts on."""
    for name in ("title", "source", "history", "packages", "left_out", "versions", "long_name", "comment"):
        content.attrs[name] = f"{name} {TEXT}"
    for name in ("warnings", "accuracy"):
        content.attrs[name] = f"a line\n{TEXT}\n{TEXT}"
    content.attrs["scene"] = f"{content.attrs.get('scene', '')}\n# \x9b2J \x85 \u202e\n"  # the others are not TOML
    for name, (dims, values, attrs) in list(content.variables.items()):
        attrs["long_name"] = attrs["comment"] = TEXT
        if dims in ((name,), ("cell",)) and values.dtype.kind == "f" and name.startswith(("adhesion", "asperities")):
            texts = np.array([f"{number} {TEXT}" for number in values], dtype=object)
            content.variables[name] = Variable(dims, texts, {"units": TEXT})
    content.variables["odd\x9b\u202e"] = Variable((), np.array(1.0), {"units": TEXT})


@pytest.mark.parametrize("name", [*RESULTS, "ensemble", "table", "map"])
@pytest.mark.parametrize("failed", [False, True])
def test_nothing_in_a_file_reaches_a_terminal(folder: Path, name: str, failed: bool) -> None:
    """Not what colours, moves, renames the window or turns the text round; files that are shown, not refused."""
    content = content_of(Path(f"{name}.nc"))
    odd(content)
    if name in RESULTS and failed:
        all_failed(content)
        remarked(content)
        content.variables["remark"].values[...] = f"OutOfRange: {TEXT}"
    assert put(content, believed=True)
    if name not in RESULTS:
        commands = OF_INPUT[:1] if name == "table" else (*OF_INPUT, "plan {}.toml")
    else:
        commands = (*OF_RESULT, "plan changed.nc") if name == "curves" and not failed else OF_RESULT[:3]
    said = [checked(command.format(name)) for command in commands]
    assert said[0].exit_code == 0, said[0].output
    if name != "map":  # which has no words that are shown
        assert "\\x1b[31m" in "".join(done.output for done in said)


@pytest.mark.parametrize("name", [*RESULTS, "ensemble", "table", "map"])
def test_nothing_in_what_is_refused_reaches_a_terminal(folder: Path, name: str) -> None:
    """One word after the other is replaced: attributes, names of variables and dimensions, texts."""
    whole = content_of(Path(f"{name}.nc"))
    command = ("info changed.nc" if name in RESULTS else OF_INPUT[0]).format(name)
    for owner in ("", *whole.variables):
        for attribute in whole.variables[owner].attrs if owner else whole.attrs:
            content = copy.deepcopy(whole)
            (content.variables[owner].attrs if owner else content.attrs)[attribute] = TEXT
            if put(content, believed=False):
                checked(command)
    for owner in whole.variables:
        renamed, filled = copy.deepcopy(whole), copy.deepcopy(whole)
        renamed.variables[f"{owner}\x9b\u202e"] = renamed.variables.pop(owner)
        dims, values, attrs = filled.variables[owner]
        filled.variables[owner] = Variable(dims, np.full(values.shape, TEXT, dtype=object), attrs)
        for content in (renamed, filled):
            if put(content, believed=False):
                checked(command)


def test_nothing_in_a_scene_or_a_name_reaches_a_terminal(folder: Path) -> None:
    odd_name = "n\x1b[31m\x9b\u202e"
    quoted = "".join(f"\\u{ord(letter):04x}" for letter in TEXT)
    for text in (
        f'"{quoted}" = 1\n',
        f'title = "{quoted}"\n',
        f'[asperities]\nsource = "{quoted}"\n',
        f'[asperities]\nsource = "random"\nshape = "{quoted}"\n"{quoted}" = "{quoted}"\n',
        f'[asperities]\nsource = "file"\nfile = "{quoted}"\n',
        f'[sweep]\n"{quoted}" = ["{quoted}"]\n',
        f"# {odd_name} \n",
    ):
        Path(f"{odd_name}.toml").write_text(text)
        for command in (
            "plan {}.toml",
            "run {}.toml -o {}.nc",
            "info {}.toml",
            "plot {}.nc -o {}.png",
            "{}",
            "info {} {}",
        ):
            done = CliRunner().invoke(main, [part.replace("{}", odd_name) for part in command.split()])
            assert done.exit_code == 2
            assert not control_characters(done.output), done.output
    Path(f"{odd_name}.toml").write_text(Path("curves.toml").read_text())
    done = CliRunner().invoke(main, ["run", f"{odd_name}.toml", "-o", f"{odd_name}.nc"])
    assert done.exit_code == 0, done.output
    assert not control_characters(done.output)


@pytest.fixture
def special(folder: Path, tmp_path: Path) -> dict[str, Path]:
    """What is no ordinary file."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    (tmp_path / "round").symlink_to(tmp_path / "round")
    names = "pipe", "link", "round"
    return {"/dev/zero": Path("/dev/zero"), "/dev/null": Path("/dev/null"), "folder": tmp_path} | {
        name: tmp_path / name for name in names
    }


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/null", "folder", "pipe", "link", "round"])
def test_what_is_no_ordinary_file_is_not_read(folder: Path, special: dict[str, Path], name: str) -> None:
    path = special[name]
    says = {"folder": "is a folder; expected a file", "round": "cannot be read: Too many levels"}.get(
        name, "no ordinary"
    )
    assert says in checked(f"info {path}").output
    assert says in checked(f"generate {path} -o made.nc").output
    assert says in checked(f"plot {path} -o picture.png").output
    for source in ("ensemble", "map"):
        done = checked(f"generate {source}.toml -o made.nc --set asperities.file={path}")
        assert done.exit_code == 2
        assert says in done.output


def command(*arguments: str, **how: Any) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([*ROUGHMDR, *arguments], stderr=subprocess.PIPE, text=True, timeout=120, check=False, **how)


def test_a_scene_may_come_through_a_pipe(folder: Path) -> None:
    text = Path("curves.toml").read_text()
    done = command("plan", "/dev/stdin", cwd=folder, input=text, stdout=subprocess.PIPE)
    assert (done.returncode, "A small scene" in done.stdout) == (0, True), done.stderr
    endless = subprocess.Popen(["yes", "#"], stdout=subprocess.PIPE)
    with endless:
        done = command("plan", "/dev/stdin", cwd=folder, stdin=endless.stdout, stdout=subprocess.PIPE)
        endless.kill()
    assert (done.returncode, "longer than 16777216 bytes" in done.stderr) == (2, True), done.stderr


@pytest.mark.parametrize("arguments", [["info", "curves.nc"], ["plan", "curves.toml"], ["info", "none.nc"]])
def test_a_full_disk_behind_the_output_is_told_in_one_line(folder: Path, arguments: list[str]) -> None:
    with open("/dev/full", "w") as full:
        done = command(*arguments, cwd=folder, stdout=full)
    assert done.returncode == 2
    said = "none.nc: no such file" if "none.nc" in arguments else "the standard output cannot be written: No space left"
    assert [said in line for line in done.stderr.splitlines()] == [True]


def test_letters_that_an_output_lacks_are_spelt(folder: Path) -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = command("info", "curves.nc", cwd=folder, stdout=subprocess.PIPE, env=environment)
    assert (done.returncode, "\\xb1" in done.stdout) == (0, True), done.stderr


def test_the_end_of_the_memory_is_told_in_one_line(folder: Path) -> None:
    limited = ["sh", "-c", 'ulimit -v 4000000; exec "$@"', "sh", *ROUGHMDR]
    asked = ["generate", "curves.toml", "-o", "huge.nc", "--set", "asperities.count=1000000000"]
    done = subprocess.run([*limited, *asked], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert "roughmdr: out of memory: Unable to allocate" in done.stderr
    assert not (folder / "huge.nc").exists()
