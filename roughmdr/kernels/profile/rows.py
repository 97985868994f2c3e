"""The rows that describe asperities with any ``Profile``, filled once for each. Notation of ``layout``."""

import math

import numpy as np

from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import (
    BRANCHED,
    CONTROL,
    CORNER,
    COUNT,
    DEPTH,
    FLAT,
    FUNCTIONS,
    NUMBER,
    RANGE,
    ROUNDINGS,
    STRENGTH,
    TENSION,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import Pair


def fill_params(material: Material, width: float, rise: float, control: float, params: Floats) -> None:
    """Fill the row of one asperity, in which the parameters of its shape stand already."""
    modulus, work, strength, functions = material
    params[TENSION] = math.sqrt(2.0 * math.pi * work) / math.sqrt(modulus) * math.sqrt(width) / rise
    params[CONTROL], params[NUMBER] = control, params[0]
    params[STRENGTH], params[RANGE] = 2.0 * strength / modulus * width / rise, work / strength / rise
    params[FUNCTIONS] = functions
    kernel.note_shape(params)
    kernel.find_branches(params)


def note_shape(params: Floats) -> None:
    """Fill in the entries of the shape."""
    kernel.precompute(params)
    params[ROUNDINGS] = kernel.roundings(params)
    params[CORNER], params[FLAT], params[BRANCHED] = 1.0 * kernel.corner, 1.0 * kernel.flat, 1.0 * kernel.softens


def repeated(columns: Columns, i: int) -> bool:
    """Return whether asperity i > 0 is like the one before."""
    width, rise, params = columns
    return bool(width[i] == width[i - 1] and rise[i] == rise[i - 1] and params[i] == params[i - 1])


def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return a row for each asperity from start to stop; equal ones in succession share the search for branches."""
    rows, last = np.zeros((stop - start, 2 - kernel.first_node)), 0
    for i in range(stop - start):
        if i > 0 and kernel.repeated(columns, start + i):
            for j in range(rows.shape[1]):
                rows[i, j] = rows[i - 1, j]
            continue
        rows[i, 0] = columns.params[start + i]
        kernel.fill_params(material, columns.width[start + i], columns.rise[start + i], control, rows[i])
        last = max(last, kernel.node_beyond(deepest / columns.rise[start + i], rows[i]))
    kernel.fill_nodes(last, rows)
    return rows


def prepare_tabled(
    material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float
) -> Floats:
    """Do as ``prepare`` where the params of an asperity are a row themselves."""
    size = columns.params.shape[1]
    rows, last = np.zeros((stop - start, size - kernel.first_node)), 0
    for i in range(stop - start):
        rows[i, :size] = columns.params[start + i]
        kernel.fill_params(material, columns.width[start + i], columns.rise[start + i], control, rows[i])
        last = max(last, kernel.node_beyond(deepest / columns.rise[start + i], rows[i]))
    kernel.fill_nodes(last, rows)
    return rows


def prepare_shared(
    material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float
) -> Floats:
    """Return the one row of asperities that are all alike."""
    size = columns.params.shape[1]
    rows = np.zeros((1, size - kernel.first_node))
    rows[0, :size] = columns.params[0]
    kernel.fill_params(material, columns.width[0], columns.rise[0], control, rows[0])
    kernel.fill_nodes(kernel.node_beyond(deepest / columns.rise[0], rows[0]), rows)
    return rows


def params_of(rows: Floats, i: int) -> Floats:
    """Return the row of one asperity."""
    row: Floats = rows[i]
    return row


def shared_params(rows: Floats, i: int) -> Floats:
    """Return the row of all asperities."""
    row: Floats = rows[0]
    return row


def scales(
    effective_modulus: float, work: float, width: float, rise: float, params: Floats
) -> tuple[Pair, float, float, float]:
    """Return the natural depth [m], radius [m], force [N] and stiffness [N/m]; depth 0 where there is no contact."""
    depth = rise * params[DEPTH] if params[COUNT] > 0.0 else 0.0
    return (depth, 0.0), width, 2.0 * effective_modulus * width * rise, 2.0 * effective_modulus * width


def force_scales(
    effective_modulus: float, work: float, width: float, rise: float, params: Floats
) -> tuple[Pair, float]:
    """Return the pull-off force [N], DEPTH of a row under dead load in SI, and the width [m]."""
    return ((2.0 * effective_modulus * width * rise * params[DEPTH] if params[COUNT] > 0.0 else 0.0), 0.0), width


def state_of_radius(radius: float, width: float, params: Floats) -> float:
    """Return t at a contact radius [m]."""
    return kernel.t_of_radius(radius, width, params)
