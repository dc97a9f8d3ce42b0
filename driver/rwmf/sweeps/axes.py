"""Axes of a sweep, as columns of numbers for the kernel or scenes; layout of its results."""

from __future__ import annotations

import difflib
import functools
import hashlib
import itertools
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple, Self, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf.case.namelist import Value
from rwmf.errors import InputError, did_you_mean
from rwmf.kernel import tables
from rwmf.kernel.names import readable
from rwmf.kernel.numbers import Array, Wholes, float_of, show, to_items
from rwmf.motion.record_sets import RecordFile
from rwmf.run.quantities import AXES

_T = TypeVar("_T")
Scenes = npt.NDArray[np.uint32]
Entries = dict[str, dict[str, Value]]
Key = tuple[str, str]
SCALE = "scale"
# dimension of the rows of a table
POINT = "point"
# keys set by columns without a group
_PLACES = {"T_s": ("frame", "T_s"), "gamma": ("frame", "gamma"), "b": ("wall", "b")}
# axes that set several keys at once
PAIRS = {"eta": ("cable.eta_0", "cable.eta_alpha")}
# types of keys that differ from row to row of one call of the kernel
NUMBERS = ("real", "integer", "logical")
_WORDS = {"true": 1.0, ".true.": 1.0, "1": 1.0, "false": 0.0, ".false.": 0.0, "0": 0.0}
# numbers that select a motion or the format of a file: each value is a scene
_OF_SCENE = ("storeys.n", "motion.dt", "vertical.dt")


