"""What is asked in a case of ``stability.py`` under each law, and what came of it: right, refused or wrong."""

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
import xarray as xr
from cohesive_twin import CohesiveTwin
from judgement import Answers, Judged, answers_at, judge, judge_cohesive, natural_scales, representable
from stability_cases import Case
from twins import Real, Twin, mp

import roughmdr as rm

LAWS = ("elastic", "jkr", "dugdale")
OUTCOMES = RIGHT, REFUSED, WRONG = ("right", "refused", "wrong")
CONTROLS = ("indentation", "force", "contact_radius")
_TINY = 1e-300  # no force at all


class Reference(Protocol):
    """One asperity with 60 digits."""

    def depth(self) -> Real:
        """How far it is pulled before it lets go [m], 0 without adhesion."""

    def value(self, control: str, distance: float) -> Real:
        """The control at a distance to the fold; a radius may be that of another state, where there is none."""

    def numbers(self, control: str, value: Real) -> list[Real]:
        """What a float must hold of the answer."""

    def judge(self, control: str, got: Answers) -> dict[str, Judged]:
        """Errors, and what is allowed."""

    def contact(self, indentation: Real) -> tuple[Real, Real]:
        """Contact radius [m] and force [N] of a slow retraction."""


class PlainReference:
    """Without adhesion, or with JKR's."""

    def __init__(self, shape: rm.PowerLaw, effective_modulus: float, work: float) -> None:
        self.twin, self.width = Twin(shape, effective_modulus, work), shape.nondimensional()[0]

    def depth(self) -> Real:
        """How far it is pulled before it lets go [m], 0 without adhesion."""
        return -self.twin.indentation(self.twin.fold("indentation"))

    def value(self, control: str, distance: float) -> Real:
        """The control at a distance to the fold; a radius may be that of another state, where there is none."""
        twin, own = self.twin, "force" if control == "force" else "indentation"
        law = twin.force if control == "force" else twin.indentation
        value = law(twin.fold(own)) * (1 - mp.mpf(distance)) if twin.work else law(mp.mpf(self.width)) * distance
        return twin.radius(own, value) if control == "contact_radius" else value

    def numbers(self, control: str, value: Real) -> list[Real]:
        """What a float must hold of the answer."""
        a = value if control == "contact_radius" else self.twin.radius(control, value)
        return [*natural_scales(self.twin), *answers_at(self.twin, a)]

    def judge(self, control: str, got: Answers) -> dict[str, Judged]:
        """Errors, and what is allowed."""
        return judge(self.twin, control, got)

    def contact(self, indentation: Real) -> tuple[Real, Real]:
        """Contact radius [m] and force [N] of a slow retraction."""
        a = self.twin.radius("indentation", indentation)
        return a, self.twin.force(a)


class CohesiveReference:
    """With Dugdale's adhesion."""

    def __init__(self, shape: rm.PowerLaw, effective_modulus: float, work: float, strength: float) -> None:
        self.twin = CohesiveTwin(shape, effective_modulus, work, strength)

    def depth(self) -> Real:
        """How far it is pulled before it lets go [m], 0 without adhesion."""
        return -self.twin.pull_off("indentation").indentation

    def value(self, control: str, distance: float) -> Real:
        """The control at a distance to the fold; a radius may be that of another state, where there is none."""
        own = "force" if control == "force" else "indentation"
        value = self.twin.pull_off(own).under(own) * (1 - mp.mpf(distance))
        if control != "contact_radius":
            return value
        a = self.twin.answer(own, value).contact_radius
        return a if a > 0 else self.twin.pull_off("force").contact_radius

    def numbers(self, control: str, value: Real) -> list[Real]:
        """What a float must hold of the answer."""
        twin = self.twin
        state = twin.at_radius(value) if control == "contact_radius" else twin.answer(control, value)
        ends = [state, *(twin.pull_off(own) for own in ("indentation", "force"))]
        radii = [each.contact_radius for each in ends if each.contact_radius > 0]
        radii += [each.cohesive_radius for each in ends]
        held = [number for each in ends[1:] for number in (each.indentation, each.force)]
        return [*radii, *(r * r for r in radii), *held, state.stiffness]

    def judge(self, control: str, got: Answers) -> dict[str, Judged]:
        """Errors, and what is allowed."""
        return judge_cohesive(self.twin, control, got)

    def contact(self, indentation: Real) -> tuple[Real, Real]:
        """Contact radius [m] and force [N] of a slow retraction."""
        state = self.twin.answer("indentation", indentation)
        return state.contact_radius, state.force


class Verdict(NamedTuple):
    """What came of one question."""

    outcome: str
    judged: Judged = Judged(0.0, 1.0)
    """The worst of the answers."""
    reason: str = ""
    """Why it was refused, or is wrong."""


def on_answers(judged: dict[str, Judged]) -> Verdict:
    """Right where all answers are within what is allowed."""
    if not judged:
        return Verdict(RIGHT)
    name, worst = max(judged.items(), key=lambda item: math.inf if math.isnan(item[1].excess) else item[1].excess)
    if worst.excess <= 1.0:
        return Verdict(RIGHT, worst)
    return Verdict(WRONG, worst, f"{name} is off by {worst.error:.2g}, allowed {worst.allowed:.2g}")


