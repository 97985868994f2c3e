"""All variables of datasets and files, declared once: name, unit and description."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Variable:
    """A variable of a dataset or a file, in SI units."""

    name: str
    units: str
    long_name: str
    codes: tuple[str, ...] = ()
    """Meanings of its values 0, 1, ..., where these are codes."""

    @property
    def attrs(self) -> dict[str, str]:
        """Its attributes in xarray and netCDF."""
        return {"units": self.units, "long_name": self.long_name}


@dataclass(frozen=True)
class Diagnostic(Variable):
    """A number or text that describes one run beside its curves, and the rule that merges those of several runs."""

    dtype: type = float
    merge: Literal["add", "maximum", "fmax", "fmin", "first"] = "fmax"
    """A ufunc of NumPy (``fmax`` and ``fmin`` ignore NaN, which ``maximum`` keeps); of texts the ``first`` one."""
    missing: Any = math.nan
    """Value of a run that did not run, or that failed."""
    unstated: Any = math.nan
    """Value of a run that is done, in a result or checkpoint without this diagnostic."""
    in_result: Callable[[Any], bool] = lambda scene: True
    """Whether a result with a cell of this scene has it; a text is there only if some run has one."""


def _declare(*rows: tuple[str, str, str] | tuple[str, str, str, tuple[str, ...]]) -> dict[str, Variable]:
    return {row[0]: Variable(*row) for row in rows}


CURVE_VARIABLES = _declare(
    ("force", "N", "normal force of all asperities, compression positive"),
    ("contact_area", "m2", "sum of the contact areas"),
    ("contact_count", "1", "number of asperities in contact"),
    ("stiffness", "N m-1", "sum of the slopes dP/d(delta) of the branches, jumps not included"),
    ("pressure", "Pa", "force over nominal area"),
    ("contact_fraction", "1", "contact area over nominal area"),
    ("contact_radius_sum", "m", "sum of the contact radii"),
    ("energy", "J", "elastic and surface energy of all contacts, 0 out of contact"),
    ("dissipated_energy", "J", "energy lost in jumps since the start of the path"),
    ("machine_dissipated_energy", "J", "part of it that the machine loses in its jumps; 0 under fixed grips"),
    ("model_error_curve", "1", "estimated relative error of the force by the assumptions of the model"),
)
"""Variables of a load-separation law that [output] can name."""

DEFAULT_VARIABLES = ("force", "contact_area", "contact_count", "stiffness")

SEPARATION = Variable("separation", "m", "rigid flat above the datum plane; none where a dead load has pulled it off")
"""A variable where a machine moves the flat, else a coordinate."""

REMOTE = Variable(
    "remote", "m", "far end of the machine's spring above the datum plane, where its force is 0 at the flat"
)
"""A coordinate where a path controls it, a variable where it follows from a preload."""

REFERENCE_VARIABLES = _declare(
    ("reference_force", "N", "normal force by boundary elements"),
    ("reference_contact_area", "m2", "contact area by boundary elements"),
    ("reference_contact_count", "1", "number of connected contacts by boundary elements"),
    ("reference_stiffness", "N m-1", "slope -dF/dh by boundary elements"),
    ("reference_pressure", "Pa", "force over nominal area by boundary elements"),
    ("reference_contact_fraction", "1", "contact area over nominal area by boundary elements"),
    ("reference_error", "1", "estimated relative error of the force by boundary elements, by their grid"),
)
"""Variables of a law by boundary elements beside that of the asperities."""

LAW_VARIABLES = {SEPARATION.name: SEPARATION, REMOTE.name: REMOTE, **CURVE_VARIABLES, **REFERENCE_VARIABLES}
"""Variables that a result can have over its steps."""

CONTROLS = {"separation": "m", "force": "N", "pressure": "Pa", "remote": "m"}
"""Quantities that a path can control, with their units: the last three by a machine."""

MEASURED = {**CONTROLS, "force_error": "N", "pressure_error": "Pa"}
"""Columns that a measured curve can have, with their units."""

TRAVEL = Variable("travel", "1", "way of the flat, or of the far end of its spring: clear at 0, at the preload at 1")
"""The coordinate of a path to a preload, which each realisation reaches at a separation of its own."""

PRELOADS = {
    "preload": ("force", "N"),
    "preload_pressure": ("pressure", "Pa"),
    "preload_contact_fraction": ("contact_fraction", "1"),
}
"""Preloads that a path can lead to: the quantity that loading goes on to, and its unit."""

DEFAULT_STEPS = 200
"""Of the loading to a preload."""

STEP_COORDINATES = {**CONTROLS, TRAVEL.name: TRAVEL.units}
"""Coordinates that a result can have over its steps, with their units."""

ASPERITY = _declare(
    ("indentation", "m", "approach past first touch, positive pressed in"),
    ("force", "N", "normal force, compression positive"),
    ("contact_radius", "m", "radius of the contact"),
    ("contact_area", "m2", "area of the contact"),
    ("cohesive_radius", "m", "radius up to which the surfaces attract each other"),
    ("stiffness", "N m-1", "slope dP/d(delta) of the branch"),
    ("remote", "m", "far end of the spring, past where the slack spring brings the tip to first touch"),
)
"""Variables of a single asperity."""

FIELDS = _declare(
    ("r", "m", "distance from the axis of the asperity"),
    ("z", "m", "depth below the surface of the half-space"),
    ("pressure", "Pa", "normal pressure on the surface, compression positive"),
    ("surface_displacement", "m", "normal displacement of the surface, positive into the half-space"),
    ("sigma_zz", "Pa", "normal stress along the axis, tension positive"),
    ("sigma_rr", "Pa", "normal stress across the axis, tension positive"),
    ("shear", "Pa", "largest shear stress at a point of the axis, half of |sigma_zz - sigma_rr|"),
    ("largest_shear", "Pa", "largest shear stress on the axis"),
    ("largest_shear_depth", "m", "depth at which the shear stress on the axis is largest"),
)
"""Fields in the half-space under a single asperity."""

COORDINATES = _declare(
    ("separation", "m", "rigid flat above the datum plane"),
    ("branch", "", "direction in which the flat moved"),
    ("height", "m", "summit height above the datum plane"),
    ("x", "m", "x of the summit"),
    ("y", "m", "y of the summit"),
) | {REMOTE.name: REMOTE, TRAVEL.name: TRAVEL}

DONE, FAILED, NOT_RUN = range(3)
"""Codes of ``status``."""
STATUSES = ("done", "failed", "not_run")
ADHESION_CODES = ("none", "jkr", "dugdale")
ESTIMATORS = ("sampled", "stratified", "expected")


def _tabor_known(scene: Any) -> bool:
    return bool(scene.adhesion_model.tabor_known)


def _pairwise(scene: Any) -> bool:
    return bool(scene.needs_positions)


def _referred(scene: Any) -> bool:
    return scene.reference is not None


def _adhering(scene: Any) -> bool:
    return bool(scene.needs_positions and scene.adhesion_model.work > 0.0)


def _diagnostics(*rows: Diagnostic) -> dict[str, Diagnostic]:
    return {row.name: row for row in rows}


RUN_DIAGNOSTICS = _diagnostics(
    Diagnostic(
        "run_time",
        "s",
        "time spent on the realization, or on all realizations of a statistic",
        merge="add",
        unstated=0.0,
    ),
    Diagnostic(
        "numerical_error", "1", "estimated numerical error of the force over its largest magnitude", unstated=0.0
    ),
    Diagnostic("model_error", "1", "estimated relative error of the force by the assumptions of the model, at most"),
    Diagnostic("interaction_error", "1", "part of the model error: asperities that do not feel each other"),
    Diagnostic("slope_error", "1", "part of the model error: slopes that are not small"),
    Diagnostic("profile_end_error", "1", "part of the model error: contacts beyond the end of their profile"),
    Diagnostic("adhesion_range_error", "1", "part of the model error: JKR, where adhesion reaches further"),
    Diagnostic("resolution_error", "1", "part of the model error: summits or hills that the map does not resolve"),
    Diagnostic("border_error", "1", "part of the model error: hills that the border of a map cuts", unstated=0.0),
    Diagnostic(
        "overlap_fraction",
        "1",
        "share of the contacts that reach into a neighbour's, at closest approach; with pairwise interaction the share "
        "of the force that they carry",
    ),
    Diagnostic(
        "overlap_count",
        "1",
        "number of contacts that overlap a neighbour's, at closest approach",
        in_result=_pairwise,
    ),
    Diagnostic(
        "marked_steps",
        "1",
        "number of steps without an equilibrium, not at rest to the error asked for, or with too much overlap or "
        "contact",
        merge="maximum",
        in_result=_pairwise,
    ),
    Diagnostic(
        "grid_points",
        "1",
        "points of the grid of boundary elements; 0 where contacts are coupled in pairs",
        in_result=_pairwise,
    ),
    Diagnostic(
        "reference_points", "1", "points of the grid of the reference by boundary elements", in_result=_referred
    ),
    Diagnostic(
        "avalanche_count",
        "1",
        "number of separations at which contacts are made or lost in jumps",
        in_result=_adhering,
    ),
    Diagnostic(
        "avalanche_size_max",
        "1",
        "largest number of jumps at one separation",
        merge="maximum",
        in_result=_adhering,
    ),
    Diagnostic("largest_contact_fraction", "1", "largest contact area over the nominal area"),
    Diagnostic("trusted_separation", "m", "separation below which the contact fraction is above 2 %"),
    Diagnostic(
        "edge_slope", "1", "largest slope of a profile at the edge of its contact", merge="maximum", unstated=0.0
    ),
    Diagnostic(
        "profile_extent",
        "1",
        "largest contact radius over the radius where its profile ends",
        merge="maximum",
        unstated=0.0,
    ),
    Diagnostic(
        "status", "1", "outcome of the realization", STATUSES, int, merge="maximum", missing=NOT_RUN, unstated=DONE
    ),
    Diagnostic("tabor_number", "1", "smallest Tabor number of the asperities", merge="fmin", in_result=_tabor_known),
    Diagnostic(
        "adhesion_law",
        "1",
        "adhesion model that was used",
        ADHESION_CODES,
        int,
        merge="maximum",
        missing=0,
        unstated=0,
        in_result=_tabor_known,
    ),
    Diagnostic(
        "remark",
        "",
        "why the realization failed, or why it is doubtful",
        dtype=str,
        merge="first",
        missing="",
        unstated="",
    ),
)
"""Diagnostics of a run: from here task results, checkpoints, resumed files and results have them."""

PULL_OFF_NUMBERS = _declare(
    (
        "pull_off_force",
        "N",
        "largest tension of the unloading, between its steps; none where it ends in contact",
    ),
    ("pull_off_separation", "m", "separation at the largest tension of the unloading"),
    ("pull_off_contacts", "1", "number of contacts that carry the largest tension of the unloading"),
    ("pull_off_contact_area", "m2", "contact area at the largest tension of the unloading"),
)
"""Numbers of the pull-off of each realisation, in the order of ``PullOff``."""

PULL_OFF = PULL_OFF_NUMBERS | _declare(
    ("pull_off_pressure", "Pa", "largest tension of the unloading over nominal area"),
    ("pull_off_contact_fraction", "1", "contact area over nominal area at the largest tension of the unloading"),
    ("pull_off_count", "1", "number of realizations with a pull-off: whose unloading does not end in contact"),
    ("pull_off_force_of_mean", "N", "largest tension of the mean force during unloading"),
    ("pull_off_pressure_of_mean", "Pa", "largest tension of the mean force during unloading, over nominal area"),
)
"""Variables of a result with an unloading."""

RUN_VARIABLES: dict[str, Variable] = RUN_DIAGNOSTICS | _declare(
    ("realization_count", "1", "number of realizations of the statistics"),
    ("nominal_area", "m2", "nominal area of the surface, or of its patch"),
    ("cell_key", "", "hash of everything that decides the numbers of a cell, versions included"),
    ("accuracy_reached", "1", "standard error of the mean force, or error of an expected law, over the largest force"),
    ("accuracy_method", "1", "how the cell was computed", ESTIMATORS),
)
"""Variables of a result that describe its runs and cells."""

AUXILIARY_COORDINATES = (
    "separation",
    "branch",
    "cell_key",
    *(row.name for row in RUN_DIAGNOSTICS.values() if row.dtype is str),
)
"""Coordinates of a result, other than its swept keys; the separation is one unless a machine moves the flat."""
