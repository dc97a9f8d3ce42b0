"""Controls of the page for each key: slider range, initial value, exclusions.

Keys, units, types and bounds come from the kernel. ``controls.toml`` adds practical ranges of walls
and frames, and the consequences of a choice. A key without an entry has a slider over its bounds.
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

from rwmf.kernel import tables


class Slider(NamedTuple):
    """Usual range of a number.

    Attributes
    ----------
    low, high : float
        Ends.
    is_log : bool
        Whether equal distances on the slider are equal factors.
    start : float or list of float, optional
        Value of a key that is set on the page; otherwise its default, or the middle of the range.
    """

    low: float
    high: float
    is_log: bool = False
    start: float | list[float] | None = None


_TABLES: dict[str, Any] = tomllib.loads(
    Path(__file__).with_name("controls.toml").read_text(encoding="utf-8")
)
_SLIDERS = {name: Slider(**row) for name, row in _TABLES["sliders"].items()}
_STARTS = _TABLES["starts"]
# the page must not set file names: an uploaded record has a number
_NOT_EDITABLE = {("motion", "file"), ("vertical", "file")}


def editable() -> dict[tuple[str, str], tuple[str, tuple[str, ...]]]:
    """Return the keys that the page may set."""
    return {
        row[:2]: (row.kind, tuple(row.allowed.split()) if row.kind == "choice" else ())
        for row in tables.schema()
        if row[:2] not in _NOT_EDITABLE
    }


def describe() -> dict[str, Any]:
    """Describe groups and keys for the page."""
    keys: dict[str, list[dict[str, Any]]] = {}
    for row in tables.schema():
        if row[:2] not in _NOT_EDITABLE:
            keys.setdefault(row.group, []).append(_describe_key(row))
    needs = tables.needs_of_groups()
    gives = [row for row in tables.schema() if row.gives]
    return {
        "groups": [
            {
                "name": name,
                "title": _TABLES["titles"].get(name, name.replace("_", " ").capitalize()),
                "needs": needs.get(name, []),
                "needed_too": _TABLES["needed_too"].get(name, ()),
                "can_be_added": name not in _TABLES["of_the_user"],
                "keys": found,
            }
            for name, found in keys.items()
        ],
        "alternatives": [
            *((f"{row.group}.{row.gives}", f"{row.group}.{row.key}") for row in gives),
            *_TABLES["alternatives"],
        ],
        "implied": {
            name: {key: None if value == "" else value for key, value in keys.items()}
            for name, keys in _TABLES["implied"].items()
        },
        **_TABLES["page"],
    }


def _describe_key(row: tables.KeyRow) -> dict[str, Any]:
    """Describe a key from its row in the kernel's table, with the range of its slider."""
    name = f"{row.group}.{row.key}"
    kind, default, allowed = row.kind.removesuffix("s"), row.default, row.allowed
    found: dict[str, Any] = {
        "key": row.key,
        "kind": kind,
        "unit": row.unit.strip("-"),
        "default": default,
        "allowed": allowed,
        "help": row.meaning,
    }
    if kind == "choice":
        words = allowed.split()
        start: object = default if default in words else words[0]
        found |= {"words": words, "start": _STARTS.get(name, start)}
    elif kind in ("real", "integer"):
        low, high, log, first = _SLIDERS.get(name) or _range(row)
        middle = math.sqrt(low * high) if log else 0.5 * (low + high)
        own = tables.number_of(default)
        start = _STARTS.get(name, middle if own is None else own) if first is None else first
        found |= {"low": low, "high": high, "log": log, "start": start}
        if kind == "integer":
            found["start"] = round(float(str(start)))
    elif kind == "logical":
        # a key is set when its value differs from the default
        found["start"] = default != ".true."
    elif kind == "text":
        found["start"] = _STARTS.get(name, "u_s_max_m")
    else:
        # a list needs at least one number or word
        found["start"] = _STARTS.get(name, ["u_s_max_m"] if kind == "text list" else [1.0])
        if name in _SLIDERS:
            low, high, log, first = _SLIDERS[name]
            found |= {"low": low, "high": high, "log": log, "start": first}
    return found


def _range(row: tables.KeyRow) -> Slider:
    """Return the range of a slider from the bounds of its key."""
    own, (low, high, is_above, is_below) = tables.number_of(row.default), row.bounds
    if low is not None and high is not None:
        # the end of an open interval would be refused
        inset = 1e-3 * (high - low)
        is_log = low > 0 and high > 100 * low
        return Slider(low + inset * is_above, high - inset * is_below, is_log)
    if low == 0.0 and is_above:
        middle = own or 1.0
        return Slider(0.01 * middle, 100.0 * middle, is_log=True)
    if low is not None:
        return Slider(low + 0.01 * is_above, max(10.0 * abs(low), 4.0 * (own or 0.0), low + 10.0))
    reach = max(4.0 * abs(own or 0.0), 2.0)
    return Slider(-reach, reach)
