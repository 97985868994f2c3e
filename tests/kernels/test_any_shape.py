"""Kernels of any shape call the functions of the shape whose rows they are given."""

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import roughmdr as rm
from roughmdr.aggregate.loop import compiled_sum
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.numerics.jit import UNCOMPILED

pytestmark = pytest.mark.skipif(UNCOMPILED, reason="without compiling each shape has kernels of its own")

SHAPES = [rm.Sphere(radius=5e-5), rm.TruncatedCone(slope=0.1, flat_radius=2e-6)]
JKR = Adhesion(0.05)


def prepared(shape: Any, adhesion: Adhesion) -> tuple[Any, Any]:
    columns = Columns(*(np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional()))
    kernels = choose(shape.name, adhesion, columns.params)
    material = kernels.material(4e6, adhesion, summed=True, energetic=True)
    return kernels, kernels.prepare(material, columns, 0, 1, 0.0, math.inf)


@pytest.mark.parametrize("adhesion", [Adhesion(), JKR], ids=["none", "jkr"])
def test_one_sum_is_compiled_for_shapes(adhesion: Adhesion) -> None:
    both = [choose(shape.name, adhesion, np.zeros(1)) for shape in SHAPES]
    first, second = ((kernels.in_sums or kernels).of_any for kernels in both)
    assert first is not None
    assert first is second
    assert compiled_sum(first, energetic=False) is compiled_sum(second, energetic=False)


def test_rows_lead_to_the_functions_of_their_shape() -> None:
    found = []
    for shape in SHAPES:
        kernels, rows = prepared(shape, JKR)
        t = float(kernels.state(3.0, rows[0]))
        assert kernels.reduced_control(t, rows[0]) == pytest.approx(3.0, rel=1e-12)
        found.append(kernels.of_any.radius(t, rows[0]))
        assert found[-1] == kernels.radius(t, rows[0])
    assert found[0] != found[1]


def test_threads_that_start_together_find_the_same_law() -> None:
    section = {"source": "random", "shape": "rounded_punch", "count": 50, "patch": "1 mm", "flat_radius": "2 um"}
    section |= {"edge_radius": "50 um", "height": {"distribution": "normal", "std": "1 um"}}
    asperities = rm.generate(section, seed=1)

    def force(_: int) -> bytes:
        law = rm.load_separation(asperities, separation=["2 um", "1 um"], effective_modulus=4e6, work=0.05)
        return law.force.values.tobytes()

    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(force, range(4)))) == 1
