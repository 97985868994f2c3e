"""Coordinates in a file: which arrays are some, and how ``coordinates`` of others names them (CF-1.11, chapter 5)."""

from collections.abc import Mapping
from typing import Any

from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import AUXILIARY_COORDINATES, STEP_COORDINATES


def labelled_of(arrays: Mapping[str, Array], attrs: dict[str, Any]) -> Labelled:
    """Tell the coordinates of a file from its variables: dimensions, those declared, and those that others name.

    ``arrays`` have all their attributes.
    """
    coordinates, own = {dim for array in arrays.values() for dim in array.dims} | {*AUXILIARY_COORDINATES}, {}
    for name, array in arrays.items():
        text = array.attrs.get("coordinates", "")
        named = set(text.split()) if isinstance(text, str) else set()
        coordinates |= named
        if "separation" not in named and not named.isdisjoint(STEP_COORDINATES):  # a machine moves the flat
            coordinates.discard("separation")
        kept = {key: value for key, value in array.attrs.items() if key not in ("coordinates", "_FillValue")}
        own[name] = array._replace(attrs=kept)
    return Labelled(
        {name: array for name, array in own.items() if name not in coordinates},
        {name: array for name, array in own.items() if name in coordinates},
        attrs,
    )


def attributes_in_file(data: Labelled, name: str) -> dict[str, Any]:
    """Return the attributes of an array, of a variable with those coordinates that are no dimension."""
    if name in data.coordinates:
        return data.coordinates[name].attrs
    dims, _, attrs = data.variables[name]
    named = [other for other, each in data.coordinates.items() if each.dims != (other,) and {*each.dims} <= {*dims}]
    return {**attrs, "coordinates": " ".join(named)} if named else attrs
