"""Parts of JSON Schemas (draft 2020-12) put together so that a validator can say which key is wrong, and why.

Whatever can be is said without ``anyOf``, of which validators tell only that nothing fits: keywords of one type do not
concern the others, and a table whose keys depend on a name has a rule for each name.
"""

from typing import Any

JsonSchema = dict[str, Any]


def described(schema: JsonSchema, *sentences: str) -> JsonSchema:
    """Return a schema with a description of these sentences, without those that are empty."""
    given = [f"{each[0].upper()}{each[1:].rstrip('.')}." for each in sentences if each]
    return {**schema, "description": " ".join(given)}


def of_any_type(*schemas: JsonSchema) -> JsonSchema:
    """Return the schema of values of several types, each with the keywords of its own."""
    types = [name for each in schemas for name in ([each["type"]] if isinstance(each["type"], str) else each["type"])]
    merged: JsonSchema = {}
    for each in schemas:
        merged |= each
    return {**merged, "type": types}


def of_any_name(tables: list[JsonSchema]) -> JsonSchema:
    """Return the schema of a table that is one of several, as keys which each requires to have one value tell."""
    names = dict.fromkeys(name for each in tables for name in each["properties"])
    properties = {
        name: _either([each["properties"][name] for each in tables if name in each["properties"]]) for name in names
    }
    return {
        "type": "object",
        "properties": properties,
        "required": [name for name in names if all(name in each["required"] for each in tables)],
        "additionalProperties": False,
        "allOf": [_rule(each, properties) for each in tables],
    }


def _rule(table: JsonSchema, properties: JsonSchema) -> JsonSchema:
    """Return the rule that a table has its own keys only, where the names that choose it are given."""
    own = table["properties"]
    chosen = {name: {"const": own[name]["const"]} for name in table["required"] if "const" in own[name]}
    others = {name: entry for name, entry in own.items() if name not in chosen and entry != properties[name]}
    further = {name: table[name] for name in ("allOf",) if name in table}
    then = {"propertyNames": {"enum": list(own)}, "required": table["required"], "properties": others, **further}
    return {"if": {"properties": chosen, "required": list(chosen)}, "then": then}


def _either(schemas: list[JsonSchema]) -> JsonSchema:
    """Return a schema of all values that one of these allows, tables or names, and perhaps of more."""
    first = schemas[0]
    if all(each == first for each in schemas):
        return first
    told = first["description"].partition(" Default:")[0]
    if all("properties" in each for each in schemas):
        names = dict.fromkeys(name for each in schemas for name in each["properties"])
        inner = {
            name: _either([each["properties"][name] for each in schemas if name in each["properties"]])
            for name in names
        }
        return {"description": told, "type": "object", "properties": inner, "additionalProperties": False}
    if all("const" in each or "enum" in each for each in schemas):
        values = [value for each in schemas for value in each.get("enum", [each.get("const")])]
        return {"description": told, "enum": list(dict.fromkeys(values))}
    return {"description": told, "anyOf": [each for i, each in enumerate(schemas) if each not in schemas[:i]]}


def without_required(schema: Any) -> Any:
    """Return a schema without what it requires, but for the conditions of its rules."""
    if isinstance(schema, list):
        return [without_required(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    return {
        name: entry if name == "if" else without_required(entry)
        for name, entry in schema.items()
        if name != "required" or not isinstance(entry, list)
    }


def only_required(schema: JsonSchema) -> JsonSchema:
    """Return a schema that requires what another does, and no more."""
    inner = {name: only_required(entry) for name, entry in schema.get("properties", {}).items()}
    rules = [
        {"if": rule["if"], "then": then}
        for rule in schema.get("allOf", ())
        if "if" in rule and (then := only_required(rule["then"]))
    ]
    parts = {
        "required": schema.get("required"),
        "properties": {name: entry for name, entry in inner.items() if entry},
        "allOf": rules,
    }
    return {name: entry for name, entry in parts.items() if entry}