@dataclass(frozen=True)
class Coordinate:
    """Labels along a dimension.

    Attributes
    ----------
    name : str
        Name of the coordinate.
    dimension : str
        Labelled dimension.
    values : numpy.ndarray, shape (positions,), or tuple, one label a scene
        Numbers of a column, or the differing settings of the scenes.
    unit : str
        Unit of the values, '' for texts.
    meaning : str
        Definition.
    column : str
        Kernel name of the quantity set by the numbers: ``T_s``, ``gamma``, ``b``, ``scale`` or
        ``group.key``; '' for labels of scenes.
    power : int
        Power of the kernel's number in the values: 2 for levels of a quadratic intensity.
    """

    name: str
    dimension: str
    values: Array | tuple[Value, ...]
    unit: str
    meaning: str
    column: str = ""
    power: int = 1

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of its variable."""
        return ({"units": self.unit} if self.unit else {}) | {"long_name": self.meaning}


@dataclass(frozen=True)
class Scene:
    """Settings that the rows of one kernel call cannot vary.

    Attributes
    ----------
    record : RecordFile, optional
        Ground motion that replaces the case's, used to its last sample.
    settings : tuple of (key, value)
        Texts and lists, by group and key.
    """

    record: RecordFile | None = None
    settings: tuple[tuple[Key, Value], ...] = ()

    def apply(self, entries: Entries) -> None:
        """Insert record and settings into the groups of a case."""
        if self.record is not None:
            entries["motion"] = self.record.motion()
            solver = entries.get("solver", {})
            for word in [word for word in solver if word.lower() == "t_end"]:
                del solver[word]
        for key, value in self.settings:
            _put(entries, key, value)


@dataclass(frozen=True, eq=False)
class Axis:
    """One dimension of a sweep: a table with one row per position.

    Attributes
    ----------
    name : str
        Name of the dimension.
    coordinates : tuple of Coordinate
        Its columns.
    scenes : tuple of Scene
        Distinct scenes of the positions.
    scene_of : numpy.ndarray, shape (size,)
        Index into `scenes` for each position.
    where : callable
        Describes a position in messages.
    """

    name: str
    coordinates: tuple[Coordinate, ...]
    scenes: tuple[Scene, ...]
    scene_of: Scenes
    where: Callable[[int], str]

    @property
    def size(self) -> int:
        """Number of positions."""
        return len(self.scene_of)

    @property
    def columns(self) -> dict[str, Array]:
        """Numbers by the kernel names of the quantities that they set."""
        return {
            item.column: item.values if item.power == 1 else item.values ** (1 / item.power)
            for item in self.coordinates
            if isinstance(item.values, np.ndarray)
        }

    @property
    def keys(self) -> set[Key]:
        """Groups and keys that the axis sets."""
        settings = {key for scene in self.scenes for key, _ in scene.settings}
        return settings | {key_of_column(name) for name in self.columns}

    def scene(self, position: int) -> Scene:
        """Return the scene of a position."""
        return self.scenes[int(self.scene_of[position])]


def record_axis(records: Sequence[RecordFile]) -> Axis:
    """Make the axis of recorded ground motions."""
    scenes = tuple(Scene(record) for record in records)
    labels = record_coordinates("record", records)
    return Axis("record", labels, scenes, _each(scenes), lambda i: f"record = {records[i].name}")


def _each(scenes: Sequence[Scene]) -> Scenes:
    """Assign one scene to each position."""
    return np.arange(len(scenes), dtype=np.uint32)


def record_coordinates(dimension: str, records: Sequence[RecordFile]) -> tuple[Coordinate, ...]:
    """Label records with names and checksums."""
    names = tuple(record.name for record in records)
    sums = tuple(record.crc32 for record in records)
    formats = tuple(record.format() for record in records)
    return (
        Coordinate("record", dimension, names, "", "ground motion"),
        Coordinate("record_crc32", dimension, sums, "", "CRC-32 of the record's file or numbers"),
        Coordinate("record_format", dimension, formats, "", "unit and interval of the samples"),
    )


def grid_axis(name: str, values: object) -> Axis:
    """Make an axis of a grid."""
    parts = PAIRS.get(name, (name,))
    rows = _rows(name, values, len(parts))
    title = name.split(".")[-1]

    def where(position: int) -> str:
        return f"{title} = {rows[position][0]}"

    if is_number(name):
        labels = tuple(
            column_coordinate(
                part,
                title,
                title if len(parts) == 1 else part.split(".")[-1],
                take_numbers(part, [row[i] for row in rows], lambda _: "grid", name),
            )
            for i, part in enumerate(parts)
        )
        return Axis(title, labels, (Scene(),), np.zeros(len(rows), np.uint32), where)
    key = key_of_column(name)
    if kind_of(name) in NUMBERS:
        numbers = take_numbers(name, [row[0] for row in rows], lambda _: "grid")
        is_whole = kind_of(name) == "integer"
        rows = [(int(value) if is_whole else float(value),) for value in numbers]
    scenes = tuple(Scene(settings=((key, row[0]),)) for row in rows)
    label = column_coordinate(name, title, title, tuple(row[0] for row in rows))
    return Axis(title, (label,), scenes, _each(scenes), where)


def column_coordinate(
    column: str, dimension: str, name: str, values: Array | tuple[Value, ...]
) -> Coordinate:
    """Make the coordinate for the values of a column."""
    if column == SCALE:
        unit, meaning = "1", "factor on the ground motion"
    elif column in AXES:
        unit, meaning = AXES[column].unit, AXES[column].meaning
    else:
        row = tables.rows_of_keys()[key_of_column(column)]
        unit, meaning = row.unit.replace("-", "1"), row.meaning
    if isinstance(values, np.ndarray):
        return Coordinate(name, dimension, values, unit, meaning, column)
    if any(isinstance(value, str) for value in values):
        unit = ""
    return Coordinate(name, dimension, values, unit, meaning)


def name_axes(grid: Mapping[str, _T], label: str = "grid") -> dict[str, _T]:
    """Convert the names of a grid to canonical axis names."""
    found: dict[str, _T] = {}
    words: dict[Key, str] = {}
    for word, values in grid.items():
        name = _axis_name(word, label)
        for key in keys_of_axis(name):
            if key in words:
                raise InputError(f"{label}: {words[key]} and {word}: both set {'.'.join(key)}")
            words[key] = word
        found[name] = values
    return found


def column_in(groups: Mapping[str, Mapping[str, object]], word: str, label: str) -> str:
    """Return the column of a key; one of several groups means the only one that the case gives."""
    try:
        (column,) = name_axes({word: None}, label)
    except InputError as error:
        key = str(word).lower()
        present = [name for name, keys in groups.items() if key in map(str.lower, keys)]
        if "in several groups" not in str(error) or len(present) != 1:
            raise
        (column,) = name_axes({f"{present[0]}.{word}": None}, label)
    return column


def _axis_name(word: str, label: str) -> str:
    if not isinstance(word, str):
        raise InputError(f"{label}: {word!r}: the name of an axis is a text")
    same = [name for name in (SCALE, *PAIRS) if name == word.lower()]
    if same:
        return same[0]
    group, key = _find_key(word, label)
    if group == "spectrum" and key not in _PLACES:
        raise InputError(f"{label}: {word}: no axis; the periods are the values of T_s")
    is_place = key in _PLACES and group in (_PLACES[key][0], "spectrum")
    return key if is_place else f"{group}.{key}"


def keys_of_axis(name: str) -> tuple[Key, ...]:
    """Return the groups and keys that an axis sets."""
    return tuple(key_of_column(part) for part in PAIRS.get(name, (name,)))


def key_of_column(column: str) -> Key:
    """Return the group and key that a column sets."""
    if column == SCALE:
        return ("motion", "amplitude")
    group, _, key = column.partition(".")
    return _PLACES.get(column, (group, key))


def kind_of(name: str) -> str:
    """Return the type of an axis's values."""
    if name == SCALE or name in PAIRS:
        return "real"
    # a value of an axis is one number for all elements of a group
    return tables.rows_of_keys()[key_of_column(name)].kind.removesuffix("s")


