"""Files as anyone may have changed them: every command reads them, or refuses them in words."""

import copy
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign import CHANGES, Change, Content, content_of
from foreign_commands import OF_INPUT, OF_RESULT, RESULTS, all_failed, checked, filled, put, remarked
from hypothesis import given, settings, strategies as st

EXAMPLES = int(os.environ.get("ROUGHMDR_EXAMPLES", "20"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with filled(tmp_path_factory.mktemp("foreign")) as made:
        yield made


@pytest.mark.large
@settings(deadline=None, max_examples=EXAMPLES)
@given(
    name=st.sampled_from(sorted(RESULTS)),
    changed=st.lists(CHANGES, min_size=1, max_size=3),
    command=st.sampled_from(OF_RESULT),
    believed=st.booleans(),
)
def test_no_change_of_a_result_leads_to_a_traceback(
    folder: Path, name: str, changed: list[Change], command: str, believed: bool
) -> None:
    content = copy.deepcopy(content_of(Path(f"{name}.nc")))
    for change in changed:
        change(content)
    if put(content, believed=believed):
        checked(command.format(name))


@pytest.mark.large
@settings(deadline=None, max_examples=EXAMPLES)
@given(
    name=st.sampled_from(["ensemble", "table", "map"]),
    changed=st.lists(CHANGES, min_size=1, max_size=3),
    which=st.integers(0, 1),
)
def test_no_change_of_an_ensemble_or_a_map_leads_to_a_traceback(
    folder: Path, name: str, changed: list[Change], which: int
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
    ("curves", [attribute("scene", "sweep = 3")], OF_RESULT[6], "sweep in its scene is no table"),
    ("curves", [attribute("seed", "one")], OF_RESULT[0], "seed is no whole number"),
    ("curves", [attribute("accuracy", 1.0)], OF_RESULT[0], "the attribute accuracy is no text"),
    ("curves", [values("branch", "sideways")], OF_RESULT[2], "branch must be loading or unloading"),
    ("sweep", [values("asperities_radius", np.inf)], OF_RESULT[0], "asperities_radius is not finite"),
    ("curves", [values("force", np.nan)], OF_RESULT[0], "force is not finite, and status says that it was computed"),
    ("curves", [values("status", 7)], OF_RESULT[0], "status must be 0, 1 or 2"),
    ("curves", [only("force", "contact_area", "contact_count", "stiffness")], OF_RESULT[2], "it has none of force"),
    ("statistics", [only("force_sem")], OF_RESULT[0], "it has force_mean but no force_sem"),
    ("statistics", [values("realization_count", np.nan)], OF_RESULT[0], "realization_count must be at least 0"),
    ("accuracy", [values("accuracy_method", 7)], OF_RESULT[1], "accuracy_method has a value that is none of its"),
    *[
        ("curves", [all_failed, remarked], command, "nothing to draw: no run was computed")
        for command in OF_RESULT[2:4]
    ],
]


@pytest.mark.few(1)
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


def test_the_first_run_that_failed_is_named(folder: Path) -> None:
    said = checked("info sweep.nc").output
    assert re.search(r"4 of 8 runs failed \(adhesion_work = 10 mJ/m\^2, .*, realisation 0: OutOfRange: ", said)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", RESULTS)
def test_a_result_all_of_whose_runs_failed_is_told(folder: Path, name: str) -> None:
    content = content_of(Path(f"{name}.nc"))
    all_failed(content)
    remarked(content)
    assert put(content, believed=True)
    done = checked("info changed.nc")
    assert done.exit_code == 0, done.output
    for text in (
        "OutOfRange: no); the same command tries them again, which helps",
        "not known: no run was computed",
    ):
        assert text in done.output
    assert "done" not in checked("info changed.nc --cells").output
