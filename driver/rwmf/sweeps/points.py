"""Tables whose rows are runs with individual numbers, texts and motions, and their files."""

from __future__ import annotations

import csv
import difflib
import os
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf.case import Motion
from rwmf.case.namelist import Value
from rwmf.errors import InputError
from rwmf.kernel.names import problem_of_name, shorten
from rwmf.kernel.numbers import Array, Wholes, show
from rwmf.motion.record_sets import RecordFile, decimal_point, find_records, separator_of
from rwmf.sweeps import axes

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
    path: Path, is_numeric: Callable[[str], bool]
) -> tuple[dict[str, npt.NDArray[np.generic]], Wholes]:
    """Read a CSV file: a line of names, then one line per row."""
    _check(path)
    try:
        with path.open(encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
            return _read_rows(path, file, is_numeric)
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
    path: Path, file: Iterator[str], is_numeric: Callable[[str], bool]
) -> tuple[dict[str, npt.NDArray[np.generic]], Wholes]:
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
    numeric = [is_numeric(name) for name in names]
    lines = _rows(numbered, mark, len(names), is_text=not numeric[0])
    numbers: list[Wholes] = []
    parts: list[list[npt.NDArray[np.generic]]] = [[] for _ in names]
    while block := list(islice(lines, _ROWS)):
        for number, cells in block:
            if len(cells) != len(names):
                if len(cells) < len(names):
                    fault = f"{names[len(cells)]}: no value"
                else:
                    fault = f"{shorten(cells[len(names)])!r}: a value without a column"
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


def _numbers(cells: list[str], lines: Wholes, where: str, name: str) -> Array:
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


# a pandas.DataFrame or a similar table has no type here without its package
Points = Any
_RECORD = "record"
_FORMS = (
    "a mapping of names to arrays, a pandas.DataFrame, an xarray.Dataset, a structured array, or "
    "the path of a CSV or NetCDF file"
)
Column = npt.NDArray[Any]


@dataclass(frozen=True)
class _Columns:
    """A table as given by the caller.

    Attributes
    ----------
    values : dict of str to numpy.ndarray, each shape (rows,)
        Columns by their names in the table.
    source : str
        Beginning of messages.
    folder : path
        Folder for relative paths of records.
    lines : numpy.ndarray, shape (rows,), optional
        Line of each row in a text file.
    """

    values: dict[str, Column]
    source: str = "points"
    folder: Path = Path()
    lines: Wholes | None = None

    def where(self, position: int) -> str:
        """Describe the position of a row."""
        place = f"row {position}" if self.lines is None else f"line {self.lines[position]}"
        return f"{self.source}, {place}"


def point_axis(
    points: Points,
    pool: Sequence[RecordFile] = (),
    unit: str | None = None,
    dt: float | None = None,
) -> axes.Axis:
    """Make the axis for the rows of a table."""
    table = _read(points)
    words = [word for word in table.values if str(word).lower() == _RECORD]
    named: dict[str, Column] = axes.name_axes(
        {word: values for word, values in table.values.items() if word not in words}, table.source
    )
    numbers = {name: values for name, values in named.items() if _is_number(name, table.source)}
    columns = {
        name: axes.take_numbers(name, values, table.where) for name, values in numbers.items()
    }
    texts: dict[str, tuple[Wholes, Sequence[Any]]] = {}
    if words:
        codes, values = _codes(table.values[words[0]])
        records, which = _find_records(codes, values, table, pool, unit, dt)
        texts[_RECORD] = (which[codes], records)
    for name in [name for name in named if name not in numbers]:
        texts[name] = _settings(name, table, named[name])
    scenes, scene_of = _make_scenes(texts, len(next(iter(table.values.values()))))
    labels = _labels([*named])
    coordinates = tuple(
        axes.column_coordinate(
            name,
            axes.POINT,
            labels[name],
            columns[name] if name in columns else _settings_of(name, scenes),
        )
        for name in named
    )
    if words:
        found = [scene.record for scene in scenes if scene.record is not None]
        coordinates = (*axes.record_coordinates(axes.POINT, found), *coordinates)
    return axes.Axis(axes.POINT, coordinates, scenes, scene_of, table.where)


