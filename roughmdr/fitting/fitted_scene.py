"""The scene whose numbers are fitted: it has the path of the measured curve, and no sweep."""

from typing import Any

from roughmdr.errors import SceneError
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.parameters import MACHINE
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import entry_at, set_key
from roughmdr.stages import stages_in


def scene_to_fit(source: Any, changes: Any, curve: MeasuredCurve, free: list[str]) -> tuple[Scene, MeasuredCurve]:
    """Return the scene of a curve: the path begins as measured, and nothing is swept; SceneError where it is wrong.

    A free key that is swept has its first value. The curve has a spring constant only where it is the machine's.
    """
    own: Any = None

    def amend(table: dict[str, Any]) -> None:
        nonlocal own
        path, sweep = table.get("path"), table.pop("sweep", {})
        steps: dict[str, Any] = {curve.control: [float(curve.values[0])]}
        own = path.get("machine_stiffness") if isinstance(path, dict) else None
        if curve.control == "remote" and (stiffness := curve.stiffness if own is None else own) is not None:
            steps["machine_stiffness"] = stiffness
        table["path"] = steps
        for section in ("batch", "accuracy"):
            table.pop(section, None)
        if not all(stage.flat for stage in stages_in(table)):  # else there is no law but the expected one
            table["batch"] = {"estimator": "expected"}
        for key, entries in sweep.items() if isinstance(sweep, dict) else ():
            if key in free:
                _set_first(table, key, entries)
            elif key != "mode" and (key == MACHINE or not key.startswith("path.")):
                raise SceneError(
                    f"sweep.{key}: a curve is of one scene; free the key, or fix it with --set {key}=VALUE"
                )

    scene = read(source, changes, amend)
    return scene, curve if own is None and curve.control == "remote" else curve._replace(stiffness=None)


def _set_first(table: dict[str, Any], key: str, entries: Any) -> None:
    """Set a swept key that the scene leaves out to the first of its entries."""
    if isinstance(entries, dict):
        entries = entries.get("linspace", entries.get("logspace"))
    if entry_at(key, table) is None and isinstance(entries, list) and entries:
        set_key(table, key, entries[0])
