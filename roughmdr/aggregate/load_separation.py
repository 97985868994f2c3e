"""The load-separation law of an ensemble: which totals the asked variables need, and the face in xarray."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.detachment import detachment_depths
from roughmdr.aggregate.law import PER_AREA, LoadSeparation
from roughmdr.aggregate.mean_field import couple
from roughmdr.aggregate.pull_off import pull_off_of
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, warn_limits
from roughmdr.interaction.mean_field import coupling_in, shift
from roughmdr.interaction.placed import check_placed
from roughmdr.interaction.settings import Interaction, reason_against_adhesion
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import prepare as prepare_pull_off
from roughmdr.loading.staircase import no_memory
from roughmdr.model_error import Assumptions, Givens, fraction_warnings
from roughmdr.model_error.coupling import coupling_warnings
from roughmdr.model_error.interaction import overlap_share, poisson_overlap
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_values
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import SHAPES
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import COORDINATES, CURVE_VARIABLES, DEFAULT_VARIABLES, PULL_OFF_NUMBERS, RUN_VARIABLES

if TYPE_CHECKING:
    import xarray as xr


def compute(
    ensemble: Ensemble,
    path: LoadingPath,
    *,
    effective_modulus: float,
    adhesion: Adhesion,
    variables: Iterable[str],
    interaction: Interaction | None = None,
) -> LoadSeparation:
    """Return the law of ``ensemble`` along a path; E* [Pa].

    SceneError where a variable needs a nominal area and there is none, or where the ensemble lacks positions or the
    patch that the interaction needs, OutOfRange where the contact of an asperity is
    not representable, or where the contacts have more area than the patch.
    """
    names = list(variables)
    if ensemble.nominal_area is None and not PER_AREA.isdisjoint(names):
        raise SceneError(f"ensemble: attribute nominal_area is missing; {', '.join(sorted(PER_AREA))} need it")
    if interaction is not None:
        check_placed(ensemble, interaction)
        if reason := reason_against_adhesion(interaction, adhesion):
            raise SceneError(f"interaction {reason}")
        if interaction.model == "pairwise":
            from roughmdr.aggregate.coupled import law_of_coupled

            return law_of_coupled(ensemble, path, effective_modulus, adhesion, interaction, names)
    columns = ensemble.nondimensional()
    with np.errstate(all="ignore"):  # where no float holds their squares, JKR is not taken for right
        spread = float(np.std(ensemble.height)) if ensemble.height.size else 0.0
    validity = jkr_validity(ensemble.shape, spread, columns, effective_modulus, adhesion)
    adhesion = adhesion.resolved(validity.jkr_error)
    law = choose(ensemble.shape, adhesion, columns[2])
    rows = {totals.ERROR, totals.FORCE, totals.AREA, *(totals.TOTAL_INDEX[name] for name in names)}

    def sums(along: LoadingPath, rows: set[int]) -> tuple[Floats, Floats, int]:
        return loop.sum_over_asperities(
            law, ensemble.height, columns, effective_modulus, adhesion, along.separation, along.memory, rows
        )

    if coupling := coupling_in(ensemble, interaction, effective_modulus):

        def independent(separation: Floats) -> tuple[Floats, Floats]:
            found, _, _ = sums(LoadingPath(separation, no_memory(separation)), {totals.FORCE, totals.STIFFNESS})
            return found[totals.FORCE], found[totals.STIFFNESS]

        found = shift(independent, path.separation, coupling)
        shifted = LoadingPath(found.separation, no_memory(found.separation))
        total, radius, visits = sums(shifted, rows | {totals.STIFFNESS})
        couple(total, found)
    else:
        total, radius, visits = sums(path, rows)
    area = math.nan if ensemble.nominal_area is None else ensemble.nominal_area
    givens = Givens(effective_modulus, adhesion.work, spread, area, float(radius.max(initial=0.0)))
    assumptions = Assumptions(
        ensemble.validity_limits(radius),
        np.count_nonzero(radius) * validity.contact_error if adhesion.model == "jkr" else 0.0,
        float(ensemble.attrs.get("radius_uncertainty", 0.0)),
        bool(ensemble.attrs.get("of_surface", 0)),
        _overlap(ensemble, radius),
    )
    result = LoadSeparation.of(
        total, names, path.separation, givens, assumptions, visits, validity.tabor, adhesion.model
    )
    pull_off = pull_off_of(law, ensemble.height, columns, effective_modulus, adhesion, path, total[totals.FORCE])
    return result._replace(warnings=ensemble.warnings, pull_off=pull_off)


def _overlap(ensemble: Ensemble, radius: Floats) -> float:
    """Return the share of contacts that reach into a neighbour's, from their radii [m]; NaN where it is not known."""
    touching = radius > 0.0
    contact_radius = radius[touching]
    if not contact_radius.size:
        return 0.0
    if {"x", "y"} <= ensemble.positions.keys():
        x, y = (ensemble.positions[name][touching] for name in ("x", "y"))
        return overlap_share(x, y, contact_radius)
    if ensemble.nominal_area is None:
        return math.nan
    return poisson_overlap(contact_radius, ensemble.nominal_area)


