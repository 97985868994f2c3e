"""The picture of ``estimators.py``, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = {"sampled": "#c8553d", "stratified": "#1b6ca8", "expected": "#2e8b57"}
_LEAST = 1e-17  # what cannot be seen beside a rounding
_TICKS = np.logspace(-16, 0, 9)


def draw(result: xr.Dataset) -> "Figure":
    """Error against run time, a panel for each scene; and how the expected law converges over the radii."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 8.4), layout="constrained")
    panels = figure.subplots(2, 3)
    for panel, title in zip(panels.flat, result.scene.to_numpy(), strict=False):
        _draw_scene(panel, result.sel(scene=title))
        panel.set(xlim=(5e-5, 1.0), ylim=(_LEAST, 1e7), yticks=_TICKS, title=title)
    for panel in panels[:, 0]:
        panel.set_ylabel("error of the force over its largest")
    _draw_orders(panels[1, 2], result)
    return figure


def _draw_scene(panel: "Axes", own: xr.Dataset) -> None:
    for method in own.estimator.to_numpy():
        line = own.sel(estimator=method)
        label = f"{method}: N^{float(line.slope_count):.2f}, time^{float(line.slope_time):.2f}"
        panel.loglog(line.seconds, line.error, "o-", color=_COLOURS[method], ms=4, label=label)
    rate, colour = float(own.decades_a_node), _COLOURS["expected"]
    if rate:
        label = f"expected: {rate:.1f} decades a node of the radius"
        panel.loglog(own.order_seconds, own.order_error, "s-", color=colour, ms=4, label=label)
    found = max(float(own.reference_error), _LEAST)
    time = float(own.expected_seconds.sel(asked="force"))
    label = f"expected, as it comes: {1e3 * time:.0f} ms, {found:.0e} from 25 digits"
    panel.loglog(time, found, "*", color=colour, ms=14, mec="k", label=label)
    panel.axhline(float(own.numerical_error), color=colour, lw=0.8, ls=":")
    panel.text(6e-5, 1.5 * float(own.numerical_error), "error it states", color=colour, fontsize=8)
    panel.set_xlabel("run time of 200 separations [s]")
    panel.legend(fontsize=8, loc="upper left")


def _draw_orders(panel: "Axes", result: xr.Dataset) -> None:
    for number, spread in enumerate(result.spread.to_numpy()):
        error = np.maximum(result.spread_error.sel(spread=spread), _LEAST)
        panel.semilogy(
            result.order, error, "s-", color=f"C{number}", ms=4, label=f"std of the radii {spread:g} of their mean"
        )
    panel.set(xlabel="nodes of Gauss's rule over the radii", ylim=(_LEAST, 1e3), yticks=_TICKS)
    panel.set_title("JKR, normal heights: convergence over the radii")
    panel.legend(fontsize=8)
