"""JSON schema of a case as an object of groups, from the kernel's table of keys."""

from __future__ import annotations

from itertools import groupby
from typing import Any

from rwmf.kernel import tables

_TYPES = {
    "real": "number",
    "integer": "integer",
    "logical": "boolean",
    "choice": "string",
    "text": "string",
}


def make_schema() -> dict[str, Any]:
    """Make the schema; a case that fits may still break rules between keys."""
    groups = {}
    for name, found in groupby(tables.schema(), key=lambda row: row.group):
        rows = list(found)
        replaced = {row.gives for row in rows}
        needed = [x.key for x in rows if x.default == "required" and x.key not in replaced]
        groups[name] = {
            "type": "object",
            "properties": {row.key: _property(row) for row in rows},
            "additionalProperties": False,
        } | ({"required": needed} if needed else {})
    needs = {name: words for name, words in tables.needs_of_groups().items() if words}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"Case of rwmf {tables.version()}",
        "description": "Groups and keys of the namelist. In Python: rwmf.Case(**case).",
        "type": "object",
        "properties": groups,
        "additionalProperties": False,
        "dependentRequired": needs,
    }


def _property(row: tables.KeyRow) -> dict[str, Any]:
    """Describe a key."""
    one: dict[str, Any] = {"type": _TYPES[row.kind.removesuffix(" list").removesuffix("s")]}
    if row.kind == "choice":
        one["enum"] = row.allowed.split()
    low, high, is_above, is_below = row.bounds
    if low is not None:
        one["exclusiveMinimum" if is_above else "minimum"] = low
    if high is not None:
        one["exclusiveMaximum" if is_below else "maximum"] = high
    found = one
    if row.kind.endswith(("s", "list")):
        # one number holds for all
        found = {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}
    unit = f" [{row.unit}]" if row.unit not in ("", "-") else ""
    found = {"description": row.meaning + unit} | found
    default = _default(row)
    return found if default is None else found | {"default": default}


def _default(row: tables.KeyRow) -> object:
    """Return the default as JSON; None for a key without one, and for a rule."""
    if row.kind == "logical":
        return row.default == ".true."
    if row.kind == "choice":
        return row.default if row.default in row.allowed.split() else None
    number = tables.number_of(row.default)
    return int(number) if number is not None and row.kind == "integer" else number
