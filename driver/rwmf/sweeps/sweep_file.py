"""Namelist of a sweep: case, grid, points, records and output file.

The kernel does not read this file; its case remains usable by every other command. This module
reads its few forms: numbers, quoted texts and lists.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from rwmf.case.namelist import read_text
from rwmf.errors import InputError
from rwmf.kernel.names import is_name_of_folder, problem_of_name, shorten
from rwmf.sweeps.plan import Request

Item = float | str
_TOKEN = re.compile(
    r"""\s*(?:
      (?P<comment>![^\n]*)
    | &(?P<group>\w+)
    | (?P<end>/)
    | (?P<key>[A-Za-z_][\w.]*)\s*=
    | '(?P<single>(?:[^'\n]|'')*)'
    | "(?P<double>(?:[^"\n]|"")*)"
    | (?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)(?=[\s,/!]|$)
    | (?P<comma>,)
    )""",
    re.VERBOSE,
)
# keys of &sweep: type (int: whole numbers), and True for a list
_KEYS = {
    "case": (str, False),
    "file": (str, False),
    "records": (str, True),
    "points": (str, False),
    "unit": (str, False),
    "dt": (float, False),
    "quantities": (str, True),
    "chunk": (int, False),
    "intensity": (str, False),
    "period": (float, False),
    "damping": (float, False),
    "periods": (float, True),
}
# one value, a list, and a check of each
_WANTED: dict[type, tuple[str, str, Callable[[Any], bool]]] = {
    str: ("one text", "a list of texts", lambda x: isinstance(x, str)),
    float: (
        "one finite number > 0",
        "a list of finite numbers > 0",
        lambda x: isinstance(x, float) and 0 < x < math.inf,
    ),
    int: (
        "one whole number >= 0",
        "",
        lambda x: isinstance(x, float) and x.is_integer() and 0 <= x <= _MOST_RUNS,
    ),
}
_PAIR = "eta"
_PATHS = ("case", "file", "records", "points")
# far above the size of any sweep
_MOST_RUNS = 10**15


def read_sweep_file(path: str) -> tuple[Request, Path]:
    """Read the namelist of a sweep: `&sweep` and `&grid`."""
    groups = _parse(read_text(path), path)
    unknown = [name for name in groups if name not in ("sweep", "grid")]
    if unknown:
        raise InputError(f"{path}: unknown group &{unknown[0]}; allowed are &sweep and &grid")
    given = {key.lower(): items for key, items in groups.get("sweep", {}).items()}
    values = {key: _checked(path, key, items) for key, items in given.items()}
    if "case" not in values:
        raise InputError(f"{path}, &sweep: case is missing: the namelist of the case")
    folder = Path(path).parent
    file = Path(values.pop("file", f"{Path(path).stem}.nc"))
    for key in ("case", "points"):
        if key in values:
            values[key] = str(folder / values[key])
    values["records"] = [located(folder, word) for word in values.get("records", [])]
    grid = {key: _axis(path, key, items) for key, items in groups.get("grid", {}).items()}
    return Request(grid=grid, **values), file


def located(folder: Path, word: str) -> str:
    """Return a name of records as seen from the current folder."""
    return word if word.lower().startswith("fema:") else str(folder / word)


def _axis(path: str, key: str, items: list[Item]) -> Sequence[Item | tuple[Item, ...]]:
    if key.lower() != _PAIR:
        return items
    if len(items) % 2 > 0:
        raise InputError(f"{path}, &grid: eta: needs pairs eta_0, eta_alpha")
    return list(zip(items[::2], items[1::2], strict=True))


def _checked(path: str, key: str, items: list[Item]) -> Any:  # noqa: ANN401 (a type of `_KEYS`)
    if key not in _KEYS:
        raise InputError(f"{path}, &sweep: unknown key {key}; allowed are {', '.join(_KEYS)}")
    kind, several = _KEYS[key]
    wanted = _WANTED[kind][several]
    accepted = _WANTED[kind][2]
    shown = shorten(", ".join(str(item) for item in items))
    if not all(map(accepted, items)) or (len(items) > 1 and not several):
        raise InputError(f"{path}, &sweep: {key} = {shown}: must be {wanted}")
    problems = [
        problem for item in map(str, items) if key in _PATHS and (problem := problem_of_name(item))
    ]
    if problems:
        raise InputError(f"{path}, &sweep: {key} = {shown}: {problems[0]}")
    if key == "file" and is_name_of_folder(str(items[0])):
        raise InputError(f"{path}, &sweep: {key} = {shown}: is a folder, not a file")
    if kind is int:
        return int(items[0])
    return items if several else items[0]


def _parse(text: str, path: str) -> dict[str, dict[str, list[Item]]]:
    """Split the text into groups, keys and lists of values, in the order of the file."""
    groups: dict[str, dict[str, list[Item]]] = {}
    group: dict[str, list[Item]] | None = None
    items: list[Item] | None = None
    position, text = 0, text.rstrip()

    def refuse(problem: str, start: int) -> NoReturn:
        line = text.count("\n", 0, start) + 1
        raise InputError(f"{path}, line {line}: {problem}")

    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            rest = text[position:].lstrip().splitlines()[0].strip()
            refuse(f"cannot be read: {rest}", position)
        kind = str(match.lastgroup)
        word, start = match[kind], match.start(kind)
        if kind == "group":
            if group is not None or word.lower() in groups:
                refuse(f"&{word}: the group before has no end, or it appears twice", start)
            group, items = groups.setdefault(word.lower(), {}), None
        elif kind == "end":
            group, items = None, None
        elif kind == "key":
            # keys match in upper and lower case
            if group is None or word.lower() in map(str.lower, group):
                refuse(f"{word}: outside of a group, or it appears twice", start)
            items = group.setdefault(word, [])
        elif kind not in ("comment", "comma"):
            if items is None:
                refuse(f"{word}: a value without a key", start)
            items.append(_value(kind, word))
        position = match.end()
    if group is not None:
        raise InputError(f"{path}: the last group has no end: a line with /")
    for name, keys in groups.items():
        for key, values in keys.items():
            if not values:
                raise InputError(f"{path}, &{name}: {key} has no value")
    return groups


def _value(kind: str, word: str) -> Item:
    if kind == "number":
        return float(word.lower().replace("d", "e"))
    mark = "'" if kind == "single" else '"'
    return word.replace(mark * 2, mark)
