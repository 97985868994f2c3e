"""[nominal]: the curved body that presses the rough layer, in place of a flat.

Asperities that feel each other in pairs are drawn, and each is lower by the profile of the body over it: a flat presses
them, and the half-space under all of them carries the body too. Without [interaction] they have their expected law.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, create_model, model_validator

from roughmdr.ensemble.random.sections_of_shapes import PARAMETERS
from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.shapes import SCENE_SHAPES, SHAPES, Shape
from roughmdr.stages.stage import Contacts, Given, Law, Stage
from roughmdr.variables import NOMINAL_VARIABLES

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.ensemble import Ensemble
    from roughmdr.loading.lateral import Path

DEFAULT_ERROR = 1e-4
_LEAST_ERROR, _MOST_ERROR = 1e-7, 1e-2
_BODIES = {name: shape for name, shape in SCENE_SHAPES.items() if not shape.shared}
_UNITS = {name: unit for shape in _BODIES.values() for name, unit in shape.units.items()}
_COMPUTED = ("force", "contact_area", "contact_count", "contact_radius_sum", "stiffness", "model_error_curve")
"""Variables of a law under a curved body."""
_OF_JUMPS = ("energy", "dissipated_energy")
"""More variables, of adhesive asperities that feel each other."""
_FORESEEN_ERROR = 1e-2  # relative error of the force of a foreseen law
_TABLES, _STEP, _NODE = 5e-2, 1.5e-2, 5e-2
"""Seconds: tables of each node, a step on all rings, and with adhesion each node of the first rule at a step."""


class _Nominal(Stage):
    """[nominal]: the profile of the body, by its shape, "paraboloid" by default, and that shape's parameters.

    ``error`` is the largest error of the force by the rings on which the contact is computed, over the largest force;
    asperities that feel each other in pairs have no rings.
    """

    key = "nominal"
    about = "A curved body that presses the asperities, in place of the flat, on an elastic half-space"
    about_absent = "curvature of the bodies"
    small_scene: ClassVar[Mapping[str, Any]] = {
        "nominal": {"radius": "10 mm", "error": 1e-2},
        "batch": {"estimator": "expected"},
    }
    flat = False
    unlike = "a curved body"
    most_foreseen = 8
    papers: ClassVar[Mapping[str, str]] = {"Greenwood1967": "curvature"}

    shape: Literal[tuple(_BODIES)] = "paraboloid"  # type: ignore[valid-type]
    """Shape of the body, which decides the other keys."""
    error: Annotated[float, Quantity(DIMENSIONLESS, at_least=_LEAST_ERROR, at_most=_MOST_ERROR)] = DEFAULT_ERROR
    """Error of the force by the rings of the contact, over the largest force; without [interaction]."""

    @model_validator(mode="after")
    def _is_a_shape(self) -> "_Nominal":
        shape = SHAPES[self.shape]
        for name in self._given:
            if name not in shape.units:
                raise EntryError(name, self._given[name], f"is no parameter of the {shape.name}: {_listed(shape)}")
        try:
            shape.parameter_set(set(self._given))
            _ = self.body
        except ShapeError as error:
            raise EntryError("shape", self.shape, str(error)) from None
        return self

    @property
    def _given(self) -> dict[str, float]:
        return {name: value for name in _UNITS if (value := getattr(self, name)) is not None}

    @property
    def body(self) -> Shape:
        """The shape of the body."""
        return SHAPES[self.shape](**self._given)

    def check(self, scene: Given) -> None:
        """Raise a mismatch with boundary elements, other paths than separations, variables it lacks, asperities without
        a patch, or [interaction] but that of pairs on a half-space; without it, asperities without an expected law.
        """
        for stage in scene.stages:
            if stage.on_grid:
                raise mismatch("nominal", f"does not go with [{stage.key}]: boundary elements press a flat")
        if scene.path.control != "separation":
            raise mismatch("nominal", f"goes with path.separation, not with path.{scene.path.key}")
        if scene.path.target is not None:
            raise mismatch(f"path.separation.stop.{scene.path.target.variable}", "does not go with [nominal]")
        computed = _COMPUTED + (_OF_JUMPS if scene.interaction is not None and scene.work > 0.0 else ())
        for name in scene.output.variables:
            if name not in computed:
                allowed = ", ".join(computed)
                raise mismatch("output.variables", f"{name!r} is not available with [nominal]; there are {allowed}")
        if scene.asperities.nominal_area is None:
            raise mismatch("nominal", "needs asperities on a patch, which tells how many there are per area")
        if scene.interaction is None:
            self._check_layer(scene)
            return
        if "error" in self.model_fields_set:
            raise mismatch(
                "nominal.error", "is that of the expected law; with [interaction] there is interaction.error"
            )
        for key, asked in (("model", "pairwise"), ("boundary", "free")):
            if (given := getattr(scene.interaction, key)) != asked:
                reason = "the body does not repeat with the patch, nor is its contact spread evenly over it"
                raise mismatch(f"interaction.{key}", f"is {given!r}; with [nominal] it must be {asked!r}: {reason}")

    def _check_layer(self, scene: Given) -> None:
        """Raise a mismatch where the asperities have no expected law, or rings do not remember their contacts."""
        if scene.estimators != ("expected",):
            key = "batch.estimator" if scene.accuracy is None else "accuracy.method"
            raise mismatch(key, 'must be "expected" with [nominal], unless asperities feel each other in pairs')
        if reason := scene.reason_against("expected"):
            raise mismatch("nominal", f"needs the expected law of the asperities: {reason}")
        if scene.asperities.equal_heights:
            raise mismatch("nominal", "needs asperities whose heights scatter: all heights are the same")
        if reason := _against_adhesion(scene.adhesion_model, SHAPES[scene.asperities.shape_name]):
            raise mismatch("adhesion.model", f"does not go with [nominal]: {reason}")

    def more_variables(self, names: list[str]) -> list[str]:
        return list(NOMINAL_VARIABLES)

    def clear_above(self, scene: Given) -> float:
        """Return the height [m] to which the half-space is drawn up before it detaches."""
        if scene.work == 0.0:
            return 0.0
        from roughmdr.asperity.contact import Contact

        return Contact.of(self.body, scene.effective_modulus, scene.adhesion_model).depth[0]

    def pressed(self, ensemble: "Ensemble") -> "Ensemble":
        """Return the asperities under the body, lower by its profile over them, its apex over the middle of the patch.

        One without a position stays as it is, as under the apex. OutOfRange where none is under a body that ends.
        """
        from roughmdr.interaction.placed import middle_of

        if ensemble.axis is not None or not {"x", "y"} <= ensemble.positions.keys() or not ensemble.height.size:
            return ensemble
        axis = x, y = middle_of(ensemble)
        away = np.hypot(ensemble.positions["x"] - x, ensemble.positions["y"] - y)
        under = np.flatnonzero(away <= self.body.limit)
        if not under.size:
            raise OutOfRange(f"no asperity is under the {self.shape}, which ends at a radius of {self.body.limit:g} m")
        own, area = ensemble.taken(under), (ensemble.nominal_area or math.nan) * (under.size / away.size)
        return replace(own, height=own.height - self.body.f(away[under]), nominal_area=area, axis=axis).sorted()

    def coarse(self) -> "_Nominal":
        return self.model_copy(update={"error": _FORESEEN_ERROR})

    def expected_seconds(self, nodes: int, steps: int, *, adhering: bool) -> float:
        return _TABLES * nodes + steps * (_STEP + (_NODE * nodes if adhering else 0.0))

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return that of the contacts under the body or, of an expected law, of the body on a layer with this law."""
        from roughmdr.stages import curved

        if contacts.problem is not None:
            return lambda path, names: curved.with_body(contacts.law(path, [*names, *NOMINAL_VARIABLES]), self.body)
        from roughmdr.loading.path import LoadingPath

        layer = curved.Layer(scene.asperities, scene.effective_modulus, scene.adhesion_model)

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            assert isinstance(path, LoadingPath)  # ``check`` makes sure
            return curved.compute(layer, self.body, path, error=self.error, variables=names)

        return law

    @classmethod
    def cites(cls, table: Mapping[str, Any], variables: list[str]) -> Mapping[str, str]:
        drawn = cls.is_in(table) and "interaction" in table
        return {"Yashima2015": "curvature"} if drawn else super().cites(table, variables)

    def attributes(self) -> dict[str, str]:
        return {self.key: self.shape}


def _listed(shape: type[Shape]) -> str:
    return ", or ".join(" and ".join(names) for names in shape.parameter_sets)


def _against_adhesion(adhesion: Adhesion, asperity: type[Shape]) -> str:
    """Return why the memory of a ring cannot hold contacts of such asperities; empty where it can."""
    if adhesion.work == 0.0:
        return ""
    if adhesion.model != "jkr":
        return f"rings remember contacts of model 'jkr', not of {adhesion.model!r}"
    if asperity.branched():
        return f"contacts of a {asperity.name} have several stable branches, which rings do not remember"
    return ""


if TYPE_CHECKING:
    Nominal = _Nominal
else:
    _parameters: dict[str, Any] = {
        name: (Annotated[float, Quantity(unit, above=0.0)] | None, Field(None, description=PARAMETERS[name][0]))
        for name, unit in _UNITS.items()
    }
    Nominal = create_model("Nominal", __base__=_Nominal, __module__=__name__, **_parameters)
