"""A section of a scene: a table that refuses unknown keys, declared as a model of pydantic."""

import ast
import inspect
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from itertools import pairwise
from textwrap import dedent
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args, get_origin

from pydantic import BaseModel, ConfigDict

from roughmdr.schema.quantities import Name, Quantity, Reader

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

_OF_PYDANTIC = {name for name in dir(BaseModel) if not name.startswith("__")}


class _Listed(ModelMetaclass):
    """Lists of a section its own names, not those of pydantic."""

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - _OF_PYDANTIC)


class Section(BaseModel, metaclass=_Listed):
    """A table of a scene: keys that it does not declare are errors, and it is immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    examples: ClassVar[Mapping[str, str]] = {}
    """Values of keys in TOML that make a whole section, for messages on what is missing."""

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - _OF_PYDANTIC)


@cache
def meanings(section: type[Section]) -> dict[str, str]:
    """Return the text below each key of a section, and of those that it is made of, by the names of the keys."""
    told: dict[str, str] = {}
    for part in reversed([each for each in section.__mro__ if issubclass(each, Section)]):
        with suppress(OSError):  # a section that is made by code has no source
            definition = ast.parse(dedent(inspect.getsource(part))).body[0]
            assert isinstance(definition, ast.ClassDef)
            for declared, text in pairwise(definition.body):
                match declared, text:
                    case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(words))):
                        told[name] = " ".join(words.split())
    return told


def reader_of(declared: tuple[Any, ...]) -> Reader | None:
    """Return the reader of a field from its metadata and annotation, None if it takes no number or name."""
    for part in declared:
        if isinstance(part, Reader):
            return part
    for part in declared:
        if part is str or get_origin(part) is Literal:
            return Name(get_args(part))
        inner = None if get_origin(part) in (list, dict, None) else reader_of(get_args(part))
        if inner is not None:
            return inner
    return None


Length = Annotated[float, Quantity("m", above=0.0)]
