"""The bound of the error rests on this: g and ∫ x g' dx of every profile are right to the roundings that it states."""

import numpy as np
import pytest
from oracles.jkr import ExactContact
from oracles.multiprecision import mp
from studies.asperity_error import DRAW

import roughmdr as rm
from roughmdr.numerics.jit import compiled
from roughmdr.shapes import SHAPES, ProfileShape

CURVED = [kind for kind, shape in SHAPES.items() if issubclass(shape, ProfileShape)]


@pytest.mark.few(5)
@pytest.mark.parametrize("kind", CURVED)
def test_a_profile_is_right_to_its_roundings(kind: str) -> None:
    rng = np.random.default_rng(CURVED.index(kind))
    own: type[ProfileShape] = SHAPES[kind]  # type: ignore[assignment]
    curve, push, roundings = (
        compiled(part) for part in (own.profile.mdr_profile, own.profile.reduced_load, own.profile.roundings)
    )
    magnitude = None if own.profile.term_sizes is None else compiled(own.profile.term_sizes)
    worst = 0.0
    for _ in range(20):
        try:
            with np.errstate(all="ignore"):
                shape = DRAW[kind](rng)
            width, rise, params = shape.nondimensional()
        except rm.RoughmdrError:
            continue
        numbers, exact = np.atleast_1d(np.asarray(params, dtype=np.float64)), ExactContact(shape, 1.0, 0.0)
        for t in 10.0 ** np.concatenate([rng.uniform(-4.0, 1.0, 8), rng.uniform(-0.5, 0.5, 8)]):
            _, _, g, _ = curve(t, numbers)
            pushed = push(t, numbers)
            if not (1e-290 < g < 1e290 and 1e-290 < pushed < 1e290):
                continue
            point = exact.at(mp.mpf(float(t)))
            terms = magnitude(t, numbers) if magnitude is not None else (g, pushed)
            load = point["force"] / 2 / rise / width
            for got, true, size in ((g, point["indentation"] / rise, terms[0]), (pushed, load, terms[1])):
                error = float(abs(got - true)) / max(got, size) * 2.0**53
                worst = max(worst, error)
                assert error <= roundings(numbers), (shape, t)
    assert worst > 0.0
