"""Sticky random surfaces that are loaded and unloaded, with asperities independent or coupled in pairs."""

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm

MODULUS = 2e6  # [Pa]
WORK = 0.05  # [J/m2]
RADIUS = 50e-6  # [m]
JUMP_ON_RADIUS = (2.0 * math.pi * WORK * RADIUS**2 / MODULUS) ** (1.0 / 3.0)  # [m], of a contact alone
PULL_OFF_LENGTH = 0.75 * 4.0 ** (-1.0 / 3.0) * JUMP_ON_RADIUS**2 / RADIUS  # [m], how far a contact alone is stretched
PULL_OFF_FORCE = 1.5 * math.pi * WORK * RADIUS  # [N], of a contact alone
_DEPTH = 1.5  # of the pull-off length, below the mean height at closest approach
_CLEAR = 2.0  # of the pull-off length, above the highest summit at both ends
_LEAST_DISTANCE = 0.7  # of the mean distance
MODELS: dict[str, Any] = {"independent": None, "coupled": {"model": "pairwise", "order": 2}}


class Surface(NamedTuple):
    """Equal paraboloids of normal heights that keep a distance."""

    spread: float
    """Standard deviation of the heights over the pull-off length."""
    asperities: int
    distance: float
    """The side of the area for each asperity over the jump-on radius."""

    def generate(self, realization: int) -> xr.Dataset:
        """Return a realisation."""
        spacing = self.distance * JUMP_ON_RADIUS
        return rm.generate(
            {
                "source": "random",
                "shape": "paraboloid",
                "count": self.asperities,
                "patch": math.sqrt(self.asperities) * spacing,
                "placement": "hard_core",
                "min_distance": _LEAST_DISTANCE * spacing,
                "radius": RADIUS,
                "height": {"distribution": "normal", "std": self.spread * PULL_OFF_LENGTH},
            },
            seed=2026,
            realization=realization,
        )


class Cycle(NamedTuple):
    """Numbers of a loading and unloading."""

    pull_off_force: float
    """[N], < 0, located between the steps."""
    pull_off_contacts: float
    contacts: float
    """At closest approach."""
    contact_fraction: float
    """At closest approach."""
    dissipated_energy: float
    """[J]"""
    avalanche: float
    """Contacts in the largest avalanche, 1 where all are independent."""
    marked: float
    """Steps at which contacts are too near each other for a coupling in pairs."""


def cycle(ensemble: xr.Dataset, interaction: Any, steps: int) -> Cycle:
    """Return the numbers of loading in ``steps`` and of unloading in as many, until all contacts have parted."""
    top = float(ensemble["height"].max()) + _CLEAR * PULL_OFF_LENGTH
    law = along(ensemble, np.linspace(top, -_DEPTH * PULL_OFF_LENGTH, steps), interaction)
    closest = law.isel(step=steps - 1)
    return Cycle(
        float(law["pull_off_force"]),
        float(law["pull_off_contacts"]),
        float(closest["contact_count"]),
        float(closest["contact_fraction"]),
        float(law["dissipated_energy"][-1]),
        float(law.get("avalanche_size_max", 1.0)),
        float(law.get("marked_steps", 0.0)),
    )


def along(ensemble: xr.Dataset, separation: np.ndarray, interaction: Any) -> xr.Dataset:
    """Return the law of falling separations [m], followed by the same that rise."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # marked steps are told apart in the picture
        return rm.load_separation(
            ensemble,
            separation=separation,
            unload=True,
            effective_modulus=MODULUS,
            work=WORK,
            adhesion="jkr",
            interaction=interaction,
            variables=["force", "contact_count", "contact_fraction", "energy", "dissipated_energy"],
        )
