"""Draws what makes a scene viscoelastic: times and speeds of any size, and a path that falls and rises once."""

from hypothesis import strategies as st

from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES
from studies.random_scenes.numbers import Draw, Table, number, power_of_ten

_VARIABLES = sorted(name for name in CURVE_VARIABLES | CONDUCTANCES if name != "stiffness" and "energy" not in name)


def viscoelastic(draw: Draw, size: float, datum: float) -> Table:
    """Draw [viscoelastic], with the [path] and the variables that it allows; heights are of a size around a datum."""
    count = draw(st.integers(1, 3))
    terms = [{"time": number(draw, -12.0, 12.0), "share": draw(st.floats(0.0, 1.0)) / count} for _ in range(count)]
    section: Table = {"relaxation": terms, "speed": number(draw, -12.0, 12.0, size)}
    if draw(st.booleans()):
        section["retraction_speed"] = number(draw, -12.0, 12.0, size)
    start, stop = draw(st.floats(0.0, 5.0)), draw(st.floats(-3.0, -0.1))
    steps = draw(st.integers(2, 15))
    separation = {"start": datum + start * size, "stop": datum + stop * size, "steps": steps}
    path: Table = {"separation": separation, "unload": draw(st.booleans()), "hold": draw(st.integers(0, 3))}
    if path["unload"] or path["hold"]:
        section["dwell"] = draw(st.sampled_from((0.0, power_of_ten(draw, -12.0, 12.0))))
    return {"viscoelastic": section, "path": path, "output": {"variables": _VARIABLES}}
