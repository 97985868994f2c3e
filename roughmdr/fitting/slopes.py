"""Derivatives of the law with respect to the free parameters, on a machine at its separations.

The law itself tells those by the two bodies and by the zero of the control, unless contacts are lost one by one; others
are differences.
"""

from collections.abc import Callable
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError
from roughmdr.expected import Slopes
from roughmdr.expected.compute import KERNEL_ERROR
from roughmdr.fitting.model import Model, Point
from roughmdr.fitting.parameters import BASELINE, BASELINE_SLOPE, OFFSET, Parameter, length_scale
from roughmdr.fitting.spring import Spring
from roughmdr.numerics.arguments import Floats

_LONGEST_STEP = 0.01  # largest change of x in differences
_JUMP = 0.5  # ratio of the differences to both sides of x, beyond which one of them holds a jump
_MODULUS = "material.modulus"
_TOLD = {OFFSET: "stiffness", _MODULUS: "modulus", "material.effective_modulus": "modulus", "adhesion.work": "work"}
"""Keys by which a law tells its derivatives, and their names in ``Slopes``."""


def slopes_of(model: Model, x: Floats) -> Floats:
    """Return the derivatives [step, parameter] of the deviations; RoughmdrError where the law has none.

    On a machine they are taken at the separations that the law has, and its spring yields to them.
    """
    middle = model.point(x)
    if model.curve.control == "separation" or not (model.borne is None and middle.law.force.size):
        with model.held(load=model.borne, rule=middle.law.rule):
            told = any(p.key in _TOLD for p in model.parameters)
            return _at_given(model, middle, model.slopes(x, middle.law.rule) if told else None)
    with model.held(load=middle.law.force, rule=middle.law.rule):
        slopes = model.slopes(x, middle.law.rule)
        at_given = _at_given(model, model.point(x), slopes)
        spring = _spring(model, x, slopes)
    model.near = None if model.jumps else spring
    points = middle.law.force.size  # rows behind them are from priors
    lines = model.baselines / model.curve.weight[:, None]  # which are beside the law
    return np.vstack([spring.yielded(at_given[:points] - lines) + lines, at_given[points:]])


def yielded(model: Model, x: Floats, change: Floats) -> Floats:
    """Return the change of the load at the measured control that a ``change`` at given separation makes."""
    if model.curve.control == "separation":
        return change
    law = model.point(x).law
    with model.held(load=law.force, rule=law.rule):
        return _spring(model, x, model.slopes(x, law.rule)).yielded(change)


def slopes_of_jumps(model: Model, x: Floats) -> Floats | None:
    """Return the derivatives [jump, parameter] of where the law jumps [m]; None where none or others are nearby."""
    middle, found = model.point(x), list[Floats]()
    here, known = middle.law.changes.control, model.slopes_at_jumps(x)

    def control(side: Point) -> Floats:
        there = side.law.changes.control
        return there if there.size == here.size else np.full_like(here, np.inf)

    with model.held(load=model.borne, rule=middle.law.rule), suppress(RoughmdrError):
        for number, p in enumerate(model.parameters if here.size else ()):
            told = np.zeros_like(here) if p.key in (BASELINE, BASELINE_SLOPE) else _told(model, p, known)
            found.append(_slope(model, middle, number, control) if told is None else told)
        return np.stack(found, axis=1) if found else None
    return None


def _at_given(model: Model, middle: Point, slopes: Slopes | None) -> Floats:
    """Return the derivatives of the deviations where the load that stretches a spring stays."""

    def slope(number: int, p: Parameter, prior: Floats) -> Floats:
        beside = p.key in (BASELINE, BASELINE_SLOPE) and model.borne is not model.curve.load
        load = model.baselines[:, number] if beside else _told(model, p, slopes)
        if load is None:
            return _slope(model, middle, number, lambda side: side.deviations)
        return np.append(load / model.curve.weight, prior)

    columns = zip(range(middle.x.size), model.parameters, _of_priors(model, middle.x).T, strict=True)
    return np.stack([slope(*each) for each in columns], axis=1)


def _slope(model: Model, middle: Point, number: int, of: Callable[[Point], Floats]) -> Floats:
    """Return the derivative of what a law has with respect to a parameter."""
    low, high = model.bounds
    step = min(_step(middle), 0.5 * float(high[number] - low[number]))  # to one side at least it stays within bounds
    change = step * np.eye(middle.x.size)[number]
    sides = [of(model.point(side)) for side in (middle.x + change, middle.x - change)]
    return _difference(model, of(middle), sides, step)


def _told(model: Model, p: Parameter, slopes: Slopes | None) -> Floats | None:
    """Return the derivative with respect to a parameter that the law tells; None for others."""
    if slopes is None or p.key not in _TOLD or (p.key == _MODULUS and model.start.counter is not None):
        return None
    if p.key == OFFSET:
        return -p.scale * slopes.stiffness
    told: Floats = getattr(slopes, _TOLD[p.key])
    return told if p.logarithmic and not np.isnan(told).any() else None


def _of_priors(model: Model, x: Floats) -> Floats:
    """Return the derivatives [row, parameter] of the deviations from what is known otherwise."""
    own, pairs = np.eye(x.size), zip(model.parameters, x.tolist(), strict=True)
    rows = [own[i] * (p.per_x(each) / p.prior[1]) for i, (p, each) in enumerate(pairs) if p.prior is not None]
    return np.asarray(model.noise * np.vstack([*rows, model.told[0]]))


def _spring(model: Model, x: Floats, slopes: Slopes | None) -> Spring:
    """Return how the load changes with the separation on a machine, whose spring bears a given load."""
    middle, scene = model.point(x), model.scene(x)
    step = _step(middle) * length_scale(model.curve)

    def slope(steps: NDArray[np.bool_]) -> Floats:
        if slopes is not None:
            return np.where(steps, -slopes.stiffness, 0.0)
        sides = [model.force(x, model.curve.values + sign * step * steps).force for sign in (1.0, -1.0)]
        return _difference(model, middle.law.force, sides, step)

    return Spring.of(model.curve.values, middle.law.force, float(model.stretch(scene, np.ones(1))[0]), slope)


def _step(middle: Point) -> float:
    """Return the best step of differences, the cube root of the error of the law."""
    return float(min(max(middle.law.error, KERNEL_ERROR) ** (1.0 / 3.0), _LONGEST_STEP))


def _difference(model: Model, here: Floats, sides: list[Floats], step: float) -> Floats:
    """Return the derivative from what is to both sides, or to the one with a law; RoughmdrError without any.

    Where a contact jumps within one of them, the other, which is much smaller, is taken alone.
    """
    pair = np.array([sides[0] - here, here - sides[1]])
    pair = pair[np.isfinite(pair).all(axis=1)] / step
    if not pair.size:
        raise model.last_error
    sizes = np.abs(pair)
    smaller = np.where(sizes[0] < sizes[-1], pair[0], pair[-1])
    return np.asarray(np.where(sizes.min(axis=0) < _JUMP * sizes.max(axis=0), smaller, pair.mean(axis=0)))
