"""The load-separation law of an ensemble: which totals the asked variables need, and the face in xarray."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate import loop
from roughmdr.aggregate.staircase import branches, staircase
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.kernels.laws import choose
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


class LoadSeparation(NamedTuple):
    """The law of one ensemble along one path."""

    variables: dict[str, Floats]
    """Each over the steps, in SI."""
    numerical_error: float
    """Of the force, over its largest magnitude."""
    visits: int
    """How often an asperity was visited."""


def compute(
    ensemble: Ensemble, *, separation: Floats, modulus: float, work: float, variables: Iterable[str]
) -> LoadSeparation:
    """The law of ``ensemble`` along the path ``separation`` [m], way back included; E* [Pa], work [J/m^2].

    OutOfRange where the scales of an asperity are not representable.
    """
    names = list(variables)
    if ensemble.nominal_area is None and not _PER_AREA.isdisjoint(names):
        raise SceneError("ensemble: attribute nominal_area is missing; pressure and contact_fraction need it")
    columns = ensemble.columns()
    law = choose(ensemble.shape, work, columns[2])
    rows = {_ROW[name] for name in names}
    totals, visits = loop.add_asperities(
        law, ensemble.height, columns, modulus, work, separation, staircase(separation), rows
    )
    if not np.isfinite(totals).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {ensemble.shape} with modulus {modulus:g} Pa, "
            f"work {work:g} J/m^2, separations from {separation.min():g} to {separation.max():g} m"
        )
    results = {name: totals[_ROW[name]] for name in names}
    for name in _PER_AREA.intersection(names):
        results[name] = results[name] / ensemble.nominal_area
    closest = separation[[int(np.argmin(separation))]]
    checks, _ = loop.add_asperities(
        law, ensemble.height, columns, modulus, work, closest, staircase(closest), {loop.FORCE, loop.STIFFNESS, loop.MAGNITUDE}
    )
    return LoadSeparation(results, _numerical_error(ensemble.height, closest[0], checks), visits)


def _numerical_error(height: Floats, closest: float, checks: Floats) -> float:
    """The rounding of z - h through the stiffness, and that of the kernels, at the closest approach."""
    force, slope, magnitude = (float(checks[row, 0]) for row in (loop.FORCE, loop.STIFFNESS, loop.MAGNITUDE))
    if magnitude == 0.0:
        return 0.0
    rounding = _SEPARATION_ERROR * (float(np.max(np.abs(height))) + abs(closest))
    return (abs(slope) * rounding + _KERNEL_ERROR * magnitude) / max(abs(force), np.finfo(float).tiny)


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
    path = whole_path(path, unload)
    result = compute(
        Ensemble.from_dataset(ensemble), separation=path, modulus=modulus, work=work, variables=names
    )
    data = {name: ("step", result.variables[name], LAW[name].attrs) for name in names}
    return xr.Dataset(
        {**data, "numerical_error": ((), result.numerical_error, RUN["numerical_error"].attrs)}, coords=path_coordinates(path)
    )


def whole_path(way_in: Floats, unload: bool) -> Floats:
    """The way in and, with ``unload``, the way back with the turning point repeated."""
    return np.concatenate([way_in, way_in[::-1]]) if unload else way_in


def path_coordinates(path: Floats) -> dict[str, tuple[str, object, dict[str, str]]]:
    """The coordinates over ``step``."""
    branch = {"long_name": COORDINATES["branch"].long_name}
    return {
        "separation": ("step", path, COORDINATES["separation"].attrs),
        "branch": ("step", np.array(branches(path)), branch),
    }
