"""The posterior of the parameters of a fit by Markov chains, with the error of the law inside the likelihood.

What is known before is even in the logarithm of a number that must be positive, in the number itself otherwise, between
the bounds of the search, times its prior. Noise is normal; where its size is not stated it is the same at all steps,
and any size is as likely (even in its logarithm). The error that the law states is normal too, and has one sign along
the whole path: it is one more number in the chains.

D. Foreman-Mackey, D. W. Hogg, D. Lang, J. Goodman (2013), Publ. Astron. Soc. Pacific 125, 306 (emcee).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.fitting.model import Model
from roughmdr.fitting.search import Found
from roughmdr.fitting.uncertainty import Uncertainty
from roughmdr.numerics.arguments import Floats

_WALKERS = 4  # number of chains over that of the numbers: emcee needs twice as many
_BLOCK, _BLOCKS = 100, 50  # steps between two looks at the chains, and most of these
_LONG = 50.0  # length of chains, over their autocorrelation time, from which emcee trusts that time
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
    with_law: bool
    """Whether the error of the law is in the likelihood."""


def posterior_of(model: Model, found: Found, known: Uncertainty) -> Posterior:
    """Return draws around the parameters of least squares; RoughmdrError without the package emcee."""
    emcee, seed = check_package(), model.start.seed
    rng = np.random.default_rng(seed)
    density, laws = _density(model, found, known), int(known.error_of_law is not None)
    begin, (low, high) = np.append(found.x, np.zeros(laws)), model.bounds
    starts = rng.standard_normal((_WALKERS * begin.size, known.influence.shape[1])) @ known.influence.T
    starts = np.hstack([np.clip(found.x + starts, low, high), rng.standard_normal((len(starts), laws))])
    while (lost := ~np.isfinite([density(each) for each in starts])).any():
        starts[lost] = 0.5 * (starts[lost] + begin)
    moves = [(emcee.moves.DEMove(), _DIFFERENTIAL), (emcee.moves.DESnookerMove(), _SNOOKER)]
    chains = emcee.EnsembleSampler(*starts.shape, density, moves=moves)
    chains.random_state = np.random.RandomState(seed).get_state()
    state: Any = starts
    for _ in range(_BLOCKS):
        state = chains.run_mcmc(state, _BLOCK, skip_initial_state_check=True)
        time = float(np.max(chains.get_autocorr_time(tol=0)))
        if chains.iteration > _LONG * time:
            break
    burnt, thin = min(int(_BURNT * time), chains.iteration // 2), max(int(0.5 * time), 1)
    draws = np.swapaxes(chains.get_chain(discard=burnt, thin=thin), 0, 1)[:, :, : found.x.size]
    independent = len(starts) * (chains.iteration - burnt) / time
    return Posterior(draws, independent, chains.iteration > _LONG * time, bool(laws))


def _density(model: Model, found: Found, known: Uncertainty) -> Callable[[Floats], float]:
    """Return the logarithm of the density of the posterior but for a constant, of x and the error of the law."""
    (low, high), points, count = model.bounds, found.points, found.x.size
    rho, of_law = known.noise.rho, known.error_of_law

    def density(at: Floats) -> float:
        x, sizes = at[:count], at[count:]
        if (x < low).any() or (x > high).any():
            return -np.inf
        deviations = model.deviations(x)
        if not np.isfinite(deviations).all():
            return -np.inf
        residuals, others = deviations[:points], deviations[points:] / (model.noise or 1.0)
        if of_law is not None:
            residuals = residuals + sizes[0] * of_law / _TWO_SIDED
        ahead = (residuals[1:] - rho * residuals[:-1]) / np.sqrt(1.0 - rho * rho)
        squares = float(residuals[0] ** 2 + ahead @ ahead)
        of_noise = points * np.log(squares) if model.curve.error is None else squares
        return -0.5 * float(of_noise + others @ others + sizes @ sizes)

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
