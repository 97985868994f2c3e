"""How many asperities a patch has: a given number, or as many as independent ones of a density come to."""

import numpy as np

from roughmdr.ensemble.streams import COUNT, Streams


def poisson(draws: Streams, mean: float) -> int:
    """How many independent asperities fall on a patch that has ``mean`` of them on average."""
    from scipy.special import pdtr, pdtrik

    level = float(draws(COUNT, 1)[0])
    count = max(int(np.ceil(pdtrik(level, mean))), 0)
    return count - 1 if count > 0 and pdtr(count - 1, mean) >= level else count