def _read(points: Points) -> _Columns:
    if isinstance(points, str | os.PathLike):
        path = Path(points)
        if is_netcdf(path):
            return _Columns(_one_dimension(read_netcdf(path), str(path)), str(path), path.parent)
        values, lines = read_csv(path, lambda word: _is_column_of_numbers(word, str(path)))
        return _Columns(values, str(path), path.parent, lines)
    if isinstance(points, xr.Dataset):
        return _Columns(_one_dimension(points, "points"))
    if isinstance(points, np.ndarray) and points.dtype.names:
        points = {name: points[name] for name in points.dtype.names}
    elif hasattr(points, "columns") and hasattr(points, "to_numpy"):
        # a frame of pandas, polars, ...; a repeated column name returns two columns
        points = {name: points[name].to_numpy() for name in points.columns}
    if not isinstance(points, Mapping):
        raise InputError(f"points: {shorten(type(points).__name__)}: must be {_FORMS}")
    return _Columns(_same_length({name: _column(name, item) for name, item in points.items()}))


def _column(name: object, values: Any) -> Column:  # noqa: ANN401 (anything that becomes an array)
    if np.ma.is_masked(values):
        raise InputError(f"points: {show(name)}: has masked values: must have one value a row")
    try:
        array = np.asarray(values)
    except Exception:
        raise _not_one_value(name, values) from None
    if array.ndim > 1:
        raise _not_one_value(name, values)
    if isinstance(values, list | tuple) and (
        array.dtype.kind not in "biuf"
        or (array.dtype.kind != "b" and any(isinstance(item, bool) for item in values))
    ):
        # NumPy converts all numbers to texts when one value is a text
        return np.fromiter(values, dtype=object, count=len(values))
    return array


def _not_one_value(name: object, values: Any, source: str = "points") -> InputError:  # noqa: ANN401
    """Report the first row of a column that holds more than one value."""
    for i, value in enumerate(values):
        if np.ndim(value) > 0 if isinstance(value, np.ndarray) else isinstance(value, list | tuple):
            return InputError(f"{source}, row {i}: {name} = {show(value)}: must be one value")
    return InputError(f"{source}: {name}: must be one value a row")


def _one_dimension(found: xr.Dataset, source: str) -> dict[str, Column]:
    dims = list(found.sizes)
    if len(dims) != 1:
        raise InputError(
            f"{source}: has the dimensions {', '.join(map(str, dims)) or 'none'}: points have one; "
            f"dataset.stack({axes.POINT}=[...]).reset_index('{axes.POINT}') makes one of several"
        )
    # the labels of the rows, unless they are a key
    names = [str(name) for name in found.variables if name != dims[0] or _is_known(str(name))]
    return _same_length({name: found[name].values for name in names}, source)


def _is_known(word: str) -> bool:
    try:
        return word.lower() == _RECORD or bool(axes.name_axes({word: None}))
    except InputError:
        return False


def _same_length(columns: dict[str, Column], source: str = "points") -> dict[str, Column]:
    for name, values in columns.items():
        if values.ndim > 1:
            raise _not_one_value(name, values, source)
    lengths = {name: len(values) for name, values in columns.items() if values.ndim == 1}
    n = max(lengths.values(), default=min(1, len(columns)))
    if n == 0:
        raise InputError(f"{source}: has no row")
    for name, length in lengths.items():
        if length != n:
            raise InputError(
                f"{source}, row {length}: {name}: no value: the column ends after {length} rows, "
                f"others have {n}"
            )
    return {name: np.broadcast_to(values, n) for name, values in columns.items()}


def _is_column_of_numbers(word: str, source: str) -> bool:
    """Check whether a column of a text file is numeric; words may be logicals."""
    if word.lower() == _RECORD:
        return False
    (name,) = axes.name_axes({word: None}, source)
    return axes.kind_of(name) in ("real", "integer", "real list")


def _is_number(name: str, source: str) -> bool:
    """Check whether the kernel takes a column as numbers; a list has one number per row."""
    if name in axes.PAIRS or axes.kind_of(name) == "text list":
        parts = " and ".join(".".join(key) for key in axes.keys_of_axis(name))
        raise InputError(
            f"{source}: {name}: is a list, a column has one value a row"
            + (f"; give the columns {parts}" if name in axes.PAIRS else "")
        )
    return axes.is_number(name) or axes.kind_of(name) == "real list"


