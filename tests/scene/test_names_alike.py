"""Arguments in Python and keys of scenes that mean the same are named alike."""

import inspect
from collections.abc import Iterator
from typing import Unpack, get_args, get_origin

from pydantic import BaseModel

import roughmdr as rm
from roughmdr.scene import Scene
from roughmdr.schema.faults import sections_of

OF_THE_CALL = {"quiet", "realization", "resume", "scheduler", "set", "workers"}
OF_FILES = {
    "bibtex",
    "cells",
    "ensemble",
    "fresh",
    "free",
    "kind",
    "measured",
    "out",
    "result",
    "scene",
    "style",
    "target",
    "to",
}
OF_ONE_CONTACT = {"approach", "contact_radius", "control", "indentation", "z"}
OF_THEORIES = {"gamma", "length", "mean_slope", "spectrum", "turning", "variable"}
COUNTER = {"counter_modulus", "counter_poisson"}  # counter.modulus and counter.poisson
OF_TABLES = {"a", "g"}  # g(a) of MdrTable, which no scene has


def keys(section: type[BaseModel]) -> Iterator[str]:
    for name, field in section.model_fields.items():
        yield name
        for inner in sections_of(field.annotation):
            yield from keys(inner)


def arguments() -> Iterator[str]:
    for module in (rm, rm.theory):
        for name in dir(module):
            value = getattr(module, name)
            if inspect.isfunction(value):
                for parameter in inspect.signature(value).parameters.values():
                    if parameter.kind != parameter.VAR_KEYWORD:
                        yield parameter.name
                    elif get_origin(parameter.annotation) is Unpack:
                        yield from get_args(parameter.annotation)[0].__annotations__
            elif inspect.isclass(value) and not issubclass(value, BaseException | BaseModel | tuple):
                yield from inspect.signature(value).parameters


def test_arguments_are_keys_or_have_nothing_to_do_with_scenes() -> None:
    known = OF_THE_CALL | OF_FILES | OF_ONE_CONTACT | OF_THEORIES | COUNTER | OF_TABLES
    assert set(arguments()) - set(keys(Scene)) == known
