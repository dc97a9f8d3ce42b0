"""Lists of selected records: PEER's ``_SearchResults.csv``, output of CS_Selection, own suites."""

from __future__ import annotations

import csv
import os
import re
from dataclasses import dataclass
from pathlib import Path

from rwmf.errors import InputError
from rwmf.kernel.names import shorten
from rwmf.motion.formats import header_number
from rwmf.motion.reader import is_left_behind

SUITE_HEADER = "file,factor,set"
_HEADER_BYTES = 200_000
_SEPARATORS = ";\t,"
# a title of the search results of PEER: the table above it ends
_TITLE = re.compile(r'[\s"]*--+ .* --')
# columns of an own list that would change its records
_NOT_IN_LISTS = ("channel", "damping", "dt", "unit", "units", "weight", "weights")


@dataclass(frozen=True)
class Entry:
    """A component that a list names.

    Attributes
    ----------
    path : path
        Its file.
    factor : float
        Factor on its samples [-].
    set : str
        Name that the components of one record share.
    """

    path: Path
    factor: float
    set: str


@dataclass(frozen=True)
class _Kind:
    """Columns of a kind of list, in plain words.

    Attributes
    ----------
    files : tuple of str
        Names of the columns with the files of horizontal components.
    factors : tuple of str
        Names of the column with their common factor.
    set : str
        Name of the column with the name of the record.
    mark : str
        Further column by which the line of names is recognised.
    """

    files: tuple[str, ...]
    factors: tuple[str, ...]
    set: str
    mark: str = ""


_DATABASE = ("scale factor", "scale factor h", "scale factor horizontal", "horizontal scale factor")
_OWN = _Kind(("file",), ("factor",), "set")
_NUMBER = "record sequence number"
_KINDS = (
    _Kind(("horizontal 1 acc filename", "horizontal 2 acc filename"), _DATABASE, _NUMBER, _NUMBER),
    _Kind(("file name", "file name dir 1", "file name dir 2"), _DATABASE, _NUMBER, _NUMBER),
)


def read_list(path: Path, content: bytes) -> list[Entry] | None:
    """Read a list of selected records, with any separator and order of columns."""
    head = content[:_HEADER_BYTES].decode("utf-8-sig", errors="surrogateescape").splitlines()
    found = _find_header(head)
    if found is None:
        return None
    at, kind = found
    lines = content.decode("utf-8-sig", errors="surrogateescape").splitlines()
    mark = separator_of(lines[at])
    try:
        names = [_plain(name) for name in _cells(lines[at], mark)]
        columns = _columns(names, kind, at + 1)
        rows = _own_rows(lines, at, mark) if kind is _OWN else _rows(lines, at, mark, kind)
        _check_rows(rows, len(names))
        return _entries(path, kind, columns, rows, mark)
    except InputError as error:
        raise InputError(f"records: {path}: {error}") from error


def separator_of(line: str) -> str:
    """Return the separator of a line of names."""
    return next((mark for mark in _SEPARATORS if mark in line), ",")


def decimal_point(cell: str, separator: str) -> str:
    """Return a number with a decimal point; a comma is one where it does not separate cells."""
    is_decimal = separator != "," and cell.count(",") == 1 and "." not in cell
    return cell.replace(",", ".") if is_decimal else cell


def _plain(name: str) -> str:
    """Reduce the name of a column to words; units other than '-' remain."""
    return " ".join(re.findall(r"[^\W_]+|[%/]", name.lower()))


def _cells(line: str, mark: str) -> list[str]:
    cells = next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])
    return [cell.strip() for cell in cells]


def _find_header(lines: list[str]) -> tuple[int, _Kind] | None:
    """Find the line of names; that of an own list is the first line that is no comment."""
    is_first = True
    for i, line in enumerate(lines):
        if not line.strip() or line.startswith("#"):
            continue
        names = [_plain(cell) for cell in _cells(line, separator_of(line))]
        if is_first and not {*_OWN.files, *_OWN.factors}.isdisjoint(names):
            return i, _OWN
        is_first = False
        for kind in _KINDS:
            if kind.mark in names and not set(kind.files).isdisjoint(names):
                return i, kind
    return None


