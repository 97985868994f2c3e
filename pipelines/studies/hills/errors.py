"""Errors of the study of hills: what each method is off by, over maps and separations."""

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.hills.press import QUANTITIES

WORDS = dict(zip(QUANTITIES, ("force", "contact area", "stiffness"), strict=True))
RANGES = ((0.003, 0.01), (0.01, 0.05), (0.05, 0.2))
"""Of the contact fraction, over which errors are taken together."""


def errors_of(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors over case, solver and fraction."""
    true = result[quantity].sel(solver="fine elements", drop=True)
    return result[quantity].drop_sel(solver="fine elements") / true - 1.0


def errors_on_files(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors on measured maps over surface, surface_solver and fraction."""
    values = result[f"surface_{quantity}"]
    return values.drop_sel(surface_solver="free elements") / values.sel(surface_solver="free elements", drop=True) - 1.0


def rms(values: xr.DataArray | Floats) -> float:
    """Return the root mean square of what is known."""
    known = np.asarray(values)[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else np.nan


def within(errors: xr.DataArray, share: tuple[float, float]) -> xr.DataArray:
    """Return errors at contact fractions of a range."""
    fraction = errors["fraction"].to_numpy()
    return errors.isel(fraction=np.flatnonzero((fraction >= 0.999 * share[0]) & (fraction <= 1.001 * share[1])))


def groups(result: xr.Dataset) -> dict[str, xr.Dataset]:
    """Return isotropic and anisotropic maps."""
    ratio = result["anisotropy"].to_numpy()
    found = {"isotropic": ratio == 1.0, "4:1": ratio > 1.0}
    return {name: result.isel(case=np.flatnonzero(member)) for name, member in found.items() if member.any()}


def percent(value: float, digits: int = 1) -> str:
    """Return a share in per cent; a dash where it is unknown."""
    return f"{100.0 * value:.{digits}f} %" if np.isfinite(value) else "-"
