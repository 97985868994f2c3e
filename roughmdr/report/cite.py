"""The papers behind a result or a scene: those of the models, surfaces and programs that it uses, and no others."""

import os
import re
from collections.abc import Collection, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from roughmdr.ensemble import SOURCES
from roughmdr.fitting.stored import given_fit
from roughmdr.kernels.adhesion import PAPERS
from roughmdr.result.given import given_result
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene, read
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.quantities import adheres
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import printable
from roughmdr.shapes import SHAPES
from roughmdr.stages import STAGES, stages_in

if TYPE_CHECKING:
    import xarray as xr

_Named = TypeVar("_Named")
_PROGRAM = "roughmdr"
_SOFTWARE = ("Harris2020", "Lam2015", "Virtanen2020", "Hoyer2017", "Rocklin2015")
_LETTERS = {"``": "“", "''": "”", "{\\ss}": "ß", '{\\"a}': "ä", '{\\"o}': "ö", '{\\"u}': "ü", "{\\'e}": "é", "--": "-"}
"""Letters to read, by how papers.bib spells them."""


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
    entries, cited = _entries(), _cited(_Used(parse_toml(scene), result))
    keys = sorted(cited, key=list(entries).index)
    version = "" if result is None else printable(str(result.attrs["source"])).removeprefix(f"{_PROGRAM} ")
    if bibtex:
        stated = f",\n  version = {{{version}}}" if version else ""
        program = f"@misc{{{_PROGRAM},\n  title = {{{_PROGRAM}}}{stated},\n  howpublished = {{Software}}\n}}"
        return "\n\n".join([program, *(entries[key] for key in keys)])
    lines, before = [f"{'program':<12} {_PROGRAM} {version}".rstrip()], ""
    for key in keys:
        lines.append(f"{cited[key] if cited[key] != before else '':<12} {_line(entries[key])}")
        before = cited[key]
    return "\n".join(lines)


class _Used(NamedTuple):
    """Parts that a scene uses in any of its cells; of a result those that were used indeed."""

    table: dict[str, Any]
    result: ResultView | None

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


def _cited(used: _Used) -> dict[str, str]:
    """Return what each paper is cited for, by its key in papers.bib."""
    cited = {"Hess2012": "mapping", "PopovHess2015": "mapping", "Sneddon1965": "contact"}
    models = used.adhesion_models
    for shape in _named(SHAPES, used.shapes):
        cited |= {key: reason for key, reason in shape.papers.items() if models or reason != "adhesion"}
    for keys in _named(PAPERS, models):
        cited |= dict.fromkeys(keys, "adhesion")
    if models and (used.values("adhesion.strength") or used.values("adhesion.range")):
        cited["Tabor1977"] = "adhesion"
    if not used.hills:
        cited["Greenwood1966"] = "roughness"
        for source in _named(SOURCES, used.sources):
            cited |= source.papers
    if used.values("asperities.hurst"):
        cited["Persson2005"] = "roughness"
    for stage in STAGES:
        cited |= stage.cites(used.table, list(used.table.get("output", {}).get("variables", ())))
    return cited | _of_coupling(used) | dict.fromkeys(_SOFTWARE, "software")


def _of_coupling(used: _Used) -> dict[str, str]:
    """Return that of papers on contacts that feel each other, and on boundary elements."""
    cited = {}
    models, boundaries = used.values("interaction.model"), used.values("interaction.boundary") or ["periodic"]
    if "pairwise" in models and "periodic" in boundaries:
        cited["Ewald1921"] = "interaction"
    if "mean_field" in models:
        cited["Ciavarella2008"] = "interaction"
    if used.grid:
        cited["Polonsky1999"] = "elements"
        if "periodic" in boundaries:
            cited["Stanley1997"] = "elements"
        if "free" in boundaries or ("surface" in used.sources and "interaction" not in used.table):
            cited["Love1929"] = "elements"
    return cited


def _named(table: Mapping[str, _Named], names: Collection[str]) -> list[_Named]:
    """Return the entries of a table that have one of these names; another version may know more names."""
    return [entry for name, entry in table.items() if name in names]


@cache
def _entries() -> dict[str, str]:
    """Return the entries of papers.bib by their keys."""
    text = files("roughmdr.report").joinpath("papers.bib").read_text("ascii")
    return {entry[1]: entry[0] for entry in re.finditer(r"^@\w+\{(\w+),$.*?^\}$", text, flags=re.DOTALL | re.MULTILINE)}


def _line(entry: str) -> str:
    """Return an entry as one line to read."""
    for spelt, letter in _LETTERS.items():
        entry = entry.replace(spelt, letter)
    fields = dict(re.findall(r"^  (\w+) = \{+(.*?)\}+,?$", entry, flags=re.MULTILINE))
    authors = ", ".join(fields["author"].split(" and ")).replace(", others", " and others")
    venue = next(fields[name] for name in ("journal", "booktitle", "publisher") if name in fields)
    parts = (venue, fields.get("volume"), f"({fields['year']})", fields.get("pages"))
    doi = f" doi:{fields['doi']}" if "doi" in fields else ""
    return f"{authors}. {fields['title']}. {' '.join(filter(None, parts))}.{doi}"
