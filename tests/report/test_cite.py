"""The papers behind results: those that apply and no others, each told once, in words and for BibTeX."""

import re
from contextlib import chdir
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from command import roughmdr, said
from forms import large
from pydantic import TypeAdapter
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.ensemble import SOURCES, Asperities
from roughmdr.kernels.adhesion import PAPERS
from roughmdr.shapes import SHAPES
from roughmdr.stages import STAGES

BIB = (Path(rm.__file__).parent / "report/papers.bib").read_text("ascii")
WITHOUT_DOI = {
    "Etsion2005",
    "Shield1955",
    "EasonShield1960",
    "Barber2003",
    "Cattaneo1938",
    "Mindlin1949",
    "MindlinDeresiewicz1953",
    "Jaeger1995",
    "Masing1926",
    "Yashima2015",
}
"""Papers whose DOI is not certain, or which have none."""
SOFTWARE = {"Harris2020", "Lam2015", "Virtanen2020", "Hoyer2017", "Rocklin2015"}
ALWAYS = {"Hess2012", "PopovHess2015", "Sneddon1965", *SOFTWARE}
GAUSSIAN = {"LonguetHiggins1957", "Nayak1971", "Greenwood2006", "Greenwood1966", "Hertz1882"}
FEW = {**ASPERITIES, "count": 20}
DRAWN = {key: value for key, value in FEW.items() if key != "radius"}
ONCE = {"path": {"separation": ["2 um", "1 um"]}, "batch": None}


def keys(text: str) -> set[str]:
    found = re.findall(r"^@\w+\{(\w+),$", text, flags=re.MULTILINE)
    assert found[0] == "roughmdr"
    assert len(set(found)) == len(found)
    return set(found[1:])


def entries() -> dict[str, dict[str, str]]:
    """The fields of each entry of papers.bib, and its kind, by its key; no line of an entry is anything else."""
    found = {}
    for kind, key, body in re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}$", BIB, flags=re.DOTALL | re.MULTILINE):
        fields = re.findall(r"^  (\w+) = \{(.*)\},?$", body, flags=re.MULTILINE)
        assert len(fields) == body.count("\n")
        assert key not in found
        found[key] = {"kind": kind, **dict(fields)}
    assert len(found) == BIB.count("@")
    return found


def test_each_paper_is_declared_once_and_whole() -> None:
    every = entries()
    known = [paper["doi"] for paper in every.values() if "doi" in paper]
    assert len(set(known)) == len(known)
    assert {key for key, paper in every.items() if "doi" not in paper} == WITHOUT_DOI
    for key, paper in every.items():
        assert key == f"{re.sub('[^A-Za-z]', '', key)}{paper['year']}"
        venue = {"article": "journal", "book": "publisher", "inproceedings": "booktitle"}[paper["kind"]]
        assert all((paper["author"], paper["title"], paper[venue]))
        assert "doi" not in paper or re.fullmatch(r"10\.\d{4,}/\S+", paper["doi"])
        assert paper["kind"] != "article" or paper["volume"]


def test_what_is_cited_is_there() -> None:
    of_models = {key for keys in PAPERS.values() for key in keys}
    cited = of_models.union(*(each.papers for each in (*STAGES, *SHAPES.values(), *SOURCES.values())))
    assert cited <= entries().keys()
    assert {each.papers.get("Kendall1971") for each in SHAPES.values()} == {None, "adhesion"}
    schema = TypeAdapter[rm.Scene](Asperities).json_schema()
    assert SOURCES.keys() == schema["discriminator"]["mapping"].keys()


