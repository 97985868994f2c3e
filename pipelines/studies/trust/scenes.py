"""Scenes whose stated error is put to the proof: those that are shipped, sparse, dense and sticky ones, and traps."""

import tomllib
from pathlib import Path
from typing import Any, NamedTuple

from oracles.gaussian_maps import gaussian_map

from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine

Table = dict[str, Any]
VARIABLES = ("force", "contact_fraction", "model_error_curve")
_SHIPPED = Path(__file__).parents[2] / "scenes"
_SEED = 2026


class Surface(NamedTuple):
    """A Gaussian self-affine map."""

    spectrum: SelfAffine
    size: float  # side [m]
    points: int  # a side of the grid that the file holds
    refined: int = 1  # how many points there are for each of these along a side of the grid of boundary elements

    def height(self, seed: int = 1) -> Floats:
        """Return heights [m] on the grid of the file."""
        return gaussian_map(self.spectrum, self.points, self.size, seed)


class Case(NamedTuple):
    """A scene, and the oracle that knows its force."""

    name: str
    scene: Table  # table that TOML holds; a map is named map.nc
    oracle: str  # pairs, boundary elements (of asperities), map, maps (the mean over several), or none: it is refused
    changes: str = ""  # in which way it differs from the shipped scene of its name
    surface: Surface | None = None
    points: int = 512  # points a side of the grid of boundary elements of asperities


def _shipped(name: str, without: tuple[str, ...] = (), **changes: Table) -> Table:
    """Return a shipped scene without some sections, with one realisation; changes are keys of its sections."""
    table = tomllib.loads((_SHIPPED / f"{name}.toml").read_text())
    kept = {section: keys for section, keys in table.items() if section not in ("sweep", *without)}
    return _complete(kept | {section: kept[section] | keys for section, keys in changes.items()})


def _own(title: str, asperities: Table, separation: Table, **sections: Table) -> Table:
    """Return a scene of asperities with normal heights, from where none touches."""
    random = {"source": "random", "shape": "paraboloid", "placement": "random"}
    table = {
        "title": title,
        "seed": _SEED,
        "material": {"modulus": "1 GPa", "poisson": 0.4},
        "asperities": (random if "file" not in asperities else {"source": "surface"}) | asperities,
        "path": {"separation": {"steps": 200} | separation},
    }
    return _complete(table | sections)


def _complete(table: Table) -> Table:
    """Return the scene with the variables that are looked at, and one realisation, with positions, if it draws any."""
    batch = table.get("batch", {})
    if batch.get("estimator") != "expected":
        batch = batch | {"realizations": 1}
    if table["asperities"]["source"] == "random":
        table["asperities"].setdefault("placement", "random")
    return table | {"output": {"variables": list(VARIABLES)}, "batch": batch}


def _stop(fraction: float) -> Table:
    return {"stop": {"contact_fraction": fraction}}


def _normal(std: str) -> Table:
    return {"distribution": "normal", "std": std}


_MEASURED = Surface(SelfAffine.of(hurst=0.8, long_wave=50e-6, short_wave=6e-6, rms_height=0.5e-6), 100e-6, 256, 2)
_COARSE = Surface(SelfAffine.of(hurst=0.5, long_wave=5e-6, short_wave=0.2e-6, rms_slope=0.1), 10e-6, 128, 4)
_GAUSSIAN = Surface(SelfAffine.of(hurst=0.8, long_wave=30e-6, short_wave=5e-6, rms_slope=0.1), 250e-6, 512)
_RUBBER = {"count": 2000, "patch": "1 mm", "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
           "height": _normal("1 um")}  # fmt: skip
_SOFT = {"modulus": "3 MPa", "poisson": 0.49}
_STICKY = {"model": "jkr", "work": "50 mJ/m^2"}
_FILM = {"count": 240, "patch": "2 um", "radius": "120 nm", "height": _normal("5 nm")}

CASES = (
    Case("rubber",
         _own("Rubber", _RUBBER, {}, material=_SOFT, adhesion=_STICKY,
              path={"separation": {"steps": 200} | _stop(0.04), "unload": True}),
         "pairs"),
    Case("gaussian_surface", _shipped("gaussian_surface", asperities={"patch": "0.25 mm", "long_wave": "30 um"}),
         "maps", "waves up to 30 um, on 0.25 mm", _GAUSSIAN),
    Case("measured_surface", _shipped("measured_surface", ("adhesion",), asperities={"file": "map.nc"}),
         "map", "without adhesion; on a synthetic map", _MEASURED),
    Case("work_and_roughness",
         _shipped("work_and_roughness", adhesion={"work": "20 mJ/m^2"}, asperities={"height": _normal("1 um")}),
         "pairs", "the cell 20 mJ/m^2, 1 um"),
    Case("shape_and_pull_off",
         _shipped("shape_and_pull_off", ("adhesion",), asperities={"exponent": 4.0, "count": 36, "patch": "0.12 mm"}),
         "boundary elements", "exponent 4, without adhesion; 36 asperities on 0.12 mm, as dense"),
    Case("sparse",
         _own("Sparse", {"count": 1000, "patch": "1 mm", "radius": "20 um", "height": _normal("1 um")}, _stop(0.003)),
         "pairs"),
    Case("dense",
         _own("Dense", {"count": 400, "patch": "1 mm", "radius": "50 um", "height": _normal("1 um")}, _stop(0.15)),
         "boundary elements"),
    Case("hexagonal",
         _own("Hexagonal", {"count": 100, "patch": "1 mm", "radius": "0.1 mm", "height": _normal("0.2 um"),
                            "placement": "hexagonal", "vacancies": True}, _stop(0.03)),
         "boundary elements"),
    Case("sticky film",
         _own("Sticky film", _FILM, _stop(0.03), material={"modulus": "2 GPa", "poisson": 0.3},
              adhesion={"model": "jkr", "work": "60 mJ/m^2"},
              path={"separation": {"steps": 200} | _stop(0.03), "unload": True}),
         "pairs"),
    Case("rough map", _own("Rough map", {"file": "map.nc"}, _stop(0.02)), "map", surface=_COARSE),
    Case("trap: pressed to 40 %",
         _own("Rubber", _RUBBER | {"count": 400, "patch": "0.4472 mm"}, _stop(0.4), material=_SOFT),
         "boundary elements", "rubber without adhesion, 400 asperities on 0.447 mm, as dense", points=192),
    Case("trap: 3 sigma below",
         _own("Rubber", _RUBBER | {"count": 400}, {"start": "3 sigma", "stop": "-3 sigma"}, material=_SOFT),
         "boundary elements", "rubber without adhesion, 400 asperities"),
    Case("trap: modulus = 3",
         _own("Rubber", _RUBBER, {}, material=_SOFT | {"modulus": 3}, adhesion=_STICKY,
              path={"separation": {"start": "4 sigma", "stop": "1 sigma", "steps": 200}, "unload": True}),
         "none", "rubber down to 1 sigma"),
)  # fmt: skip
QUICK = ("hexagonal", "sticky film", "trap: modulus = 3")
