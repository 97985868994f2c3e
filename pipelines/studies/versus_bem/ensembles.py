"""Cases: ensembles with positions, of profiles f = c r^n, with their maps; Gaussian maps with their summits."""

import math
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from oracles.gaussian_maps import gaussian_map

import roughmdr as rm
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.section import asperities_on
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf

SIZE = 1e-3  # [m], side of the patch
MODULUS = 1e9  # [Pa], E*
_RADIUS = 1.0  # [m], mean, so large that no slope matters: of contacts and roughness only the ratios are left
_SLOPE, _MAP_SLOPE = 1e-4, 1e-3  # r.m.s., of the surface of nayak and of maps: so small that nothing depends on it
_DROP = 1e-7  # [m], of a cone and of r^4 at the mean spacing, for as small a slope
_SEARCHED = 2000  # separations in which those of given contact fractions are found


class Case(NamedTuple):
    """An ensemble, by its ratios."""

    placement: str
    """random, hexagonal, square, or hard_core with the smallest distance over the mean spacing: "hard_core 0.7"; or at
    random on a part of the side of the patch: "crowd 0.6"."""
    shape: str  # paraboloid, lognormal (paraboloids whose radii vary by 30 %), cone, quartic (r^4), or nayak
    asperities: int
    roughness: float
    """Standard deviation of the heights over how far the flank of an asperity falls over the mean spacing; of nayak the
    longest wave over the side."""
    points: int  # a side of the grid of boundary elements
    seed: int

    def build(self) -> tuple[xr.Dataset, Floats, Floats]:
        """Return the ensemble, and its height map on the grid and on one of half as many points a side."""
        ensemble = self.generate()
        return ensemble, height_map(ensemble, self.points), height_map(ensemble, self.points // 2)

    @property
    def spacing(self) -> float:
        """The mean spacing [m], the side of the area for each asperity."""
        return SIZE / math.sqrt(self.asperities)

    def generate(self) -> xr.Dataset:
        """Return the ensemble, with positions."""
        if self.shape == "nayak":
            return self._nayak()
        lognormal = {"distribution": "lognormal", "mean": _RADIUS, "std": 0.3 * _RADIUS}
        shapes: dict[str, dict[str, object]] = {
            "cone": {"shape": "cone", "slope": _DROP / self.spacing},
            "quartic": {"shape": "power_law", "exponent": 4.0, "width": self.spacing, "rise": _DROP},
            "paraboloid": {"shape": "paraboloid", "radius": _RADIUS},
            "lognormal": {"shape": "paraboloid", "radius": lognormal},
        }
        shape = shapes[self.shape]
        drop = 0.5 * self.spacing**2 / _RADIUS if "radius" in shape else _DROP
        placement, _, distance = self.placement.partition(" ")
        if placement == "hard_core":
            shape["min_distance"] = float(distance) * self.spacing
        elif placement == "hexagonal":
            shape["vacancies"] = True  # the patch is a square
        section = {
            "source": "random", "count": self.asperities, "patch": SIZE, **shape,
            "placement": "random" if placement in ("square", "crowd") else placement,
            "height": {"distribution": "normal", "std": self.roughness * drop},
        }  # fmt: skip
        ensemble = rm.generate(section, seed=self.seed)
        if placement == "crowd":
            ensemble = ensemble.assign({axis: ensemble[axis] * float(distance) for axis in "xy"})
        elif placement == "square":
            along = (np.arange(math.isqrt(self.asperities)) + 0.5) * self.spacing
            order = np.random.default_rng(self.seed).permutation(self.asperities)
            for axis, values in zip("xy", np.meshgrid(along, along), strict=True):
                ensemble[axis] = ("asperity", values.ravel()[order], {"units": "m"})
        return ensemble

    def _nayak(self) -> xr.Dataset:
        """Return summits of a Gaussian surface as they are, placed by themselves: not as those of the surface."""
        waves = {"hurst": 0.8, "long_wave": SIZE * self.roughness, "short_wave": SIZE / math.sqrt(self.asperities)}
        ensemble = rm.generate({"source": "nayak", "patch": SIZE, **waves, "rms_slope": _SLOPE,
                                "placement": "hard_core"}, seed=self.seed)  # fmt: skip
        ensemble.attrs["of_surface"] = 0
        return ensemble


def side(ensemble: xr.Dataset) -> float:
    """Return the side of the patch [m]."""
    return math.sqrt(float(ensemble.attrs["nominal_area"]))


def exponent_and_coefficient(ensemble: xr.Dataset) -> tuple[float, Floats]:
    """Return n [1] and c [m^(1-n)] of f = c r^n for each asperity."""
    if "radius" in ensemble:
        return 2.0, 0.5 / ensemble["radius"].to_numpy()
    if "slope" in ensemble:
        return 1.0, ensemble["slope"].to_numpy()
    exponent = float(ensemble["exponent"][0])
    return exponent, (ensemble["rise"] / ensemble["width"] ** exponent).to_numpy()


def contact_radii(ensemble: xr.Dataset, separation: float) -> Floats:
    """Return the contact radius [m] of each asperity without adhesion, 0 out of contact."""
    n, c = exponent_and_coefficient(ensemble)
    kappa = 0.5 * math.sqrt(math.pi) * n * math.exp(math.lgamma(0.5 * n) - math.lgamma(0.5 * n + 0.5))
    overlap = np.maximum(ensemble["height"].to_numpy() - separation, 0.0)
    return np.asarray((overlap / (kappa * c)) ** (1.0 / n))


def height_map(ensemble: xr.Dataset, points: int) -> Floats:
    """Return the highest of all asperities and of their periodic images [m], on points x points over the patch."""
    n, c = exponent_and_coefficient(ensemble)
    size = side(ensemble)
    grid = (np.arange(points) + 0.5) * size / points
    squares = [(np.abs((grid - ensemble[axis].to_numpy()[:, None] + 0.5 * size) % size - 0.5 * size)) ** 2
               for axis in "xy"]  # fmt: skip
    highest = np.full((points, points), -np.inf)
    for i, top in enumerate(ensemble["height"].to_numpy()):
        square = squares[0][i][:, None] + squares[1][i][None, :]
        np.maximum(highest, top - c[i] * square ** (0.5 * n), out=highest)
    return highest


def distances(ensemble: xr.Dataset) -> Floats:
    """Return the distances [m] of all pairs in the periodic patch; infinite from an asperity to itself."""
    size = side(ensemble)
    apart = [np.abs((p[:, None] - p[None, :] + 0.5 * size) % size - 0.5 * size)
             for p in (ensemble["x"].to_numpy(), ensemble["y"].to_numpy())]  # fmt: skip
    result = np.hypot(*apart)
    np.fill_diagonal(result, np.inf)
    return np.asarray(result)


def separations(ensemble: xr.Dataset, fractions: Floats) -> Floats:
    """Return where independent asperities reach contact fractions; NaN where they do not before the lowest touches."""
    height = ensemble["height"].to_numpy()
    deep = 2.0 * float(np.ptp(height)) + 1e-7
    tried = height.max() - deep * np.linspace(0.0, 1.0, _SEARCHED)[1:] ** 3
    squares = [float(np.sum(contact_radii(ensemble, h) ** 2)) for h in tried.tolist()]
    return np.asarray(np.interp(fractions, math.pi * np.array(squares) / SIZE**2, tried, right=np.nan))


class MapCase(NamedTuple):
    """A map of a self-affine spectrum; its waves as shares of the side."""

    hurst: float
    long_wave: float
    short_wave: float
    points: int  # a side of the grid
    seed: int

    def build(self) -> tuple[xr.Dataset, Floats, Floats]:
        """Return the summits, and the map on its grid and on every second point of it, which still holds its waves."""
        waves = {"long_wave": self.long_wave * SIZE, "short_wave": self.short_wave * SIZE}
        spectrum = SelfAffine.of(hurst=self.hurst, rms_slope=_MAP_SLOPE, **waves)
        height = gaussian_map(spectrum, self.points, SIZE, self.seed)
        surface = HeightMap(height, SIZE / self.points, SIZE / self.points, True)
        summits = asperities_on(surface, 0.0, "summits", "map", {"detrend": "none"})
        return summits.labelled().to_xarray(), height, height[::2, ::2]


def write_map(height: Floats, size: float, file: Path) -> None:
    """Write a periodic map of heights [m] over ``size`` [m] as netCDF."""
    along = np.arange(height.shape[0]) * size / height.shape[0]
    stored = xr.Dataset(
        {"height": (("x", "y"), height, {"units": "m"})},
        {axis: (axis, along, {"units": "m"}) for axis in "xy"},
        {"periodic": 1},
    )
    write_netcdf(Labelled.of(stored), file)


PLACEMENTS = ("random", "hard_core 0.5", "hard_core 0.7", "hexagonal", "square")
FINE = 1024  # grid of the cases that are to show more digits than the others
CASES: list[Case | MapCase] = [
    *(Case(where, "paraboloid", 64, rough, 256, seed)
      for seed, rough, where in product((1, 2), (0.02, 0.2, 1.0), PLACEMENTS)),
    *(Case(where, shape, 64, 0.2, 256, 3)
      for shape, where in product(("lognormal", "cone", "quartic"), PLACEMENTS[::2])),
    *(Case("nayak", "nayak", 250, long, 512, seed) for seed, long in ((6, 0.25), (7, 0.5), (8, 0.07))),
    *(MapCase(hurst, long, 0.0833, 256, 4) for hurst, long in product((0.3, 0.8), (0.5, 0.25, 0.0834))),
    *(Case(where, "paraboloid", count, 0.1, points, 5)
      for (count, points), where in product(((16, 128), (256, 512)), PLACEMENTS[::2])),
    *(Case(where, "paraboloid", 40, rough, 256, 9)
      for rough, where in product((0.02, 0.2), ("crowd 0.5", "crowd 0.7"))),
    *(Case("hard_core 0.7", "lognormal", count, 0.2, FINE, seed)
      for seed, count in enumerate((40, 52, 64, 80, 100), start=11)),
]  # fmt: skip
QUICK: list[Case | MapCase] = [
    Case("random", "paraboloid", 25, 0.2, 96, 1),
    Case("square", "paraboloid", 25, 0.02, 96, 1),
    MapCase(0.8, 0.25, 0.125, 128, 2),
]
