"""The study of hills: its table and its picture."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.hills.measure import METHODS
from studies.hills.separations import POINTS
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = dict(zip(METHODS, ("0.6", "#1b6ca8", "#c8553d", "g","y","#c2a5cf", "#9970ab", "#762a83"), strict=True))


def errors_of(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors over case, solver and fraction."""
    true = result[quantity].sel(solver="fine elements", drop=True)
    return result[quantity].drop_sel(solver="fine elements") / true - 1.0


def rms(values: Floats) -> float:
    """Return the root mean square of what is known."""
    return float(np.sqrt(np.nanmean(np.square(values)))) if np.isfinite(values).any() else np.nan


def groups(result: xr.Dataset) -> dict[str, xr.Dataset]:
    """Return isotropic and anisotropic maps."""
    ratio = result["anisotropy"].to_numpy()
    found = {"isotropic": ratio == 1.0, "4:1": ratio > 1.0}
    return {name: result.isel(case=np.flatnonzero(member)) for name, member in found.items() if member.any()}


def report(result: xr.Dataset) -> str:
    """Return errors and run times of each method."""
    rows = []
    for name, own in groups(result).items():
        force, area = errors_of(own), errors_of(own, "contact_fraction")
        for method in METHODS:
            of_force, of_area = force.sel(solver=method).to_numpy(), area.sel(solver=method).to_numpy()
            seconds = own["seconds"].sel(solver=method).to_numpy()
            of_true = np.median(seconds / own["seconds"].sel(solver="fine elements").to_numpy())
            rows.append(
                [
                    name,
                    method,
                    f"{100 * rms(of_force):.1f} %",
                    f"{100 * np.nanmean(of_force):+.1f} %",
                    f"{100 * np.nanquantile(np.abs(of_force), 0.9):.1f} %",
                    f"{100 * rms(of_area):.0f} %",
                    f"{100 * np.isnan(of_force).mean():.0f} %",
                    f"{1e3 * np.median(seconds):.0f} ms",
                    f"{of_true:.2f}",
                ]
            )
    head = ["maps", "method", "force, rms", "mean", "90 % within", "area, rms", "no answer", "a path", "of fine"]
    counts = ", ".join(f"{own.sizes['case']} {name}" for name, own in groups(result).items())
    return (
        f"{counts} maps, {result.sizes['fraction']} separations from 0.3 to 20 % contact each, against boundary "
        f"elements with {POINTS} points a shortest wave.\n\n{table(head, rows)}"
    )


def draw(result: xr.Dataset) -> "Figure":
    """Draw the errors of the force over the contact fraction, and over the run time."""
    from matplotlib.figure import Figure

    parts = groups(result)
    figure = Figure(figsize=(5.0 * (len(parts) + 1), 4.6), layout="constrained")
    panels = figure.subplots(1, len(parts) + 1)
    for panel, (name, own) in zip(panels, parts.items(), strict=False):
        errors, fraction = errors_of(own), 100.0 * own["fraction"].to_numpy()
        for method in METHODS[:3]:
            each = 100.0 * errors.sel(solver=method).to_numpy()
            low, middle, high = np.nanquantile(each, [0.1, 0.5, 0.9], axis=0)
            panel.fill_between(fraction, low, high, color=_COLOURS[method], alpha=0.2, lw=0.0)
            panel.semilogx(fraction, middle, color=_COLOURS[method], lw=2.0, label=method)
        panel.axhline(0.0, color="k", lw=0.8)
        panel.set(xlabel="contact fraction [%]", ylabel="error of the force [%]", title=f"{name}: median, 10 to 90 %")
        panel.set_ylim(-45.0, 25.0)
        panel.legend(fontsize=8)
    own, panel = parts["isotropic"], panels[-1]
    for method in METHODS:
        seconds = own["seconds"].sel(solver=method).to_numpy()
        by_case = [100.0 * rms(case) for case in errors_of(own).sel(solver=method).to_numpy()]
        panel.loglog(1e3 * seconds, by_case, "o", color=_COLOURS[method], label=method, ms=5)
    panel.set(
        xlabel="run time of nine separations [ms]", ylabel="r.m.s. error of the force [%]", title="isotropic maps"
    )
    panel.legend(fontsize=8)
    return figure
