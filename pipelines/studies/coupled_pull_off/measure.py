"""Pull-off, hysteresis and avalanches of rubbery paraboloids, independent and coupled, over density and number."""

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from studies.study import named

MODULUS, WORK, RADIUS = 2e6, 0.05, 50e-6  # E* [Pa], w [J/m2], R [m]
JUMP_ON = (2.0 * math.pi * WORK * RADIUS**2 / MODULUS) ** (1.0 / 3.0)
"""Radius [m] of a contact that is made at first touch."""
LENGTH = 0.75 * 0.25 ** (1.0 / 3.0) * JUMP_ON**2 / RADIUS
"""Height [m] up to which one alone is stretched under fixed grips."""
LONE = 1.5 * math.pi * WORK * RADIUS
"""Pull-off force [N] of one alone under dead load (K. L. Johnson, K. Kendall, A. D. Roberts, 1971)."""
PAIRWISE = {"model": "pairwise", "order": 2}
SPREADS = (0.3, 1.0, 3.0)
SPACINGS = (5.0, 6.0, 8.0, 10.0, 14.0, 20.0, 40.0)
OF_NUMBER = 8.0
"""Spacing at which the number is varied, at a spread of 1."""
_CLOSEST = 0.7  # distance of two asperities over the spacing
_COUNT = 100
_COUNTS = (25, 50, 100, 200, 400, 800)
_DRAWN = 2400  # asperities that are drawn for each number in all
_STEPS = 30
_DEPTH = 2.0  # below the mean height where the flat is closest, over LENGTH


class Sample(NamedTuple):
    """Asperities at random: their number, mean spacing [jump-on radius] and spread of heights [``LENGTH``]."""

    asperities: int
    spacing: float
    spread: float
    seed: int

    def generate(self) -> xr.Dataset:
        """Return the ensemble."""
        side = math.sqrt(self.asperities) * self.spacing * JUMP_ON
        return rm.generate(
            {
                "source": "random",
                "shape": "paraboloid",
                "count": self.asperities,
                "patch": side,
                "placement": "hard_core",
                "min_distance": _CLOSEST * self.spacing * JUMP_ON,
                "radius": RADIUS,
                "height": {"distribution": "normal", "std": self.spread * LENGTH},
            },
            seed=self.seed,
        )


def cycle(ensemble: xr.Dataset, spread: float, interaction: Any, steps: int = _STEPS) -> tuple[xr.Dataset, bool]:
    """Return the law of loading and unloading until none is in contact, and whether it is crowded.

    Crowded are contacts that overlap as soon as they are made.
    """
    begin = float(ensemble["height"].max()) + 6.0 * LENGTH * (1.0 + spread)
    separation = np.append(begin, np.linspace(begin - 6.0 * LENGTH, -_DEPTH * LENGTH, steps))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rm.LimitWarning)
        law = rm.load_separation(
            ensemble,
            separation=separation,
            effective_modulus=MODULUS,
            work=WORK,
            unload=True,
            interaction=interaction,
            variables=["force", "contact_count", "contact_fraction", "dissipated_energy"],
        )
    return law, any("as soon as they are made" in str(one.message) for one in caught)


def compare(sample: Sample) -> dict[str, float]:
    """Return the numbers of one sample, forces over those of lone asperities that all part at once."""
    ensemble = sample.generate()
    alone, _ = cycle(ensemble, sample.spread, None)
    coupled, crowded = cycle(ensemble, sample.spread, PAIRWISE)
    unit = sample.asperities * LONE
    last, deepest = {"step": -1}, {"step": _STEPS}
    return {
        "independent": -float(alone["pull_off_force"]) / unit,
        "coupled": -float(coupled["pull_off_force"]) / unit,
        "dissipation": float(coupled["dissipated_energy"].isel(last) / alone["dissipated_energy"].isel(last)),
        "largest": float(coupled["avalanche_size_max"]) / sample.asperities,
        "touching": float(coupled["contact_count"].isel(deepest)) / sample.asperities,
        "touching_alone": float(alone["contact_count"].isel(deepest)) / sample.asperities,
        "fraction": float(coupled["contact_fraction"].max()),
        "crowded": float(crowded),
        "marked": float(coupled["marked_steps"]),
    }


def samples(quick: bool) -> list[Sample]:
    """Return those over density, then those over number."""
    spacings, seeds, count = (SPACINGS[1::2], 1, 25) if quick else (SPACINGS, 8, _COUNT)
    over_density = [
        Sample(count, spacing, spread, seed) for spread in SPREADS for spacing in spacings for seed in range(seeds)
    ]
    counts, drawn = (_COUNTS[:2], 50) if quick else (_COUNTS, _DRAWN)
    return over_density + [
        Sample(count, OF_NUMBER, 1.0, 100 + seed) for count in counts for seed in range(max(drawn // count, 2))
    ]


def measure(quick: bool) -> xr.Dataset:
    """Return all samples."""
    asked = samples(quick)
    found = [compare(sample) for sample in asked]
    words = {
        "independent": "pull-off force of independent asperities over that of all alone",
        "coupled": "pull-off force of coupled asperities over that of all alone",
        "dissipation": "energy lost in the cycle, coupled over independent",
        "largest": "largest avalanche over the number of asperities",
        "touching": "share of asperities in contact where the flat is closest, coupled",
        "touching_alone": "share of asperities in contact where the flat is closest, independent",
        "fraction": "largest contact fraction, coupled",
        "crowded": "whether contacts overlap as soon as they are made",
        "marked": "marked steps",
    }
    columns = {name: ("sample", [one[name] for one in found], named(text)) for name, text in words.items()}
    keys = {
        "asperities": "number of asperities",
        "spacing": "mean spacing over the jump-on radius",
        "spread": "standard deviation of the heights over the stretch of one alone",
        "seed": "seed",
    }
    labels = {name: ("sample", [getattr(one, name) for one in asked], named(text)) for name, text in keys.items()}
    return xr.Dataset(columns, labels)
