"""Doubts about a fit: parameters that the data do not tell apart, and residuals that are not noise."""

import math
from collections.abc import Iterator

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.fitting.correlation import is_systematic
from roughmdr.fitting.model import Model
from roughmdr.fitting.parameters import Parameter
from roughmdr.fitting.search import Found, fitted
from roughmdr.fitting.uncertainty import Uncertainty, apart_from_the_rest, correlation_of
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity

_ALIKE, _SAME = 0.99, 0.9999  # correlations of parameters that the curve hardly tells apart, and does not
_SHARED = 0.05  # product of the weights of two parameters in weak directions from which they count as joined
_WIDE = math.log(2.0)  # half a 95 % interval of x that is very wide: a factor of two, or as much of the scale
_BETTER = 25.0  # decrease of the sum of squares over the variance of the noise: five standard deviations
_BAND, _FLAT = 6.0, 1e-3  # height of a flat top, over the noise, and at least over the range of the load
_ROWS, _LONGER = 10, 4.0  # most points of a sharp top or of no dwell; points of a flat top over those of the next band
_DWELL = 0.1  # share of points in a dwell
_CHANCE = 1e-3  # probability that the distance of a prior, or of other curves, is larger by chance
_FAR_OFF = 2.0  # root mean square of deviations over their stated errors


def doubts(model: Model, found: Found, known: Uncertainty) -> Iterator[str]:
    """Yield the doubts about a fit, in words."""
    parameters = model.parameters
    groups = _alike(found.slopes)
    for group in groups:
        yield _told_apart(group, parameters, known)
    width = known.reach.max(axis=0)
    for i, parameter in enumerate(parameters):
        if width[i] > _WIDE and not any(i in group for group in groups):
            yield f"the curve hardly determines {parameter.key}: its 95 % interval is very wide"
        if bound := parameter.bound_met(float(found.x[i])):
            yield bound
    if not found.converged:
        yield "the search ended before it converged"
    if is_systematic(found.residuals) and not known.noise.rho:
        rms = 100.0 * model.curve.relative_rms(found.deviations)
        yield (
            f"the residuals are systematic ({rms:.2g} % r.m.s.): the scene does not describe the curve, and the "
            "intervals mean little"
        )
    yield from _of_the_curve(model, found)
    yield from _backwards(model, found, known)
    yield from _at_odds(model, found, known)
    size = float(np.sqrt(np.mean(np.square(found.residuals))))
    if model.curve.error is not None and size > _FAR_OFF:
        yield f"the residuals are {size:.2g} times the stated errors of the {model.curve.quantity}"


def _of_the_curve(model: Model, found: Found) -> Iterator[str]:
    """Yield doubts about the measurement itself: no contact, a detector at its end, a dwell."""
    curve, name, steps = model.curve, model.curve.quantity, np.diff(model.curve.values)
    sums = [float(np.sum(np.square(each))) for each in ((curve.load - curve.level) / curve.weight, found.residuals)]
    noise = 1.0 if curve.error is not None else sums[1] / curve.load.size
    if sums[0] - sums[1] < _BETTER * noise and not curve.has_less_noise(found.deviations):
        yield f"the {name} is noise along the whole curve, which shows no contact"
    band = max(_BAND * curve.noise, _FLAT * float(np.ptp(curve.load)))
    top, next_to_it = (np.sum(np.floor((curve.load.max() - curve.load) / band) == i) for i in (0, 1))
    if top > max(_ROWS, _LONGER * next_to_it) and np.ptp(curve.load) > _LONGER * band:
        most = format_quantity(float(curve.load.max()), curve.unit)
        yield f"the {name} stays at its largest, {most}, over {top} points: a detector at its end? leave these out"
    still = int(np.diff(np.flatnonzero(np.concatenate([[1.0], steps, [1.0]]))).max())
    if still > max(_ROWS, _DWELL * steps.size):
        yield f"the {curve.control} stays the same over {still} points: contacts can creep in a dwell; leave these out"


