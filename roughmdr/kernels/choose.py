"""Which kernels compute which shape, with and without adhesion. A new shape with a profile needs no line here."""

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
    law = Kernels(name)
    found = {name: getattr(module, name + suffix, None) or getattr(module, name, None) for name in _NAMES}
    vars(law).update({name: kernel for name, kernel in found.items() if kernel is not None})
    return law


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
    law = _of_module(f"{'jkr' if adhesive else 'elastic'}_{shape}", module, suffix)
    law.adhesive = adhesive
    law.alike = shape != "power_law"
    vars(law).update(prepare=scalar.prepare, params_of=scalar.params_of, heterogeneous=scalar.heterogeneous)
    law.hardening = not adhesive or shape != "power_law"  # of JKR power laws only those with n >= 0.768
    law.found_together = "radius_force_stiffness" in vars(law)
    if not law.found_together:
        law.radius_force_stiffness = specialise(scalar.radius_force_stiffness, law)
    if shape == "power_law" and not adhesive:
        law.in_sums = law.copy("_of_x")
        vars(law.in_sums).update(vars(_of_module("", power_of_x)), __name__=law.in_sums.name, found_together=True)
    return law


@once
def _of_profile(shape: type[ProfileShape], adhesive: bool) -> Kernels:
    """Return the kernels of a shape that is known by its profile."""
    law: Kernels = build(shape, cohesive=False).copy("_jkr" if adhesive else "_elastic")
    law.adhesive, law.branched, law.hardening = adhesive, adhesive and shape.branched(), not adhesive
    if law.of_any is not None:
        law.of_any = _of_any(law.of_any, adhesive)
    if shape.similar and not adhesive:
        law.in_sums = build(shape, cohesive=False, similar=True)
        law.in_sums.hardening = True
    return law


@once
def _of_any(kernels: Kernels, adhesive: bool) -> Kernels:
    """Return kernels of any shape with or without adhesion."""
    law = kernels.copy("_jkr" if adhesive else "_elastic")
    law.adhesive = adhesive
    law.rows_tell = adhesive
    return law


@once
def _dugdale(shape: type[Shape]) -> Kernels:
    """Return the kernels of a shape under adhesion with a range."""
    if shape is not FlatPunch:
        return build(shape, cohesive=True)
    law = _of_module("dugdale_flat_punch", dugdale_flat_punch)
    law.adhesive = law.iterative = law.branched = law.cohesive = law.one_by_one = law.found_together = True
    return law


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
