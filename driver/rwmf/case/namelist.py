"""Namelist text: reading files, formatting values, edits that change numbers only."""

from __future__ import annotations

import functools
import stat
import textwrap
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from rwmf.case.motion import Motion
from rwmf.errors import InputError
from rwmf.kernel import kernel_case, tables
from rwmf.kernel.numbers import Array, is_whole, show, to_array, to_items, to_number


def numbers_of(
    groups: Mapping[str, object],
) -> tuple[kernel_case.Changes, Array] | None:
    """Split an edit into keys and numbers."""
    kinds = _kinds()
    names: list[str] = []
    values: list[Array] = []
    for group, changes in groups.items():
        if not isinstance(changes, Mapping) or not changes:
            return None
        for key, value in changes.items():
            name = f"{group}.{key}".lower()
            found = _numbers(name, kinds.get(name, ""), value)
            if found is None or name in names:
                return None
            names.append(name)
            values.append(found)
    sizes = tuple(array.size for array in values)
    numbers = np.concatenate(values) if values else np.zeros(0)
    return kernel_case.Changes(tuple(names), sizes), numbers


def _numbers(name: str, kind: str, value: object) -> Array | None:
    """Return the value of a key as numbers; no numbers for None, which removes the key."""
    if value is None and kind:
        return np.zeros(0)
    try:
        if kind in ("reals", "real list"):
            return to_array(name, value, least=1)
        if kind == "logical" and isinstance(value, bool | np.bool_):
            return np.array([value], dtype=np.float64)
        if kind == "real" or (kind in ("integer", "integers") and is_whole(value)):
            return np.array([to_number(name, value)])
    except InputError:
        # the parser of the whole text gives the message
        return None
    return None


@functools.cache
def _kinds() -> dict[str, str]:
    """Return the type of each key by ``group.key`` in lower case."""
    return {f"{row.group}.{row.key}".lower(): row.kind for row in tables.schema()}


Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...]

_LINE_WIDTH = 100
# keys accept no larger integers
_LARGEST = 2**63 - 1
_HOLDS = "a namelist holds numbers, texts, true or false, and lists of them"


def read_text(path: str) -> str:
    """Read the text of a namelist file, with the messages of the batch program."""
    try:
        status = Path(path).stat()
    except (OSError, ValueError):
        raise InputError(f"{path}: the file does not exist") from None
    # opening a pipe could block for ever
    if status.st_size == 0 or not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        raise InputError(f"{path}: the file is empty or not a regular file")
    try:
        return Path(path).read_bytes().decode("utf-8", "surrogateescape")
    except OSError:
        raise InputError(f"{path}: the file cannot be read: a folder, or no permission") from None


def compose(groups: Mapping[str, Mapping[str, object]]) -> str:
    """Write groups as namelist text."""
    return "\n".join(_compose_group(name, entries) for name, entries in groups.items())


def _compose_group(name: str, entries: Mapping[str, object]) -> str:
    if not entries:
        return f"&{name} /\n"
    lines = [f"&{name}"]
    for key, value in entries.items():
        if value is None:
            continue
        try:
            text = format_value(value)
        except InputError as error:
            raise InputError(f"&{name}: {key} = {error}") from None
        lines += _wrap(f"   {key} = {text}", value)
    return "\n".join([*lines, "/", ""])


def _wrap(line: str, value: object) -> list[str]:
    # only lists are broken: a line end inside a quoted text would become part of it
    if isinstance(value, str) or len(line) <= _LINE_WIDTH:
        return [line]
    return textwrap.wrap(
        line,
        _LINE_WIDTH,
        initial_indent="   ",
        subsequent_indent="      ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def format_value(value: object) -> str:
    """Format one value for a namelist."""
    if isinstance(value, Motion):
        return format_value(value.name)
    if isinstance(value, str):
        return "'" + str(value).replace("'", "''") + "'"
    if isinstance(value, bool | np.bool_):
        return ".true." if value else ".false."
    if is_whole(value) and abs(int(value)) <= _LARGEST:
        return repr(int(value))
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "biufU":
        if not np.ma.is_masked(value):
            return format_value(value.item())
    else:
        items = to_items(value)
        if items and not any(to_items(item) for item in items):
            return ", ".join(map(format_value, items))
    raise InputError(f"{show(value)}: {_HOLDS}")


def parse_value(kind: str, text: str) -> Value:
    """Convert a value of the kernel's description."""
    if kind == "text list":
        return tuple(text.split(", "))
    convert: Callable[[str], float] = int if kind.startswith("integer") else float
    if kind in ("reals", "real list", "integers"):
        numbers = tuple(map(convert, text.replace(",", " ").split()))
        return numbers if kind == "real list" or len(numbers) > 1 else numbers[0]
    if kind in ("real", "integer"):
        return convert(text)
    if kind == "logical":
        return text.strip(".").lower() in ("t", "true")
    return text
