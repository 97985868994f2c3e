"""The posterior of the parameters of a fit by Markov chains, with the error of the law inside the likelihood.

What is known before is even in the logarithm of a number that must be positive, in the number itself otherwise, between
the bounds of the search, times its prior. Noise is normal; where its size is not stated it is the same at all steps,
and its logarithm, one more number in the chains, is even. The error that the law states is normal too, and has one sign
along the whole path: the covariance of the deviations is s^2 + v v', with that of the noise, s, and of the law, v.

D. Foreman-Mackey, D. W. Hogg, D. Lang, J. Goodman (2013), Publ. Astron. Soc. Pacific 125, 306 (emcee).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.fitting.model import LEAST_NOISE, Model
from roughmdr.fitting.search import Found
from roughmdr.fitting.uncertainty import Uncertainty
from roughmdr.numerics.arguments import Floats

_WALKERS, _FEWEST = 4, 8  # number of chains over that of the numbers, of which emcee needs two, and least
_BLOCK, _BLOCKS = 100, 50  # steps between two looks at the chains, and most of these
_LONG = 50.0  # length of chains, over their autocorrelation time, from which emcee trusts that time
_HALVINGS = 10  # halvings of the distance to the best parameters of chains that begin where there is no law
_BURNT = 5.0  # length of their begin that is left out, over that time
_TWO_SIDED = 1.96  # quantile of the normal distribution: stated errors of laws bound 95 %
_DIFFERENTIAL, _SNOOKER = 0.8, 0.2  # shares of two kinds of moves, as emcee's documentation proposes for several modes


class Posterior(NamedTuple):
    """Draws from the posterior."""

    x: Floats
    """[chain, draw, parameter]"""
    independent: float
    """Number of independent draws that would tell as much."""
    long_enough: bool
    """Whether the chains are long enough to tell this."""


def posterior_of(model: Model, found: Found, known: Uncertainty) -> Posterior:
    """Return draws around the parameters of least squares; RoughmdrError without the package emcee."""
    emcee, seed = check_package(), model.start.seed
    rng, noise = np.random.default_rng(seed), np.zeros(int(model.curve.error is None))
    least = float(np.max(np.abs(model.curve.load / model.curve.weight))) * LEAST_NOISE
    if noise.size:
        noise += np.log(max(float(np.sqrt(np.mean(np.square(found.residuals)))), least))
    density, begin = _density(model, found, known, least), np.append(found.x, noise)
    count = max(_WALKERS * begin.size, _FEWEST)
    of_noise = rng.standard_normal((count, noise.size)) / np.sqrt(2.0 * found.points)
    starts = np.hstack([_starts(model, found, known, rng, count), noise + np.abs(of_noise)])
    for _ in range(_HALVINGS):
        lost = ~np.isfinite([density(each) for each in starts])
        starts[lost] = 0.5 * (starts[lost] + begin)
    moves = [(emcee.moves.DEMove(), _DIFFERENTIAL), (emcee.moves.DESnookerMove(), _SNOOKER)]
    chains = emcee.EnsembleSampler(*starts.shape, density, moves=moves)
    chains.random_state = np.random.RandomState(seed).get_state()
    state: Any = starts
    for _ in range(_BLOCKS):
        with np.errstate(all="ignore"):  # chains that stand at one place propose no other
            state = chains.run_mcmc(state, _BLOCK, skip_initial_state_check=True)
        time = float(np.nan_to_num(np.max(chains.get_autocorr_time(tol=0)), nan=chains.iteration))
        if chains.iteration > _LONG * time:
            break
    burnt, thin = min(int(_BURNT * time), chains.iteration // 2), max(int(0.5 * time), 1)
    draws = np.swapaxes(chains.get_chain(discard=burnt, thin=thin), 0, 1)[:, :, : found.x.size]
    independent = count * (chains.iteration - burnt) / time
    return Posterior(draws, independent, chains.iteration > _LONG * time)


def _starts(model: Model, found: Found, known: Uncertainty, rng: np.random.Generator, count: int) -> Floats:
    """Return where chains begin: within the bounds along each direction in which noise and law move the parameters."""
    width, (low, high) = np.hstack([known.influence, LEAST_NOISE * np.eye(found.x.size)]), model.bounds
    if known.error_of_law is not None:
        width = np.column_stack([width, known.by_even_noise[:, : found.points] @ known.error_of_law / _TWO_SIDED])
    ahead = rng.standard_normal((count, width.shape[1])) @ width.T
    up, down = high - found.x, found.x - low
    forth, back = (np.min(np.where(s * ahead > 0.0, up, down) / np.abs(ahead), axis=1) for s in (1.0, -1.0))
    sign = np.where(forth < np.minimum(back, 1.0), -1.0, 1.0)  # away from a bound that is met
    part = np.minimum(rng.random(count) * np.maximum(forth, back), 1.0)
    return np.asarray(found.x + (sign * part)[:, None] * ahead)


def _density(model: Model, found: Found, known: Uncertainty, least: float) -> Callable[[Floats], float]:
    """Return the logarithm of the density of the posterior but for a constant, of x and the logarithm of the noise,
    whose ``least`` is in units of the deviations.
    """
    points, count, rho = found.points, found.x.size, known.noise.rho

    def white(each: Floats) -> Floats:
        return np.append(each[0], (each[1:] - rho * each[:-1]) / np.sqrt(1.0 - rho * rho))

    law, lowest = known.error_of_law, np.log(least)
    v = white(np.zeros(points) if law is None else law / _TWO_SIDED)
    size = float(v @ v)

    def density(at: Floats) -> float:
        x, noise = at[:count], float(at[count:].sum())  # 0 where it is stated: deviations are in its units
        deviations = model.point(x).deviations
        if (at.size > count and noise < lowest) or not np.isfinite(deviations).all():
            return -np.inf
        r, others = white(deviations[:points]), deviations[points:] / (model.noise or 1.0)
        variance = np.exp(2.0 * noise)
        along = float(v @ r) / size if size > 0.0 else 0.0
        across = r - along * v
        squares = float(across @ across) / variance + along * along * size / (variance + size) + float(others @ others)
        return -points * noise - 0.5 * float(np.log1p(size / variance) + squares)

    return density


def check_package() -> Any:
    """Return the package emcee; RoughmdrError where it is not installed."""
    try:
        import emcee
    except ImportError:
        raise RoughmdrError(
            "posterior needs the package emcee: pip install -e '.[posterior]' in the clone of roughmdr"
        ) from None
    return emcee
