"""Commands print nothing that a terminal acts on, and one line where they cannot go on."""

import copy
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from command import ROUGHMDR
from foreign import ODD, Content, Variable, content_of, control_characters
from foreign_commands import OF_INPUT, OF_RESULT, RESULTS, all_failed, checked, filled, put, remarked
from forms import large

from roughmdr.cli import main

TEXT = ODD.replace("\x00", "")  # which ends a text in a file


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with filled(tmp_path_factory.mktemp("foreign")) as made:
        yield made


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


@pytest.mark.few(1)
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


@pytest.mark.large
@pytest.mark.parametrize(
    ("name", "every"),
    [
        *((name, False) for name in ("curves", "ensemble", "table", "map")),
        *(large(name, False) for name in RESULTS if name != "curves"),
        *(large(name, True) for name in ("curves", "ensemble")),
    ],
)
def test_nothing_in_what_is_refused_reaches_a_terminal(folder: Path, name: str, every: bool) -> None:
    """One word after the other is replaced: attributes, names of variables and dimensions, texts.

    Of attributes that many variables have in common one is, and one variable in five, unless it is ``every`` one.
    """
    whole = content_of(Path(f"{name}.nc"))
    command = ("info changed.nc" if name in RESULTS else OF_INPUT[0]).format(name)
    owner_of: dict[str, str] = {}
    for owner in ("", *whole.variables):
        for attribute in whole.variables[owner].attrs if owner else whole.attrs:
            if not every and owner_of.setdefault(attribute, owner) != owner:
                continue
            content = copy.deepcopy(whole)
            (content.variables[owner].attrs if owner else content.attrs)[attribute] = TEXT
            if put(content, believed=False):
                checked(command)
    for owner in list(whole.variables)[:: 1 if every else 5]:
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
    """Paths that are no ordinary files."""
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
        name, "not a regular"
    )
    assert says in checked(f"info {path}").output
    assert says in checked(f"generate {path} -o made.nc --fresh").output
    assert says in checked(f"plot {path} -o picture.png").output
    for source in ("ensemble", "map"):
        done = checked(f"generate {source}.toml -o made.nc --fresh --set asperities.file={path}")
        assert done.exit_code == 2
        assert says in done.output


def command(*arguments: str, **how: Any) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([*ROUGHMDR, *arguments], stderr=subprocess.PIPE, text=True, timeout=120, check=False, **how)


@pytest.mark.large
def test_a_scene_may_come_through_a_pipe(folder: Path) -> None:
    text = Path("curves.toml").read_text()
    done = command("plan", "/dev/stdin", cwd=folder, input=text, stdout=subprocess.PIPE)
    assert (done.returncode, "A small scene" in done.stdout) == (0, True), done.stderr
    endless = subprocess.Popen(["yes", "#"], stdout=subprocess.PIPE)
    with endless:
        done = command("plan", "/dev/stdin", cwd=folder, stdin=endless.stdout, stdout=subprocess.PIPE)
        endless.kill()
    assert (done.returncode, "longer than 16777216 bytes" in done.stderr) == (2, True), done.stderr


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "arguments",
    [["info", "curves.nc"], ["plan", "curves.toml"], ["info", "none.nc"], ["--help"], ["run", "--help"], ["--version"]],
)
def test_a_full_disk_behind_the_output_is_told_in_one_line(folder: Path, arguments: list[str]) -> None:
    with open("/dev/full", "w") as full:
        done = command(*arguments, cwd=folder, stdout=full)
    assert done.returncode == 2
    said = "none.nc: no such file" if "none.nc" in arguments else "the standard output cannot be written: No space left"
    assert [said in line for line in done.stderr.splitlines()] == [True]


@pytest.mark.large
def test_letters_that_an_output_lacks_are_spelt(folder: Path) -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = command("info", "curves.nc", cwd=folder, stdout=subprocess.PIPE, env=environment)
    assert (done.returncode, "\\xb1" in done.stdout) == (0, True), done.stderr


@pytest.mark.large
def test_the_end_of_the_memory_is_told_in_one_line(folder: Path) -> None:
    limited = ["sh", "-c", 'ulimit -v 4000000; exec "$@"', "sh", *ROUGHMDR]
    asked = ["generate", "curves.toml", "-o", "huge.nc", "--set", "asperities.count=1000000000"]
    done = subprocess.run([*limited, *asked], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert "roughmdr: out of memory: Unable to allocate" in done.stderr
    assert not (folder / "huge.nc").exists()
