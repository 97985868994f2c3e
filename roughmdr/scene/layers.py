"""Sections of what is made of the law of the contacts: what they need of the scene, and what they do not go with."""

from typing import TYPE_CHECKING, Any

from roughmdr.scene.conduction import check_conduction
from roughmdr.scene.nominal import check_nominal
from roughmdr.scene.tangential import check_tangential
from roughmdr.scene.viscoelastic import check_viscoelastic, without_unknown
from roughmdr.schema.faults import mismatch
from roughmdr.variables import DEFAULT_LATERAL_VARIABLES

if TYPE_CHECKING:
    from roughmdr.scene.scene import Scene


def with_usual_variables(table: Any) -> Any:
    """Return a scene's table with the variables that such a law has where the output names none."""
    path, output = table.get("path"), table.get("output", {})
    lateral = path.get("lateral") if isinstance(path, dict) else getattr(path, "lateral", None)
    if not isinstance(output, dict) or "variables" in output:
        return table
    if lateral is not None:
        usual = list(DEFAULT_LATERAL_VARIABLES)
    elif table.get("viscoelastic") is not None:
        usual = without_unknown()
    else:
        return table
    return {**table, "output": {**output, "variables": usual}}


def check_layers(scene: "Scene") -> None:
    """Raise a mismatch where one of these sections lacks something, or does not go with another section."""
    alone = {"path.lateral": scene.path.lateral, "viscoelastic": scene.viscoelastic, "nominal": scene.nominal}
    given = [key for key, section in alone.items() if section is not None]
    if len(given) > 1:
        raise mismatch(given[0], f"does not go with {given[1]}: each is of the elastic law under a flat")
    check_conduction(scene)
    check_tangential(scene)
    check_viscoelastic(scene)
    check_nominal(scene)
