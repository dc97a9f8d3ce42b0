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
from rwmf.errors import InputError

__all__ = ["is_netcdf", "read_csv", "read_netcdf"]

_NETCDF = (".nc", ".nc4", ".h5", ".hdf5")
# rows converted at once
_ROWS = 65536


def is_netcdf(path: Path) -> bool:
    """Check by the name whether a file is NetCDF.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    bool
        True for NetCDF, False for CSV.
    """
    return path.suffix.lower() in _NETCDF


def read_netcdf(path: Path) -> xr.Dataset:
    """Read a NetCDF file.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    xarray.Dataset
        Its variables, in memory.

    Raises
    ------
    InputError
        When it cannot be read.
    """
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
    """Read a CSV file: a line of names, then one line per row; lines with # are comments.

    Parameters
    ----------
    path : path
        The file.
    is_number : callable
        Returns True for the name of a numeric column; the other columns are texts.

    Returns
    -------
    dict of str to numpy.ndarray, each shape (rows,)
        Columns by name.
    numpy.ndarray, shape (rows,)
        Line of each row in the file.

    Raises
    ------
    InputError
        When it cannot be read, or when a row does not match the names.
    """
    _check(path)
    try:
        with path.open(encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
            return _read_rows(path, _lines(file), is_number)
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


def _lines(file: Iterator[str]) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of every line that is not empty."""
    for number, line in enumerate(file, 1):
        if line.strip() and not line.startswith("#"):
            cells = next(csv.reader([line], skipinitialspace=True, strict=True))
            yield number, cells


def _read_rows(
    path: Path, lines: Iterator[tuple[int, list[str]]], is_number: Callable[[str], bool]
) -> tuple[dict[str, npt.NDArray[np.generic]], npt.NDArray[np.int64]]:
    head = next(lines, None)
    if head is None:
        raise InputError(f"{path}: has no line with the names of its columns")
    names = [name.strip() for name in head[1]]
    twice = [name for name in names if names.count(name) > 1]
    if twice or "" in names:
        fault = f"the column {twice[0]} is given twice" if twice else "a column has no name"
        raise InputError(f"{path}, line {head[0]}: {fault}")
    numeric = [is_number(name) for name in names]
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
                _numbers(cells, numbers[-1], where, name)
                if numeric[i]
                else np.array([cell.strip() for cell in cells], dtype=object)
            )
    if not numbers:
        raise InputError(f"{path}: has no row below the names of its columns")
    columns = {name: np.concatenate(part) for name, part in zip(names, parts, strict=True)}
    return columns, np.concatenate(numbers)


def _numbers(
    cells: list[str], lines: npt.NDArray[np.int64], where: str, name: str
) -> npt.NDArray[np.float64]:
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        for cell, line in zip(cells, lines, strict=True):
            try:
                float(cell)
            except ValueError:
                shown = shorten(cell) or "nothing"
                raise InputError(
                    f"{where} {line}: {name} = {shown}: must be a finite number"
                ) from None
        raise
