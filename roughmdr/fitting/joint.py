"""Parameters with one value for many curves: each curve takes as a prior what the others tell of them.

A curve tells the information S'S/v, and that times its best value: S are the slopes for the shared parameters less what
its own parameters make up for, v is the variance of the noise. Where the curves agree the sum of all squares is least.
How far their noise, even or not, may shift what they tell follows from the errors that each finds alone; so the errors
that one finds with the prior are those of the joint fit.
"""

from collections.abc import Callable

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.fitting.model import Model
from roughmdr.fitting.parameters import AT_BOUND
from roughmdr.fitting.search import Fitted, Found
from roughmdr.numerics.arguments import Floats

_ROUNDS = 30  # most rounds of searches
_AGREED = 1e-3  # largest distance from the common value, over its standard error, which searches find to 2e-4
_LESS = 0.999  # largest ratio of successive distances at which rounds make headway
_STEADY = 0.05  # least share of what a curve tells anew that is taken: rounds that need less come to nothing
_LEAST = 1e-14  # least information along a combination over the largest: less tells nothing


def agree(
    searched: dict[int, Fitted],
    alone: dict[int, Floats],
    keys: list[str],
    search_again: Callable[[dict[int, Model]], dict[int, Fitted]],
    names: list[str],
) -> dict[int, Fitted]:
    """Return the searches with one value of the shared parameters; OutOfRange where they come to none.

    ``alone`` are the covariances of the parameters of each curve without the others.
    """
    unit = _scales(next(iter(searched.values())).model, keys)[1]
    for model, found, *_ in searched.values():
        if model.noise in (0.0, 1.0):  # not found yet
            model.assume_noise_of(found.deviations, found.slopes)
    taken, share, last = dict[int, tuple[Floats, ...]](), 1.0, np.inf
    for number in range(_ROUNDS + 1):
        places = {i: (at, scale / unit) for i, each in searched.items() for at, scale in [_scales(each.model, keys)]}
        told = {i: _told(each.model, each.found, *places[i]) for i, each in searched.items()}
        for i, (at, scale) in places.items():
            told[i] += (told[i][0] @ (np.outer(scale, scale) * alone[i][np.ix_(at, at)]) @ told[i][0],)
        every = [np.array(each) for each in zip(*told.values(), strict=True)]
        root, best, _ = _as_measured(*(each.sum(axis=0) for each in every))
        apart = [root @ (scale * searched[i].found.x[at]) - best for i, (at, scale) in places.items()]
        size, name = max((float(np.abs(each).max()), names[i]) for each, i in zip(apart, places, strict=True))
        if number and size < _AGREED:
            return searched
        share *= 0.5 if number > 1 and size > _LESS * last else 1.0
        if share < _STEADY or number == _ROUNDS:
            break
        if share < 1.0:  # near what the curves told before, else they may answer each other without end
            told = {
                i: tuple(old + share * (new - old) for old, new in zip(taken[i], each, strict=True))
                for i, each in told.items()
            }
            every = [np.array(each) for each in zip(*told.values(), strict=True)]
        last, taken = size, told
        for k, (i, (at, scale)) in enumerate(places.items()):
            root, best, spread = _as_measured(*(np.delete(each, k, axis=0).sum(axis=0) for each in every))
            searched[i].model.take(searched[i].found.x, at, (root * scale, best, spread))
        searched = search_again({i: each.model for i, each in searched.items()})
    raise OutOfRange(
        f"shared: {', '.join(keys)}: the curves come to no common value; {name} is farthest off, by about {size:.2g} "
        "standard errors: leave it out, or share less"
    )


def _scales(model: Model, keys: list[str]) -> tuple[list[int], Floats]:
    """Return where shared parameters stand, and the scale of each."""
    at = [i for i, parameter in enumerate(model.parameters) if parameter.key in keys]
    return at, np.array([model.parameters[i].scale or 1.0 for i in at])


def _told(model: Model, found: Found, at: list[int], scale: Floats) -> tuple[Floats, ...]:
    """Return the information on shared parameters, and that times their values."""
    rows = found.deviations.size - model.told[1].size
    slopes, deviations = (each[:rows] / model.noise for each in (found.slopes, found.deviations))
    held = np.minimum(found.x - model.bounds[0], model.bounds[1] - found.x) < AT_BOUND  # makes up for nothing
    held[at] = True
    own = slopes[:, ~held]
    rest = (slopes[:, at] - own @ (np.linalg.pinv(own) @ slopes[:, at])) / scale
    return rest.T @ rest, rest.T @ (rest @ (scale * found.x[at]) - deviations)


def _as_measured(information: Floats, weighted: Floats, shaken: Floats) -> tuple[Floats, Floats, Floats]:
    """Return a matrix A and numbers b such that |A y - b|^2 tells of y what the information does, and a square root of
    the covariance of b, where ``shaken`` is that of the weighted values.
    """
    sizes, axes = np.linalg.eigh(information)
    known = sizes > _LEAST * max(float(sizes[-1]), 0.0)
    roots, axes = np.sqrt(sizes[known]), axes[:, known]
    variances, directions = np.linalg.eigh((axes.T @ shaken @ axes) / np.outer(roots, roots))
    return roots[:, None] * axes.T, axes.T @ weighted / roots, directions * np.sqrt(np.maximum(variances, 0.0))
