"""One panel of a law: curves of one quantity over another, with what is drawn over them."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.curves import Curve, Quantity, quantiles
from roughmdr.pictures.style import Scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_NAMED = 8
"""Most cells that a legend names, and whose errors are drawn; more are distinguished by a colour bar."""
MAX_RUNS, _SOME_RUNS = 64, 16
"""Most realisations that are all drawn as lines; more are drawn as a band of most of them with some lines."""
_MOST = (0.05, 0.95)
_FOR_RANGE = 256  # most realisations that determine the range of an axis
_DECADES = 4.0  # maximum number of decades of a logarithmic axis
_EXPONENTIAL = 1e3  # ratio of the largest to the least positive value from which an axis is logarithmic
_INSETS = ((0.42, 0.5, 0.55, 0.46), (0.12, 0.12, 0.36, 0.24))
"""Possible positions of an inset, in shares of a panel: left, bottom, width and height."""
_SIGNED = ("force", "pressure", "stiffness", "tangential_force")

Style = dict[str, Any]


class Mark(NamedTuple):
    """A point with its standard errors: a pull-off."""

    x: float
    y: float
    x_error: float
    y_error: float
    colour: str


class Panel(NamedTuple):
    """The content of one panel, in SI, and its style."""

    quantity: Quantity
    x: Quantity
    curves: Sequence[Curve]
    styles: Sequence[Style]  # of each curve
    overlays: Sequence[tuple[Floats, Floats, Style]]
    marks: Sequence[Mark]
    trusted: float  # separation below which the law is not to be trusted; NaN where that is not drawn
    log: bool | None  # None: where the curves are exponential
    cells: int  # with one its realisations are shown, with many no errors


def draw_panel(ax: "Axes", panel: Panel) -> None:
    """Draw a panel; units and the kind of its axis follow from what is in it."""
    quantity, x = panel.quantity, panel.x
    x_scale = Scale.of(_joined([curve.x for curve in panel.curves]), x.name, x.unit)
    visible = _visible(panel)
    scale = Scale.of(visible, quantity.name, quantity.unit)
    log = _is_exponential(panel) if panel.log is None else panel.log

    def draw_means(axes: "Axes") -> None:
        for curve, style in zip(panel.curves, panel.styles, strict=True):
            alone: Style = {"marker": "o", "ms": 4.5} if curve.x.size == 1 else {}
            axes.plot(x_scale(curve.x), _drawn(scale(curve.middle), log=log), **style, **alone)
        for over, values, style in panel.overlays:
            axes.plot(x_scale(over), _drawn(scale(values), log=log), **style)
        for mark in panel.marks:
            axes.errorbar(
                float(x_scale(mark.x)), float(scale(mark.y)), xerr=_bar(mark.x_error, x_scale),
                yerr=_bar(mark.y_error, scale), fmt="o", ms=4.5, mfc="white", mew=1.3, capsize=2.0, elinewidth=1.0,
                color=mark.colour, zorder=6,
            )  # fmt: skip

    for curve, style in zip(panel.curves, panel.styles, strict=True):
        if panel.cells <= MAX_NAMED:
            _draw_bands(ax, curve, style["color"], (x_scale, scale), alone=panel.cells == 1)
    draw_means(ax)
    if quantity.variable in _SIGNED and not log:
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    _set_range(ax, scale(visible), log=log)
    if np.isfinite(panel.trusted):
        left, right = ax.get_xlim()
        ax.axvspan(left, float(x_scale(panel.trusted)), color="0.5", alpha=0.12, lw=0, zorder=0.2)
        ax.set_xlim(left, right)
    if quantity.variable in ("force", "pressure") and x.variable in ("separation", "remote") and not log:
        _add_tension_inset(ax, panel, (x_scale, scale), draw_means)
    ax.set_ylabel(scale.label)
    ax.set_xlabel(x_scale.label)


def _bar(error: float, scale: Scale) -> float | None:
    return float(scale(2.0 * error)) if np.isfinite(error) else None


def _draw_bands(ax: "Axes", curve: Curve, colour: str, scales: tuple[Scale, Scale], *, alone: bool) -> None:
    """Draw the error of the model, the realisations and twice the standard error, one over the other."""
    x_scale, scale = scales
    x = x_scale(curve.x)
    if np.isfinite(curve.model_error).any():
        middle, off = scale(curve.middle), scale(curve.model_error)
        ax.fill_between(x, middle - off, middle + off, color="0.5", alpha=0.25, lw=0, zorder=0.5)
    if alone and (count := curve.runs.computed.size) > 1:
        shown = count
        if shown > MAX_RUNS:
            shown = _SOME_RUNS
            low, high = curve.runs.quantiles(list(_MOST))
            ax.fill_between(x, scale(low), scale(high), color=colour, alpha=0.12, lw=0, zorder=1)
        some = np.unique(np.linspace(0, count - 1, shown).astype(int))
        drawn = x_scale(curve.runs_x.some(some)).T, scale(curve.runs.some(some)).T
        ax.plot(*drawn, color=colour, lw=0.3, alpha=0.25, zorder=1.2)
    ax.fill_between(x, scale(curve.low), scale(curve.high), color=colour, alpha=0.3, lw=0, zorder=1.5)


def _visible(panel: Panel) -> Floats:
    """Return the values that the axis must show."""
    shown = [curve.middle for curve in panel.curves] + [values for _, values, _ in panel.overlays]
    shown += [mark.y + np.array([-2.0, 2.0]) * np.nan_to_num(mark.y_error) for mark in panel.marks]
    if panel.quantity.variable != "stiffness" and panel.cells <= MAX_NAMED:
        shown += [edge for curve in panel.curves for edge in (curve.low, curve.high)]
    if panel.cells == 1 and panel.quantity.variable != "stiffness":
        runs = [curve.runs for curve in panel.curves if curve.runs.computed.size]
        some = [each.some(slice(None, None, each.computed.size // _FOR_RANGE + 1)) for each in runs]
        shown += [quantiles(each, list(_MOST), axis=0).ravel() for each in some]
    values = _joined(shown)
    return values if values.size else np.zeros(1)


def _joined(arrays: Sequence[Floats]) -> Floats:
    values = np.concatenate([np.ravel(array) for array in arrays]) if arrays else np.zeros(0)
    return np.asarray(values[np.isfinite(values)])


def _is_exponential(panel: Panel) -> bool:
    """Return whether the curves lie over many decades, without tension."""
    middles = _joined([curve.middle for curve in panel.curves])
    if not panel.x.variable.startswith(("separation", "remote")) or not middles.size or middles.min() < 0.0:
        return False
    positive = middles[middles > 0.0]
    return bool(positive.size > 1 and positive.max() > _EXPONENTIAL * np.quantile(positive, 0.1))


def _drawn(values: Floats, *, log: bool) -> Floats:
    return np.where(values > 0.0, values, np.nan) if log else values


def _set_range(ax: "Axes", visible: Floats, *, log: bool) -> None:
    if log:
        positive = visible[visible > 0.0]
        if positive.size:
            top, bottom = float(positive.max()), float(positive.min())
            ax.set_yscale("log")
            ax.set_ylim(0.7 * max(bottom, top * 10.0**-_DECADES), 1.5 * top)
        return
    low, high = float(visible.min()), float(visible.max())
    if high > low:
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))


def _add_tension_inset(
    ax: "Axes", panel: Panel, scales: tuple[Scale, Scale], draw_means: "Callable[[Axes], None]"
) -> None:
    """Add an inset of the tension, where the panel is empty, if it is too small beside the compression to be seen."""
    x_scale, scale = scales
    x = _joined([x_scale(np.where(np.isfinite(curve.middle), curve.x, np.nan)) for curve in panel.curves])
    values = scale(_joined([curve.middle for curve in panel.curves]))
    if not values.size or x.size != values.size:
        return
    lowest = float(values.min())
    marks = [float(scale(mark.y - 2.0 * np.nan_to_num(mark.y_error))) for mark in panel.marks]
    deepest = min([lowest, *marks])
    tense = x[values < 0.02 * lowest]
    if not -0.2 * values.max() < lowest < 0.0 or np.ptp(tense) == 0.0:
        return
    free = [box for box in _INSETS if not _crosses(ax, box, panel, scales)]
    if not free:
        return
    inset = ax.inset_axes(free[0])
    draw_means(inset)
    inset.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    inset.set(xlim=(tense.min(), tense.max()), ylim=(1.4 * deepest, -1.4 * deepest))
    inset.tick_params(labelsize=7)
    inset.set_title("tension", fontsize=7, pad=2)


def _crosses(ax: "Axes", box: tuple[float, float, float, float], panel: Panel, scales: tuple[Scale, Scale]) -> bool:
    """Return whether a curve runs through a part of a panel, or close by."""
    (left, bottom, width, height), (x_scale, scale), margin = box, scales, 0.04
    to_shares = ax.transData + ax.transAxes.inverted()
    for curve in panel.curves:
        x, y = to_shares.transform(np.column_stack([x_scale(curve.x), scale(curve.middle)])).T
        inside = (x > left - 2.0 * margin) & (x < left + width + margin)
        inside &= (y > bottom - 2.0 * margin) & (y < bottom + height + margin)
        if inside.any():
            return True
    return False
