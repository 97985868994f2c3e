"""Pictures of a result."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.analysis import standard_error
from roughmdr.arguments import Floats
from roughmdr.errors import StoreError
from roughmdr.store import replacing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_INK = {"loading": "#1b6ca8", "unloading": "#c8553d"}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}


def plot(result: "xr.Dataset", path: Path, variables: list[str] | None = None) -> None:
    """Draw variables of a result against separation into ``path``; StoreError for a name that the result lacks.

    Every realisation is a thin line, the mean a thick one, twice its standard error a band. Without ``variables``
    all that the result holds.
    """
    from matplotlib.figure import Figure

    held = [str(name) for name in result.data_vars if result[name].dims == ("realization", "step")]
    names = variables or held
    for name in names:
        if name not in held:
            raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(held)}")
    columns = min(2, len(names))
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(5.2 * columns, 3.6 * rows + 0.4), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    for ax, name in zip(axes.flat, names, strict=False):
        _draw(ax, result, name)
    for ax in axes.flat[len(names) :]:
        ax.set_visible(False)
    axes.flat[0].legend(frameon=False)
    count = result.sizes["realization"]
    note = f"{count} realisations, mean ± 2 standard errors" if count > 1 else "one realisation"
    figure.suptitle(f"{result.attrs['title']}  ({note})", fontsize=11, parse_math=False)
    suffix = path.suffix.lstrip(".").lower() or "png"
    if suffix not in figure.canvas.get_supported_filetypes():
        raise StoreError(f"{path}: cannot draw a .{suffix}; try .png, .pdf or .svg")
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=160, format=suffix)


def _draw(ax: "Axes", result: "xr.Dataset", name: str) -> None:
    values = result[name]
    h_scale, h_prefix = _scale(result["separation"].to_numpy())
    scale, prefix = 1.0, ""
    if values.units != "1":
        scale, prefix = _scale(_shown(values).to_numpy(), power=2 if values.units == "m2" else 1)
    branches = result["branch"].to_numpy()
    sweeps = np.split(np.arange(branches.size), np.flatnonzero(branches[1:] != branches[:-1]) + 1)
    means: list[tuple[str, Floats, Floats]] = []
    for steps in sweeps:
        branch = str(branches[steps[0]])
        part, colour = values.isel(step=steps), _INK[branch]
        h = result["separation"].isel(step=steps).to_numpy() / h_scale
        mean, error = part.mean("realization").to_numpy() / scale, standard_error(part).to_numpy() / scale
        ax.plot(h, part.to_numpy().T / scale, color=colour, lw=0.3, alpha=0.25)
        if name != "stiffness" or branch == "loading":  # where contacts snap its variance is infinite
            ax.fill_between(h, mean - 2 * error, mean + 2 * error, color=colour, alpha=0.3, lw=0)
        first = branch not in [other for other, _, _ in means]
        ax.plot(h, mean, color=colour, lw=1.8, label=branch if first else None)
        means.append((branch, h, mean))
    if name in ("force", "pressure", "stiffness"):
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    if name in ("force", "pressure"):
        _zoom_on_tension(ax, means)
    shown = _shown(values).to_numpy() / scale
    low, high = float(shown.min()), float(shown.max())
    if high > low:
        ax.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    unit = values.units.replace(" m-1", "/m").replace("m2", "m²")
    ax.set_ylabel(f"{name.replace('_', ' ')}" + (f" [{prefix}{unit}]" if unit != "1" else ""))
    ax.set_xlabel(f"separation [{h_prefix}m]")


def _zoom_on_tension(ax: "Axes", means: list[tuple[str, Floats, Floats]]) -> None:
    """An inset where the tension is too small beside the compression to be seen."""
    h, values = (np.concatenate([curve[i] for curve in means]) for i in (1, 2))
    lowest = float(values.min())
    tense = h[values < 0.02 * lowest]
    if not -0.2 * values.max() < lowest < 0.0 or np.ptp(tense) == 0.0:
        return
    inset = ax.inset_axes((0.46, 0.3, 0.5, 0.36))
    for branch, *curve in means:
        inset.plot(*curve, color=_INK[branch], lw=1.2)
    inset.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    inset.set(xlim=(tense.min(), tense.max()), ylim=(1.3 * lowest, -1.3 * lowest))
    inset.tick_params(labelsize=7)


def _shown(values: "xr.DataArray") -> "xr.DataArray":
    """What the axis must show: of stiffness, which runs off to minus infinity where a contact snaps, the mean curve."""
    mean = values.mean("realization")
    if values.name != "stiffness":
        return values
    low, high = np.quantile(mean, [0.01, 1.0])
    return mean.clip(low, high)


def _scale(values: np.ndarray, power: int = 1) -> tuple[float, str]:
    """The SI prefix under which the largest magnitude reads from 1 to 1000; from 0.1 to 1e5 for areas (``power`` 2)."""
    largest = float(np.max(np.abs(values), initial=0.0))
    if largest == 0.0:
        return 1.0, ""
    exponent = 3 * int(np.floor((np.log10(largest) + power - 1) / (3 * power)))
    exponent = min(max(exponent, -12), 12)
    return 10.0 ** (exponent * power), _PREFIXES[exponent]
