"""Which kernels compute which shape, with and without adhesion. A new curved shape needs no line here."""

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.closed import flat_punch as flat
from roughmdr.kernels.closed import hertz as elastic
from roughmdr.kernels.closed import jkr_cone, jkr_paraboloid, jkr_power, scalar
from roughmdr.kernels.dugdale import flat_punch as dugdale_flat
from roughmdr.kernels.profile import build as curved
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape, Shape

Kernel = Callable[..., float]


class Kernels(NamedTuple):
    """The kernels of one asperity: scalars in, scalars out, reduced by the natural scales of the contact.

    ``x`` is the distance to the onset of contact over the natural depth (without adhesion delta/depth, with it
    1 - delta/delta_c, delta_c where a slow retraction ends); ``params`` are one asperity's share of what ``prepare``
    made of the third result of ``Shape.nondimensionalise``: a number, or a row of numbers.
    """

    name: str
    adhesive: bool
    curved: bool
    """Whether a form is a row, which holds what was found out about one asperity."""
    branched: bool
    """Whether there can be more than one stable branch."""
    prepare: Callable[..., Floats]
    """(modulus, work, strength, width, rise, form, start, stop, control) -> the forms of the asperities from start to
    stop, with control 0 for fixed grips and 1 for dead load."""
    own: Callable[..., Any]
    """(forms, i) -> the form of one."""
    natural: Callable[..., tuple[tuple[float, float], float, float, float]]
    """(modulus, work, width, rise, form) -> depth (hi, lo), radius, force, stiffness."""
    natural_force: Callable[..., tuple[tuple[float, float], float]]
    """(modulus, work, width, rise, form under dead load) -> the force (hi, lo) that force control is reduced by, and a
    radius."""
    state: Kernel
    """(x, form) -> the state on the branch that a retraction follows."""
    state_of_force: Kernel
    """(distance to the onset under dead load, form under dead load) -> the state."""
    state_of_radius: Kernel
    """(a, natural radius, form) -> the state."""
    distance: Kernel
    """(state, form) -> x."""
    radius: Kernel
    """(state, form) -> a over natural radius."""
    force: Kernel
    """(state, form) -> P over natural force."""
    stiffness: Kernel
    """(state, form) -> k over natural stiffness."""
    energy: Kernel
    """(state, form) -> elastic and surface energy over natural force times natural depth."""
    errors: Callable[..., tuple[float, float]]
    """form -> what ``bound`` has to allow for: of the force over its terms, which are P and twice what adhesion takes
    of it; and of the indentation over g + dl, 0 where the state comes from the distance to the fold itself."""
    radius_of_force: Kernel | None = None
    """(distance to the onset under dead load, form under dead load) -> a over the radius of ``natural_force``, where
    that has more digits than the radius of the state."""
    answer: Callable[..., tuple[float, float, float]] | None = None
    """(state, form) -> radius, force and stiffness, where they are found together."""
    pulled: Callable[..., tuple[float, float]] | None = None
    """(a, form) -> what adhesion takes of the indentation and of the force, or no less, over natural force/stiffness
    and natural force. Used where there is an ``answer``."""
    magnitude: Callable[..., tuple[float, float]] | None = None
    """(state, form) -> how large the terms of g and of a g - G are, in the same units, where they cancel."""
    mixed: Kernel | None = None
    """forms -> whether they differ; None where the law is curved. What follows is used only where it is."""
    passes: int = 0
    """How many steps of Newton's method bring most contacts to their state."""
    guess: Kernel | None = None
    """(x, form) -> where Newton's method begins."""
    nearer: Callable[..., tuple[float, float, float]] | None = None
    """(state, x, form) -> the state one step nearer, how far away it was, and d(state)/dx."""
    arrived: Callable[..., bool] | None = None
    """(state, away, x, rung, form) -> whether a step from so far away has come to the state on branch ``rung``."""
    state_on: Kernel | None = None
    """(x, rung, form) -> the state on branch number ``rung``."""
    rung: Kernel | None = None
    """(x, rung before, whether attracted, form) -> the branch after a way in one direction, 0 out of contact."""
    spent: Kernel | None = None
    """(rung before, rung after, form) -> the energy lost between."""
    cohesive_radius: Kernel | None = None
    """(state, form) -> c over natural radius, where adhesion has a range."""

    @property
    def kernels(self) -> dict[str, object]:
        """Each under its name with an underscore before it, as loops ask ``specialise`` for them."""
        kernels: dict[str, object] = {f"_{name}": value for name, value in self._asdict().items()}
        return {**kernels, "_cohesive": self.cohesive_radius is not None}