def _codes(column: Column) -> tuple[Wholes, list[Any]]:
    """Find the distinct values, and the index of each row's value."""
    if column.dtype.kind == "U":
        different, which = np.unique(column, return_inverse=True)
        return which, different.tolist()
    found: dict[Hashable, int] = {}
    values: dict[int, Any] = {}
    codes = []
    for value in column.tolist():
        # avoid comparing records and motions of many samples row by row
        key = value if isinstance(value, str | int | float | os.PathLike) else id(value)
        code = found.setdefault((type(value), key), len(found))
        values.setdefault(code, value)
        codes.append(code)
    return np.array(codes), list(values.values())


def _settings(name: str, table: _Columns, column: Column) -> tuple[Wholes, list[Any]]:
    """Find the texts of a column, or its numbers that define scenes."""
    is_text = axes.kind_of(name) not in axes.NUMBERS
    if not is_text:
        column = axes.take_numbers(name, column, table.where)
    codes, values = _codes(column)
    for i, value in enumerate(values):
        if is_text and not isinstance(value, str):
            place = table.where(int(np.argmax(codes == i)))
            raise InputError(f"{place}: {name} = {show(value)}: must be a text")
    is_whole = axes.kind_of(name) == "integer"
    return codes, [int(value) if is_whole else value for value in values]


def _make_scenes(
    texts: Mapping[str, tuple[Wholes, Sequence[Any]]], n: int
) -> tuple[tuple[axes.Scene, ...], npt.NDArray[np.uint32]]:
    """Combine records and texts into scenes, in the order of their first rows."""
    combined = np.zeros(n, dtype=np.int64)
    for codes, values in texts.values():
        combined = combined * len(values) + codes
    _, first, which = np.unique(combined, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    scenes = []
    for row in first[order].tolist():
        found = {name: values[codes[row]] for name, (codes, values) in texts.items()}
        record = found.pop(_RECORD, None)
        settings = tuple((axes.key_of_column(name), value) for name, value in found.items())
        scenes.append(axes.Scene(record, settings))
    return tuple(scenes), rank[which].astype(np.uint32)


def _labels(names: Sequence[str]) -> dict[str, str]:
    """Name the coordinates like grid axes, with the group where keys are ambiguous."""
    short = [name.split(".")[-1] for name in names]
    return {
        name: name.replace(".", "_") if short.count(label) > 1 else label
        for name, label in zip(names, short, strict=True)
    }


def _settings_of(name: str, scenes: Sequence[axes.Scene]) -> tuple[Value, ...]:
    key = axes.key_of_column(name)
    return tuple(value for scene in scenes for known, value in scene.settings if known == key)


def _find_records(
    codes: Wholes,
    words: list[Any],
    table: _Columns,
    pool: Sequence[RecordFile],
    unit: str | None,
    dt: float | None,
) -> tuple[tuple[RecordFile, ...], Wholes]:
    """Find the records that a column names, and the record of each of its words."""
    found: dict[RecordFile, int] = {record: i for i, record in enumerate(pool)}
    names = {record.name: record for record in pool}
    which = []
    for i, word in enumerate(words):
        record = names.get(word) if isinstance(word, str) else None
        try:
            record = record or _find_record(word, table.folder, pool, unit, dt)
        except InputError as error:
            place = table.where(int(np.argmax(codes == i)))
            close = difflib.get_close_matches(str(word), names, 1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise InputError(f"{place}: {error}{hint}") from error
        which.append(found.setdefault(record, len(found)))
    # files with equal names get their folders' names as well
    return find_records(list(found)), np.array(which)


def _find_record(
    word: object, folder: Path, pool: Sequence[RecordFile], unit: str | None, dt: float | None
) -> RecordFile:
    if isinstance(word, RecordFile | Motion):
        return find_records([word])[0]
    if not isinstance(word, str | os.PathLike) or not os.fspath(word):
        raise InputError(f"record = {show(word)}: must be a record, its name or path")
    path = (folder / word).absolute()
    same = [record for record in pool if record.path == str(path)]
    if same:
        return same[0]
    if not path.is_file():
        known = ", ".join(record.name for record in pool) or "none"
        raise InputError(
            f"record = {shorten(word)}: is neither a file nor the name of one of the records "
            f"({shorten(known)})"
        )
    return find_records([path], unit=unit, dt=dt)[0]
