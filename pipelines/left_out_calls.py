"""What ``left_out.py`` counts where nothing is compiled, so that every call can be seen.

    NUMBA_DISABLE_JIT=1 python pipelines/left_out_calls.py

Prints one line of JSON: for each scene and part, left out and forced on, the calls of a small form of the scene.
"""

import json
import sys
from types import FrameType
from typing import NamedTuple

from left_out_cases import SCENES, Forced, Way, forced, scene_of

from roughmdr.scene import Scene

_MEMORY = ("hold", "jumps", "jumps_branched", "staircase")  # what an adhesive contact remembers


class Calls(NamedTuple):
    """How often."""

    adhesive: float
    """Functions that only adhesion needs are called, a visit."""
    kernels: float
    """Kernels are called, a visit."""
    drawn: float
    """A random number is drawn, an asperity."""


def calls_of(scene: Scene, force: Forced = lambda way: way) -> Calls:
    """What a scene calls, planned and computed."""
    adhesive = kernels = drawn = 0

    def see(frame: FrameType, event: str, _: object) -> None:
        nonlocal adhesive, kernels, drawn
        if event == "call":
            module, function = frame.f_globals["__name__"], frame.f_code.co_name
            kernel = module.startswith("roughmdr.kernels.")
            kernels += kernel
            adhesive += function in _MEMORY or (kernel and ("jkr" in module or "dugdale" in module))
            drawn += frame.f_locals["count"] if function == "uniforms" else 0

    sys.setprofile(see)
    try:
        visits = sum(law.visits for law in force(Way.of(scene)).laws())
    finally:
        sys.setprofile(None)
    return Calls(adhesive / visits, kernels / visits, drawn / scene.asperities.expected_count)


def all_calls() -> dict[str, dict[str, tuple[Calls, Calls]]]:
    """By the scene and the part: left out, and forced on."""
    found = {}
    for name, size in SCENES.items():
        scene = scene_of(size._replace(asperities=60, steps=20, realizations=1))
        calls_of(scene)  # loads what it needs
        left_out = calls_of(scene)
        found[name] = {part: (left_out, calls_of(scene, force)) for part, force in forced(size).items()}
    return found


if __name__ == "__main__":
    print(json.dumps(all_calls()))
