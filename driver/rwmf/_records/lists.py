"""Lists of selected records: PEER's ``_SearchResults.csv``, output of CS_Selection, own suites."""

from __future__ import annotations

import csv
import io
import os
from dataclasses import dataclass
from pathlib import Path

from rwmf._records.channels import header_number
from rwmf.errors import InputError

__all__ = ["SUITE_HEADER", "Entry", "read_list"]

SUITE_HEADER = "file,factor,set"
_PEER = "-- Summary of Metadata of Selected Records --"
_PEER_FILES = ("Horizontal-1 Acc. Filename", "Horizontal-2 Acc. Filename")
_CS_FILES = ("File Name", "File Name Dir. 1", "File Name Dir. 2")
_FACTOR = "Scale Factor"
_HEADER_BYTES = 20_000


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


def read_list(path: Path, content: bytes) -> list[Entry] | None:
    """Read a list of selected records.

    Parameters
    ----------
    path : path
        The list; its files are in its folder or below.
    content : bytes
        Its bytes.

    Returns
    -------
    list of Entry or None
        The horizontal components in the order of the list; None for another kind of file.

    Raises
    ------
    InputError
        When a row is damaged, or a file is missing.
    """
    head = content[:_HEADER_BYTES].decode("latin-1")
    is_peer = _PEER in head
    is_cs = "Record Sequence Number" in head and "File Name" in head and "\t" in head
    is_own = head.startswith(SUITE_HEADER)
    if not (is_peer or is_cs or is_own):
        return None
    lines = content.decode("latin-1").splitlines()
    try:
        if is_peer:
            rows = _table(lines, _PEER, ",")
            return _entries(path, rows, _PEER_FILES, _FACTOR, "Record Sequence Number")
        if is_cs:
            return _entries(
                path, _table(lines, None, "\t"), _CS_FILES, _FACTOR, "Record Sequence Number"
            )
        return _entries(path, _table(lines, None, ","), ("file",), "factor", "set")
    except InputError as error:
        raise InputError(f"records: {path}: {error}") from error


_Rows = list[tuple[int, dict[str, str]]]


def _table(lines: list[str], title: str | None, mark: str) -> _Rows:
    """Return the rows below a line of names, with their line numbers."""
    first = 0
    if title is not None:
        first = next(i for i, line in enumerate(lines) if title in line) + 1
    named = ("Scale Factor", "factor")
    at = next(
        (i for i in range(first, len(lines)) if any(name in lines[i] for name in named)), None
    )
    if at is None:
        raise InputError("the list has no column Scale Factor")
    names = _cells(lines[at], mark)
    rows = []
    for i in range(at + 1, len(lines)):
        cells = _cells(lines[i], mark)
        # the table ends with an empty line, or with a note
        if not any(cells) or not (cells[0][:1].isdigit() or (mark == "," and title is None)):
            break
        if len(cells) < len(names):
            raise InputError(
                f"line {i + 1}: {len(cells)} columns where the header has {len(names)}"
            )
        rows.append((i + 1, dict(zip(names, cells, strict=False))))
    return rows


def _cells(line: str, mark: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader(io.StringIO(line), delimiter=mark), [])]


def _entries(
    path: Path, rows: _Rows, columns: tuple[str, ...], factor: str, title: str
) -> list[Entry]:
    """Return the components that the rows name."""
    found = []
    for line, row in rows:
        names = [row[column] for column in columns if row.get(column, "").strip("- ")]
        if not names:
            raise InputError(f"line {line}: names no file of a horizontal component")
        try:
            number = header_number(factor, row.get(factor))
        except InputError as error:
            raise InputError(f"line {line}: {error}") from error
        found += [
            Entry(_file(path.parent, name, line), number, row.get(title, "")) for name in names
        ]
    if not found:
        raise InputError("the list names no record")
    return found


def _file(folder: Path, name: str, line: int) -> Path:
    """Find a file of a list, in its folder or anywhere below."""
    path = Path(os.path.normpath(folder / name))
    if path.is_file():
        return path
    base = name.replace("\\", "/").rpartition("/")[2]
    below = sorted(item for item in folder.rglob("*") if item.name == base and item.is_file())
    if not below:
        raise InputError(f"line {line}: {name}: the file is not in the folder of the list or below")
    return below[0]
