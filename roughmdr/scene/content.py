"""The sections of a scene together, and what follows from them."""

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, InstanceOf, create_model

from roughmdr.ensemble import Asperities, Ensemble
from roughmdr.errors import RoughmdrError
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.scene.path import FlatPath
from roughmdr.scene.sections import Accuracy, AdhesionSection, Batch, Body, MaterialSection, Output
from roughmdr.scene.sweep import Sweep
from roughmdr.schema.material import effective_modulus
from roughmdr.schema.quantities import WholeNumber
from roughmdr.schema.section import Section
from roughmdr.stages import STAGES
from roughmdr.stages.stage import AnySection, Stage

_NEGLIGIBLE = 0.01  # share of the required error that is negligible


def _check_title(value: object) -> str:
    if not isinstance(value, str) or not value.isprintable():
        raise RoughmdrError("must be a text on one line, of characters that can be printed")
    return value


class _Sections(Section):
    """All sections of a scene but for the stages."""

    title: Annotated[str, BeforeValidator(_check_title)]
    """Title of results and pictures. Default: the name of the file."""
    seed: Annotated[int, WholeNumber(0, 2**63 - 1)] = 0
    """Seed of all random numbers: the same seed gives the same result to the last bit."""
    material: MaterialSection
    """Elastic constants: effective_modulus alone, or modulus and poisson."""
    counter: Body | None = None
    """The other body, which is rigid without this section."""
    adhesion: AdhesionSection | None = None
    """Adhesion between the surfaces; none without this section."""
    asperities: Asperities
    """Where the asperities come from."""
    interaction: Interaction | None = None
    """How asperities feel each other; they are independent without this section."""
    path: FlatPath
    """Way of the rigid flat, or what the machine does that moves it."""
    output: Output = Output()
    """Variables of the result."""
    batch: Batch = Batch()
    """Number of realisations, and how each is made."""
    accuracy: Accuracy | None = None
    """An error asked for in place of a number of realisations."""
    sweep: InstanceOf[Sweep] = Sweep()
    """Values of keys to run the scene with, by their dotted names in quotes."""

    def reason_against(self, estimator: str) -> str:
        """Return why the estimator "stratified" or "expected" is impossible; empty where it is possible."""
        if reason := next(filter(None, (stage.reason_against(self, estimator) for stage in self.stages)), ""):
            return reason
        if estimator == "expected" and self.needs_positions:
            return "asperities that feel each other in pairs have positions, which the expected law does not know"
        return self.asperities.reason_against(estimator)

    @property
    def estimators(self) -> tuple[str, ...]:
        """Estimators to choose from: one, or with accuracy.method "auto" one that draws and, if possible, "expected".

        Stratified draws need fewer realisations, but their number of asperities is rounded, which must be negligible.
        At given load they are not used: their mean, and the expected law, is not that of patches drawn at random.
        """
        if self.accuracy is None:
            return (self.batch.estimator,)
        if self.accuracy.method != "auto":
            return (self.accuracy.method,)
        if not self.flat and not self.needs_positions:
            return ("expected",)
        if self.path.control != "separation":
            return ("sampled",)
        count = self.asperities.expected_count
        is_whole = abs(count - round(count)) <= _NEGLIGIBLE * self.accuracy.share * count
        drawn = "stratified" if is_whole else "sampled"
        return (drawn,) if self.reason_against("expected") else (drawn, "expected")

    @property
    def effective_modulus(self) -> float:
        """E* [Pa] (H 43)."""
        if self.material.effective_modulus is not None:
            return self.material.effective_modulus
        assert self.bodies is not None  # ``MaterialSection`` makes sure
        return effective_modulus(*self.bodies)

    @property
    def bodies(self) -> tuple[float, ...] | None:
        """Modulus [Pa] and Poisson's ratio of both bodies, or of the first where the counter body is rigid.

        None where only E* is known.
        """
        material, counter = self.material, self.counter
        if material.modulus is None or material.poisson is None:
            return None
        return (material.modulus, material.poisson, *(() if counter is None else (counter.modulus, counter.poisson)))

    @property
    def work(self) -> float:
        """Work of adhesion [J/m^2]; 0 without adhesion."""
        return 0.0 if self.adhesion is None else self.adhesion.work

    @property
    def adhesion_model(self) -> Adhesion:
        """Adhesion model with its parameters."""
        return Adhesion() if self.adhesion is None else self.adhesion.adhesion_model

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that the scene has, innermost first."""
        return tuple([section for stage in STAGES if (section := getattr(self, stage.key)) is not None])

    def stage(self, kind: type[AnySection]) -> AnySection | None:
        """Return the stage of a kind; None where the scene has none."""
        return next((stage for stage in self.stages if isinstance(stage, kind)), None)

    @property
    def flat(self) -> bool:
        """Whether a flat presses all asperities alike."""
        return all(stage.flat for stage in self.stages)

    def pressed(self, ensemble: Ensemble) -> Ensemble:
        """Return drawn asperities as a flat presses them, lower where a body is curved."""
        for stage in self.stages:
            ensemble = stage.pressed(ensemble)
        return ensemble

    @property
    def unlike(self) -> str:
        """Why the law is not that of elastic contacts under a flat; empty if it is."""
        return next(filter(None, (stage.unlike for stage in self.stages)), "")

    @property
    def needs_positions(self) -> bool:
        """Whether the law depends on where the asperities stand."""
        return self.interaction is not None and self.interaction.model == "pairwise"

    @property
    def placed(self) -> bool:
        """Whether realisations need the positions of their asperities, for the law or beside it."""
        return self.needs_positions or any(stage.on_grid for stage in self.stages)

    @property
    def nominal_area(self) -> float | None:
        """[m2]; None where it is unknown, and under a curved body, which has none."""
        return self.asperities.nominal_area if self.flat else None

    @property
    def repeats(self) -> bool:
        """Whether the surface repeats beyond its patch: as the interaction says, or else as its map says."""
        return self.asperities.repeats if self.interaction is None else self.interaction.boundary == "periodic"

    @property
    def map_lines(self) -> tuple[str, ...]:
        """Lines on the map of the asperities and, where that matters, on how it is continued; none without a map."""
        lines = self.asperities.description
        if not lines or not self.placed:
            return lines
        joined = "" if self.asperities.repeats else ", opposite edges joined, though the map is not periodic"
        return (*lines, f"pressed as a patch that repeats{joined}" if self.repeats else "pressed alone on a half-space")


if TYPE_CHECKING:
    Sections = _Sections
else:
    _stages: dict[str, Any] = {stage.key: (stage | None, Field(None, description=stage.about)) for stage in STAGES}
    Sections = create_model("Sections", __base__=_Sections, __doc__="All sections of a scene.", **_stages)
