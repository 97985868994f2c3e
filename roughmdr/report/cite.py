"""The papers behind a result or a scene: those of the models, surfaces and programs that it uses, and no others."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.fitting.stored import given_fit
from roughmdr.report import citations as papers
from roughmdr.report.citations import Paper
from roughmdr.report.citations_of_stages import OF_STAGES
from roughmdr.result.given import given_result
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene, read
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.quantities import adheres
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import printable
from roughmdr.stages import STAGES, stages_in

if TYPE_CHECKING:
    import xarray as xr

_ROUND = ("paraboloid", "sphere")
_FLAT = ("flat_punch", "truncated_cone", "truncated_paraboloid")
_PROGRAM = "roughmdr"
_NAMES = {"“": "``", "”": "''", "ß": "{\\ss}", "ä": '{\\"a}', "ö": '{\\"o}', "ü": '{\\"u}'}


@named_keywords
def cite(target: "str | Path | xr.Dataset | Scene", *, bibtex: bool = False) -> str:
    """Return the papers behind a result or a scene, as ``roughmdr cite`` prints them; nothing is printed.

    Parameters
    ----------
    target : path, xarray.Dataset or Scene
        A result or a fit, as a file or as ``run`` or ``fit`` returned it; or a scene, a .toml file or as it was read.
    bibtex : bool, optional
        Whether to return entries of BibTeX in place of lines to read.

    Returns
    -------
    str
        A paper a line, after what it is cited for; or one entry of BibTeX after the other.

    Raises
    ------
    SceneError, StoreError
        Where there is no such file, or no scene or result in it.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "One patch", "material": {"effective_modulus": "1 GPa"}, "path": {"separation": ["3 um", "2 um"]},
    ...     "asperities": {
    ...         "source": "random", "shape": "sphere", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... })
    >>> print(rm.cite(result).splitlines()[3].partition(" and ")[0])
    contact      I. N. Sneddon. The relation between load
    """
    if isinstance(target, Scene):
        return describe_papers(target.toml, None, bibtex=bibtex)
    if isinstance(target, str | os.PathLike) and Path(target).suffix.lower() == ".toml":
        return describe_papers(read(target if isinstance(target, str) else Path(target)).toml, None, bibtex=bibtex)
    if (fit := given_fit(target)) is not None:
        return describe_papers(fit.attrs["scene"], None, bibtex=bibtex)
    result, _ = given_result(target)
    return describe_papers(result.attrs["scene"], result, bibtex=bibtex)


def describe_papers(scene: str, result: ResultView | None, *, bibtex: bool) -> str:
    """Return that text of a scene, as TOML, and of its ``result`` where there is one."""
    used = _Used.of(scene, result)
    told = [*_papers(used), *(("software", paper) for paper in papers.SOFTWARE.values())]
    version = "" if result is None else printable(str(result.attrs["source"])).removeprefix(f"{_PROGRAM} ")
    if bibtex:
        stated = f",\n  version = {{{_escaped(version)}}}" if version else ""
        program = f"@misc{{{_PROGRAM},\n  title = {{{_PROGRAM}}}{stated},\n  howpublished = {{Software}}\n}}"
        return "\n\n".join([program, *(_bibtex(paper) for _, paper in told)])
    lines, before = [f"{'program':<12} {_PROGRAM} {version}".rstrip()], ""
    for reason, paper in told:
        lines.append(f"{reason if reason != before else '':<12} {_line(paper)}")
        before = reason
    return "\n".join(lines)


class _Used(NamedTuple):
    """Parts that a scene uses in any of its cells; of a result those that were used indeed."""

    table: dict[str, Any]
    result: ResultView | None

    @classmethod
    def of(cls, scene: str, result: ResultView | None) -> "_Used":
        """Return what a scene, as TOML, and its result use."""
        return cls(parse_toml(scene), result)

    def values(self, key: str) -> list[Any]:
        """Return the values that a dotted key has, one for each cell that changes it."""
        section, name = key.split(".")
        outer = self.table.get(section, {})
        swept = self.table.get("sweep", {}).get(key)
        if isinstance(swept, dict):
            return [end for ends in swept.values() if isinstance(ends, list) for end in ends]
        if isinstance(swept, list):
            return swept
        return [outer[name]] if isinstance(outer, dict) and name in outer else []

    @property
    def sources(self) -> list[Any]:
        return self.values("asperities.source")

    @property
    def hills(self) -> bool:
        """Whether asperities have the profiles of hills."""
        default = ["hills"] if "spectrum" in self.sources else []
        return "hills" in (self.values("asperities.model") or default)

    @property
    def adhesion_models(self) -> set[str]:
        """The models of adhesion, none without work."""
        if not adheres(self.table):
            return set()
        if self.result is not None and "adhesion_law" in self.result.variables:
            law = self.result.variables["adhesion_law"]
            names = str(law.attrs["flag_meanings"]).split()
            return {names[int(number)] for number in np.unique(law.values[self.result.done])} - {"none"}
        models = set(self.values("adhesion.model"))
        return models - {"auto"} | ({"jkr", "dugdale"} if "auto" in models else set())

    @property
    def shapes(self) -> list[Any]:
        """The shapes of the asperities, as far as the scene tells them."""
        if "random" in self.sources:
            return self.values("asperities.shape")
        return ["paraboloid"] if not self.hills and "file" not in self.sources else []

    @property
    def grid(self) -> bool:
        """Whether boundary elements are used, or may be."""
        if any(stage.on_grid for stage in stages_in(self.table)):
            return True
        if self.result is not None and "grid_points" in self.result.variables:
            return self.result.largest("grid_points") > 0.0
        return self.result is None and "boundary_elements" in self.values("interaction.beyond")


def _papers(used: _Used) -> Iterator[tuple[str, Paper]]:
    """Yield what a paper is cited for, and the paper."""
    yield from _of_contacts(used)
    yield from _of_surfaces(used)
    yield from _of_coupling(used)
    variables = list(used.table.get("output", {}).get("variables", ()))
    for stage in STAGES:
        yield from ((reason, OF_STAGES[key]) for reason, key in stage.papers(used.table, variables))


def _of_contacts(used: _Used) -> Iterator[tuple[str, Paper]]:
    yield from (("mapping", paper) for paper in (papers.HESS, papers.POPOV_HESS))
    yield "contact", papers.SNEDDON
    if any(shape in _ROUND for shape in used.shapes):
        yield "contact", papers.HERTZ
    models = used.adhesion_models
    if "jkr" in models:
        yield "adhesion", papers.JKR
    if models and any(shape in _FLAT for shape in used.shapes):
        yield "adhesion", papers.KENDALL
    if "dugdale" in models:
        yield from (("adhesion", paper) for paper in (papers.MAUGIS, papers.DUGDALE))
    ranged = used.values("adhesion.strength") or used.values("adhesion.range")
    if models and ranged:
        yield "adhesion", papers.TABOR


def _of_surfaces(used: _Used) -> Iterator[tuple[str, Paper]]:
    if not used.hills:
        yield "roughness", papers.GREENWOOD_WILLIAMSON
    if "nayak" in used.sources:
        yield from (("roughness", paper) for paper in (papers.LONGUET_HIGGINS, papers.NAYAK))
    if not used.hills and not {"nayak", "surface", "spectrum"}.isdisjoint(used.sources):
        yield "roughness", papers.GREENWOOD
    if used.values("asperities.hurst"):
        yield "roughness", papers.PERSSON


def _of_coupling(used: _Used) -> Iterator[tuple[str, Paper]]:
    boundaries = used.values("interaction.boundary") or ["periodic"]
    if "pairwise" in used.values("interaction.model") and "periodic" in boundaries:
        yield "interaction", papers.EWALD
    if "mean_field" in used.values("interaction.model"):
        yield "interaction", papers.CIAVARELLA
    if used.grid:
        yield "elements", papers.POLONSKY
        if "periodic" in boundaries:
            yield "elements", papers.STANLEY_KATO
        if "free" in boundaries or ("surface" in used.sources and "interaction" not in used.table):
            yield "elements", papers.LOVE


def _line(paper: Paper) -> str:
    """Return a paper as one line to read."""
    names = ["and others" if name == "others" else name for name in paper.authors]
    authors = ", ".join(names).replace(", and others", " and others")
    where = " ".join(part for part in (paper.venue, paper.volume, f"({paper.year})", paper.pages) if part)
    return f"{authors}. {paper.title}. {where}." + (f" doi:{paper.doi}" if paper.doi else "")


def _bibtex(paper: Paper) -> str:
    """Return a paper as an entry of BibTeX."""
    venue = {"article": "journal", "book": "publisher", "inproceedings": "booktitle"}[paper.kind]
    fields = {
        "author": " and ".join(paper.authors),
        "title": f"{{{paper.title}}}",
        venue: paper.venue,
        "volume": paper.volume,
        "pages": paper.pages.replace("-", "--"),
        "year": str(paper.year),
        "doi": paper.doi,
    }
    lines = [f"  {name} = {{{_escaped(value)}}}" for name, value in fields.items() if value]
    return f"@{paper.kind}{{{paper.key},\n" + ",\n".join(lines) + "\n}"


def _escaped(text: str) -> str:
    for letter, spelt in _NAMES.items():
        text = text.replace(letter, spelt)
    return text
