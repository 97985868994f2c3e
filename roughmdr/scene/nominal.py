"""[nominal]: the curved body that presses the rough layer, in place of a flat, and what goes with it."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, create_model, model_validator

from roughmdr.errors import ShapeError
from roughmdr.schema.quantities import EntryError, Quantity, Section
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.shapes import SCENE_SHAPES, SHAPES, Shape

DEFAULT_ERROR = 1e-4
_LEAST_ERROR, _MOST_ERROR = 1e-7, 1e-2
_BODIES = {name: shape for name, shape in SCENE_SHAPES.items() if not shape.shared}
_UNITS = {name: unit for shape in _BODIES.values() for name, unit in shape.units.items()}


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
