"""Files of target spectra: two columns, by the quantities and units that the file states."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from rwmf._files.names import shorten
from rwmf._records.column_names import (
    ACCELERATION,
    ColumnName,
    convert,
    known_words,
    read_column_name,
    unit_in_text,
    unit_of_cell,
)
from rwmf._records.lists import decimal_point, separator_of
from rwmf._records.reader import read_bytes
from rwmf.errors import InputError

__all__ = ["read_target"]

_Array = npt.NDArray[np.float64]
_ROLES = {
    "period": (
        known_words("t tn period periods natural vibration structural fundamental"),
        "time",
    ),
    "frequency": (known_words("f fn freq frequency frequencies natural omega"), "frequency"),
    ACCELERATION: (
        known_words(
            "sa psa se sae rs a s t spectral pseudo acceleration accelerations accel acc response "
            "spectrum"
        )
        | known_words("target design elastic code site ec asce uhs mce mcer dbe year years yr")
        | known_words("horizontal mean median geomean geometric max rotd damped damping")
        | known_words("of critical %"),
        ACCELERATION,
    ),
}
# words by which a line of names is recognised, at its begin and anywhere in a name
_FIRST = known_words("t tn f fn omega se sae sv sd psv psd log ln velocity displacement")
_ANYWHERE = known_words("period periods freq frequency sa psa acceleration")
_DAMPING = re.compile(
    r"([\d.]+)\s*%\s*(?:of critical )?damp|([\d.]+)\s*%\s*[\])]|damp\w*\W+([\d.]+)\s*%"
)
_FORM = "must have two columns, as Period (s),Sa (g)"


def read_target(path: Path, damping: float) -> _Array:
    """Read a target spectrum."""
    lines = read_bytes(path).decode("utf-8-sig", errors="surrogateescape").splitlines()
    first = next((i for i, line in enumerate(lines) if _begins_with_number(line)), len(lines))
    try:
        names, at = _names_above(lines[:first], damping)
        table = _numbers(lines, first)
    except InputError as error:
        raise InputError(f"target: {path}, {error}") from error
    if not table:
        raise InputError(f"target: {path}: {_FORM}")
    try:
        return _converted(table, names)
    except InputError as error:
        place = "" if names is None else f"line {at}: "
        raise InputError(f"target: {path}, {place}{error}") from error


def _begins_with_number(line: str) -> bool:
    return re.match(r"\s*[\"']?[-+]?\.?\d", line) is not None


def _names_above(lines: list[str], damping: float) -> tuple[tuple[ColumnName, ...] | None, int]:
    """Return the names of the columns, and their line; None without names."""
    found: tuple[ColumnName, ...] | None = None
    at = 0
    stated: tuple[int, str] | None = None
    for i, line in enumerate(lines, 1):
        text = line.strip().lstrip("#%!").strip()
        if not text:
            continue
        _check_damping(text, damping, i)
        cells = _split(text)
        units = [unit for unit in map(unit_of_cell, cells) if unit is not None]
        names = tuple(map(read_column_name, cells))
        is_comment = line.startswith(("#", "%", "!"))
        if found is not None and len(cells) == len(units) == 2:
            # a line of units below the names
            found = tuple(
                ColumnName(name.words, unit) for name, unit in zip(found, units, strict=True)
            )
        elif len(names) == 2 and any(map(_is_column, names)):
            found, at = names, i
        elif (unit := unit_in_text(text)) is not None:
            stated = (i, unit)
        elif len(cells) > 1 and not is_comment and i == len(lines):
            raise InputError(f"line {i}: the columns are {shorten(text)}: {_FORM}")
    if stated is not None and not (found and all(name.unit for name in found)):
        raise InputError(
            f"line {stated[0]}: states {stated[1]}: name the columns with their units, as "
            "Period (s),Sa (m/s2)"
        )
    return found, at


def _is_column(name: ColumnName) -> bool:
    is_first = not _FIRST.isdisjoint(name.tokens[:1])
    return is_first or not _ANYWHERE.isdisjoint(name.tokens)


def _split(text: str) -> list[str]:
    """Split a line of names at its separators, or behind the brackets of the first one."""
    mark = separator_of(text)
    if mark in text:
        return [cell.strip(" ,") for cell in text.split(mark) if cell.strip(" ,")]
    match = re.fullmatch(r"(.+?[\])])\s+(\S.*)", text) or re.fullmatch(r"(\S+)\s+(\S+)", text)
    return [text] if match is None else [match[1], match[2]]


def _check_damping(text: str, damping: float, line: int) -> None:
    match = _DAMPING.search(text.lower())
    if match is None:
        return
    stated = next(part for part in match.groups() if part is not None)
    if not math.isclose(float(stated), 100 * damping, rel_tol=1e-6):
        raise InputError(f"line {line}: states {stated} % damping, where damping = {damping:g}")


def _kind(name: ColumnName) -> str:
    """Return period, frequency or acceleration; '' for another name."""
    for kind, (words, dimension) in _ROLES.items():
        if name.consists_of(words, dimension) and (name.tokens or name.dimension == dimension):
            return kind
    return ""


def _numbers(lines: list[str], first: int) -> list[tuple[int, float, float]]:
    """Return line number and both numbers of every row."""
    found = []
    mark = separator_of(lines[first]) if first < len(lines) else ","
    for i in range(first, len(lines)):
        text = lines[i].partition("#")[0].strip()
        if not text.strip(" ,;\t"):
            continue
        cells = text.split(mark) if mark in text and mark != "\t" else text.split()
        cells = [decimal_point(cell.strip(), mark).strip("\"'") for cell in cells if cell.strip()]
        if len(cells) != 2:
            raise InputError(f"line {i + 1}: has {len(cells)} columns: {_FORM}")
        try:
            x, y = (math.nan if "_" in cell else float(cell) for cell in cells)
        except ValueError:
            x = y = math.nan
        if not (0 < x < math.inf and 0 < y < math.inf):
            raise InputError(f"line {i + 1}: {shorten(text)}: must be two finite numbers > 0")
        found.append((i + 1, x, y))
    return found


def _converted(
    table: list[tuple[int, float, float]], names: tuple[ColumnName, ...] | None
) -> _Array:
    """Return periods [s] and accelerations [g] by the names of their columns."""
    lines, x, y = (np.array(column) for column in zip(*table, strict=True))
    if names is None:
        names = (ColumnName("period", ""), ColumnName("sa", ""))
    if _kind(names[0]) == ACCELERATION:
        names, x, y = names[::-1], y, x
    position, value = names
    kind = _kind(position)
    factor = convert(value, "g")
    if kind not in ("period", "frequency") or _kind(value) != ACCELERATION or factor is None:
        shown = " and ".join(f"{name.words} [{name.unit}]" for name in names)
        raise InputError(f"the columns are {shown}: {_FORM}")
    x = x * position.factor
    if kind == "frequency":
        x = 1 / x
    order = np.argsort(x, kind="stable")
    same = np.flatnonzero(np.diff(x[order]) == 0)
    if same.size:
        i = order[same[0] + 1]
        raise InputError(f"the period {x[i]:g} s is given twice, again in line {lines[i]:.0f}")
    return np.stack([x[order], y[order] * factor])
