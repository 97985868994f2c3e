"""Variables that describe runs and cells: diagnostics, the pull-off, and how they were computed."""

from typing import Any

from roughmdr.variables.law import CONDUCTANCES
from roughmdr.variables.variable import Diagnostic, Variable, declare

DONE, FAILED, NOT_RUN = range(3)
"""Codes of ``status``."""
STATUSES = ("done", "failed", "not_run")
ADHESION_CODES = ("none", "jkr", "dugdale")
ESTIMATORS = ("sampled", "stratified", "expected")
ORIGINS = ("asperities", "summits", "hills")


def _tabor_known(scene: Any) -> bool:
    return bool(scene.adhesion_model.tabor_known)


def _pairwise(scene: Any) -> bool:
    return bool(scene.needs_positions)


def _adhering(scene: Any) -> bool:
    return bool(scene.needs_positions and scene.adhesion_model.work > 0.0)


def _referred(scene: Any) -> bool:
    return any(stage.on_grid for stage in scene.stages)


def _plastic(scene: Any) -> bool:
    return any(stage.key == "plasticity" for stage in scene.stages)


def _hard(scene: Any) -> bool:
    return scene.material.hardness is not None


def _diagnostics(*rows: Diagnostic) -> dict[str, Diagnostic]:
    return {row.name: row for row in rows}


YIELDING = {
    "yielded_contact_fraction": ("1", "share of the contacts with a mean pressure above the hardness, where closest"),
    "yielded_load_fraction": ("1", "share of the load that these contacts bear, at closest approach"),
    "elastic_pressure": ("Pa", "pressure to which these bear at most 2 % of the load; none where they never bear more"),
    "elastic_separation": ("m", "separation at that pressure"),
    "plasticity_index": ("1", "plasticity index of Greenwood and Williamson: (E*/hardness) sqrt(sigma/R)"),
}
"""Units and meanings of the diagnostics of contacts above the hardness."""

YIELDED = {
    "plastic_contact_fraction": ("1", "share of the contacts that have yielded, at closest approach"),
    "plastic_load_fraction": ("1", "share of the load that these contacts bear, at closest approach"),
}
"""Units and meanings of the diagnostics of contacts that yield."""

_BY_MODEL = {
    "plasticity_area_error": "error of the contact area at given force on loading, by the model of yielding, at most",
    "plasticity_stiffness_error": "error of the stiffness there, at most",
    "plasticity_radius_error": "error of contact radii there, at most",
    "plasticity_softness": "slope of the law over that of elastic contacts of the same radii, at closest approach",
}

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
    Diagnostic("border_error", "1", "part of the model error: what the border of a map cuts", unstated=0.0),
    Diagnostic(
        "plasticity_error",
        "1",
        "part of the model error: the model of yielding, from which others differ",
        unstated=0.0,
        in_result=_plastic,
    ),
    *(Diagnostic(name, "1", words, in_result=_plastic) for name, words in _BY_MODEL.items()),
    Diagnostic(
        "conductance_error",
        "1",
        "estimated relative error of the conductance at given separation by the assumptions of the model, at most",
        in_result=lambda scene: not {"conductance_radius", *CONDUCTANCES}.isdisjoint(scene.output.variables),
    ),
    Diagnostic(
        "tangential_error",
        "1",
        "estimated relative error of the tangential stiffness of contacts that stick, at given separation, at most",
        in_result=lambda scene: "tangential_stiffness" in scene.output.variables and scene.path.lateral is None,
    ),
    Diagnostic(
        "overlap_fraction",
        "1",
        "share of the contacts that reach into a neighbour's, at closest approach; with pairwise interaction the share "
        "of the force that they carry; none for hills",
    ),
    Diagnostic(
        "overlap_count", "1", "number of contacts that overlap a neighbour's, at closest approach", in_result=_pairwise
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
        "avalanche_count", "1", "number of separations at which contacts are made or lost in jumps", in_result=_adhering
    ),
    Diagnostic(
        "avalanche_size_max", "1", "largest number of jumps at one separation", merge="maximum", in_result=_adhering
    ),
    Diagnostic("largest_contact_fraction", "1", "largest contact area over the nominal area"),
    Diagnostic(
        "asperity_origin",
        "1",
        "which part of a surface the asperities stand for",
        ORIGINS,
        int,
        merge="maximum",
        missing=0,
        unstated=0,
    ),
    Diagnostic(
        "effective_contacts",
        "1",
        "effective number of contacts that carry the load at closest approach: squared sum of the magnitudes of their "
        "forces over the sum of the squares",
        merge="fmin",
    ),
    Diagnostic(
        "sampling_error",
        "1",
        "estimated standard deviation of the force at closest approach from patch to patch of this size, at the same "
        "separation, over the summed magnitudes of the forces of the contacts",
    ),
    Diagnostic(
        "area_sampling_error",
        "1",
        "estimated standard deviation of the contact area from patch to patch, at the same force, over the area",
    ),
    Diagnostic("trusted_separation", "m", "separation below which the error by interaction is above the trusted one"),
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
    *(
        Diagnostic(name, *told, merge="fmin" if name == "elastic_pressure" else "fmax", in_result=_hard)
        for name, told in YIELDING.items()
    ),
    *(Diagnostic(name, *told, in_result=_plastic) for name, told in YIELDED.items()),
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

