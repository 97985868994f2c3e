"""Gauss's rules for a measure of many weighted points.

The rule of n nodes integrates polynomials of degree 2n - 1 exactly; its nodes are the eigenvalues of the Jacobi matrix
of the measure, its weights follow from their vectors (G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221).
"""

import numpy as np

from roughmdr.numerics.arguments import Floats

_NEGLIGIBLE = 1e-13  # of the spread: what is left of a vector is roundings


def gauss_of_points(x: Floats, weights: Floats, count: int) -> tuple[Floats, Floats]:
    """Return nodes, ascending, and weights of the rule with ``count`` nodes, or with fewer of few points.

    The Jacobi matrix is found by Lanczos's recurrence, each vector orthogonalised anew against all before.
    """
    total = weights.sum()
    centre = float((x * weights).sum() / total)
    spread = float(np.sqrt(((x - centre) ** 2 * weights).sum() / total))
    if not spread > 0.0 or count == 1:
        return np.array([centre]), np.array([total])
    at = (x - centre) / spread
    vectors = [np.sqrt(weights / total)]
    diagonal, beside = [], []
    while True:
        image = at * vectors[-1]
        diagonal.append(float((image * vectors[-1]).sum()))
        for _ in range(2):
            for vector in vectors:
                image = image - (image * vector).sum() * vector
        length = float(np.sqrt((image * image).sum()))
        if len(diagonal) == count or length < _NEGLIGIBLE:
            break
        beside.append(length)
        vectors.append(image / length)
    values, states = np.linalg.eigh(np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1))
    return centre + spread * values, total * states[0] ** 2
