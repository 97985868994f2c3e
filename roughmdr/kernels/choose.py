"""The choice of kernels by shape and adhesion. A new shape with a profile needs no line here."""

from types import ModuleType

from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.closed import flat_punch, hertz, jkr_cone, jkr_paraboloid, jkr_power, power_of_x, scalar
from roughmdr.kernels.dugdale import flat_punch as dugdale_flat_punch
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.build import build
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape, Shape

_NAMES = tuple(Kernels.__annotations__)


def _of_module(name: str, module: ModuleType, suffix: str = "") -> Kernels:
    """Return the kernels of a module, those that end in ``suffix`` before others."""
    kernels = Kernels(name)
    found = {name: getattr(module, name + suffix, None) or getattr(module, name, None) for name in _NAMES}
    vars(kernels).update({name: kernel for name, kernel in found.items() if kernel is not None})
    return kernels


@once
def _closed(shape: str, adhesive: bool) -> Kernels:
    """Return the kernels of a shape whose states have a closed form."""
    module, suffix = {
        ("paraboloid", False): (hertz, "_paraboloid"),
        ("cone", False): (hertz, "_cone"),
        ("power_law", False): (hertz, "_power"),
        ("flat_punch", False): (flat_punch, ""),
        ("paraboloid", True): (jkr_paraboloid, ""),
        ("cone", True): (jkr_cone, ""),
        ("power_law", True): (jkr_power, ""),
        ("flat_punch", True): (flat_punch, "_jkr"),
    }[shape, adhesive]
    kernels = _of_module(f"{'jkr' if adhesive else 'elastic'}_{shape}", module, suffix)
    kernels.adhesive = adhesive
    kernels.alike = shape != "power_law"
    vars(kernels).update(prepare=scalar.prepare, params_of=scalar.params_of, heterogeneous=scalar.heterogeneous)
    kernels.hardening = not adhesive or shape != "power_law"  # JKR power laws harden for n >= 0.768 only
    kernels.found_together = "radius_force_stiffness" in vars(kernels)
    if not kernels.found_together:
        kernels.radius_force_stiffness = specialise(scalar.radius_force_stiffness, kernels)
    if shape == "power_law" and not adhesive:
        kernels.in_sums = of_x = kernels.copy("_of_x")
        vars(of_x).update(vars(_of_module("", power_of_x)), __name__=of_x.name, found_together=True)
    return kernels


@once
def _of_profile(shape: type[ProfileShape], adhesive: bool) -> Kernels:
    """Return the kernels of a shape that is known by its profile."""
    kernels: Kernels = build(shape, cohesive=False).copy("_jkr" if adhesive else "_elastic")
    kernels.adhesive, kernels.branched, kernels.hardening = adhesive, adhesive and shape.branched(), not adhesive
    if kernels.of_any is not None:
        kernels.of_any = _of_any(kernels.of_any, adhesive)
    if shape.similar and not adhesive:
        kernels.in_sums = build(shape, cohesive=False, similar=True)
        kernels.in_sums.hardening = True
    return kernels


@once
def _of_any(profiled: Kernels, adhesive: bool) -> Kernels:
    """Return kernels of any shape with or without adhesion."""
    kernels = profiled.copy("_jkr" if adhesive else "_elastic")
    kernels.adhesive = adhesive
    kernels.rows_tell = adhesive
    return kernels


@once
def _dugdale(shape: type[Shape]) -> Kernels:
    """Return the kernels of a shape under adhesion with a range."""
    if shape is not FlatPunch:
        return build(shape, cohesive=True)
    kernels = _of_module("dugdale_flat_punch", dugdale_flat_punch)
    kernels.adhesive = kernels.iterative = kernels.branched = True
    kernels.cohesive = kernels.one_by_one = kernels.found_together = True
    return kernels


def choose(shape: str, adhesion: Adhesion, params: Floats) -> Kernels:
    """Return the kernels for asperities of one shape, whose ``params`` are as from ``Shape.nondimensionalise``.

    OutOfRange where adhesion and exponent do not go together: for n < 1/2 the only branch is
    metastable, at n = 1/2 dl(a) and g(a) are proportional.
    """
    kind = SHAPES[shape]
    if adhesion.work > 0.0:
        lowest = kind.least_exponent(params)
        if not lowest > 0.5:
            raise OutOfRange(f"exponent is {lowest:g}; with adhesion (work > 0) it must be above 1/2")
    if adhesion.cohesive:
        return _dugdale(kind)
    if kind.uses_profile:
        return _of_profile(kind, adhesion.work > 0.0)
    return _closed(shape, adhesion.work > 0.0)