SAMPLE = ("effective_contacts", "sampling_error", "area_sampling_error")
"""Diagnostics that tell how far one sample of a surface stands for others."""

PULL_OFF_NUMBERS = declare(
    ("pull_off_force", "N", "largest tension of the unloading, between its steps; none where it ends in contact"),
    ("pull_off_separation", "m", "separation at the largest tension of the unloading"),
    ("pull_off_contacts", "1", "number of contacts that carry the largest tension of the unloading"),
    ("pull_off_contact_area", "m2", "contact area at the largest tension of the unloading"),
)
"""Numbers of the pull-off of each realisation, in the order of ``PullOff``."""

PULL_OFF_PER_AREA = declare(
    ("pull_off_pressure", "Pa", "largest tension of the unloading over nominal area"),
    ("pull_off_contact_fraction", "1", "contact area over nominal area at the largest tension of the unloading"),
)
"""Numbers of the pull-off of each realisation over the nominal area, where that is known."""

PULL_OFF_OF_CELLS = declare(
    ("pull_off_count", "1", "number of realizations with a pull-off: whose unloading does not end in contact"),
    ("pull_off_force_of_mean", "N", "largest tension of the mean force during unloading"),
    ("pull_off_pressure_of_mean", "Pa", "largest tension of the mean force during unloading, over nominal area"),
)
"""Numbers of the pull-off of each cell."""

PULL_OFF = PULL_OFF_NUMBERS | PULL_OFF_PER_AREA | PULL_OFF_OF_CELLS
"""Variables of a result with an unloading."""

OVER_AREA = {
    "force": "pressure",
    "contact_area": "contact_fraction",
    "pull_off_force": "pull_off_pressure",
    "pull_off_force_of_mean": "pull_off_pressure_of_mean",
    "pull_off_contact_area": "pull_off_contact_fraction",
}
"""Totals, and the variables that are these over the nominal area."""

CELL_VARIABLES = declare(
    ("realization_count", "1", "number of realizations of the statistics"),
    ("nominal_area", "m2", "nominal area of the surface, or of its patch"),
    ("cell_key", "", "hash of everything that decides the numbers of a cell, versions included"),
    ("accuracy_reached", "1", "standard error of the mean force, or error of an expected law, over the largest force"),
    ("accuracy_method", "1", "how the cell was computed", ESTIMATORS),
)
"""Variables of a result that describe its cells."""

RUN_VARIABLES: dict[str, Variable] = RUN_DIAGNOSTICS | CELL_VARIABLES
"""Variables of a result that describe its runs and cells."""

STATISTICS = {"mean": "mean", "sem": "standard error of the mean", "min": "least", "max": "greatest"}
"""Endings of the names of statistics over realisations, and these in words."""

INFINITE_VARIANCE = "not computed where contacts detach: there k goes to minus infinity and has no finite variance"
"""Comment on the standard error of the stiffness."""

AUXILIARY_COORDINATES = (
    "separation",
    "time",
    "branch",
    "cell_key",
    *(row.name for row in RUN_DIAGNOSTICS.values() if row.dtype is str),
)
"""Coordinates of a result, other than its swept keys; the separation is one unless a machine moves the flat."""


def plain_name(key: str) -> str:
    """Return the name of a key in a result: with underscores for dots and brackets."""
    return key.replace("].", "_").replace("[", "_").replace(".", "_")


def swept_name(key: str) -> str:
    """Return the name of a swept key in a result: as ``plain_name``, and with "swept_" if a variable is so named."""
    name = plain_name(key)
    return f"swept_{name}" if name in RUN_VARIABLES else name
