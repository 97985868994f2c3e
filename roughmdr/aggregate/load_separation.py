"""The load-separation law of an ensemble: its face in xarray."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate.path_argument import LawArguments, path_of
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.simulate import simulate
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, warn_limits
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.model_error.coupling import coupling_warnings
from roughmdr.model_error.refusal import fraction_warnings
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import effective_modulus_of
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import (
    CONDUCTANCES,
    CURVE_VARIABLES,
    DEFAULT_VARIABLES,
    LAW_VARIABLES,
    OVER_AREA,
    PULL_OFF_NUMBERS,
    PULL_OFF_PER_AREA,
    RUN_VARIABLES,
    SAMPLE,
)

if TYPE_CHECKING:
    import xarray as xr


@named_keywords
def load_separation(
    ensemble: xr.Dataset,
    *,
    separation: ArrayLike | None = None,
    work: float | str = 0.0,
    unload: bool = False,
    interaction: str | Mapping[str, Any] | None = None,
    variables: Iterable[str] = DEFAULT_VARIABLES,
    **given: Unpack[LawArguments],
) -> xr.Dataset:
    """Compute the load-separation curve of an ensemble pressed by a rigid flat, in this process.

    Parameters
    ----------
    ensemble : xarray.Dataset
        Over ``asperity``, as ``generate`` returns it.
    separation : array_like, shape () or (n,), optional
        Path of the flat [m], which comes from infinity; or in place of it a machine, see below.
    work : float or str, optional
        Work of adhesion [J/m^2]; 0 for none.
    unload : bool, optional
        Whether the same steps follow in reversed order, the turning point repeated.
    interaction : {"pairwise", "mean_field"} or dict, optional
        How asperities feel each other, as in a scene's [interaction]: a dict has model, boundary, order, error, beyond.
        None: they are independent. "pairwise" needs x and y; with adhesion it needs the model "jkr".
    variables : str or iterable of str, optional
        Of force, contact_area, contact_count, stiffness, pressure, contact_fraction, contact_radius_sum,
        conductance_radius, energy, dissipated_energy, machine_dissipated_energy, model_error_curve.
    **given
        The machine: force [N] or pressure [Pa], a dead load, or remote [m], the position of the far end of a spring
        whose machine_stiffness [N/m] is given too: the spring bears machine_stiffness (separation - remote).
        The material: E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with
        counter_poisson). adhesion="dugdale" needs the strength [Pa] of the attraction, or its range [m], work/strength;
        "jkr", the default, then warns where the Tabor number is small. "auto" takes JKR where its force is off by at
        most ``error`` (default 0.01) of the largest force, else Dugdale; the attribute ``adhesion`` says which.

    Returns
    -------
    xarray.Dataset
        The variables over ``step`` in SI, with the coordinates separation [m] and branch; under a machine with the
        quantity that it controls as the coordinate, and separation as a variable, NaN where a dead load has pulled the
        flat off, and force; numerical_error [1];
        model_error [1], what the assumptions of the model cost, with its parts, and the largest contact fraction (NaN
        where there is no nominal area); effective_contacts [1], how many equal contacts would carry the load where the
        flat is closest, sampling_error [1], how far the force there differs from patch to patch, and
        area_sampling_error [1], the area at the same force (NaN where that is not known); with an unloading
        pull_off_force [N], pull_off_separation [m],
        pull_off_contacts [1] and pull_off_contact_area [m2], NaN where it ends in contact; with pairwise interaction
        overlap_count [1], marked_steps [1] and grid_points [1]; with conductance_radius its conductance_error [1].

    Raises
    ------
    SceneError
        Where the ensemble or a name is wrong.
    OutOfRange
        Where a number is out of its range, or where the contacts have more area than the patch.
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
    try:
        asked = Adhesion.from_arguments(work, given)
        coupling = Interaction.from_argument(interaction)
    except RoughmdrError as error:
        raise error if isinstance(error, OutOfRange) else SceneError(str(error)) from None
    asperities = Ensemble.from_dataset(ensemble)
    path = path_of(separation, given, unload=unload, area=asperities.nominal_area, adhesive=asked.work > 0.0)
    effective_modulus = effective_modulus_of(load_separation, given)
    names = [variables] if isinstance(variables, str) else list(variables)
    for name in names:
        if name in CONDUCTANCES:
            raise SceneError(f"variables: {name!r} needs the [conduction] of a scene; ask for conductance_radius")
        if name not in CURVE_VARIABLES:
            raise SceneError(f"variables: {name!r} is not available; there are {', '.join(CURVE_VARIABLES)}")
    problem = Problem(asperities, effective_modulus, asked, coupling)
    result = simulate(problem, path, path.variables(names))
    data = {name: Array(("step",), values, LAW_VARIABLES[name].attrs) for name, values in result.variables.items()}
    errors = {"numerical_error": result.numerical_error, **result.model_error.named}
    errors |= {name: getattr(result, name) for name in SAMPLE}
    if asperities.nominal_area is not None:
        errors["nominal_area"] = asperities.nominal_area
    if coupling is not None and coupling.model == "pairwise":
        names_of_coupling = ["overlap_count", "marked_steps", "grid_points"]
        names_of_coupling += ["avalanche_count", "avalanche_size_max"] if asked.work > 0.0 else []
        errors |= {name: getattr(result, name) for name in names_of_coupling}
    if result.model == "jkr" and np.isfinite(result.tabor):
        errors["tabor_number"] = result.tabor
    if "conductance_radius" in names:
        errors["conductance_error"] = result.conductance_error
    data |= {name: Array((), np.array(value), RUN_VARIABLES[name].attrs) for name, value in errors.items()}
    coordinates = path.coordinates()
    if "unloading" in coordinates["branch"].values:
        for variable, number in zip(PULL_OFF_NUMBERS.values(), result.pull_off, strict=True):
            data[variable.name] = Array((), np.array(number), variable.attrs)
            if asperities.nominal_area is not None and variable.name in OVER_AREA:
                share = PULL_OFF_PER_AREA[OVER_AREA[variable.name]]
                data[share.name] = Array((), np.array(number / asperities.nominal_area), share.attrs)
    warnings = [*result.warnings, *result.extremes.warnings]
    fraction, overlap = (result.model_error.named[name] for name in ("largest_contact_fraction", "overlap_fraction"))
    if coupling is not None and coupling.model == "pairwise":
        warnings += coupling_warnings(fraction, overlap, result.marked_steps, on_grid=result.grid_points > 0.0)
    else:
        warnings += fraction_warnings(fraction)
    attrs = warn_limits(warnings) | ({"adhesion": result.model} if asked.model == "auto" else {})
    attrs |= {} if coupling is None else {"interaction": coupling.model}
    return Labelled(data, coordinates, attrs).to_xarray()
