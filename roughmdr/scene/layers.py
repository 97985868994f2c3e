"""Sections of what is made of the law of the contacts: what they need of the scene, and what they do not go with."""

from typing import Any

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.scene.conduction import NEEDED
from roughmdr.scene.content import Sections
from roughmdr.scene.tangential import bodies_of, ratio_of
from roughmdr.schema.faults import mismatch
from roughmdr.shapes import SHAPES, Shape
from roughmdr.variables import CONDUCTANCES, DEFAULT_LATERAL_VARIABLES, DEFAULT_VARIABLES, TANGENTIAL_VARIABLES

_NOT_VISCOELASTIC = ("stiffness", "energy", "dissipated_energy", "machine_dissipated_energy")
"""Variables that a viscoelastic law does not have."""
_NOMINAL_VARIABLES = ("force", "contact_area", "contact_count", "contact_radius_sum", "stiffness", "model_error_curve")
"""Variables of a law under a curved body."""
_STICKING = "tangential_stiffness"
_NOT_TANGENTIAL = (
    (
        "interaction",
        "interaction",
        "contacts that feel each other begin to slip at different displacements; the scene without path.lateral gives "
        "their tangential_stiffness before any slips, without [interaction] it gives slip",
    ),
    ("adhesion", "path.lateral", "the shear of adhesive contacts is no difference of normal contacts"),
    ("reference", "reference", "boundary elements press along the normal only"),
)
"""Section, key at fault, and why a lateral path does not go with it."""


def with_usual_variables(table: Any) -> Any:
    """Return a scene's table with the variables that such a law has where the output names none."""
    path, output = table.get("path"), table.get("output", {})
    lateral = path.get("lateral") if isinstance(path, dict) else getattr(path, "lateral", None)
    if not isinstance(output, dict) or "variables" in output:
        return table
    if lateral is not None:
        usual = list(DEFAULT_LATERAL_VARIABLES)
    elif table.get("viscoelastic") is not None:
        usual = [name for name in DEFAULT_VARIABLES if name not in _NOT_VISCOELASTIC]
    else:
        return table
    return {**table, "output": {**output, "variables": usual}}


def check_layers(scene: Sections) -> None:
    """Raise a mismatch where one of these sections lacks something, or does not go with another section."""
    alone = {"path.lateral": scene.path.lateral, "viscoelastic": scene.viscoelastic, "nominal": scene.nominal}
    given = [key for key, section in alone.items() if section is not None]
    if len(given) > 1:
        raise mismatch(given[0], f"does not go with {given[1]}: each is of the elastic law under a flat")
    _check_conduction(scene)
    _check_tangential(scene)
    _check_viscoelastic(scene)
    _check_nominal(scene)


def _check_conduction(scene: Sections) -> None:
    """Raise the fault of a conductance that is asked for without what it takes."""
    for name in scene.output.variables:
        if name in CONDUCTANCES and name not in scene.conductance_factors:
            raise mismatch("output.variables", f"{name} needs conduction.{NEEDED[name]}")


def _check_tangential(scene: Sections) -> None:
    """Raise a mismatch where lateral forces are asked for that other sections do not go with, or do not tell."""
    tangential, path, bodies = scene.tangential, scene.path, bodies_of(scene.material, scene.counter)
    against = {"interaction": scene.interaction, "adhesion": scene.work or None, "reference": scene.reference}
    lateral, asked = path.lateral is not None, [name for name in scene.output.variables if name in TANGENTIAL_VARIABLES]
    if not lateral and (wrong := [name for name in asked if name != _STICKING]):
        raise mismatch("output.variables", f"{wrong[0]} needs a lateral path: path.lateral")
    if tangential is not None and tangential.stiffness_ratio is not None and bodies is not None:
        raise mismatch("tangential.stiffness_ratio", "follows from the modulus and poisson of [material] already")
    if not lateral and not asked:
        return
    subject = "path.lateral" if lateral else f"{_STICKING} among output.variables"
    if tangential is None or (lateral and tangential.friction is None):
        raise mismatch("tangential.friction" if lateral else "tangential", f"is missing; {subject} needs it")
    if ratio_of(tangential, bodies) is None:
        message = f"is missing; {subject} needs G*/E*, which material.effective_modulus does not tell"
        raise mismatch("tangential.stiffness_ratio", message)
    for section, key, reason in _NOT_TANGENTIAL:
        if lateral and against[section] is not None:
            raise mismatch(key, f"does not go with {subject if key != 'path.lateral' else section}: {reason}")


def _check_viscoelastic(scene: Sections) -> None:
    """Raise a mismatch where [viscoelastic], if it is there, does not go with another section of a scene."""
    if scene.viscoelastic is None:
        return
    path = scene.path
    others = {"adhesion": scene.work > 0.0, "interaction": scene.interaction, "reference": scene.reference}
    for name, other in others.items():
        if other:
            raise mismatch(name, "does not go with [viscoelastic]: its asperities are independent and do not adhere")
    if path.control != "separation":
        raise mismatch(f"path.{path.key}", "does not go with [viscoelastic], which needs path.separation")
    if unknown := [name for name in scene.output.variables if name in _NOT_VISCOELASTIC]:
        raise mismatch("output.variables", f"{', '.join(unknown)} cannot be computed with [viscoelastic]")


def _check_nominal(scene: Sections) -> None:
    """Raise a mismatch where a curved body, if there is one, does not go with another section of a scene."""
    if scene.nominal is None:
        return
    if scene.interaction is not None:
        raise mismatch("nominal", "does not go with [interaction]: the half-space gives way under all asperities")
    if scene.reference is not None:
        raise mismatch("nominal", "does not go with [reference]: boundary elements press a flat")
    if scene.path.control != "separation":
        raise mismatch("nominal", f"goes with path.separation, not with path.{scene.path.key}")
    if scene.path.target is not None:
        raise mismatch(f"path.separation.stop.{scene.path.target.variable}", "does not go with [nominal]")
    for name in scene.output.variables:
        if name not in _NOMINAL_VARIABLES:
            allowed = ", ".join(_NOMINAL_VARIABLES)
            raise mismatch("output.variables", f"{name!r} is not available with [nominal]; there are {allowed}")
    if scene.estimators != ("expected",):
        key = "batch.estimator" if scene.accuracy is None else "accuracy.method"
        raise mismatch(key, 'must be "expected" with [nominal]: the layer has the expected law of its asperities')
    if reason := scene.reason_against("expected"):
        raise mismatch("nominal", f"needs the expected law of the asperities: {reason}")
    if scene.asperities.equal_heights:
        raise mismatch("nominal", "needs asperities whose heights scatter: all heights are the same")
    if scene.asperities.nominal_area is None:
        raise mismatch("nominal", "needs asperities on a patch, which tells how many there are per area")
    if reason := _against_adhesion(scene.adhesion_model, SHAPES[scene.asperities.shape_name]):
        raise mismatch("adhesion.model", f"does not go with [nominal]: {reason}")


def _against_adhesion(adhesion: Adhesion, asperity: type[Shape]) -> str:
    """Return why rings cannot remember the contacts of such asperities; empty where they can."""
    if adhesion.work == 0.0:
        return ""
    if adhesion.model != "jkr":
        return f"rings remember contacts of model 'jkr', not of {adhesion.model!r}"
    if asperity.branched():
        return f"contacts of a {asperity.name} have several stable branches, which rings do not remember"
    return ""
