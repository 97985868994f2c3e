"""The parts of the kernels of any profile, beside the kernels that loops call (``kernels.interface``).

In units of the shape's width and rise; ``params`` is a row as ``layout`` describes it.
"""

from collections.abc import Callable

from roughmdr.kernels.interface import Columns, Kernel, Kernels
from roughmdr.numerics.arguments import Floats


class ProfileKernels(Kernels):
    """Kernels of a shape that is known by its profile."""

    mdr_profile: Callable[..., tuple[float, float, float, float]]
    """Described in ``shapes.profile.Profile``, with all names down to ``t_of_q``."""
    reduced_load: Kernel
    t_of_radius: Kernel
    f_and_slope: Callable[..., tuple[float, float]]
    softening_count: Callable[[Floats], int]
    softening_interval: Callable[[int, Floats], tuple[float, float]]
    kink: Callable[..., bool]
    breakpoint_count: Callable[[Floats], int]
    breakpoint: Callable[[int, Floats], tuple[float, float]]
    precompute: Callable[[Floats], None]
    roundings: Kernel
    softens: bool
    """Whether sqrt(a) g'(a) may fall, so that there may be more than one branch with adhesion."""
    note_shape: Callable[[Floats], None]
    """params -> None; fills in the entries of the shape, first those of ``precompute``."""
    elastic_integral: Kernel
    zone_integrals: Callable[..., tuple[float, float]]
    corner: bool
    flat: bool
    end: float
    has_t_of_q: bool
    t_of_q: Kernel

    indentation_at: Callable[..., tuple[float, float]]
    """(t, params) -> the indentation and its derivative by t."""
    control_at: Callable[..., tuple[float, float]]
    """(t, params) -> the controlled quantity, indentation or force, and its derivative by t."""
    steepness: Kernel
    log_excess: Kernel
    steepness_crossing: Kernel
    note_branch: Callable[..., int]
    list_branches: Callable[..., int]
    measure_branches: Callable[[int, Floats], None]
    find_branches: Callable[[Floats], None]
    control_above_fold: Callable[..., tuple[float, float]]
    solve_on_branch: Kernel
    octaves: int
    """Number of octaves of y that the table of initial guesses covers."""
    newton_step: Callable[..., tuple[float, float, float]]
    split: int
    """Number of times each of them is halved."""
    first_node: int
    """Index in a row of the first node of that table."""
    node_size: int
    """Numbers of a node."""
    y_over_part: Callable[[int], float]
    y_of_node: Callable[[int], float]
    shortening: Callable[[int], float]
    cubic: Kernel
    guess_anywhere: Kernel
    x_of_y: Callable[..., tuple[float, float]]
    extrapolate_node: Kernel
    step_to: Callable[[int, Floats], float]
    fill_first_node: Callable[[Floats], float]
    fill_node: Callable[..., None]
    repeated: Callable[[Columns, int], bool]
    node_beyond: Callable[[float, Floats], int]
    fill_nodes: Callable[[int, Floats], None]
    one_step_all: Callable[[float, Floats, Floats], None]
    fill_params: Callable[..., None]

    two_steps: Callable[..., tuple[float, float, float]]
    kink_between: Callable[..., bool]
    """(low, high, params) -> whether the indentation is not smooth for states from low to high."""
    stride: float
    """Factor from one state to the next in the search for branches under adhesion with a range."""
    widest_zone: Kernel
    t_along: Kernel
    of_pieces: bool
    """Whether g is a piecewise polynomial in sqrt(x^2 - y^2), y from ``breakpoint``."""
    zone_panel: Callable[..., tuple[float, float, float]]
    rise_begins: Kernel
    zone_quadrature: Callable[..., tuple[float, float, float]]
    thin_integral: Kernel
    gap_integrals: Callable[..., tuple[float, float]]
    energy_integral: Kernel
    find_junction: Callable[[Floats], bool]
    gap_at: Callable[..., tuple[float, float]]
    zone_guess: Kernel
    zone_width: Kernel
    zone_edge: Callable[..., tuple[float, float, float, float, float, float, float]]
    contact_edge: Callable[..., tuple[float, float, float, float, float]]
    zone_edge_near: Callable[..., tuple[float, float, float, float, float, float, float]]
    state_along: Callable[..., tuple[float, float, float, float, float]]
    state_between: Callable[..., tuple[float, float, float, float, float]]
    newton_of_both: Callable[..., tuple[float, float, float, float]]
    room: Kernel
    newton_at_end: Callable[..., tuple[float, float, float, float]]
    both_edges: Callable[..., tuple[bool, float, float, float, float]]
    guess_both: Callable[..., tuple[float, float]]
    edges_at: Callable[..., tuple[bool, float, float]]
    state_by_search: Kernel
    fill_nodes_of: Callable[[int, Floats], None]
    zone_at: Callable[..., tuple[float, float]]
    next_trial: Kernel
    slope_root: Kernel


kernel = ProfileKernels("kernel")
"""Stands for the kernels in functions that ``specialise`` is given."""