def is_number(name: str) -> bool:
    """Check whether rows of one kernel call can differ in the key of an axis."""
    return kind_of(name) in NUMBERS and name not in _OF_SCENE


def put_number(entries: Entries, column: str, value: float) -> None:
    """Insert a number of a column into the groups of a case."""
    kind = kind_of(column)
    if column != SCALE:
        types = {"integer": int, "logical": bool}
        number = types.get(kind, float)(value)
        # a column holds lists with a single number
        _put(entries, key_of_column(column), (number,) if kind.endswith("list") else number)


def take_numbers(
    name: str, values: object, where: Callable[[int], str], shown: str | None = None
) -> Array:
    """Convert the values of a column to numbers."""
    kind = kind_of(name)
    array = np.asarray(values)
    if isinstance(values, list) and any(isinstance(item, bool) for item in values):
        # beside numbers NumPy converts a truth value to 0 or 1
        array = array.astype(object)
    if array.dtype.kind not in ("iufb" if kind == "logical" else "iuf"):
        # NumPy converts a list with one text to an array of texts
        texts = values if isinstance(values, list) else array.tolist()
        array = np.array([_number(value, kind) for value in texts])
    numbers = np.ascontiguousarray(array, dtype=np.float64)
    is_good = np.isfinite(numbers)
    wanted = "a finite number"
    if kind == "integer":
        is_good &= np.floor(numbers) == numbers
        wanted = "a whole number"
    elif kind == "logical":
        is_good = (numbers == 0) | (numbers == 1)
        wanted = "true or false"
    if not is_good.all():
        i = int(np.argmin(is_good))
        items = values if isinstance(values, list) else np.asarray(values, dtype=object).tolist()
        raise InputError(f"{where(i)}: {shown or name} = {show(items[i])}: must be {wanted}")
    return numbers


def _number(value: object, kind: str) -> float:
    """Return a number, or NaN for other values."""
    if kind == "logical" and isinstance(value, str):
        return _WORDS.get(value.strip().lower(), np.nan)
    if kind == "logical" and isinstance(value, bool | np.bool_):
        return float(value)
    number = float_of(value)
    return np.nan if number is None else number


def _rows(name: str, values: object, width: int) -> list[tuple[Value, ...]]:
    """Return the values of an axis, one tuple per position."""
    if np.ma.is_masked(values):
        raise InputError(f"grid: {name} = {show(values)}: has masked values: must be numbers")
    # a single value becomes a list of one
    found = to_items(values)
    values = [values] if found is None else found
    items = [
        item.tolist() if isinstance(item, np.generic | np.ndarray) else item for item in values
    ]
    rows = [tuple(item) if isinstance(item, list | tuple) else (item,) for item in items]
    if not rows or any(len(row) != width for row in rows):
        wanted = "a list of values" if width == 1 else f"a list of {width} numbers each"
        raise InputError(f"grid: {name} = {show(values)}: needs {wanted}")
    wrong = [value for row in rows for value in row if not isinstance(value, str | int | float)]
    if wrong:
        raise InputError(f"grid: {name} = {show(wrong[0])}: must be a finite number")
    if len(set(rows)) < len(rows):
        raise InputError(f"grid: {name}: a value is given twice")
    return rows


def _put(entries: Entries, key: Key, value: Value) -> None:
    target = entries.setdefault(key[0], {})
    same = next((name for name in target if name.lower() == key[1].lower()), key[1])
    target[same] = value


# groups without a number of the structure or the motion, with the reason
SETTINGS = {
    "output": "is a setting of the output",
    "spectrum": "is a setting of a spectrum",
    "solver": "is a setting of the solver",
}
# groups that leave short names to others: e and nu are keys of &impact and &motion
_NEEDS_GROUP = ("base", "base_section", "bending")


