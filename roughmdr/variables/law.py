"""Variables of a load-separation law over its steps, and quantities that a path controls."""

from roughmdr.variables.variable import Variable, declare

CURVE_VARIABLES = declare(
    ("force", "N", "normal force of all asperities, compression positive"),
    ("contact_area", "m2", "sum of the contact areas"),
    ("contact_count", "1", "number of asperities in contact"),
    ("stiffness", "N m-1", "sum of the slopes dP/d(delta) of the branches, jumps not included"),
    ("pressure", "Pa", "force over nominal area"),
    ("contact_fraction", "1", "contact area over nominal area"),
    ("contact_radius_sum", "m", "sum of the contact radii"),
    ("conductance_radius", "m", "radius of the one circular contact that conducts as well as all"),
    ("energy", "J", "elastic and surface energy of all contacts, 0 out of contact"),
    ("dissipated_energy", "J", "energy lost in jumps since the start of the path"),
    ("machine_dissipated_energy", "J", "part of it that the machine loses in its jumps; 0 under fixed grips"),
    (
        "model_error_curve",
        "1",
        "estimated relative error of the force by the assumptions of the model; parts "
        "by JKR are over the largest force",
    ),
)
"""Variables of the contacts."""

CONDUCTANCES = declare(
    ("thermal_conductance", "W K-1", "thermal conductance of all contacts"),
    ("electrical_conductance", "S", "electrical conductance of all contacts"),
)
"""Conductances, of the dimension of a conductivity times the conductance radius; those of a scene with [conduction]."""

TANGENTIAL_VARIABLES = declare(
    ("tangential_force", "N", "lateral force of all asperities at the lateral displacement"),
    ("tangential_stiffness", "N m-1", "slope of the lateral force; on a normal path that of contacts that stick"),
    ("friction_energy", "J", "energy lost by slip since the start of the lateral path"),
)
"""Variables that follow from a normal law and [tangential]."""

OUTPUT_VARIABLES = CURVE_VARIABLES | CONDUCTANCES | TANGENTIAL_VARIABLES
"""All variables that [output] can name."""

DEFAULT_VARIABLES = ("force", "contact_area", "contact_count", "stiffness")
DEFAULT_LATERAL_VARIABLES = ("tangential_force", "tangential_stiffness", "force")

SEPARATION = Variable("separation", "m", "rigid flat above the datum plane; none where a dead load has pulled it off")
"""A variable where a machine moves the flat, else a coordinate."""

REMOTE = Variable(
    "remote", "m", "far end of the machine's spring above the datum plane, where its force is 0 at the flat"
)
"""A coordinate where a path controls it, a variable where it follows from a preload."""

TIME = Variable("time", "s", "time since the first step")
"""A coordinate of a viscoelastic law."""

MODEL_ERROR = "_model_error"
"""Ending of the names of errors of the model."""
WITH_MODEL_ERROR = (
    SEPARATION.name,
    *("force", "pressure", "contact_area", "contact_fraction", "stiffness", "contact_radius_sum", "conductance_radius"),
    *CONDUCTANCES,
)
"""Variables whose error of the model can be told."""

DERIVATIVE, DERIVATIVE_ERROR = "_derivative", "_derivative_error"
"""Endings of the names of derivatives with respect to numbers of the scene, and of their errors."""

REFERENCE_VARIABLES = declare(
    ("reference_separation", "m", "rigid flat above the datum plane under the same load by boundary elements"),
    ("reference_force", "N", "normal force by boundary elements"),
    ("reference_contact_area", "m2", "contact area by boundary elements"),
    ("reference_contact_count", "1", "number of connected contacts by boundary elements"),
    ("reference_stiffness", "N m-1", "slope -dF/dh by boundary elements"),
    ("reference_pressure", "Pa", "force over nominal area by boundary elements"),
    ("reference_contact_fraction", "1", "contact area over nominal area by boundary elements"),
    ("reference_conductance_radius", "m", "radius of one contact that conducts as well, by boundary elements"),
    ("reference_thermal_conductance", "W K-1", "thermal conductance by boundary elements"),
    ("reference_electrical_conductance", "S", "electrical conductance by boundary elements"),
    ("reference_error", "1", "estimated relative error of the force by boundary elements, by their grid"),
    ("reference_area_error", "1", "estimated relative error of the contact area at given force, by the grid"),
)
"""Variables of a law by boundary elements beside that of the asperities."""

LATERAL = Variable("lateral", "m", "lateral displacement of the flat, from rest")
"""The coordinate of a lateral path, at constant separation or load."""

NOMINAL_VARIABLES = declare(
    ("nominal_contact_radius", "m", "effective radius of the pressure of the contacts that push under a curved body"),
)
"""Variables of a law under a curved body beside those asked for."""

LAW_VARIABLES = {
    **{each.name: each for each in (SEPARATION, REMOTE, LATERAL, TIME)},
    **OUTPUT_VARIABLES,
    **REFERENCE_VARIABLES,
    **NOMINAL_VARIABLES,
}
"""Variables that a result can have over its steps."""

CONTROLS = {"separation": "m", "force": "N", "pressure": "Pa", "remote": "m"}
"""Quantities that a path can control, with their units: the last three by a machine."""

BRANCHES = ("loading", "unloading")
"""Values of the coordinate ``branch``."""

MEASURED = {**CONTROLS, "piezo": "m", "force_error": "N", "pressure_error": "Pa"}
"""Columns that a measured curve can have, with their units."""

TRAVEL = Variable("travel", "1", "way of the flat, or of the far end of its spring: clear at 0, at the preload at 1")
"""The coordinate of a path to a preload, which each realisation reaches at a separation of its own."""

PRELOADS = {
    "preload": ("force", "N"),
    "preload_pressure": ("pressure", "Pa"),
    "preload_contact_fraction": ("contact_fraction", "1"),
}
"""Preloads that a path can lead to: the quantity at which loading ends, and its unit."""

LOSSES = {"dissipated_energy", "machine_dissipated_energy"}
"""Energies that jumps lose; under a machine each jump is located for them."""

DEFAULT_STEPS = 200
"""Default number of steps of the loading to a preload."""

STEP_COORDINATES = {**CONTROLS, TRAVEL.name: TRAVEL.units, LATERAL.name: LATERAL.units}
"""Coordinates that a result can have over its steps, with their units."""

COORDINATES = declare(
    ("separation", "m", "rigid flat above the datum plane"),
    ("branch", "", "direction in which the flat moved"),
    ("height", "m", "summit height above the datum plane"),
    ("x", "m", "x of the summit"),
    ("y", "m", "y of the summit"),
) | {each.name: each for each in (REMOTE, TRAVEL, LATERAL, TIME)}
