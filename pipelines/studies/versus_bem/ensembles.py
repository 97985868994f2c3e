"""Ensembles of asperities with positions, of power-law profiles f = c r^n, and their height maps on a grid."""

import math
from typing import NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.numerics.arguments import Floats

SIZE = 1e-3  # [m], side of the patch
_RADIUS = 1.0  # [m], mean, so large that no slope matters: of contacts and roughness only the ratios are left
_SLOPE = 1e-4  # of a Gaussian surface
_DROP = 1e-7  # [m], of a cone and of r^4 at the mean spacing, for as small a slope


class Case(NamedTuple):
    """An ensemble, by its ratios."""

    placement: str
    """random, hexagonal, square, or hard_core with the smallest distance over the mean spacing: "hard_core 0.7"; or at
    random on a part of the side of the patch: "crowd 0.6"."""
    shape: str
    """paraboloid, lognormal (paraboloids whose radii vary by 30 %), cone, quartic (r^4), or nayak."""
    asperities: int
    roughness: float
    """Standard deviation of the heights over how far the flank of an asperity falls over the mean spacing; of nayak the
    longest wave over the side."""
    points: int
    """A side of the grid of boundary elements."""
    seed: int

    @property
    def labels(self) -> tuple[str, str, float]:
        """Placement, shape and roughness."""
        return self.placement, self.shape, self.roughness

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
        shape: dict[str, object]
        match self.shape:
            case "cone":
                shape, drop = {"shape": "cone", "slope": _DROP / self.spacing}, _DROP
            case "quartic":
                shape = {"shape": "power_law", "exponent": 4.0, "width": self.spacing, "rise": _DROP}
                drop = _DROP
            case name:
                lognormal = {"distribution": "lognormal", "mean": _RADIUS, "std": 0.3 * _RADIUS}
                shape = {"shape": "paraboloid", "radius": lognormal if name == "lognormal" else _RADIUS}
                drop = 0.5 * self.spacing**2 / _RADIUS
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
