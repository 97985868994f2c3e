"""The public API explains itself: numpydoc sections in order, every parameter described, examples that run."""

import doctest
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import roughmdr as rm
from roughmdr.analysis.accessor import Analysis

ROOMS = ("aggregate", "asperity", "errors", "fitting", "schema", "spectrum", "theory")
"""The rooms whose public names are described in sections."""
SECTIONS = ("Parameters", "Returns", "Raises", "References", "Examples")


def public() -> Iterator[tuple[str, Any]]:
    """Every public name, with what it stands for."""
    for name in dir(rm):
        if name not in ("spectrum", "theory", "__version__"):
            yield name, getattr(rm, name)
    for module in (rm.spectrum, rm.theory):
        for name in module.__all__:
            yield f"{module.__name__.removeprefix('roughmdr.')}.{name}", getattr(module, name)


PUBLIC = dict(public())
FUNCTIONS = {
    name: value
    for name, value in {**PUBLIC, "spectrum.SelfAffine.of": rm.spectrum.SelfAffine.of}.items()
    if not inspect.isclass(value) and value.__module__.split(".")[1] in ROOMS
}


def sections(value: Any) -> dict[str, str]:
    """The sections of a docstring, in order."""
    parts = re.split(r"^(\w[\w ]*)\n-+\n", inspect.getdoc(value) or "", flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_has_a_summary_of_one_line(name: str) -> None:
    summary, *rest = (inspect.getdoc(PUBLIC[name]) or "").splitlines()
    assert len(summary) <= 120
    assert summary[0].isupper() or not summary[0].isalpha() or inspect.isclass(PUBLIC[name])
    if name in FUNCTIONS:
        assert summary.endswith(".")
        assert not rest or not rest[0]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_has_its_sections_in_order(name: str) -> None:
    found = sections(FUNCTIONS[name])
    assert tuple(found) == SECTIONS
    assert all(text.strip() for text in found.values())


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_parameter_is_described(name: str) -> None:
    entries = re.findall(r"^(\S.*?)(?: :.*)?$", sections(FUNCTIONS[name])["Parameters"], flags=re.MULTILINE)
    described = [entry.lstrip("*") for line in entries for entry in line.split(", ")]
    assert sorted(described) == sorted(inspect.signature(FUNCTIONS[name]).parameters)


@pytest.mark.parametrize("name", PUBLIC)
def test_the_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for example in doctest.DocTestFinder().find(PUBLIC[name], name, globs={}):
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
        said: list[str] = []
        runner.run(example, out=said.append)
        assert not runner.failures, "".join(said)


def test_the_examples_of_the_accessor_run() -> None:
    """Examples of the methods use ``result``, which that of the class has computed."""
    found = {example.name: example for example in doctest.DocTestFinder().find(Analysis, "Analysis", globs={})}
    methods = {name for name in vars(Analysis) if not name.startswith("_")}
    assert {name.removeprefix("Analysis.") for name, each in found.items() if each.examples} == {*methods, "Analysis"}
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    said: list[str] = []
    of_class = found.pop("Analysis")
    runner.run(of_class, out=said.append, clear_globs=False)
    for example in found.values():
        example.globs |= of_class.globs
        runner.run(example, out=said.append)
    assert not runner.failures, "".join(said)


def test_the_signature_is_short() -> None:
    for name, function in FUNCTIONS.items():
        assert len(str(inspect.signature(function))) <= 500, name