def _scalar(name: str, module: ModuleType, adhesive: bool, suffix: str = "", **others: Callable[..., Any]) -> Kernels:
    """The law of a module's kernels, those that end in ``suffix`` before others, and of ``others``."""
    kernels = {"prepare": scalar.prepare, "own": scalar.own, "mixed": scalar.mixed, **_of_module(module, suffix)}
    return Kernels(name, adhesive, curved=False, branched=False, **{**kernels, **others})


def _of_module(module: ModuleType, suffix: str = "") -> dict[str, Any]:
    """A module's kernels, by the names that ``Kernels`` has for them."""
    found = {name: getattr(module, name + suffix, None) or getattr(module, name, None) for name in Kernels._fields}
    return {name: kernel for name, kernel in found.items() if kernel is not None and not isinstance(kernel, ModuleType)}


def _curved(shape: type[ProfileShape], adhesive: bool) -> Kernels:
    """The law of a shape that is known by its profile."""
    built = curved.build(shape, cohesive=False)
    kernels = {name: built[name] for name in Kernels._fields if name in built}
    name = f"{'jkr' if adhesive else 'elastic'}_{shape.name}"
    branched = adhesive and shape.branched()
    return Kernels(name, adhesive, curved=True, branched=branched, **kernels)


def _dugdale(shape: type[Shape]) -> Kernels:
    """The law of a shape under adhesion of finite range."""
    if shape is FlatPunch:
        kernels = _of_module(dugdale_flat)
    else:
        built = curved.build(shape, cohesive=True)
        kernels = {name: built[name] for name in Kernels._fields if name in built}
    return Kernels(f"dugdale_{shape.name}", adhesive=True, curved=True, branched=True, **kernels)


_ELASTIC = {
    "paraboloid": _scalar("elastic_paraboloid", elastic, False, "_paraboloid"),
    "cone": _scalar("elastic_cone", elastic, False, "_cone"),
    "power_law": _scalar("elastic_power_law", elastic, False, "_power"),
    "flat_punch": _scalar("elastic_flat_punch", flat, False, state_of_force=flat.state),
}
_JKR = {
    "paraboloid": _scalar("jkr_paraboloid", jkr_paraboloid, True),
    "cone": _scalar("jkr_cone", jkr_cone, True),
    "power_law": _scalar("jkr_power_law", jkr_power, True),
    "flat_punch": _scalar("jkr_flat_punch", flat, True, "_jkr", state_of_force=flat.state_jkr),
}


def choose(shape: str, adhesion: Adhesion, params: Floats) -> Kernels:
    """The law of asperities of one shape; ``params`` as from ``Shape.stretch``.

    OutOfRange where adhesion and exponent do not go together: below 1/2 only a metastable branch exists, at 1/2 the
    two springs' laws are parallel.
    """
    kind = SHAPES[shape]
    if adhesion.work > 0.0:
        lowest = kind.least_exponent(params)
        if not lowest > 0.5:
            raise OutOfRange(f"exponent is {lowest:g}; with adhesion (work > 0) it must be above 1/2")
    if adhesion.cohesive:
        return _dugdale(kind)
    if issubclass(kind, ProfileShape):
        return _curved(kind, adhesion.work > 0.0)
    return (_JKR if adhesion.work > 0.0 else _ELASTIC)[shape]
