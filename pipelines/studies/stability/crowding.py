"""Crowded asperities that feel each other: every step has an equilibrium within the stated error, or is marked."""

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np

from studies.comparison import PAIRS, law_of
from studies.versus_bem.ensembles import MODULUS, Case, separations

SHAPES = ("paraboloid", "cone", "quartic")
_COUNTS, _COUNTS_QUICK = (60, 250, 700), (60,)
_ROUGHNESSES, _ROUGHNESSES_QUICK = (1e-3, 0.05, 1.0), (0.05,)
_DECADES = (0.0, 2.0, 6.0)
_FRACTIONS = np.array([1e-3, 0.01, 0.03, 0.06, 0.1, 0.2])
_TIGHT = 1e-9


class Crowd(NamedTuple):
    """Asperities at random, some of which overlap, with radii over some decades."""

    shape: str
    decades: float
    asperities: int
    roughness: float
    seed: int


class Steps(NamedTuple):
    """Outcomes of the steps of one crowd."""

    name: str
    steps: int
    marked: int
    without: int  # number of steps without an equilibrium
    excess: float  # the largest error of the force, against one by a thousand times smaller errors, over the stated one


def crowds(quick: bool) -> Iterator[Crowd]:
    """Yield all crowds: decades of radii for paraboloids alone."""
    counts, roughnesses = (_COUNTS_QUICK, _ROUGHNESSES_QUICK) if quick else (_COUNTS, _ROUGHNESSES)
    for seed, (shape, count, roughness) in enumerate(product(SHAPES, counts, roughnesses)):
        for decades in _DECADES if shape == "paraboloid" else _DECADES[:1]:
            yield Crowd(shape, decades, count, roughness, seed)


def judge(crowd: Crowd) -> Steps:
    """Press a crowd from first contact to 0.2 of the patch, as independent asperities have it."""
    ensemble = Case("random", crowd.shape, crowd.asperities, crowd.roughness, 64, crowd.seed).generate()
    if crowd.decades:
        spread = np.random.default_rng(crowd.seed).uniform(-crowd.decades, 0.0, crowd.asperities)
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
    name = f"{crowd.shape}, radii over {crowd.decades:g} decades" if crowd.decades else crowd.shape
    return Steps(name, along.size, int(found["marked_steps"]), int(np.isnan(force).sum()), off / max(stated, _TIGHT))


def crowded(quick: bool) -> list[Steps]:
    """Return the outcomes of all crowds."""
    return [judge(crowd) for crowd in crowds(quick)]