def _backwards(model: Model, found: Found, known: Uncertainty) -> Iterator[str]:
    """Yield a doubt where an adhesive law, which depends on the sense of motion, fits the curve better from its end."""
    if not (model.adheres and model.curve.has_less_noise(found.deviations)):
        return
    other = model.along(model.curve.backwards())
    other.told, other.spread, other.noise = model.told, model.spread, model.noise
    try:
        deviations = fitted(other).found.residuals
    except RoughmdrError:
        return
    here, there = (float(np.mean(np.square(each))) for each in (found.residuals, deviations))
    points = known.noise.effective(deviations.size)
    if (here - there) * points > _BETTER * (there if model.curve.error is None else 1.0):
        sizes = [100.0 * model.curve.relative_rms(found.deviations), 100.0 * other.curve.relative_rms(deviations)]
        yield (
            f"read from its last row to its first the curve is fitted better, to {sizes[1]:.2g} % r.m.s. in place of "
            f"{sizes[0]:.2g} %: rows must be in the order of measurement, for adhesion tells loading from unloading"
        )


def _at_odds(model: Model, found: Found, known: Uncertainty) -> Iterator[str]:
    """Yield each prior, and the other curves of a joint fit, where all the rest tells something else."""
    from scipy.stats import chi2

    (matrix, best), points = model.told, found.points
    claims = [f"the prior of {each.key}" for each in model.parameters if each.prior is not None]
    rows = [np.array([points + i]) for i in range(len(claims))]
    if best.size:
        shared = [each.key for each, column in zip(model.parameters, matrix.T, strict=True) if column.any()]
        claims.append(f"what the other curves tell of {', '.join(shared)}")
        rows.append(np.arange(points + len(rows), found.deviations.size))
    for claim, each in zip(claims, rows, strict=True):
        apart, covariance = apart_from_the_rest(model, found, known.noise, each)
        square = float(apart @ np.linalg.pinv(covariance, hermitian=True) @ apart)
        if square > chi2.isf(_CHANCE, apart.size):
            yield f"{claim} is about {math.sqrt(square):.0f} standard errors from what this curve tells"


def _alike(slopes: Floats) -> list[list[int]]:
    """Return the groups of parameters of which some combination hardly moves the law, though each of them does."""
    sizes = np.linalg.norm(slopes, axis=0)
    _, strengths, directions = np.linalg.svd(slopes / np.where(sizes > 0.0, sizes, 1.0), full_matrices=False)
    weak = directions[np.square(strengths) < 1.0 - _ALIKE]
    shared = np.abs(weak.T @ weak)
    groups: list[list[int]] = []
    for i in range(sizes.size):
        joined = [group for group in groups if (shared[i, group] > _SHARED).any()]
        groups = [group for group in groups if group not in joined] + [sorted(sum(joined, [i]))]
    return [group for group in groups if len(group) > 1]


def _told_apart(group: list[int], parameters: list[Parameter], known: Uncertainty) -> str:
    names = [parameters[i].key for i in group]
    correlation = correlation_of(known.by_even_noise)[group[0], group[1]]
    wide = known.reach[:, group].max() > _WIDE or abs(correlation) > _SAME
    text = f"the curve {'does not tell' if wide else 'hardly tells'} {', '.join(names[:-1])} and {names[-1]} apart"
    if len(group) > 2:
        return text
    pair = [parameters[i] for i in group]
    text += f" (correlation {correlation:.4g})"
    best = np.linalg.svd(known.by_even_noise[group], full_matrices=False)[0][:, -1]  # of the smallest standard error
    if all(parameter.logarithmic for parameter in pair):
        exponents = best / np.abs(best).max() * np.sign(best[np.abs(best).argmax()])
        combination = np.zeros(len(parameters))
        combination[group] = exponents
        error = 100.0 * known.deviation_of(combination)
        product = " * ".join(f"{key}^{each:.2g}".removesuffix("^1") for key, each in zip(names, exponents, strict=True))
        return f"{text}; it determines {product}, to {error:.2g} %"
    if any(parameter.logarithmic for parameter in pair):
        power, exponent = (0, 1) if pair[0].logarithmic else (1, 0)
        decay = float(pair[exponent].scale * best[power] / best[exponent])
        length = format_quantity(decay, pair[exponent].unit)
        return f"{text}; it determines {names[power]} * exp({names[exponent]} / {length})"
    if pair[0].unit != pair[1].unit:
        return text
    weights = best / [parameter.scale for parameter in pair]
    ratio = float(weights[1] / weights[0])
    part = "" if abs(abs(ratio) - 1.0) < 0.005 else f"{abs(ratio):.2g} "
    return f"{text}; it determines {names[0]} {'+' if ratio > 0.0 else '-'} {part}{names[1]}"