def _find_key(name: str, label: str) -> Key:
    """Return group and key of a name, in canonical form."""
    group, _, key = name.rpartition(".")
    rows = tables.rows_of_keys()
    matches = [
        known
        for known in rows
        if known[1].lower() == key.lower()
        and (known[0] == group.lower() if group else known[0] != "spectrum")
    ]
    if len(matches) > 1:
        matches = [known for known in matches if known[0] not in _NEEDS_GROUP]
    if len(matches) == 1:
        return matches[0]
    if matches:
        names = ", ".join(".".join(found) for found in matches)
        raise InputError(f"{label}: {name}: in several groups; write one of {names}")
    keys = (key for _, key in rows)
    hint = did_you_mean(name, ["scale", *PAIRS, *keys, *map(".".join, rows)])
    hint = f"{hint} Allowed" if hint else "; allowed"
    raise InputError(
        f"{label}: {name}: no key of a case{hint} are {', '.join(('scale', *PAIRS))} and the keys "
        "of reference/namelist.md"
    )


_SHOWN_LINES = 20
# separator between the text of a layout, which never contains it, and its columns
_END = b"\0"


class Rows(NamedTuple):
    """Runs of one chunk.

    Attributes
    ----------
    positions : tuple of numpy.ndarray, each shape (rows,)
        Positions along each dimension.
    places : numpy.ndarray, shape (rows,)
        Indices of the runs in the whole sweep, with the last dimension fastest.
    """

    positions: tuple[Wholes, ...]
    places: Wholes


