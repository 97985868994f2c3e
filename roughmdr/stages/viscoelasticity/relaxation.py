"""The relaxation of a viscoelastic modulus as a Prony series; differences of it are written so that none cancels."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

_RTOL = 2.0**-51  # relative difference of equal durations: two roundings


class Relaxation(NamedTuple):
    """The modulus over its instantaneous value: phi(t) = 1 - sum_i g_i (1 - exp(-t/tau_i))."""

    shares: Floats
    """g_i [1], at least 0, together at most 1."""
    times: Floats
    """tau_i [s], above 0."""

    @property
    def long_term(self) -> float:
        """Long-term modulus over the instantaneous one."""
        return max(1.0 - math.fsum(self.shares), 0.0)

    def modulus(self, time: Floats) -> Floats:
        """Return phi at each time [s]."""
        return self.long_term + sum(
            (g * np.exp(-time / tau) for g, tau in zip(self.shares, self.times, strict=True)), np.zeros_like(time)
        )

    def integral(self, start: Floats, duration: Floats) -> Floats:
        """Return the integral of phi [s] from each start on [s], over a duration [s]."""
        total = self.long_term * duration
        for g, tau in zip(self.shares, self.times, strict=True):
            total = total - g * tau * np.exp(-start / tau) * np.expm1(-duration / tau)
        return total

    def duration(self, start: Floats, integral: Floats, longest: float) -> Floats:
        """Return the duration [s] from each start [s] on over which phi has an integral [s]; at most ``longest`` [s].

        The integral is concave, so that Newton's method from below never goes beyond the duration.
        """
        duration = np.zeros_like(integral)
        while True:
            missing = np.maximum(integral - self.integral(start, duration), 0.0)
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                step = np.where(missing > 0.0, missing / self.modulus(start + duration), 0.0)
            following = np.minimum(duration + step, longest)
            if (following - duration <= _RTOL * following).all():
                return following
            duration = following
