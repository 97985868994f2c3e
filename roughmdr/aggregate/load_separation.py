"""The load-separation law of an ensemble: which totals the asked variables need, and the face in xarray."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.pull_off import prepare as prepare_pull_off
from roughmdr.aggregate.pull_off import pull_off_of
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.asperity.validity import ValidityLimits
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, Model
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import PullOff
from roughmdr.loading.staircase import no_memory
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_values
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.shapes import SHAPES
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import COORDINATES, CURVE_VARIABLES, DEFAULT_VARIABLES, PULL_OFF_NUMBERS, RUN_VARIABLES

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
    """The extremes of all contacts."""
    visits: int
    """How often an asperity was visited."""
    tabor: float
    """The least Tabor number of the asperities [1]; inf where the strength of the attraction is not known."""
    model: str
    """The adhesion model that was used."""
    warnings: tuple[str, ...] = ()
    """Warnings that concern the ensemble itself."""
    pull_off: PullOff = PullOff()
    """The largest tension of the unloadings."""

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
    ) -> LoadSeparation:
        """Return the law from ``total`` [row, step]; OutOfRange where a variable is not representable."""
        results = {name: total[totals.TOTAL_INDEX[name]] for name in names}
        for name in _PER_AREA.intersection(names):
            with np.errstate(over="ignore"):  # refused below
                results[name] = results[name] / nominal_area
            if not np.isfinite(results[name]).all():
                raise OutOfRange(f"{name} is not representable on a nominal area of {nominal_area:g} m2")
        largest, error = float(np.max(np.abs(total[totals.FORCE]))), float(np.max(total[totals.ERROR]))
        relative = error / largest if largest > 0.0 else 0.0
        extremes = extremes._replace(tabor=tabor if model == "jkr" else math.inf)
        return cls(results, relative, extremes, visits, tabor, model)


def compute(
    ensemble: Ensemble, path: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, variables: Iterable[str]
) -> LoadSeparation:
    """Return the law of ``ensemble`` along a path; E* [Pa].

    SceneError where a variable needs a nominal area and there is none, OutOfRange where the contact of an asperity is
    not representable.
    """
    names = list(variables)
    if ensemble.nominal_area is None and not _PER_AREA.isdisjoint(names):
        raise SceneError("ensemble: attribute nominal_area is missing; pressure and contact_fraction need it")
    columns = ensemble.nondimensional()
    with np.errstate(all="ignore"):  # where no float holds their squares, JKR is not taken for right
        spread = float(np.std(ensemble.height)) if ensemble.height.size else 0.0
    validity = jkr_validity(ensemble.shape, spread, columns, effective_modulus, adhesion)
    adhesion = adhesion.resolved(validity.jkr_error)
    law = choose(ensemble.shape, adhesion, columns[2])
    total, max_radius, visits = loop.sum_over_asperities(
        law,
        ensemble.height,
        columns,
        effective_modulus,
        adhesion,
        path.separation,
        path.memory,
        {totals.ERROR, totals.FORCE, *(totals.TOTAL_INDEX[name] for name in names)},
    )
    extremes = ensemble.validity_limits(max_radius)
    result = LoadSeparation.of(total, names, ensemble.nominal_area, extremes, visits, validity.tabor, adhesion.model)
    pull_off = pull_off_of(law, ensemble.height, columns, effective_modulus, adhesion, path, total[totals.FORCE])
    return result._replace(warnings=ensemble.warnings, pull_off=pull_off)


def prepare(shape: str, adhesion: Adhesion) -> None:
    """Compile the sum for a shape and an adhesion model, once, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in example.nondimensional())
    columns = Columns(width, rise, params)
    for model in adhesion.candidates:
        one = Adhesion(float(adhesion.work > 0.0), model, 1.0)
        law = choose(shape, one, params)
        loop.sum_over_asperities(law, np.zeros(1), columns, 1.0, one, np.zeros(1), no_memory(np.zeros(1)), set())
        prepare_pull_off(law, columns, one)
    if adhesion.tabor_known:
        jkr_validity(shape, 0.0, columns, 1.0, adhesion._replace(work=1.0, strength=1.0))


