"""Small results, each computed once."""

import pytest
import xarray as xr
from scenes import scene

import roughmdr as rm

_VARIABLES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]
_PATH = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 60}, "unload": True}
_SWEEP = {"mode": "product", "adhesion.work": ["20 mJ/m^2", "50 mJ/m^2"], "asperities.height.std": ["1 um", "2 um"]}


@pytest.fixture(scope="package")
def curves() -> xr.Dataset:
    """A sweep with realisations, loading and unloading."""
    return rm.run(scene(path=_PATH, sweep=_SWEEP, output={"variables": _VARIABLES}, batch={"realizations": 5}))


@pytest.fixture(scope="package")
def statistics() -> xr.Dataset:
    """The statistics of that sweep."""
    output = {"variables": _VARIABLES, "keep": "statistics"}
    return rm.run(scene(path=_PATH, sweep=_SWEEP, output=output, batch={"realizations": 5}))


@pytest.fixture(scope="package")
def dead_load() -> xr.Dataset:
    """Realisations under a dead load, which pulls the flat off in the end."""
    path = {"force": ["0 uN", "50 uN", "200 uN", "200 uN", "50 uN", "0 uN", "-5 mN"]}
    return rm.run(scene(path=path, batch={"realizations": 3}))


@pytest.fixture(scope="package")
def preload() -> xr.Dataset:
    """Realisations that are loaded to a preload, and unloaded."""
    return rm.run(scene(path={"preload": "0.2 mN", "steps": 40, "unload": True}, batch={"realizations": 3}))
