"""Advice on a map: which of its summits, its hills and boundary elements to believe, and why."""

from typing import Any

from roughmdr.ensemble.maps.resolution import MAX_HILLS_ERROR, MAX_SUMMITS_ERROR
from roughmdr.schema.quantities import adheres
from roughmdr.schema.toml_text import parse_toml

_OF_MAPS = ("surface", "spectrum")
_USELESS = 0.3
"""Error by the resolution of a map beyond which no model of it is to be believed."""
_HILLS = "hills in pairs are within 3 % r.m.s. of them from 0.3 to 20 % contact, 6 % where waves are four times as long"
_SUMMITS = "summits are 14 % off in pairs and 32 % alone, since their flanks are no paraboloids"
_TOO_COARSE = 'asperities.model = "hills" tells whether it is too coarse for hills and boundary elements too'
_TO_HILLS = 'take asperities.model = "hills" with [interaction] model = "pairwise"'


def advice_on(scene: str, resolution_error: float) -> str:
    """Return the advice on a scene, as TOML, whose asperities are found on maps; empty for others.

    ``resolution_error`` is that of the force by the resolution of the map [1]. The figures are measured
    (``pipelines/study.py hills``, ``pipelines/study.py adhesive_hills``).
    """
    table = parse_toml(scene)
    asperities = table.get("asperities", {})
    if not isinstance(asperities, dict) or asperities.get("source") not in _OF_MAPS:
        return ""
    model = asperities.get("model", "summits" if asperities["source"] == "surface" else "hills")
    coupled = table.get("interaction", {}).get("model") == "pairwise"
    which = _which(table, model, coupled)
    if resolution_error <= (MAX_SUMMITS_ERROR if model == "summits" else MAX_HILLS_ERROR):
        return which
    finer, useless = _finer(asperities), resolution_error > _USELESS
    if model == "summits":
        opening = "do not believe the summits; " if useless else ""
        coarse = f"{opening}the map is too coarse or noisy for its summits: {finer}"
        return f"{coarse}; as far as it goes, {which}; {_TOO_COARSE}"
    if useless:
        return f"believe neither hills nor boundary elements; the map is too coarse for both: {finer}"
    return f"the map is too coarse for hills and boundary elements alike: {finer}; as far as it goes, {which}"


def _finer(asperities: dict[str, Any]) -> str:
    """Return what helps a map that is too coarse or noisy."""
    if asperities["source"] == "spectrum":
        return "raise asperities.points"
    return "a finer map helps" if "cutoff" in asperities else "a finer map or a cutoff of known noise helps"


def _which(table: dict[str, Any], model: object, coupled: bool) -> str:
    """Return which of the three to believe."""
    if adheres(table):
        believed = (
            "believe hills in pairs as far as they have values, in unloading: their pull-off is 10 % off in the "
            "median, 50 % at worst; boundary elements are without adhesion here, and"
        )
        if model == "hills" and coupled:
            return f"{believed} without it {_SUMMITS}"
        return f"{believed} without it {_SUMMITS}; {_TO_HILLS}"
    if "reference" in table:
        return "believe boundary elements, which press the map itself; the asperities are right as far as they agree"
    ask = "ask for them with --set reference.model=boundary_elements"
    if model == "hills" and coupled:
        return f"believe boundary elements most, which press the map itself ({ask}); {_HILLS}"
    return f"believe boundary elements, which press the map itself ({ask}), or {_TO_HILLS}: {_HILLS}; {_SUMMITS}"