def test_papers_in_docstrings_are_the_same() -> None:
    """Volume, first page and year as the code cites them beside its formulas."""
    code = re.sub(r"\s+", " ", " ".join(path.read_text() for path in Path(rm.__file__).parent.rglob("*.py")))
    cited = 0
    for key, paper in entries().items():
        name = paper["author"].replace("{\\ss}", "ß").replace('{\\"a}', "ä").split(" and ")[0].split()[-1]
        first = paper.get("pages", "").partition("-")[0]
        places = re.findall(rf"{re.escape(name)}[^()]{{0,80}}? (\d+)\s?\((\d{{4}})\),? (R?\d+)\b", code)
        of_year = [(volume, page) for volume, year, page in places if year == paper["year"]]
        cited += bool(of_year)
        assert not of_year or (paper.get("volume"), first) in of_year, key
    assert cited >= 8


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            {"output": {"variables": ["conductance_radius"]}},
            {"Hertz1882", "Johnson1971", "Greenwood1966", "Holm1967", "Barber2003"},
        ),
        ({}, {"Hertz1882", "Johnson1971", "Greenwood1966"}),
        ({"adhesion": None}, {"Hertz1882", "Greenwood1966"}),
        ({"adhesion": {"model": "jkr", "work": 0.0}}, {"Hertz1882", "Greenwood1966"}),
        (
            {"adhesion": {"model": "dugdale", "work": 0.05, "strength": "5 MPa"}},
            {"Hertz1882", "Maugis1992", "Dugdale1960", "Tabor1977", "Greenwood1966"},
        ),
        large(
            {"asperities": {**DRAWN, "shape": "flat_punch", "radius": "2 um"}},
            {"Johnson1971", "Kendall1971", "Greenwood1966"},
        ),
        (
            {"sweep": {"adhesion.work": [0.0, 0.05], "asperities.shape": ["sphere", "paraboloid"]}},
            {"Hertz1882", "Johnson1971", "Greenwood1966"},
        ),
        (
            {"asperities": {"source": "nayak", "patch": "0.2 mm", "m0": "1 um^2", "m2": 0.02, "m4": 5e9}},
            {"Johnson1971", *GAUSSIAN},
        ),
        (
            {"adhesion": None, "interaction": {"model": "pairwise"}, **ONCE},
            {"Hertz1882", "Greenwood1966", "Ewald1921"},
        ),
        (
            {"adhesion": None, "interaction": {"model": "pairwise", "boundary": "free"}, **ONCE},
            {"Hertz1882", "Greenwood1966"},
        ),
        (
            {"adhesion": None, "interaction": {"model": "mean_field"}, **ONCE},
            {"Hertz1882", "Greenwood1966", "Ciavarella2008"},
        ),
        (
            {"adhesion": None, "reference": {"model": "boundary_elements", "error": 0.5}, **ONCE},
            {"Hertz1882", "Greenwood1966", "Polonsky1999", "Stanley1997"},
        ),
    ],
)
def test_the_papers_that_apply(tmp_path: Path, changes: dict[str, Any], expected: set[str]) -> None:
    table = scene(**{"asperities": FEW, "batch": {"realizations": 2}, **changes})
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(table))
    assert keys(rm.cite(tmp_path / "scene.toml", bibtex=True)) == ALWAYS | expected
    result = rm.run(tmp_path / "scene.toml")
    assert keys(rm.cite(result, bibtex=True)) == ALWAYS | expected


def test_auto_names_what_was_used_in_a_result() -> None:
    table = scene(asperities=FEW, batch=None, adhesion={"model": "auto", "work": 0.05, "strength": "5 GPa"})
    both = {"Hertz1882", "Johnson1971", "Maugis1992", "Dugdale1960", "Tabor1977", "Greenwood1966"}
    assert keys(rm.cite(_read(table), bibtex=True)) == ALWAYS | both
    assert keys(rm.cite(rm.run(table), bibtex=True)) == ALWAYS | both - {"Maugis1992", "Dugdale1960"}


def _read(table: dict[str, Any]) -> rm.Scene:
    from roughmdr.scene import read

    return read(table)


def test_the_command_says_the_same(tmp_path: Path) -> None:
    with chdir(tmp_path):
        Path("scene.toml").write_text(tomli_w.dumps(scene(asperities=FEW, batch=None)))
        rm.run("scene.toml", "out.nc")
        for options in ([], ["--bibtex"]):
            for name in ("scene.toml", "out.nc"):
                assert said("cite", name, *options) == f"{rm.cite(name, bibtex=bool(options))}\n"
        lines = rm.cite("out.nc").splitlines()
        assert lines[0] == f"program      roughmdr {rm.__version__}"
        assert "adhesion     K. L. Johnson, K. Kendall, A. D. Roberts. Surface energy" in "\n".join(lines)
        assert f"version = {{{rm.__version__}}}" in rm.cite("out.nc", bibtex=True)
        for name in ("none.nc", "none.toml"):
            done = roughmdr("cite", name)
            assert (done.returncode, "no such file" in done.stderr) == (2, True)


def test_bibtex_holds_plain_letters() -> None:
    text = rm.cite(_read(scene(asperities=FEW, batch=None)), bibtex=True)
    assert text.isascii()
    assert text.count("{") == text.count("}")
    assert "author = {K. L. Johnson and K. Kendall and A. D. Roberts}" in text
    assert "pages = {301--313}" in text
