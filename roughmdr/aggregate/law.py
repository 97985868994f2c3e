"""The load-separation law of an ensemble: which totals the asked variables need, and the face in xarray."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate import loop
from roughmdr.aggregate.staircase import Staircase, branches, no_memory, staircase
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.kernels.laws import choose
from roughmdr.shapes import SHAPES
from roughmdr.shapes.base import Floats
from roughmdr.variables import COORDINATES, DEFAULT, LAW, RUN

if TYPE_CHECKING:
    import xarray as xr

_ROW = {
    "force": loop.FORCE,
    "pressure": loop.FORCE,
    "contact_area": loop.AREA,
    "contact_fraction": loop.AREA,
    "contact_count": loop.COUNT,
    "contact_radius_sum": loop.RADIUS,
    "stiffness": loop.STIFFNESS,
}
_PER_AREA = {"pressure", "contact_fraction"}

# Of one asperity's force over its magnitude: the kernels keep to 1e-13 of the natural scale, tested against mpmath.
_KERNEL_ERROR = 1e-13
# z - h, its distance to the fold, and what h was rounded to.
_SEPARATION_ERROR = 4.0 * np.finfo(float).eps


class Route(NamedTuple):
    """A path of the flat, with what the contacts remember of it."""

    separation: Floats
    memory: Staircase

    @classmethod
    def along(cls, way_in: Floats, *, unload: bool, adhesive: bool) -> "Route":
        """The way in [m] and, with ``unload``, the way back with the turning point repeated."""
        separation = np.concatenate([way_in, way_in[::-1]]) if unload else way_in
        return cls(separation, staircase(separation) if adhesive else no_memory(separation))

    @property
    def closest(self) -> "Route":
        """The closest approach alone, on the way in."""
        lowest = self.separation[[int(np.argmin(self.separation))]]
        return Route(lowest, no_memory(lowest))

    def coordinates(self) -> dict[str, tuple[str, object, dict[str, str]]]:
        """The coordinates over ``step``."""
        branch = {"long_name": COORDINATES["branch"].long_name}
        return {
            "separation": ("step", self.separation, COORDINATES["separation"].attrs),
            "branch": ("step", np.array(branches(self.separation)), branch),
        }


class LoadSeparation(NamedTuple):
    """The law of one ensemble along one path."""

    variables: dict[str, Floats]
    """Each over the steps, in SI."""
    numerical_error: float
    """Of the force, over its largest magnitude."""
    visits: int
    """How often an asperity was visited."""


def compute(
    ensemble: Ensemble, route: Route, *, modulus: float, work: float, variables: Iterable[str]
) -> LoadSeparation:
    """The law of ``ensemble`` along a route; E* [Pa], work [J/m^2].

    SceneError where a variable needs a nominal area and there is none, OutOfRange where the contact of an asperity is
    not representable.
    """
    names = list(variables)
    if ensemble.nominal_area is None and not _PER_AREA.isdisjoint(names):
        raise SceneError("ensemble: attribute nominal_area is missing; pressure and contact_fraction need it")
    columns = ensemble.columns()
    law = choose(ensemble.shape, work, columns[2])

    def add_up(along: Route, rows: set[int]) -> tuple[Floats, int]:
        totals, visits = loop.add_asperities(
            law, ensemble.height, columns, modulus, work, along.separation, along.memory, rows
        )
        if not np.isfinite(totals).all():
            raise OutOfRange(
                f"the contact of an asperity is not representable: {ensemble.shape} with modulus {modulus:g} Pa, "
                f"work {work:g} J/m^2, separation down to {along.separation.min():g} m"
            )
        return totals, visits

    totals, visits = add_up(route, {_ROW[name] for name in names})
    results = {name: totals[_ROW[name]] for name in names}
    for name in _PER_AREA.intersection(names):
        results[name] = results[name] / ensemble.nominal_area
    closest = route.closest
    checks, _ = add_up(closest, {loop.FORCE, loop.STIFFNESS, loop.MAGNITUDE})
    largest = float(np.max(np.abs(np.append(totals[loop.FORCE], checks[loop.FORCE]))))
    error = _force_error(ensemble.height, closest.separation[0], checks)
    return LoadSeparation(results, error / largest if largest > 0.0 else 0.0, visits)


def prepare(shape: str, work: float) -> None:
    """Compile the sum for a shape with or without adhesion, once, before several threads or a clock need it."""
    columns = SHAPES[shape].stretch({name: np.ones(1) for name in SHAPES[shape].spellings[0]})
    law = choose(shape, work, columns[2])
    loop.add_asperities(law, np.zeros(1), columns, 1.0, 1.0, np.zeros(1), no_memory(np.zeros(1)), set())


def _force_error(height: Floats, closest: float, checks: Floats) -> float:
    """Error of the force [N] at the closest approach: the rounding of z - h through the stiffness, and the kernels'."""
    rounding = _SEPARATION_ERROR * (float(np.max(np.abs(height))) + abs(closest))
    return abs(float(checks[loop.STIFFNESS, 0])) * rounding + _KERNEL_ERROR * float(checks[loop.MAGNITUDE, 0])


def load_separation(
    ensemble: "xr.Dataset",
    *,
    separation: ArrayLike,
    modulus: float,
    work: float = 0.0,
    adhesion: Literal["jkr"] = "jkr",
    unload: bool = False,
    variables: Iterable[str] = DEFAULT,
) -> "xr.Dataset":
    """The load-separation law of an ensemble pressed by a rigid flat, in this process.

    ensemble is a Dataset over ``asperity`` as ``generate`` returns it; separation [m] the path of the flat, coming from
    infinity; with ``unload`` the same separations follow reversed, the turning point repeated. modulus is E* [Pa], work
    the work of adhesion [J/m^2], 0 for none. The result lies over ``step`` with the coordinates separation [m] and
    branch; every variable in SI, ``numerical_error`` beside them.

    SceneError where the ensemble or a name is wrong, OutOfRange where a number is.
    """
    import xarray as xr

    from roughmdr.asperity import check_number

    if adhesion != "jkr":
        raise SceneError(f"adhesion is {adhesion!r}; it must be 'jkr'")
    modulus = check_number("modulus", modulus, "Pa", zero=False)
    work = check_number("work", work, "J/m^2", zero=True)
    path = np.atleast_1d(np.asarray(separation, dtype=np.float64))
    if path.ndim != 1 or path.size == 0 or not np.isfinite(path).all():
        raise OutOfRange("separation must be a non-empty one-dimensional array of finite numbers [m]")
    names = [variables] if isinstance(variables, str) else list(variables)
    for name in names:
        if name not in LAW:
            raise SceneError(f"variables: {name!r} is not available; there are {', '.join(LAW)}")
    route = Route.along(path, unload=unload, adhesive=work > 0.0)
    result = compute(Ensemble.from_dataset(ensemble), route, modulus=modulus, work=work, variables=names)
    data = {name: ("step", result.variables[name], LAW[name].attrs) for name in names}
    error = ((), result.numerical_error, RUN["numerical_error"].attrs)
    return xr.Dataset({**data, "numerical_error": error}, coords=route.coordinates())
