"""The namelist of a sweep: which case, which grid, points and records, where to.

The kernel never sees this file: the case that it names stays a case of its own, for every other
command. Its few forms (numbers, texts in quotes, lists) are read here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rwmf._files.names import is_name_of_folder, problem_of_name, shorten
from rwmf.case.namelist import read_text
from rwmf.errors import InputError

__all__ = ["SweepFile", "read_sweep_file"]

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
# key of &sweep: what it holds (int: whole numbers), and whether it is a list
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
}
_PAIR = "eta"
_PATHS = ("case", "file", "records", "points")
# beyond any sweep
_MOST_RUNS = 10**15


@dataclass
class SweepFile:
    """A sweep as its file asks for it.

    Attributes
    ----------
    case : path
        Namelist of the case.
    file : path
        NetCDF file to write; relative paths start from the current folder.
    records : list of str
        As for `rwmf.sweep`, absolute where they are paths.
    grid : dict
        Values by axis.
    points : path, optional
        CSV or NetCDF file with a table whose rows are runs.
    unit : str, optional
        Unit of records that are not AT2.
    dt : float, optional
        Sampling interval [s] of records of one column.
    quantities : list of str
        What to keep.
    chunk : int
        Largest number of runs in a chunk, 0 for the usual one.
    intensity : str, optional
        What the records are scaled to 1 g of.
    period, damping : float, optional
        Period [s] and damping ratio [-] of its oscillator.
    """

    case: Path
    file: Path
    records: list[str] = field(default_factory=list)
    grid: dict[str, Sequence[Item | tuple[Item, ...]]] = field(default_factory=dict)
    points: Path | None = None
    unit: str | None = None
    dt: float | None = None
    quantities: list[str] = field(default_factory=list)
    chunk: int = 0
    intensity: str | None = None
    period: float | None = None
    damping: float | None = None


def read_sweep_file(path: str) -> SweepFile:
    """Read the namelist of a sweep: `&sweep` and `&grid`.

    Parameters
    ----------
    path : str
        The file; case, records and points are looked for relative to its folder.

    Returns
    -------
    SweepFile
        What it asks for.

    Raises
    ------
    InputError
        When the file cannot be read or does not have this form.
    """
    groups = _parse(read_text(path), path)
    unknown = [name for name in groups if name not in ("sweep", "grid")]
    if unknown:
        raise InputError(f"{path}: unknown group &{unknown[0]}; allowed are &sweep and &grid")
    asked = {key.lower(): items for key, items in groups.get("sweep", {}).items()}
    values = {key: _checked(path, key, items) for key, items in asked.items()}
    if "case" not in values:
        raise InputError(f"{path}, &sweep: case is missing: the namelist of the case")
    folder = Path(path).parent
    found = SweepFile(folder / values.pop("case"), Path(f"{Path(path).stem}.nc"))
    records = [_located(folder, word) for word in values.pop("records", [])]
    if "points" in values:
        values["points"] = folder / values["points"]
    for key, value in (values | {"records": records}).items():
        setattr(found, key, Path(value) if key == "file" else value)
    found.grid = {key: _axis(path, key, items) for key, items in groups.get("grid", {}).items()}
    return found


def _located(folder: Path, word: str) -> str:
    return word if word.lower().startswith("fema:") else str(folder / word)


def _axis(path: str, key: str, items: list[Item]) -> Sequence[Item | tuple[Item, ...]]:
    if key.lower() != _PAIR:
        return items
    if len(items) % 2 > 0:
        raise InputError(f"{path}, &grid: eta: needs pairs eta_0, eta_alpha")
    return list(zip(items[::2], items[1::2], strict=True))


def _checked(path: str, key: str, items: list[Item]) -> Any:  # noqa: ANN401 (as `_KEYS` says)
    if key not in _KEYS:
        raise InputError(f"{path}, &sweep: unknown key {key}; allowed are {', '.join(_KEYS)}")
    kind, several = _KEYS[key]
    wanted = {
        str: "a list of texts" if several else "one text",
        float: "one finite number > 0",
        int: "one whole number >= 0",
    }[kind]
    accepted = {str: _is_text, float: _is_positive, int: _is_count}[kind]
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


def _is_text(item: Item) -> bool:
    return isinstance(item, str)


def _is_positive(item: Item) -> bool:
    return isinstance(item, float) and 0 < item < math.inf


def _is_count(item: Item) -> bool:
    return isinstance(item, float) and item.is_integer() and 0 <= item <= _MOST_RUNS


def _parse(text: str, path: str) -> dict[str, dict[str, list[Item]]]:
    """Split into groups, keys and lists of values, in the order of the file."""
    groups: dict[str, dict[str, list[Item]]] = {}
    group: dict[str, list[Item]] | None = None
    items: list[Item] | None = None
    position = 0
    text = text.rstrip()
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise InputError(
                f"{_where(path, text, position)}: cannot be read: {_line(text, position)}"
            )
        kind, word = match.lastgroup, match[match.lastgroup or 0]
        where = _where(path, text, match.start(match.lastgroup or 0))
        position = match.end()
        if kind == "group":
            if group is not None or word.lower() in groups:
                raise InputError(
                    f"{where}: &{word}: the group before has no end, or it stands twice"
                )
            group = groups.setdefault(word.lower(), {})
            items = None
        elif kind == "end":
            group, items = None, None
        elif kind == "key":
            # the same key in other letters is the same key
            if group is None or word.lower() in map(str.lower, group):
                raise InputError(f"{where}: {word}: outside of a group, or it stands twice")
            items = group.setdefault(word, [])
        elif kind not in ("comment", "comma"):
            if items is None:
                raise InputError(f"{where}: {word}: a value without a key")
            items.append(_value(kind, word))
    _check_complete(groups, group, path)
    return groups


def _check_complete(
    groups: dict[str, dict[str, list[Item]]], group: dict[str, list[Item]] | None, path: str
) -> None:
    if group is not None:
        raise InputError(f"{path}: the last group has no end: a line with /")
    for name, keys in groups.items():
        for key, items in keys.items():
            if not items:
                raise InputError(f"{path}, &{name}: {key} has no value")


def _value(kind: str | None, word: str) -> Item:
    if kind == "number":
        return float(word.lower().replace("d", "e"))
    mark = "'" if kind == "single" else '"'
    return word.replace(mark * 2, mark)


def _where(path: str, text: str, position: int) -> str:
    return f"{path}, line {text.count(chr(10), 0, position) + 1}"


def _line(text: str, position: int) -> str:
    start = position + len(text[position:]) - len(text[position:].lstrip())
    return text[start:].splitlines()[0].strip()
