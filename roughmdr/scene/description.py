"""Parts of a scene in words: its asperities, its path, the values of a swept key. No file is read."""

from roughmdr.ensemble import Source
from roughmdr.scene.lateral import displacements
from roughmdr.scene.path import FlatPath
from roughmdr.scene.separation import CLEAR, Separation, Target
from roughmdr.scene.sweep import Axis
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import printable
from roughmdr.variables import CONTROLS, CURVE_VARIABLES, PRELOADS


def asperities_in_words(section: Source) -> str:
    """Return how many there are, their shape and source, or the files that they are read from."""
    if section.is_random:
        lattice = f", {section.lattice_in_words}" if section.lattice_in_words else ""
        return f"{section.expected_count:.10g} of shape {section.shape_name}, source {section.source}{lattice}"
    return f"source {section.source}: {', '.join(printable(str(file)) for file in section.inputs)}"


def path_in_words(path: FlatPath) -> str:
    """Return the ends of a path, and its steps."""
    given = getattr(path, path.key)
    if path.lateral is not None:
        held = f"{path.key} {_end(given, CONTROLS[path.key])}"
        steps = f"lateral in {displacements(path.lateral).size} steps at {held}"
    elif isinstance(given, list):
        steps = f"{path.key} in {len(given)} steps"
    elif path.to_preload:
        steps = f"{path.key} {format_quantity(given, PRELOADS[path.key][1])} in {path.steps} steps"
    else:
        start = CLEAR if path.starts_clear else _end(given.start, CONTROLS[path.key])
        steps = f"{path.key} from {start} to {_end(given.stop, CONTROLS[path.key])} in {given.steps} steps"
    return f"{steps}{f', held for {path.hold}' if path.hold else ''}{', and back' if path.unload else ''}"


def _end(end: Separation | Target | float, unit: str) -> str:
    """Return an end of a range with its unit."""
    if isinstance(end, Target):
        return (
            f"a {end.variable.replace('_', ' ')} of {format_quantity(end.value, CURVE_VARIABLES[end.variable].units)}"
        )
    if isinstance(end, Separation):
        return f"{end.value:g} sigma" if end.in_sigma else format_quantity(end.value, unit)
    return format_quantity(end, unit)


def axis_in_words(axis: Axis) -> str:
    """Return the range of the values of a swept key, or its names."""
    if axis.values.dtype.kind == "U":
        return ", ".join(map(str, axis.values))
    low, high = float(axis.values.min()), float(axis.values.max())
    return f"{format_quantity(low, axis.unit, to=high)} ({axis.values.size} values)"
