"""The kernels of one contact, by the names that loops and contacts call them: floats in, floats out.

All is reduced by the natural scales of the contact. ``x`` is the distance to detachment, without adhesion to first
touch, over the natural depth: delta/depth without adhesion, 1 - delta/delta_c with it, delta_c where a slow retraction
ends. ``params`` are those of one contact: a number, or a row of numbers. The state of a contact is one number that
grows with its radius.
"""

from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple, Self

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats

Kernel = Callable[..., float]


class Material(NamedTuple):
    """Elasticity and adhesion, as kernels take them."""

    effective_modulus: float
    """E* [Pa]."""
    work: float
    """w [J/m2]; 0 for none."""
    strength: float
    """sigma0 [Pa] of adhesion with a range, else inf."""
    functions: float
    """Address of the functions of the shape, from ``Kernels.material``; 0 where the kernels hold them."""


class Columns(NamedTuple):
    """Dimensional and other parameters of asperities, one each."""

    width: Floats
    """Radius [m] that contact radii are reduced by."""
    rise: Floats
    """Height [m] that indentations are reduced by."""
    params: Floats
    """Shape parameters [1], from ``Shape.nondimensionalise``."""


class Kernels(ModuleType):
    """The kernels of a shape under an adhesion model.

    A module, since compiled code can hold nothing else under one name: a loop names its kernels ``kernel.state`` and so
    on, and ``numerics.jit.specialise`` puts these in the place of ``kernel``.
    """

    adhesive = False
    iterative = False
    """Whether states are found by Newton's method, and ``params`` is a row."""
    shared = False
    """Whether one such row serves all asperities."""
    branched = False
    """Whether there can be more than one stable branch."""
    cohesive = False
    """Whether adhesion has a range."""
    hardening = False
    """Whether it is certain that k grows with the indentation along a branch."""
    one_by_one = False
    """Whether contacts are solved one at a time, not all of a block step by step."""
    found_near = False
    """Whether guesses of the state are so good that a contact is found from its values at the guess."""
    found_together = False
    """Whether radius, force and stiffness cost no more together than one of them."""
    alike = False
    """Whether asperities differ in width and rise alone."""

    in_sums: Self | None = None
    """Kernels for the sum over asperities alone, where these are too slow for it; None where they are not."""
    of_any: Self | None = None
    """Kernels of any shape, which call the functions of this one by addresses in its rows: code compiled with them
    serves all shapes."""
    rows_tell: bool = False
    """Whether ``branched`` depends on the shape, and is read from the row."""
    functions: Callable[[bool, bool], float] | None = None
    """(whether for a sum, whether with energies) -> the address of the functions that ``of_any`` calls."""

    prepare: Callable[[Material, Columns, int, int, float, float], Any]
    """(material, columns, start, stop, control, deepest) -> params of the asperities from start to stop; control is 0
    for fixed grips, 1 for dead load. States deeper than ``deepest`` [m] are asked for out of contact alone, where
    results are dropped."""
    params_of: Callable[..., Any]
    """(params, i) -> the params of asperity i."""
    heterogeneous: Callable[[Any], bool]
    """params -> whether asperities differ in them; only where ``found_together`` and ``alike`` are false."""
    scales: Callable[..., tuple[tuple[float, float], float, float, float]]
    """(effective_modulus, work, width, rise, params) -> depth (hi, lo) [m], radius [m], force [N], stiffness [N/m]."""
    force_scales: Callable[..., tuple[tuple[float, float], float]]
    """(effective_modulus, work, width, rise, params under dead load) -> the force (hi, lo) [N] that force control is
    reduced by, and a radius [m]."""
    state: Kernel
    """(x, params) -> the state on the branch that a retraction follows."""
    state_of_force: Kernel
    """(distance to detachment under dead load, params under dead load) -> the state."""
    state_of_radius: Kernel
    """(a, natural radius, params) -> the state; NaN where the radius does not determine it."""
    radius_of_force: Kernel | None = None
    """(distance to detachment under dead load, params under dead load) -> a over the radius of ``force_scales``, where
    that has more digits than the radius of the state."""
    reduced_control: Kernel
    """(state, params) -> x."""
    radius: Kernel
    """(state, params) -> a over natural radius."""
    force: Kernel
    """(state, params) -> P over natural force."""
    stiffness: Kernel
    """(state, params) -> k over natural stiffness."""
    radius_force_stiffness: Callable[..., tuple[float, float, float]]
    """(state, params) -> all three."""
    energy: Kernel
    """(state, params) -> elastic and surface energy over natural force times natural depth."""
    contact_at: Callable[..., tuple[float, float, float, float]]
    """(x, branch, params) -> the state on that branch, and what ``radius_force_stiffness`` returns; where
    ``one_by_one``."""
    cohesive_radius: Kernel
    """(state, params) -> c over natural radius, where ``cohesive``."""
    equilibrium_at_radius: Callable[..., tuple[float, float, float]]
    """(a, natural radius, params) -> indentation, force and stiffness over their scales, of adhesion with a range."""
    cohesive_at_radius: Kernel
    """(a, natural radius, params) -> c over natural radius, of adhesion with a range."""
    relative_errors: Callable[..., tuple[float, float]]
    """params -> two relative errors for ``aggregate.error_bound``: of the force, relative to |P| plus twice the second
    of ``adhesion_terms``; of the indentation, relative to g + dl, 0 where the state comes from x itself."""
    adhesion_terms: Callable[..., tuple[float, float]]
    """(a, params) -> upper bounds of the parts of adhesion: in the indentation (dl in JKR), over natural
    force/stiffness, and in the force (2 E* a dl), over natural force; where ``found_together``."""
    terms_cancel = False
    """Whether g or a g - G is a sum of terms that cancel."""
    term_sizes: Callable[..., tuple[float, float]]
    """(state, params) -> the sizes of those terms, in the units of ``adhesion_terms``."""

    refinements: int = 0
    """Number of times ``refined`` is applied to ``initial_guess`` to find the state; 0 where ``state`` is no slower."""
    refined: Kernel
    """(state, x, params) -> the state one step nearer."""

    initial_guess: Kernel
    """(x or ``y_of_x``, params) -> the state to begin at."""
    y_of_x: Kernel
    """(x, params) -> the variable of a table of guesses; this and the next two where ``iterative``."""
    find_all: Callable[..., None]
    """(count, contacts, params) -> None; fills in what ``kernels.blocks`` says."""
    evaluate_all: Callable[..., None]
    """(count, contacts, params) -> None; fills in the same from the states alone."""
    approach: Callable[..., tuple[float, float, float]]
    """(that state, x, params) -> the state after a fixed number of steps, a bound of its error, and d(state)/dx."""
    one_step: Callable[..., tuple[float, float, float]]
    """Like ``approach``, with one step."""
    contact_near: Callable[..., tuple[float, float, float, float, float]]
    """(guess of the state, x, params) -> the state, what ``radius_force_stiffness`` returns, and about the square of
    their relative distance from the guess, inf next to a kink; where ``found_near``."""
    converged: Callable[..., bool]
    """(error bound, branch, params) -> whether the state is that on this branch."""
    state_on_branch: Kernel
    """(x, branch, params) -> the state on branch number 1, 2, ..."""
    branch: Kernel
    """(x, branch before, whether attracted, params) -> the branch after a path in one direction; 0 out of contact."""
    jump_energy: Kernel
    """(branch before, branch after, params) -> the energy dissipated between them."""

    @property
    def name(self) -> str:
        """The name that distinguishes copies of a loop in the cache."""
        return self.__name__

    def material(
        self, effective_modulus: float, adhesion: Adhesion, *, summed: bool = False, energetic: bool = False
    ) -> Material:
        """Return elasticity and adhesion for ``prepare``; E* [Pa].

        ``summed`` where a sum compiled with ``of_any`` reads the rows, ``energetic`` where it sums energies. The
        address is valid in this process alone.
        """
        at = 0.0 if self.functions is None else self.functions(summed, energetic)
        return Material(effective_modulus, adhesion.work, adhesion.strength, at)

    def copy(self, suffix: str = "") -> Self:
        """Return a copy of these kernels, which may be changed, under a name with ``suffix``."""
        other = type(self)(self.__name__ + suffix)
        vars(other).update({**vars(self), "__name__": other.__name__})
        return other


kernel = Kernels("kernel")
"""Stands for the kernels in a loop that ``specialise`` is given."""
