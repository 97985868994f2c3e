"""The parts of the kernels of asperities with any ``Profile``, and the constants of kernels of all shapes."""

import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any

from roughmdr.kernels.profile import branches, elastic, equilibrium, folds, initial_guess, newton, rows
from roughmdr.kernels.profile.layout import first_node

OCTAVES, OCTAVES_OF_SIMILAR = 24, 40
OCTAVES_OF_EDGES = 14  # octaves of the table of both edges; a node costs as much as two visits
_SPLIT = 6  # halvings of an octave of the initial guess where all asperities share one row
VECTOR_CODE: set[Callable[..., Any]] = {
    equilibrium.indentation_at,
    equilibrium.radius_force_stiffness,
    elastic.y_of_x,
    elastic.x_of_y,
    elastic.indentation_at,
    elastic.contact_near,
    elastic.radius_force_stiffness,
    initial_guess.y_of_x,
    initial_guess.cubic,
    initial_guess.shortening,
    initial_guess.y_over_part,
    initial_guess.initial_guess,
    initial_guess.x_of_y,
    initial_guess.extrapolate_node,
    newton.newton_step,
    newton.one_step,
    newton.two_steps,
    newton.converged,
    equilibrium.adhesion_terms,
    equilibrium.relative_errors,
}


def functions_of(*modules: ModuleType) -> dict[str, Callable[..., Any]]:
    """Return the public functions of modules by name; those of later modules take the place of earlier ones."""
    return {
        name: function
        for module in modules
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and not name.startswith("_") and name != "build"
    }


def elastic_or_jkr(similar: bool) -> dict[str, Callable[..., Any]]:
    """Return the parts without adhesion, and of JKR; ``similar`` for asperities that share one row."""
    own = (elastic,) if similar else ()
    return functions_of(folds, newton, initial_guess, branches, rows, equilibrium, *own)


def constants_of(shared: bool, similar: bool, octaves: int, node_size: int) -> dict[str, Any]:
    """Return the constants of kernels of all shapes: how contacts are found, and the layout of rows."""
    split = _SPLIT if shared else 0
    return {
        "iterative": True,
        "found_together": True,
        "shared": shared,
        "found_near": similar,
        "octaves": octaves,
        "split": split,
        "first_node": first_node(octaves, split, node_size),
        "node_size": node_size,
    }