def prepare(shape: str, adhesion: Adhesion, interaction: Interaction | None = None) -> None:
    """Compile the sum for a shape, an adhesion model and an interaction, before several threads or a clock need it."""
    if interaction is not None and interaction.model == "pairwise":
        from roughmdr.interaction.solve import prepare as prepare_coupled

        if adhesion.work > 0.0:
            from roughmdr.interaction.jkr.path import prepare as prepare_adhering

            prepare_adhering(shape)
        else:
            prepare_coupled(shape)
    kind = SHAPES[shape]
    example = kind(**kind.example())
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in example.nondimensional())
    columns = Columns(width, rise, params)
    for model in adhesion.candidates if interaction is None or interaction.model != "pairwise" else ():
        one = Adhesion(float(adhesion.work > 0.0), model, 1.0)
        law = choose(shape, one, params)
        loop.sum_over_asperities(law, np.zeros(1), columns, 1.0, one, np.zeros(1), no_memory(np.zeros(1)), set())
        if law.adhesive:
            detachment_depths(law, columns, 1.0, one)
            prepare_pull_off()
    if adhesion.work > 0.0:
        jkr_validity(shape, 0.0, columns, 1.0, adhesion._replace(work=1.0, strength=1.0))


def load_separation(
    ensemble: xr.Dataset,
    *,
    separation: ArrayLike,
    work: float | str = 0.0,
    unload: bool = False,
    interaction: str | Mapping[str, Any] | None = None,
    variables: Iterable[str] = DEFAULT_VARIABLES,
    **material: Unpack[AdhesiveMaterial],
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
    unload : bool, optional
        Whether the same separations follow in reversed order, the turning point repeated.
    interaction : {"pairwise", "mean_field"} or dict, optional
        How asperities feel each other, as in a scene's [interaction]: a dict has model, boundary, order, error, beyond.
        None: they are independent. "pairwise" needs x and y; with adhesion it needs the model "jkr".
    variables : str or iterable of str, optional
        Of force, contact_area, contact_count, stiffness, pressure, contact_fraction, contact_radius_sum, energy,
        dissipated_energy, model_error_curve.
    **material
        E* as effective_modulus [Pa], or as modulus [Pa] with poisson [1] (and counter_modulus with counter_poisson).
        adhesion="dugdale" needs the strength [Pa] of the attraction, or its range [m], work/strength; "jkr", the
        default, then warns where the Tabor number is small. "auto" takes JKR where its force is off by at most
        ``error`` (default 0.01) of the largest force, else Dugdale; the attribute ``adhesion`` says which.

    Returns
    -------
    xarray.Dataset
        The variables over ``step`` in SI, with the coordinates separation [m] and branch; numerical_error [1];
        model_error [1], what the assumptions of the model cost, with its parts, and the largest contact fraction (NaN
        where there is no nominal area); with an unloading pull_off_force [N], pull_off_separation [m],
        pull_off_contacts [1] and pull_off_contact_area [m2], NaN where it ends in contact; with pairwise interaction
        overlap_count [1], marked_steps [1] and grid_points [1].

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
        asked = Adhesion.from_arguments(work, material)
        coupling = Interaction.from_argument(interaction)
    except RoughmdrError as error:
        raise error if isinstance(error, OutOfRange) else SceneError(str(error)) from None
    effective_modulus = effective_modulus_of(load_separation, material)
    separations = np.atleast_1d(check_values("separation", separation, "m"))
    if separations.size == 0:
        raise OutOfRange("separation is empty; it must hold at least one number")
    names = [variables] if isinstance(variables, str) else list(variables)
    for name in names:
        if name not in CURVE_VARIABLES:
            raise SceneError(f"variables: {name!r} is not available; there are {', '.join(CURVE_VARIABLES)}")
    path = LoadingPath.along(separations, unload=unload, adhesive=asked.work > 0.0)
    result = compute(
        Ensemble.from_dataset(ensemble),
        path,
        effective_modulus=effective_modulus,
        adhesion=asked,
        interaction=coupling,
        variables=names,
    )
    data = {name: Array(("step",), result.variables[name], CURVE_VARIABLES[name].attrs) for name in names}
    errors = {"numerical_error": result.numerical_error, **result.model_error.named}
    if coupling is not None and coupling.model == "pairwise":
        names_of_coupling = ["overlap_count", "marked_steps", "grid_points"]
        names_of_coupling += ["avalanche_count", "avalanche_size_max"] if asked.work > 0.0 else []
        errors |= {name: getattr(result, name) for name in names_of_coupling}
    data |= {name: Array((), np.array(value), RUN_VARIABLES[name].attrs) for name, value in errors.items()}
    if (np.diff(path.separation) > 0.0).any():
        for variable, number in zip(PULL_OFF_NUMBERS.values(), result.pull_off, strict=True):
            data[variable.name] = Array((), np.array(number), variable.attrs)
    distance = Array(("step",), path.separation, COORDINATES["separation"].attrs)
    warnings = [*result.warnings, *result.extremes.warnings]
    fraction, overlap = result.model_error.largest_fraction, result.model_error.overlap
    if coupling is not None and coupling.model == "pairwise":
        warnings += coupling_warnings(fraction, overlap, result.marked_steps, on_grid=result.grid_points > 0.0)
    else:
        warnings += fraction_warnings(fraction)
    attrs = warn_limits(warnings) | ({"adhesion": result.model} if asked.model == "auto" else {})
    attrs |= {} if coupling is None else {"interaction": coupling.model}
    return Labelled(data, {"separation": distance, "branch": path.branch()}, attrs).to_xarray()
