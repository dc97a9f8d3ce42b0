"""Files with the points of a sweep: CSV and NetCDF."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._files.names import problem_of_name, shorten
from rwmf._records.lists import decimal_point, separator_of
from rwmf.errors import InputError

__all__ = ["is_netcdf", "read_csv", "read_netcdf"]

_NETCDF = (".nc", ".nc4", ".h5", ".hdf5")
# rows converted at once
_ROWS = 65536


def is_netcdf(path: Path) -> bool:
    """Check by the name whether a file is NetCDF."""
    return path.suffix.lower() in _NETCDF


def read_netcdf(path: Path) -> xr.Dataset:
    """Read a NetCDF file."""
    _check(path)
    try:
        with xr.open_dataset(path, engine="h5netcdf") as found:
            return found.load()
    except Exception as error:
        # HDF5 has errors of many kinds for a damaged file
        raise InputError(f"{path}: cannot be read as NetCDF: {error}") from error


def read_csv(
    path: Path, is_number: Callable[[str], bool]
) -> tuple[dict[str, npt.NDArray[np.generic]], npt.NDArray[np.int64]]:
    """Read a CSV file: a line of names, then one line per row.

    Commas, semicolons or tabs separate the values; beside the latter two a comma is a decimal
    point. Lines that begin with # are comments, except a row whose first column is a text.
    """
    _check(path)
    try:
        with path.open(encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
            return _read_rows(path, file, is_number)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as CSV: {error}") from error


def _check(path: Path) -> None:
    problem = problem_of_name(str(path))
    if problem is not None:
        raise InputError(f"points: {shorten(path)!r}: {problem}")
    if not path.is_file():
        raise InputError(f"points: {path}: the file does not exist, or is no regular file")


def _is_comment(line: str) -> bool:
    return not line.strip() or line.startswith("#")


def _read_rows(
    path: Path, file: Iterator[str], is_number: Callable[[str], bool]
) -> tuple[dict[str, npt.NDArray[np.generic]], npt.NDArray[np.int64]]:
    numbered = enumerate(file, 1)
    at, head = next((item for item in numbered if not _is_comment(item[1])), (0, ""))
    if not head:
        raise InputError(f"{path}: has no line with the names of its columns")
    mark = separator_of(head)
    names = [name.strip() for name in _cells(head, mark)]
    twice = [name for name in names if names.count(name) > 1]
    if twice or "" in names:
        fault = f"the column {twice[0]} is given twice" if twice else "a column has no name"
        raise InputError(f"{path}, line {at}: {fault}")
    if all(map(_is_float, names)):
        raise InputError(f"{path}, line {at}: has numbers instead of the names of the columns")
    numeric = [is_number(name) for name in names]
    lines = _rows(numbered, mark, len(names), is_text=not numeric[0])
    numbers: list[npt.NDArray[np.int64]] = []
    parts: list[list[npt.NDArray[np.generic]]] = [[] for _ in names]
    while block := list(islice(lines, _ROWS)):
        for number, cells in block:
            if len(cells) != len(names):
                lacks = len(cells) < len(names)
                fault = (
                    f"{names[len(cells)]}: no value"
                    if lacks
                    else f"{shorten(cells[len(names)])!r}: a value without a column"
                )
                raise InputError(
                    f"{path}, line {number}: {fault}: {len(cells)} values for {len(names)} columns"
                )
        numbers.append(np.array([number for number, _ in block]))
        for i, name in enumerate(names):
            cells = [row[i] for _, row in block]
            where = f"{path}, line"
            parts[i].append(
                _numbers([decimal_point(cell, mark) for cell in cells], numbers[-1], where, name)
                if numeric[i]
                else np.array([cell.strip() for cell in cells], dtype=object)
            )
    if not numbers:
        raise InputError(f"{path}: has no row below the names of its columns")
    columns = {name: np.concatenate(part) for name, part in zip(names, parts, strict=True)}
    return columns, np.concatenate(numbers)


def _rows(
    numbered: Iterator[tuple[int, str]], mark: str, count: int, *, is_text: bool
) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of every row below the names."""
    for number, line in numbered:
        if not _is_comment(line):
            yield number, _cells(line, mark)
        elif is_text and count > 1 and line.count(mark) >= count - 1:
            # the name of a design or a record may begin with the mark of a comment
            cells = _cells(line, mark)
            if len(cells) == count:
                yield number, cells


def _cells(line: str, mark: str) -> list[str]:
    return next(csv.reader([line], delimiter=mark, skipinitialspace=True, strict=True))


def _is_float(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _numbers(
    cells: list[str], lines: npt.NDArray[np.int64], where: str, name: str
) -> npt.NDArray[np.float64]:
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        for cell, line in zip(cells, lines, strict=True):
            if not _is_float(cell):
                shown = shorten(cell) or "nothing"
                raise InputError(
                    f"{where} {line}: {name} = {shown}: must be a finite number"
                ) from None
        raise
