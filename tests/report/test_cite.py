"""The papers behind results: those that apply and no others, each told once, in words and for BibTeX."""

import re
from contextlib import chdir
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from click.testing import CliRunner
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.report import citations
from roughmdr.report.citations import SOFTWARE, Paper
from roughmdr.report.citations_of_stages import OF_STAGES

PAPERS = [*(each for each in vars(citations).values() if isinstance(each, Paper)), *OF_STAGES.values()]
WITHOUT_DOI = {"Barber2003", "Cattaneo1938", "Mindlin1949", "MindlinDeresiewicz1953", "Jaeger1995", "Masing1926"}
"""Those whose DOI is not certain, or which have none."""
ALWAYS = {"Hess2012", "PopovHess2015", "Sneddon1965", *(paper.key for paper in SOFTWARE.values())}
GAUSSIAN = {"LonguetHiggins1957", "Nayak1971", "Greenwood2006", "Greenwood1966", "Hertz1882"}
FEW = {**ASPERITIES, "count": 20}
DRAWN = {key: value for key, value in FEW.items() if key != "radius"}
ONCE = {"path": {"separation": ["2 um", "1 um"]}, "batch": None}


def keys(text: str) -> set[str]:
    found = re.findall(r"^@\w+\{(\w+),$", text, flags=re.MULTILINE)
    assert found[0] == "roughmdr"
    assert len(set(found)) == len(found)
    return set(found[1:])


def test_each_paper_is_declared_once_and_whole() -> None:
    every = [*PAPERS, *SOFTWARE.values()]
    known = [paper.doi for paper in every if paper.doi]
    assert len({paper.key for paper in every}) == len(every)
    assert len(set(known)) == len(known)
    assert {paper.key for paper in every if not paper.doi} == WITHOUT_DOI
    for paper in every:
        assert paper.key == f"{re.sub('[^A-Za-z]', '', paper.key)}{paper.year}"
        assert all((paper.authors, paper.title, paper.venue))
        assert not paper.doi or re.fullmatch(r"10\.\d{4,}/\S+", paper.doi)
        assert paper.kind != "article" or paper.volume


def test_papers_in_docstrings_are_the_same() -> None:
    """Volume, first page and year as the code cites them beside its formulas."""
    code = " ".join(path.read_text() for path in Path(rm.__file__).parent.rglob("*.py") if path.name != "citations.py")
    code = re.sub(r"\s+", " ", code)
    cited = 0
    for paper in PAPERS:
        name = re.escape(paper.authors[0].split()[-1])
        first = paper.pages.partition("-")[0]
        places = re.findall(rf"{name}[^()]{{0,80}}? (\d+)\s?\((\d{{4}})\),? (R?\d+)\b", code)
        of_year = [(volume, page) for volume, year, page in places if year == str(paper.year)]
        cited += bool(of_year)
        assert not of_year or (paper.volume, first) in of_year, paper.key
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
                done = CliRunner().invoke(main, ["cite", name, *options])
                assert done.exit_code == 0, done.output
                assert done.output == f"{rm.cite(name, bibtex=bool(options))}\n"
        lines = rm.cite("out.nc").splitlines()
        assert lines[0] == f"program      roughmdr {rm.__version__}"
        assert "adhesion     K. L. Johnson, K. Kendall, A. D. Roberts. Surface energy" in "\n".join(lines)
        assert f"version = {{{rm.__version__}}}" in rm.cite("out.nc", bibtex=True)
        for name, says in (("none.nc", "no such file"), ("none.toml", "no such file")):
            done = CliRunner().invoke(main, ["cite", name])
            assert done.exit_code == 2
            assert says in done.output


def test_bibtex_holds_plain_letters() -> None:
    text = rm.cite(_read(scene(asperities=FEW, batch=None)), bibtex=True)
    assert text.isascii()
    assert text.count("{") == text.count("}")
    assert "author = {K. L. Johnson and K. Kendall and A. D. Roberts}" in text
    assert "pages = {301--313}" in text
