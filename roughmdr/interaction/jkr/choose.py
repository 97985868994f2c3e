"""The kernels of adhesive contacts that feel each other, for a shape."""

from collections.abc import Callable

from roughmdr.interaction.contacts import coupled_kernels
from roughmdr.interaction.jkr import coincident, contacts, lone
from roughmdr.interaction.jkr.interface import JkrKernels
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.jit import once, specialise


@once
def jkr_kernels(kernels: Kernels) -> JkrKernels:
    """Return the kernels of a shape without adhesion with those of its adhesive contacts, compiled."""
    coupled = coupled_kernels(kernels)
    whole = JkrKernels(f"jkr_{coupled.name}")
    vars(whole).update(vars(coupled) | {"__name__": whole.__name__})
    profile = isinstance(kernels, ProfileKernels)
    whole.pinned, whole.flat = coupled.pinned, coupled.flat
    parts: dict[str, Callable[..., object]] = {
        "strain": contacts.strain_of_profile if profile else contacts.strain_of_power,
        "held": contacts.held,
        "lift": contacts.lift,
        "slide": contacts.slide,
        "fill": contacts.fill,
        "flanks": coincident.flanks,
        "edge": lone.edge,
        "next_state": lone.next_state,
        "lone_load": lone.lone_load,
    }
    for name, part in parts.items():
        vars(whole)[name] = specialise(part, whole)
    return whole
