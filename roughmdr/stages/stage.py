"""Stage: the base of sections of a scene that change the law of its contacts, or add to it.

A stage is a table of the scene. The program uses such a section through the methods below alone, whose defaults suit a
section that changes nothing. None of them imports physics before it is needed: scenes are read without it.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, Self, TypeVar

from roughmdr.schema.section import Section

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.aggregate.problem import Problem
    from roughmdr.ensemble import Ensemble, Source
    from roughmdr.kernels.adhesion import Adhesion
    from roughmdr.loading.lateral import Path
    from roughmdr.numerics.arguments import Floats

AnySection = TypeVar("AnySection", bound=Section)
Law = Callable[["Path", list[str]], "LoadSeparation"]
"""A path and the variables asked for -> the law along it, which may have other variables too."""


class Given(Protocol):
    """The parts of a scene without a sweep that stages use, as ``scene.content`` declares them: it imports stages."""

    @property
    def seed(self) -> int: ...
    @property
    def material(self) -> Any: ...
    @property
    def path(self) -> Any: ...
    @property
    def output(self) -> Any: ...
    @property
    def accuracy(self) -> Any: ...
    @property
    def interaction(self) -> Any: ...
    @property
    def asperities(self) -> "Source": ...
    @property
    def effective_modulus(self) -> float: ...
    @property
    def bodies(self) -> tuple[float, ...] | None: ...
    @property
    def work(self) -> float: ...
    @property
    def adhesion_model(self) -> "Adhesion": ...
    @property
    def nominal_area(self) -> float | None: ...
    @property
    def repeats(self) -> bool: ...
    @property
    def estimators(self) -> tuple[str, ...]: ...
    @property
    def unlike(self) -> str: ...
    @property
    def stages(self) -> "tuple[Stage, ...]": ...
    def reason_against(self, estimator: str) -> str: ...
    def stage(self, kind: type[AnySection]) -> AnySection | None: ...


class Contacts(NamedTuple):
    """The contacts whose law a stage changes."""

    law: Law
    """Their law, as inner stages changed it."""
    highest: Callable[[], float]
    """Return the height of the highest summit [m]; -inf where there is none."""
    nominal_area: float | None
    """[m2]"""
    problem: "Problem | None" = None
    """The asperities, or a part of them, with their material; None for an expected law."""
    realization: int | None = None
    """Number of the realisation; None for an expected law, and where ``plan`` foresees the law from that part."""


class Stage(Section):
    """A section that changes the law of a scene. ``roughmdr.stages.STAGES`` lists all, innermost first."""

    key: ClassVar[str]
    """Name of the section."""
    about: ClassVar[str]
    """Line on the section, for editors."""
    small_scene: ClassVar[Mapping[str, Any]]
    """Sections of a small scene that compiles the functions of the section."""
    swept: ClassVar[bool] = True
    """Whether its keys may be swept."""
    fitted: ClassVar[bool] = True
    """Whether its keys may be fitted to a measured normal law."""
    replaces_contacts: ClassVar[bool] = False
    """Whether its law is made of the asperities, not of the law of their elastic contacts."""
    visit_seconds: ClassVar[float] = 0.0
    """Seconds of an asperity at a step, where it is."""
    on_grid: ClassVar[bool] = False
    """Whether it presses the surface itself by boundary elements, which takes the positions of the asperities."""
    flat: ClassVar[bool] = True
    """False where the section replaces the flat by another body."""
    unlike: ClassVar[str] = ""
    """How the law differs from that of elastic contacts under a flat, the only one that theories and coupling describe,
    in words; empty if it does not.
    """
    most_foreseen: ClassVar[float] = math.inf
    """Largest number of steps at which ``plan`` foresees the law."""
    more_separations: ClassVar[int] = 0
    """Number of separations, beside those of the steps, at which the law of the contacts is needed."""
    own_variables: ClassVar[tuple[str, ...]] = ()
    """Variables of [output] that a scene without the section does not have."""
    about_absent: ClassVar[str] = ""
    """Name of the part of physics that a scene without the section leaves out."""
    noted: ClassVar[str] = ""
    """Attribute of results, and name in summaries, of ``notes``; one of ``RESULT_ATTRIBUTES``."""
    papers: ClassVar[Mapping[str, str]] = {}
    """Subject of each paper, by its key in report/papers.bib."""

    # the scene

    @classmethod
    def is_in(cls, table: Mapping[str, Any]) -> bool:
        """Return whether a scene, as a table, has the section in any of its cells."""
        return cls.key in table or any(str(key).startswith(f"{cls.key}.") for key in table.get("sweep", {}))

    @classmethod
    def usual_variables(cls, table: Mapping[str, Any]) -> list[str] | None:
        """Return the variables of a scene, as a table, whose output names none; None where they are the usual ones."""
        return None

    @classmethod
    def check_without(cls, scene: Given) -> None:
        """Raise a mismatch where a scene without the section needs it."""

    def check(self, scene: Given) -> None:
        """Raise a mismatch where the scene lacks something that the section needs, or it does not go with another."""

    @classmethod
    def alone(cls, scene: Given, section: Any) -> str:
        """Return the key at fault if two sections need the plain elastic law under a flat; empty if this does not.

        ``section`` is None where the scene has none. A section that is ``unlike`` needs it, unless it says otherwise.
        """
        return cls.key if section is not None and cls.unlike else ""

    def reason_against(self, scene: Given, estimator: str) -> str:
        """Return why the estimator "stratified" or "expected" is impossible; empty where it is possible."""
        return ""

    # the plan

    def check_path(self, values: "Floats") -> None:
        """Raise SceneError where the section does not go with a path of these values, in SI."""

    def check_read(self, scene: Given, ensemble: "Ensemble") -> None:
        """Raise SceneError where asperities that are read, not drawn, lack what a section ``on_grid`` needs."""

    def more_variables(self, names: list[str]) -> list[str]:
        """Return result variables that the section adds, given those asked for; none under a machine or sideways."""
        return []

    def coordinates(self, values: "Floats") -> "dict[str, Floats]":
        """Return the coordinates over the steps that the section adds to the controlled ``values``, in SI."""
        return {}

    def pressed(self, ensemble: "Ensemble") -> "Ensemble":
        """Return drawn asperities as a flat presses them in place of the body of the section."""
        return ensemble

    def clear_above(self, scene: Given) -> float:
        """Return the height [m] that the section adds to the start "clear"."""
        return 0.0

    @classmethod
    def left_out(cls, scene: Given, section: Any) -> Iterator[str]:
        """Yield lines "part: reason" on what the scene leaves out; ``section`` is None where it has none."""
        if section is None:
            yield f"{cls.about_absent}: the scene has no [{cls.key}]"

    def notes(self, scene: Given) -> Iterator[str]:
        """Yield effects that the theory of the section neglects, for ``noted``."""
        yield from ()

    def coarse(self) -> Self:
        """Return the section as its law is foreseen: with larger errors, in less time."""
        return self

    def expected_seconds(self, nodes: int, steps: int, *, adhering: bool) -> float | None:
        """Return about how long an expected law of so many nodes takes [s]; None to take the estimate for a flat."""
        return None

    def beside(self, scene: Given, separations: int, *, finest: bool) -> tuple[float, float]:
        """Return about how long [s] and how much memory [byte] the section adds to each realisation.

        With the grids it begins with, or with the ``finest``, which few and small contacts may need.
        """
        return 0.0, 0.0

    def plan_lines(self, longest: str, finest: str) -> Iterator[str]:
        """Yield the cost that the section adds to a run, given time and memory with the ``finest`` grids in words."""
        yield from ()

    # the law

    def prepare(self, scene: Given, *, drawn: bool) -> None:
        """Compile what the law of ``drawn`` asperities, or the expected one, needs where it ``replaces_contacts``."""

    def inner_variables(self, names: list[str]) -> list[str]:
        """Return the variables that ``law`` asks of the inner law for these; they are compiled before a run."""
        return names

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the law of a scene from that of its contacts.

        Under a machine the law of the contacts finds the separations: a section that changes the force excludes one.
        """
        return contacts.law

    # the result

    def attributes(self) -> dict[str, str]:
        """Return attributes of the result, each one of ``RESULT_ATTRIBUTES``, which checksums cover."""
        return {}

    @classmethod
    def result_lines(cls, result: Any) -> Iterator[tuple[str, str]]:
        """Yield lines on the section for the summary of a result, which is read through ``ResultView``."""
        yield from ()

    @classmethod
    def cites(cls, table: Mapping[str, Any], variables: list[str]) -> Mapping[str, str]:
        """Return those of ``papers`` that a scene, as a table, rests on, given the variables asked for."""
        return cls.papers if cls.is_in(table) else {}
