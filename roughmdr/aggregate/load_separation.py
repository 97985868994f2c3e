"""The load-separation law of an ensemble: which totals the asked variables need, and the face in xarray."""

import math
import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.asperity.validity import ValidityLimits
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import LimitWarning, OutOfRange, RoughmdrError, SceneError
from roughmdr.kernels.adhesion import Adhesion, Model
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.staircase import no_memory
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.shapes import SHAPES
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import COORDINATES, CURVE_VARIABLES, DEFAULT_VARIABLES, RUN_VARIABLES

if TYPE_CHECKING:
    import xarray as xr

_PER_AREA = {"pressure", "contact_fraction"}


class LoadSeparation(NamedTuple):
    """The law of one ensemble along one path."""

    variables: dict[str, Floats]
    """Each over the steps, in SI."""
    numerical_error: float
    """Bound on the error of the force along the path, over the largest magnitude of the force."""
    extremes: ValidityLimits
    """The most that any contact comes to."""
    visits: int
    """How often an asperity was visited."""
    tabor: float
    """The least Tabor number of the asperities [1]; inf where the strength of the attraction is not known."""
    model: str
    """The law of adhesion that was taken."""
    doubts: tuple[str, ...] = ()
    """What makes the ensemble itself doubtful."""

    @classmethod
    def of(
        cls,
        total: Floats,
        names: list[str],
        nominal_area: float | None,
        extremes: ValidityLimits,
        visits: int,
        tabor: float,
        model: str,
    ) -> "LoadSeparation":
        """The law that ``total`` [row, step] comes to; OutOfRange where a variable is not representable."""
        results = {name: total[totals.TOTAL_INDEX[name]] for name in names}
        for name in _PER_AREA.intersection(names):
            with np.errstate(over="ignore"):  # refused below
                results[name] = results[name] / nominal_area
            if not np.isfinite(results[name]).all():
                raise OutOfRange(f"{name} is not representable on a nominal area of {nominal_area:g} m2")
        largest, error = float(np.max(np.abs(total[totals.FORCE]))), float(np.max(total[totals.ERROR]))
        relative = error / largest if largest > 0.0 else 0.0
        taken = extremes._replace(tabor=tabor if model == "jkr" else math.inf)
        return cls(results, relative, taken, visits, tabor, model)


def compute(
    ensemble: Ensemble, route: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, variables: Iterable[str]
) -> LoadSeparation:
    """The law of ``ensemble`` along a route; E* [Pa].

    SceneError where a variable needs a nominal area and there is none, OutOfRange where the contact of an asperity is
    not representable.
    """
    names = list(variables)
    if ensemble.nominal_area is None and not _PER_AREA.isdisjoint(names):
        raise SceneError("ensemble: attribute nominal_area is missing; pressure and contact_fraction need it")
    columns = ensemble.nondimensional()
    with np.errstate(all="ignore"):  # where no float holds their squares, JKR is not taken for right
        spread = float(np.std(ensemble.height)) if ensemble.height.size else 0.0
    reach = jkr_validity(ensemble.shape, spread, columns, effective_modulus, adhesion)
    adhesion = adhesion.resolved(reach.jkr_error)
    law = choose(ensemble.shape, adhesion, columns[2])
    total, reached, visits = loop.add_asperities(
        law,
        ensemble.height,
        columns,
        effective_modulus,
        adhesion,
        route.separation,
        route.memory,
        {totals.ERROR, totals.FORCE, *(totals.TOTAL_INDEX[name] for name in names)},
    )
    extremes = ensemble.validity_limits(reached)
    found = LoadSeparation.of(total, names, ensemble.nominal_area, extremes, visits, reach.tabor, adhesion.model)
    return found._replace(doubts=ensemble.warnings)


def prepare(shape: str, adhesion: Adhesion) -> None:
    """Compile the sum for a shape and a law of adhesion, once, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in example.nondimensional())
    columns = Columns(width, rise, params)
    for model in adhesion.candidates:
        one = Adhesion(float(adhesion.work > 0.0), model, 1.0)
        law = choose(shape, one, params)
        loop.add_asperities(law, np.zeros(1), columns, 1.0, one, np.zeros(1), no_memory(np.zeros(1)), set())
    if adhesion.tabor_known:
        jkr_validity(shape, 0.0, columns, 1.0, adhesion._replace(work=1.0, strength=1.0))


def load_separation(
    ensemble: "xr.Dataset",
    *,
    separation: ArrayLike,
    effective_modulus: float,
    work: float = 0.0,
    adhesion: Model = "jkr",
    strength: float | None = None,
    unload: bool = False,
    variables: Iterable[str] = DEFAULT_VARIABLES,
) -> "xr.Dataset":
    """The load-separation law of an ensemble pressed by a rigid flat, in this process.

    ensemble is a Dataset over ``asperity`` as ``generate`` returns it; separation [m] the path of the flat, coming from
    infinity; with ``unload`` the same separations follow reversed, the turning point repeated. effective_modulus is E*
    [Pa], work the work of adhesion [J/m^2], 0 for none. Adhesion "dugdale" has a range and needs the stress
    ``strength`` [Pa] of the attraction; "jkr" with a strength warns where it is not right. The result lies over
    ``step`` with the coordinates separation [m] and branch; every variable in SI, ``numerical_error`` beside them.

    SceneError where the ensemble or a name is wrong, OutOfRange where a number is.
    """
    import xarray as xr

    if not isinstance(ensemble, xr.Dataset):
        raise SceneError(f"ensemble is a {type(ensemble).__name__}; it must be a Dataset as generate returns it")
    effective_modulus = check_number("effective_modulus", effective_modulus, "Pa")
    try:
        asked = Adhesion.checked(adhesion, work, strength)
    except RoughmdrError as error:
        raise error if isinstance(error, OutOfRange) else SceneError(str(error)) from None
    path = np.atleast_1d(check_values("separation", separation))
    if path.size == 0:
        raise OutOfRange("separation is empty; it must hold at least one number")
    names = [variables] if isinstance(variables, str) else list(variables)
    for name in names:
        if name not in CURVE_VARIABLES:
            raise SceneError(f"variables: {name!r} is not available; there are {', '.join(CURVE_VARIABLES)}")
    route = LoadingPath.along(path, unload=unload, adhesive=asked.work > 0.0)
    result = compute(
        Ensemble.from_dataset(ensemble), route, effective_modulus=effective_modulus, adhesion=asked, variables=names
    )
    data = {name: Array(("step",), result.variables[name], CURVE_VARIABLES[name].attrs) for name in names}
    data["numerical_error"] = Array((), np.array(result.numerical_error), RUN_VARIABLES["numerical_error"].attrs)
    way = Array(("step",), route.separation, COORDINATES["separation"].attrs)
    doubts = [*result.doubts, *result.extremes.warnings]
    attrs = {"warnings": "\n".join(doubts)} if doubts else {}
    for text in doubts:
        warnings.warn(text, LimitWarning, stacklevel=2)
    return Labelled(data, {"separation": way, "branch": route.branch()}, attrs).to_xarray()