def load_separation(
    ensemble: xr.Dataset,
    *,
    separation: ArrayLike,
    work: float | str = 0.0,
    adhesion: Model = "jkr",
    strength: float | str | None = None,
    unload: bool = False,
    variables: Iterable[str] = DEFAULT_VARIABLES,
    **material: Unpack[MaterialArguments],
) -> xr.Dataset:
    """Compute the load-separation curve of an ensemble pressed by a rigid flat, in this process.

    Parameters
    ----------
    ensemble : xarray.Dataset
        Over ``asperity``, as ``generate`` returns it.
    separation : array_like, shape () or (n,)
        Path of the flat [m], which comes from infinity.
    work : float or str, optional
        Work of adhesion [J/m^2]; 0 for none.
    adhesion : {"jkr", "dugdale"}, optional
        "dugdale" has a range and needs strength; "jkr" with strength warns where the Tabor number is small.
    strength : float or str, optional
        Stress of the attraction [Pa].
    unload : bool, optional
        Whether the same separations follow in reversed order, the turning point repeated.
    variables : str or iterable of str, optional
        Of force, contact_area, contact_count, stiffness, pressure, contact_fraction, contact_radius_sum, energy,
        dissipated_energy.
    **material
        E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with counter_poisson).

    Returns
    -------
    xarray.Dataset
        The variables over ``step`` in SI, with the coordinates separation [m] and branch; numerical_error [1]; with an
        unloading pull_off_force [N], pull_off_separation [m] and pull_off_contacts [1], NaN where it ends in contact.

    Raises
    ------
    SceneError
        Where the ensemble or a name is wrong.
    OutOfRange
        Where a number is out of its range.
    RoughmdrError
        Unless E* is given in exactly one way.

    References
    ----------
    .. [1] J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A 295 (1966) 300, for any shape and heights.

    Examples
    --------
    >>> import roughmdr as rm
    >>> section = {"source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...            "height": {"distribution": "normal", "std": "1 um"}}
    >>> asperities = rm.generate(section, seed=1)
    >>> curve = rm.load_separation(asperities, separation=["2 um", "1 um"], modulus="3 MPa", poisson=0.49)
    >>> curve.contact_count.values.tolist()
    [11.0, 82.0]
    """
    import xarray as xr

    if not isinstance(ensemble, xr.Dataset):
        raise SceneError(f"ensemble is a {type(ensemble).__name__}; it must be a Dataset as generate returns it")
    effective_modulus = effective_modulus_of(load_separation, material)
    try:
        asked = Adhesion.checked(adhesion, work, strength)
    except RoughmdrError as error:
        raise error if isinstance(error, OutOfRange) else SceneError(str(error)) from None
    separations = np.atleast_1d(check_values("separation", separation, "m"))
    if separations.size == 0:
        raise OutOfRange("separation is empty; it must hold at least one number")
    names = [variables] if isinstance(variables, str) else list(variables)
    for name in names:
        if name not in CURVE_VARIABLES:
            raise SceneError(f"variables: {name!r} is not available; there are {', '.join(CURVE_VARIABLES)}")
    path = LoadingPath.along(separations, unload=unload, adhesive=asked.work > 0.0)
    result = compute(
        Ensemble.from_dataset(ensemble), path, effective_modulus=effective_modulus, adhesion=asked, variables=names
    )
    data = {name: Array(("step",), result.variables[name], CURVE_VARIABLES[name].attrs) for name in names}
    data["numerical_error"] = Array((), np.array(result.numerical_error), RUN_VARIABLES["numerical_error"].attrs)
    if (np.diff(path.separation) > 0.0).any():
        for variable, number in zip(PULL_OFF_NUMBERS.values(), result.pull_off, strict=True):
            data[variable.name] = Array((), np.array(number), variable.attrs)
    distance = Array(("step",), path.separation, COORDINATES["separation"].attrs)
    warnings = [*result.warnings, *result.extremes.warnings]
    return Labelled(data, {"separation": distance, "branch": path.branch()}, warn_limits(warnings)).to_xarray()
