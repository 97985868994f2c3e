"""[plasticity]: contacts that yield under the pressure of their asperities."""

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator
from pydantic_core import PydanticCustomError

from roughmdr.errors import RoughmdrError
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.stages.stage import Contacts, Given, Law, Stage

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.loading.lateral import Path
    from roughmdr.stages.plastic.body import Body
    from roughmdr.stages.plastic.law import Asperities

_ROUND, _OTHERS = ("paraboloid", "sphere"), ("cone", "flat_punch")
"""Shapes that yield as a sphere of their radius; others, by model = "mdr" on a half-space."""
_SPHERES = ("jackson-green", "kogut-etsion", "sphere")
"""Models and bodies that are of spheres alone."""
_PAPERS = {
    "paraboloid": ("Zunker2024", "JacksonGreen2005", "KogutEtsion2002", "Etsion2005"),
    "cone": ("Zunker2024", "Johnson1985", "OliverPharr1992"),
    "flat_punch": ("Shield1955", "EasonShield1960"),
}
"""Keys of papers in report/papers.bib, by shape; others have those of paraboloids."""
_Strength = Annotated[float, Quantity("Pa", above=0.0, example='"300 MPa"')]


class Plasticity(Stage):
    """[plasticity]: the yield strength or the hardness of the softer body, and the model by which contacts yield.

    The body that yields is [material], whose modulus and poisson the models take where they need them.
    """

    key = "plasticity"
    about = "How contacts yield; they are elastic without it"
    about_absent = "plastic flow"
    examples: ClassVar[Mapping[str, str]] = {"yield_strength": '"300 MPa"'}
    small_scene: ClassVar[Mapping[str, Any]] = {
        "plasticity": {"yield_strength": "1 MPa"},
        "path": {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 6}, "unload": True},
    }
    unlike = "contacts that yield"
    replaces_contacts = True
    visit_seconds = 7e-8  # 4.5e-8 without adhesion, 1.2e-7 with it
    papers: ClassVar[Mapping[str, str]] = {key: "yielding" for papers in _PAPERS.values() for key in papers}

    yield_strength: _Strength | None = None
    """Yield strength of the softer body, which is [material]."""
    hardness: _Strength | None = None
    """Hardness of the softer body, which is [material]: 2.8 times its yield strength (Tabor)."""
    model: Literal["mdr", "jackson-green", "kogut-etsion"] = "mdr"
    """"mdr": elastic and perfectly plastic, by the method of dimensionality reduction, with adhesion and energies;
    "jackson-green" and "kogut-etsion": formulas fitted to finite elements."""
    body: Literal["half-space", "sphere"] = "half-space"
    """"half-space": asperities on a body; "sphere": particles whose own compression down to the centre counts."""

    @model_validator(mode="after")
    def _one_strength(self) -> "Plasticity":
        if self.yield_strength is None and self.hardness is None:
            raise mismatch("plasticity", "needs either yield_strength or hardness")
        if self.yield_strength is not None and self.hardness is not None:
            raise mismatch("plasticity", "takes either yield_strength or hardness, not both")
        if self.body == "sphere" and self.model != "mdr":
            raise EntryError("body", self.body, f"does not go with model = {self.model!r}: it goes with 'mdr' alone")
        return self

    def check(self, scene: Given) -> None:
        """Raise a mismatch with shapes, sections and paths that its models do not know, and variables they lack."""
        shape, path = scene.asperities.shape_name, scene.path
        asked = {"model": self.model, "body": self.body}
        of_spheres = next((f"plasticity.{key} = {value!r}" for key, value in asked.items() if value in _SPHERES), "")
        shapes = _ROUND if of_spheres else (*_ROUND, *_OTHERS)
        if shape not in shapes:
            told = f"is {shape!r}; with {of_spheres or '[plasticity]'} it must be {' or '.join(shapes)}"
            raise mismatch("asperities.shape", told)
        others = {"interaction": scene.interaction is not None}
        others |= {stage.key: stage.on_grid or not stage.flat for stage in scene.stages}
        for name, other in others.items():
            if other:
                raise mismatch(name, "does not go with [plasticity]: its asperities are independent, under a flat")
        if scene.work > 0.0:
            if shape == "cone":
                raise mismatch("adhesion", "does not go with [plasticity] and cones, whose similarity it would end")
            if self.model != "mdr":
                raise mismatch("adhesion", f"does not go with plasticity.model = {self.model!r}: 'mdr' alone adheres")
            if scene.adhesion_model.candidates != ("jkr",):
                raise mismatch("adhesion.model", "must be 'jkr' with [plasticity]")
            if path.control != "separation" and (path.to_preload is None or path.machine_stiffness is not None):
                key = path.key if path.to_preload is None else "machine_stiffness"
                reason = "does not go with [plasticity] and adhesion, which need path.separation or a preload alone"
                raise mismatch(f"path.{key}", reason)
        energies = ("energy", "dissipated_energy")
        missing = ["machine_dissipated_energy", *(energies if self.model != "mdr" else ())]
        if unknown := [name for name in scene.output.variables if name in missing]:
            raise mismatch("output.variables", f"{', '.join(unknown)} cannot be computed with this [plasticity]")
        known = scene.material.modulus is not None and scene.material.poisson is not None
        if not known and (of_spheres or shape == "cone"):
            raise mismatch(
                "material", f"needs modulus and poisson, on which {of_spheres or 'a cone that yields'} depends"
            )
        if self.model != "mdr" and scene.material.poisson < 0.0:
            message = f"is {scene.material.poisson:g}; with plasticity.model = {self.model!r} it must be at least 0"
            raise mismatch("material.poisson", message)

    def reason_against(self, scene: Given, estimator: str) -> str:
        reason = "the expected law does not know contacts that adhere and yield"
        return reason if estimator == "expected" and scene.work > 0.0 else ""

    @classmethod
    def left_out(cls, scene: Given, section: "Plasticity | None") -> Iterator[str]:
        if section is None:
            yield from (
                super().left_out(scene, section) if cls._fits(scene) else (f"{cls.about_absent}: contacts are elastic",)
            )
            return
        yield "hardening, size effect of the hardness: the body that yields is perfectly plastic, as hard at every size"
        if scene.work > 0.0:
            yield "yield in tension, roughness of dents: dents are smooth, and elastic while they are pulled off"

    @classmethod
    def _fits(cls, scene: Given) -> bool:
        """Return whether the section could be added to a scene without it."""
        try:
            cls(yield_strength=1.0).check(scene)
        except PydanticCustomError:
            return False
        return not any(stage.alone(scene, stage) for stage in scene.stages)

    @classmethod
    def cites(cls, table: Mapping[str, Any], variables: list[str]) -> Mapping[str, str]:
        papers = _PAPERS.get(table.get("asperities", {}).get("shape"), _PAPERS["paraboloid"])
        return dict.fromkeys(papers, "yielding") if cls.is_in(table) else {}

    def constants(self, scene: Given) -> "Body":
        """Return the constants of the bodies."""
        from roughmdr.stages.plastic.body import Body
        from roughmdr.stages.plastic.empirical import TABOR_HARDNESS

        material, shear = scene.material, math.inf
        strength = self.yield_strength if self.hardness is None else self.hardness / TABOR_HARDNESS
        if self.body == "sphere":
            shear = material.modulus / (2.0 * (1.0 + material.poisson))
        poisson = math.nan if material.poisson is None else material.poisson
        squared = float(scene.asperities.shape_name == "sphere")
        assert strength is not None  # the validator makes sure
        return Body(scene.effective_modulus, strength, scene.work, poisson, shear, squared)

    def prepare(self, scene: Given, *, drawn: bool) -> None:
        if drawn:
            from roughmdr.stages.plastic.drawn import prepare

            prepare(self.model, self.constants(scene), scene.asperities.shape_name)
        else:
            from roughmdr.stages.plastic.mean import MeanAsperities

            with suppress(RoughmdrError):  # the run itself will report it
                mean = MeanAsperities(scene.asperities, self.model, self.constants(scene))
                mean.totals(np.array([mean.first_touch]), set())

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the law of contacts that yield; OutOfRange where one is not representable."""
        asperities: Asperities
        body = self.constants(scene)
        if contacts.problem is not None:
            from roughmdr.stages.plastic.drawn import DrawnAsperities

            asperities = DrawnAsperities(contacts.problem, self.model, body)
        else:
            from roughmdr.stages.plastic.mean import MeanAsperities

            asperities = MeanAsperities(scene.asperities, self.model, body)

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            from roughmdr.loading.lateral import LateralPath
            from roughmdr.stages.plastic.law import plastic_law

            assert not isinstance(path, LateralPath)  # ``alone`` makes sure
            return plastic_law(asperities, path, names)

        return law