def _columns(names: list[str], kind: _Kind, line: int) -> dict[str, int]:
    """Return the positions of the columns that a list needs, by their names."""
    wanted = (*kind.files, *kind.factors, kind.set)
    for name in wanted:
        if names.count(name) > 1:
            raise InputError(f"line {line}: the column {name} is given twice")
    factors = [name for name in kind.factors if name in names]
    titles = {_OWN: ("file", "factor")}.get(kind, ("File Name", "Scale Factor"))
    if len(factors) != 1 or set(kind.files).isdisjoint(names):
        lacking = titles[0] if set(kind.files).isdisjoint(names) else titles[1]
        fault = f"has {len(factors)} columns" if len(factors) > 1 else "has no column"
        raise InputError(
            f"line {line}: the list {fault} {lacking}: it has "
            f"{shorten(', '.join(filter(None, names)))}"
        )
    if kind is _OWN:
        changing = [name for name in names if name in _NOT_IN_LISTS]
        if changing:
            raise InputError(
                f"line {line}: the list has the column {changing[0]}: a list has {SUITE_HEADER}"
            )
    found = {name: names.index(name) for name in kind.files if name in names}
    found["factor"] = names.index(factors[0])
    if kind.set in names:
        found["set"] = names.index(kind.set)
    return found


_Rows = list[tuple[int, list[str]]]


def _own_rows(lines: list[str], at: int, mark: str) -> _Rows:
    """Return the rows of an own list; comments have another number of columns."""
    count = len(_cells(lines[at], mark))
    rows = [(i + 1, _cells(lines[i], mark)) for i in range(at + 1, len(lines))]
    return [
        (line, cells)
        for line, cells in rows
        if any(cells) and not (cells[0].startswith("#") and len(cells) != count)
    ]


def _rows(lines: list[str], at: int, mark: str, kind: _Kind) -> _Rows:
    """Return the rows of a database; a title or a note ends its table."""
    names = [_plain(name) for name in _cells(lines[at], mark)]
    places = [names.index(name) for name in kind.files if name in names]
    rows: _Rows = []
    end = 0
    for i in range(at + 1, len(lines)):
        cells = _cells(lines[i], mark)
        if not any(cells):
            continue
        named = [cells[place] for place in places if place < len(cells)]
        is_row = any(re.search(r"\.[A-Za-z]\w*$", name) for name in named)
        is_title = _TITLE.match(lines[i]) is not None
        if end and is_row and not is_title:
            raise InputError(f"line {i + 1}: names a record below the end of the list, line {end}")
        if not end and not is_title and (is_row or cells[0][:1].isdigit()):
            rows.append((i + 1, cells))
        else:
            end = end or i + 1
    return rows


def _check_rows(rows: _Rows, count: int) -> None:
    for line, cells in rows:
        if len(cells) < count or any(cells[count:]):
            raise InputError(f"line {line}: {len(cells)} columns where the header has {count}")


def _entries(
    path: Path, kind: _Kind, columns: dict[str, int], rows: _Rows, mark: str
) -> list[Entry]:
    """Return the components that the rows name."""
    found = []
    for line, cells in rows:
        given = [cells[columns[name]] for name in kind.files if name in columns]
        names = [name for name in given if name.strip("- ")]
        if not names:
            raise InputError(f"line {line}: names no file of a horizontal component")
        key = "factor" if kind is _OWN else "Scale Factor"
        try:
            number = header_number(key, decimal_point(cells[columns["factor"]], mark))
        except InputError as error:
            raise InputError(f"line {line}: {error}") from error
        title = cells[columns["set"]] if "set" in columns else ""
        found += [Entry(_file(path.parent, name, line), number, title) for name in names]
    if not found:
        raise InputError("the list names no record")
    return found


def _file(folder: Path, name: str, line: int) -> Path:
    """Find a file of a list, in its folder or anywhere below."""
    path = Path(os.path.normpath(folder / name))
    if path.is_file():
        return path
    base = name.replace("\\", "/").rpartition("/")[2]
    below = sorted(
        item
        for item in folder.rglob("*")
        if item.name == base and item.is_file() and not is_left_behind(item.relative_to(folder))
    )
    if not below:
        raise InputError(f"line {line}: {name}: the file is not in the folder of the list or below")
    if any(item.read_bytes() != below[0].read_bytes() for item in below[1:]):
        raise InputError(
            f"line {line}: {name}: {below[0]} and {below[1]} differ: name one with its folder"
        )
    return below[0]