@dataclass(frozen=True)
class Layout:
    """Shape and identity of a sweep.

    Attributes
    ----------
    version : str
        Version of the kernel.
    case : str
        Namelist text common to all runs.
    coordinates : tuple of Coordinate
        Labels of all dimensions.
    scene_of : dict of str to numpy.ndarray, each shape (positions,)
        Scene number of each position by name of the dimension, slowest dimension first; a single
        scene where the positions differ in numbers only.
    block : int
        Largest number of runs in a chunk.
    quantities : tuple of str
        Quantities stored for each run.
    motion_crc32 : str
        Checksum of the case's own record, '' without one.
    method : str
        Method of all runs, '' when they differ.
    warnings : str
        Conservation laws that some runs violate, in one line; '' for none.
    intensity : dict of str to str or float
        Attributes of the intensity that a factor on the ground motion sets; empty without one.
    """

    version: str
    case: str
    coordinates: tuple[Coordinate, ...]
    scene_of: dict[str, Scenes]
    block: int
    quantities: tuple[str, ...]
    motion_crc32: str = ""
    method: str = ""
    warnings: str = ""
    intensity: dict[str, str | float] = field(default_factory=dict)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of all dimensions."""
        return tuple(self.scene_of)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of all dimensions."""
        return tuple(map(len, self.scene_of.values()))

    @property
    def n_chunks(self) -> int:
        """Count the chunks."""
        return int(self._first_chunks[-1])

    @functools.cached_property
    def _members(self) -> list[tuple[Wholes, Wholes]]:
        """Return the positions along each dimension grouped by scene, and each scene's start."""
        found = []
        for scenes in self.scene_of.values():
            begins = np.concatenate([[0], np.cumsum(np.bincount(scenes))])
            found.append((np.argsort(scenes, kind="stable"), begins))
        return found

    @functools.cached_property
    def _first_chunks(self) -> Wholes:
        """Return the number of the first chunk of each group, and of all chunks."""
        sizes = np.ones(1, dtype=np.int64)
        for _, begins in self._members:
            sizes = np.multiply.outer(sizes, np.diff(begins)).ravel()
        return np.concatenate([[0], np.cumsum(-(-sizes // self.block))])

    def chunk_size(self, number: int) -> int:
        """Count the runs of a chunk."""
        _, start, stop = self._part(number)
        return stop - start

    def rows(self, number: int) -> Rows:
        """Find the runs of a chunk."""
        members, start, stop = self._part(number)
        rest = np.arange(start, stop)
        places = np.zeros(stop - start, dtype=np.int64)
        positions: list[Wholes] = []
        stride = 1
        for size, member in zip(reversed(self.shape), reversed(members), strict=True):
            rest, inside = np.divmod(rest, len(member))
            positions.insert(0, member[inside])
            places += stride * positions[0]
            stride *= size
        return Rows(tuple(positions), places)

    def _part(self, number: int) -> tuple[list[Wholes], int, int]:
        """Return a group's positions along each dimension, and a chunk's range in the group."""
        group = int(np.searchsorted(self._first_chunks, number, "right")) - 1
        first, following = self._first_chunks[group : group + 2].tolist()
        members: list[Wholes] = []
        for order, begins in reversed(self._members):
            group, scene = divmod(group, len(begins) - 1)
            members.insert(0, order[begins[scene] : begins[scene + 1]])
        # all chunks of a group have equal length
        size = math.prod(map(len, members))
        n = following - first
        start, stop = (size * i // n for i in (number - first, number - first + 1))
        return members, start, stop

    def labels(self, item: Coordinate) -> npt.NDArray[Any]:
        """Return the labels of all positions of a dimension."""
        if isinstance(item.values, np.ndarray):
            return item.values
        values = np.array([readable(value) for value in item.values])
        return values[self.scene_of[item.dimension]]

    def to_text(self) -> str:
        """Convert the layout to JSON; equal texts mean equal sweeps."""
        found = {item.name: getattr(self, item.name) for item in fields(self)}
        found["coordinates"] = [_entry(item) for item in self.coordinates]
        del found["scene_of"]
        found["dimensions"] = [{"name": n, "size": len(s)} for n, s in self.scene_of.items()]
        found["table"] = self._sha256
        return json.dumps(found, indent=1, sort_keys=True)

    def _arrays(self) -> list[memoryview]:
        """Return the bytes of all scenes, then of all columns, in little-endian order."""
        columns = [item.values for item in self.coordinates if item.column]
        arrays = [np.ascontiguousarray(scenes, "<u4") for scenes in self.scene_of.values()]
        return [item.data.cast("B") for item in (*arrays, *(np.asarray(c, "<f8") for c in columns))]

    @functools.cached_property
    def _sha256(self) -> str:
        found = hashlib.sha256()
        for part in self._arrays():
            found.update(part)
        return found.hexdigest()

    def parts(self) -> list[bytes | memoryview]:
        """Return the bytes of text and columns without copying them."""
        return [self.to_text().encode(), _END, *self._arrays()]

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Read the bytes of `parts`."""
        text, _, rest = content.partition(_END)
        found: dict[str, Any] = json.loads(text)
        del found["table"]
        place = 0

        def take(dtype: str, dimension: str) -> npt.NDArray[Any]:
            nonlocal place
            values = np.frombuffer(rest, dtype, sizes[dimension], place)
            place += values.nbytes
            return values

        sizes = {item["name"]: item["size"] for item in found.pop("dimensions")}
        found["scene_of"] = {name: take("<u4", name) for name in sizes}
        for entry in found["coordinates"]:
            has_column = entry["column"]
            entry["values"] = (
                take("<f8", entry["dimension"]) if has_column else tuple(entry["values"])
            )
        found["coordinates"] = tuple(Coordinate(**entry) for entry in found["coordinates"])
        found["quantities"] = tuple(found["quantities"])
        return cls(**found)

    @staticmethod
    def text_of(content: bytes) -> str:
        """Extract the text from the bytes of `parts`."""
        return content.partition(_END)[0].decode()


def _entry(item: Coordinate) -> dict[str, Any]:
    """Return the entry of a coordinate in the text."""
    values = list(item.values)
    if isinstance(item.values, np.ndarray):
        values = [] if item.dimension == POINT else item.values.tolist()
    return vars(item) | {"values": values}


def difference(old: str, new: str) -> str:
    """Show the difference of two layouts."""
    lines = difflib.unified_diff(_lines(old), _lines(new), lineterm="", n=0)
    changed = [line for line in lines if line[0] in "+-" and line[:3] not in ("---", "+++")]
    shown = list(itertools.islice(changed, _SHOWN_LINES))
    if len(changed) > len(shown):
        shown.append(f"... and {len(changed) - len(shown)} lines more")
    return "\n".join(shown)


def _lines(text: str) -> list[str]:
    """Return one line per value, and the case's text as in its namelist."""
    found = json.loads(text)
    lines: list[str] = found.pop("case").splitlines()
    for item in found.pop("coordinates"):
        lines.append(f"{item['name']} = {', '.join(str(value) for value in item['values'])}")
    lines.append(f"columns (SHA-256 of all) = {found.pop('table', '')}")
    return lines + [f"{key} = {value}" for key, value in sorted(found.items())]
