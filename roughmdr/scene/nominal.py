"""[nominal]: the curved body that presses the rough layer, in place of a flat, and what goes with it."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, create_model, model_validator

from roughmdr.errors import ShapeError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity, Section
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.shapes import SCENE_SHAPES, SHAPES, Shape

if TYPE_CHECKING:
    from roughmdr.scene.scene import Scene

DEFAULT_ERROR = 1e-4
_LEAST_ERROR, _MOST_ERROR = 1e-7, 1e-2
_BODIES = {name: shape for name, shape in SCENE_SHAPES.items() if not shape.shared}
_UNITS = {name: unit for shape in _BODIES.values() for name, unit in shape.units.items()}
_VARIABLES = ("force", "contact_area", "contact_count", "contact_radius_sum", "stiffness", "model_error_curve")


class _Nominal(Section):
    """[nominal]: the profile of the body, by its shape, "paraboloid" by default, and that shape's parameters.

    ``error`` is the largest error of the force by the rings on which the contact is computed, over the largest force.
    """

    shape: Literal[tuple(_BODIES)] = "paraboloid"  # type: ignore[valid-type]
    error: Annotated[float, BeforeValidator(Quantity(DIMENSIONLESS, at_least=_LEAST_ERROR, at_most=_MOST_ERROR))] = (
        DEFAULT_ERROR
    )

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


def _listed(shape: type[Shape]) -> str:
    return ", or ".join(" and ".join(names) for names in shape.parameter_sets)


if TYPE_CHECKING:
    NominalSection = _Nominal
else:
    _parameters: dict[str, Any] = {
        name: (Annotated[float, BeforeValidator(Quantity(unit, above=0.0))] | None, None)
        for name, unit in _UNITS.items()
    }
    NominalSection = create_model("NominalSection", __base__=_Nominal, __module__=__name__, **_parameters)


def check_nominal(scene: "Scene") -> None:
    """Raise a mismatch where a curved body, if there is one, does not go with another section of a scene."""
    if scene.nominal is None:
        return
    if scene.interaction is not None:
        raise mismatch("nominal", "does not go with [interaction]: the half-space gives way under all asperities")
    if scene.reference is not None:
        raise mismatch("nominal", "does not go with [reference]: boundary elements press a flat")
    if scene.path.control != "separation":
        raise mismatch("nominal", f"goes with path.separation, not with path.{scene.path.key}")
    if scene.path.target is not None:
        raise mismatch(f"path.separation.stop.{scene.path.target.variable}", "does not go with [nominal]")
    for name in scene.output.variables:
        if name not in _VARIABLES:
            allowed = ", ".join(_VARIABLES)
            raise mismatch("output.variables", f"{name!r} is not available with [nominal]; there are {allowed}")
    if scene.estimators != ("expected",):
        key = "batch.estimator" if scene.accuracy is None else "accuracy.method"
        raise mismatch(key, 'must be "expected" with [nominal]: the layer has the expected law of its asperities')
    if reason := scene.reason_against("expected"):
        raise mismatch("nominal", f"needs the expected law of the asperities: {reason}")
    if scene.asperities.nominal_area is None:
        raise mismatch("nominal", "needs asperities on a patch, which tells how many there are per area")
    if reason := _against_adhesion(scene.adhesion_model, SHAPES[scene.asperities.shape_name]):
        raise mismatch("adhesion.model", f"does not go with [nominal]: {reason}")


def _against_adhesion(adhesion: Adhesion, asperity: type[Shape]) -> str:
    """Return why rings cannot remember the contacts of such asperities; empty where they can."""
    if adhesion.work == 0.0:
        return ""
    if adhesion.model != "jkr":
        return f"rings remember contacts of model 'jkr', not of {adhesion.model!r}"
    if asperity.branched():
        return f"contacts of a {asperity.name} have several stable branches, which rings do not remember"
    return ""