def on_error(error: Exception, numbers: list[Real]) -> Verdict:
    """An error is right only as a refusal, where floats do not hold all the numbers of the exact answer."""
    if not isinstance(error, rm.RoughmdrError):
        return Verdict(WRONG, reason=f"{type(error).__name__}: {error}")
    if representable(numbers):
        return Verdict(WRONG, reason=f"refused without need: {error}")
    return Verdict(REFUSED, reason=_kind(str(error)))


def _kind(message: str) -> str:
    """What an error says, without its numbers."""
    return re.sub(r"-?(\d|inf)\S*", "...", re.sub(r" \(.*?\)", "", re.split("[:;]", message)[0]))


def verdicts(case: Case, law: str) -> list[Verdict]:
    """Of all the questions: each asperity under each control, and the sum along a way in and out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # slopes that are not small have right answers too
        return list(_verdicts(case, law))


def _verdicts(case: Case, law: str) -> Iterator[Verdict]:
    shapes = case.shapes()[: 2 if law == "dugdale" else None]  # the slow reference
    asked: dict[str, Any] = {"effective_modulus": case.stiffness, "work": 0.0 if law == "elastic" else case.work}
    if law == "dugdale":
        try:
            strength = case.tabor / rm.tabor(shapes[0], **asked, strength=1.0)
        except Exception as error:
            yield on_error(error, natural_scales(Twin(shapes[0], **asked)))
            return
        asked["strength"] = strength
    references = [(CohesiveReference if law == "dugdale" else PlainReference)(shape, **asked) for shape in shapes]
    asked |= {"adhesion": "dugdale"} if law == "dugdale" else {}
    alone = 1 if law == "dugdale" else len(shapes)
    for shape, reference, distance in list(zip(shapes, references, case.distances(), strict=False))[:alone]:
        for control in CONTROLS:
            yield _alone(shape, reference, control, distance, asked)
    depths = [reference.depth() for reference in references]
    if law == "elastic" or representable(depths):
        yield _together(shapes, references, depths, case.distances(), asked)


def _alone(shape: rm.PowerLaw, reference: Reference, control: str, distance: float, asked: dict[str, Any]) -> Verdict:
    """One asperity under one control."""
    value = reference.value(control, distance)
    try:
        contact = rm.indent(shape, **asked, **{control: float(value)})  # type: ignore[arg-type]
    except Exception as error:
        return on_error(error, reference.numbers(control, value))
    return on_answers(reference.judge(control, {str(name): float(contact[name]) for name in contact.variables}))


def _together(
    shapes: list[rm.PowerLaw],
    references: Sequence[Reference],
    depths: list[Real],
    distances: tuple[float, ...],
    asked: dict[str, Any],
) -> Verdict:
    """The sum along a way: pressed until all touch, back to the distances to the folds, and until the first lets go.

    The error of the force must be within what the sum itself says of it, and no contact may be made or lost too many.
    """
    exact = [
        reference.value("indentation", distance) for reference, distance in zip(references, distances, strict=False)
    ]
    height = np.array([float(value) for value in exact])
    first, second = sorted(float(z + depth) for z, depth in zip(exact, depths, strict=True))[:2]
    low = float(min(z - depth for z, depth in zip(exact, depths, strict=True))) if any(depths) else 0.5 * min(height)
    way = [low, 0.0, 0.5 * (first + second)]
    columns = {name: [shape.parameters[name] for shape in shapes] for name in shapes[0].parameters}
    ensemble = xr.Dataset(
        {name: ("asperity", column) for name, column in {"height": height, **columns}.items()},
        attrs={"shape": shapes[0].name},
    )
    contacts = [
        [
            reference.contact(mp.mpf(z) - mp.mpf(h))
            for z, reference, depth in zip(height.tolist(), references, depths, strict=True)
            if mp.mpf(z) - mp.mpf(h) > -depth
        ]
        for h in way
    ]
    try:
        law = rm.load_separation(ensemble, separation=way, variables=["force", "contact_count"], **asked)
    except Exception as error:
        # The bound of the error takes the greatest of all natural scales and distances together.
        farthest = (max(height) - low) / min(depths) if any(depths) else 0
        needed = [
            number
            for reference, depth, z in zip(references, depths, height.tolist(), strict=True)
            for delta in (depth * farthest, *(mp.mpf(z) - mp.mpf(h) for h in way[:2]))
            if delta
            for number in reference.numbers("indentation", delta)
        ]
        return on_error(error, needed)
    force = [mp.fsum(push for _, push in step) for step in contacts]
    largest = max(*map(abs, force), mp.mpf(_TINY))
    worst = max(abs(exact - mp.mpf(got)) for exact, got in zip(force, law.force.to_numpy().tolist(), strict=True))
    count = [sum(a > 0 for a, _ in step) for step in contacts]
    if law.contact_count.to_numpy().tolist() != count:
        return Verdict(WRONG, reason=f"{law.contact_count.to_numpy().tolist()} contacts, not {count}")
    return on_answers({"force of all": Judged(float(worst / largest), float(law.numerical_error))})
