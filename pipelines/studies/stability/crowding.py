"""Crowded asperities that feel each other: every step has an equilibrium within the stated error, or is marked."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from studies.comparison import PAIRS, law_of
from studies.versus_bem.ensembles import MODULUS, Case, separations

_TIGHT = 1e-9
_FRACTIONS = np.array([1e-3, 0.01, 0.03, 0.06, 0.1, 0.2])
"""Contact fractions of independent asperities, from first contact on."""


def crowds(quick: bool) -> Iterator[tuple[Case, float]]:
    """Yield crowds at random, some of which overlap, and over how many decades radii spread: of paraboloids alone."""
    counts, roughnesses = ((60,), (0.05,)) if quick else ((60, 250, 700), (1e-3, 0.05, 1.0))
    for seed, (shape, count, roughness) in enumerate(product(("paraboloid", "cone", "quartic"), counts, roughnesses)):
        for decades in (0.0, 2.0, 6.0) if shape == "paraboloid" else (0.0,):
            yield Case("random", shape, count, roughness, 64, seed), decades


def judge(case: Case, decades: float) -> dict[str, Any]:
    """Press a crowd; count its steps, those marked and those without an equilibrium.

    The excess is the largest error of the force, against one by a thousand times smaller errors, over the stated one.
    """
    ensemble = case.generate()
    if decades:
        spread = np.random.default_rng(case.seed).uniform(-decades, 0.0, case.asperities)
        ensemble["radius"] = ensemble["radius"] * 10.0**spread
    along = separations(ensemble, _FRACTIONS)
    along = along[np.isfinite(along)]
    found, tight = (
        law_of(ensemble, separation=along, effective_modulus=MODULUS, variables="force",
               interaction={**PAIRS[2], "error": error})
        for error in (1e-6, _TIGHT)
    )  # fmt: skip
    force, exact = found["force"].to_numpy(), tight["force"].to_numpy()
    solved = np.isfinite(force) & np.isfinite(exact)
    off = float(np.abs(force - exact)[solved].max(initial=0.0) / np.abs(exact[solved]).max(initial=1e-300))
    stated = float(found["numerical_error"] + tight["numerical_error"])
    return {
        "name": f"{case.shape}, radii over {decades:g} decades" if decades else case.shape,
        "steps": along.size,
        "marked": int(found["marked_steps"]),
        "without": int(np.isnan(force).sum()),
        "excess": off / max(stated, _TIGHT),
    }


def crowded(quick: bool) -> list[dict[str, Any]]:
    """Return the outcomes of all crowds."""
    return [judge(*crowd) for crowd in crowds(quick)]
