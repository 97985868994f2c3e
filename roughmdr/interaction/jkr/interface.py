"""The kernels that adhesive contacts of a shape are solved with."""

from collections.abc import Callable

from roughmdr.interaction.interface import CoupledKernels


class JkrKernels(CoupledKernels):
    """Kernels of a shape without adhesion, with those of its adhesive contacts."""

    strain: Callable[..., float]
    """(t, params) -> ∫ (g(a) - g)^2 dx over natural size and depth^2."""
    held: Callable[..., float]
    lift: Callable[..., float]
    """(t, size, depth, params) -> lambda."""
    slide: Callable[..., tuple[float, float, float]]
    fill: Callable[..., None]
    flanks: Callable[..., None]
    edge: Callable[..., tuple[float, float, bool]]
    next_state: Callable[..., float]
    lone_load: Callable[..., float]


kernel = JkrKernels("kernel")
"""Stands for the kernels in parts that ``specialise`` is given."""
