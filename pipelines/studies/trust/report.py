"""The study of the stated error: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FACTOR = 3.0
"""Within which the model error is to be of the true one."""
_ORACLES = {
    "pairs": "asperities that feel each other in pairs",
    "boundary elements": "boundary elements",
    "map": "boundary elements on the map",
    "maps": "boundary elements, mean of Gaussian maps",
    "none": "",
}
_COLOURS = dict(zip(_ORACLES, ("#1b6ca8", "#c8553d", "#8a5fb0", "#2e8b57", "0.6"), strict=True))


def errors(result: xr.Dataset) -> Floats:
    """Return the true relative error of the force in each scene, 1 in full contact; NaN of those refused."""
    return np.asarray(np.abs(1.0 - result["force"] / result["true_force"]))


def judge(result: xr.Dataset) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return of each scene whether the model error bounds the true one, and whether it is within FACTOR of it."""
    error, stated = errors(result), result["model_error"].to_numpy()
    return error <= stated, (stated <= FACTOR * error) & (error <= FACTOR * stated)


def draw(result: xr.Dataset) -> "Figure":
    """Draw the model error over the true error, a point a scene."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 6.0), layout="constrained")
    axes = figure.subplots()
    error, stated = errors(result), result["model_error"].to_numpy()
    ends = np.array([0.01, 3.0])
    axes.fill_between(ends, ends, FACTOR * ends, color="0.92", lw=0, label="bounds it, within a factor of 3")
    axes.loglog(ends, ends, color="k", lw=1)
    for oracle, words in _ORACLES.items():
        own = np.isfinite(error) & (result["oracle"].to_numpy() == oracle)
        if own.any():
            axes.plot(error[own], stated[own], "o", color=_COLOURS[oracle], label=words)
    for rank, i in enumerate(np.argsort(error)):
        if np.isfinite(error[i]):
            side, off = ("left", (6, -8)) if rank % 2 else ("right", (-6, 3))
            name = str(result["name"].values[i])
            axes.annotate(name, (error[i], stated[i]), xytext=off, textcoords="offset points", fontsize=8, ha=side)
    axes.set(xlim=ends, ylim=ends, xlabel="true error of the force (relative)", ylabel="model error that is stated")
    axes.grid(color="0.9", which="both", lw=0.5)
    axes.set_axisbelow(True)
    axes.legend(loc="lower right", fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the table of the scenes, the counts, and the lines that were printed."""
    error = errors(result)
    known = np.isfinite(error)
    bounded, within = judge(result)
    contact, stated = (result[name].to_numpy() for name in ("contact_fraction", "model_error"))
    rows, printed = [], []
    for i, name in enumerate(result["name"].to_numpy().tolist()):
        lines = str(result["printed"].values[i]).splitlines()
        printed.append("\n".join([f"{name}:", *(f"    {line}" for line in lines)]))
        changes = f" ({result['changes'].values[i]})" if result["changes"].values[i] else ""
        if not known[i]:
            rows.append([name + changes, "", f"refused, exit status {result['exit_status'].values[i]}", *[""] * 5])
            continue
        oracle = str(result["oracle"].values[i])
        numbers = [_percent(part[i]) for part in (stated, error)]
        answers = ["yes" if part[i] else "no" for part in (bounded, within)]
        trust = next((line[12:].strip() for line in lines if line.startswith("trust")), "")
        rows.append([name + changes, _percent(contact[i]), trust, *numbers, _ORACLES[oracle], *answers])
    head = ["scene", "contact", "trust", "model error", "true error", "by", "bounded", f"within a factor of {FACTOR:g}"]
    refused = int((~known).sum())
    return f"""
The stated error of the force at closest approach, against the true one. In {int(known.sum())} scenes with a force the
model error bounds the true error in {int(bounded[known].sum())}, and is within a factor of {FACTOR:g} of it in
{int(within[known].sum())}; {refused} more {"is" if refused == 1 else "are"} refused. {_pull_off(result)}

{table(head, rows)}

Printed:

{chr(10).join(printed)}
"""


def _pull_off(result: xr.Dataset) -> str:
    """Return how far off the pull-off forces are."""
    off = np.abs(1.0 - result["pull_off"].to_numpy() / result["true_pull_off"].to_numpy())
    known = np.flatnonzero(np.isfinite(off))
    each = ", ".join(f"{_percent(off[i])} ({result['name'].values[i]})" for i in known)
    return f"Pull-off forces are off by {each}, by pairs." if known.size else ""


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"
