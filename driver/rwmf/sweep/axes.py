"""The axes that a sweep loops over outside the kernel: records, scale factors, keys of the case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rwmf import _library
from rwmf.errors import InputError
from rwmf.namelist import Value
from rwmf.sweep.suite import RecordFile

__all__ = ["Axis", "Coordinate", "Entries", "KeyAxis", "RecordAxis", "ScaleAxis", "key_axis"]

Entries = dict[str, dict[str, Value]]
# names of axes that set several keys at once
_PAIRS = {"eta": ("eta_0", "eta_alpha")}
_AMPLITUDES = ("scale", "a_max_g", "v_p")


@dataclass(frozen=True)
class Coordinate:
    """Labels along a dimension.

    Attributes
    ----------
    name : str
        Name of the coordinate.
    dimension : str
        Dimension that it labels.
    values : tuple of float or str
        One label a position.
    unit : str
        Unit of the values, '' for texts.
    meaning : str
        What it is.
    """

    name: str
    dimension: str
    values: tuple[Value, ...]
    unit: str
    meaning: str


class Axis(Protocol):
    """One loop of a sweep."""

    @property
    def name(self) -> str:
        """Name of the dimension."""

    def __len__(self) -> int:
        """Count the positions."""

    def apply(self, entries: Entries, position: int) -> None:
        """Put the values of one position into the groups of a case."""

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension."""


@dataclass(frozen=True)
class KeyAxis:
    """Values of one key of the case, or of several that change together.

    Attributes
    ----------
    name : str
        Name of the dimension.
    keys : tuple of (group, key)
        What is set.
    values : tuple of tuple
        One tuple a position, one value a key.
    """

    name: str
    keys: tuple[tuple[str, str], ...]
    values: tuple[tuple[Value, ...], ...]

    def __len__(self) -> int:
        """Count the positions."""
        return len(self.values)

    def apply(self, entries: Entries, position: int) -> None:
        """Put the values of one position into the groups of a case."""
        for (group, key), value in zip(self.keys, self.values[position], strict=True):
            target = entries.setdefault(group, {})
            same = next((name for name in target if name.lower() == key.lower()), key)
            target[same] = value

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension with each key; a pair also needs numbers to select by."""
        table = {(row[0], row[1]): row for row in _library.schema()}
        found = []
        for i, key in enumerate(self.keys):
            unit, meaning = table[key][3], table[key][6]
            name = self.name if len(self.keys) == 1 else key[1]
            values = tuple(row[i] for row in self.values)
            numbers = isinstance(values[0], int | float)
            unit = unit.replace("-", "1") if numbers else ""
            found.append(Coordinate(name, self.name, values, unit, meaning))
        return found


@dataclass(frozen=True)
class ScaleAxis:
    """Factors on the ground motion, whatever its kind.

    Attributes
    ----------
    values : tuple of float
        The factors [-].
    name : str
        Name of the dimension.
    """

    values: tuple[float, ...]
    name: str = "scale"

    def __len__(self) -> int:
        """Count the positions."""
        return len(self.values)

    def apply(self, entries: Entries, position: int) -> None:
        """Multiply the amplitude that the motion gives; a record without one has 1."""
        motion = entries.get("motion", {})
        if motion.get("kind") == "record":
            motion.setdefault("scale", 1.0)
        for key in list(motion):
            if key.lower() in _AMPLITUDES:
                motion[key] = float(motion[key]) * self.values[position]

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension."""
        text = "factor on the ground motion"
        return [Coordinate(self.name, self.name, self.values, "1", text)]


@dataclass(frozen=True)
class RecordAxis:
    """Recorded ground motions, each to its last sample.

    Attributes
    ----------
    records : tuple of RecordFile
        The records.
    name : str
        Name of the dimension.
    """

    records: tuple[RecordFile, ...]
    name: str = "record"

    def __len__(self) -> int:
        """Count the positions."""
        return len(self.records)

    def apply(self, entries: Entries, position: int) -> None:
        """Let the record take the place of the case's motion and of its end."""
        entries["motion"] = self.records[position].motion()
        solver = entries.get("solver", {})
        for key in [key for key in solver if key.lower() == "t_end"]:
            del solver[key]

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension with names and checksums."""
        names = tuple(record.name for record in self.records)
        sums = tuple(record.crc32 for record in self.records)
        formats = tuple(record.format() for record in self.records)
        return [
            Coordinate("record", "record", names, "", "ground motion"),
            Coordinate("record_crc32", "record", sums, "", "CRC-32 of the record's file"),
            Coordinate("record_format", "record", formats, "", "unit and interval of the samples"),
        ]


def key_axis(name: str, values: object) -> KeyAxis | ScaleAxis:
    """Make the axis of a name in a grid.

    Parameters
    ----------
    name : str
        ``scale``; ``eta`` for pairs (eta_0, eta_alpha); or a key of the case, ``e`` or
        ``frame.xi_s``.
    values : sequence
        Numbers or texts, for ``eta`` pairs of numbers.

    Returns
    -------
    KeyAxis or ScaleAxis
        The axis.

    Raises
    ------
    InputError
        When there is no such key, or when the values do not fit it.
    """
    rows = _rows(name, values, len(_PAIRS.get(name, (name,))))
    if name == "scale":
        return ScaleAxis(tuple(float(_number(name, row[0])) for row in rows))
    keys = tuple(_find_key(part) for part in _PAIRS.get(name, (name,)))
    return KeyAxis(name.split(".")[-1], keys, tuple(_typed(keys, row) for row in rows))


def _rows(name: str, values: object, width: int) -> tuple[tuple[Value, ...], ...]:
    if isinstance(values, str) or not isinstance(values, Sequence | np.ndarray):
        values = [values]
    values = values.tolist() if isinstance(values, np.ndarray) else values
    items = [item.tolist() if isinstance(item, np.generic) else item for item in values]
    rows = [tuple(item) if isinstance(item, list | tuple) else (item,) for item in items]
    if not rows or any(len(row) != width for row in rows):
        wanted = "a list of values" if width == 1 else f"a list of {width} numbers each"
        raise InputError(f"grid: {name} = {values!r}: needs {wanted}")
    rows = [tuple(_plain(name, value) for value in row) for row in rows]
    if len(set(rows)) < len(rows):
        raise InputError(f"grid: {name}: a value stands there twice")
    return tuple(rows)


def _typed(keys: tuple[tuple[str, str], ...], row: tuple[Value, ...]) -> tuple[Value, ...]:
    """Write whole numbers of integer keys as such."""
    kinds = {(found[0], found[1]): found[2] for found in _library.schema()}
    return tuple(
        int(value) if kinds[key] == "integer" and float(value).is_integer() else value
        for key, value in zip(keys, row, strict=True)
    )


def _plain(name: str, value: object) -> Value:
    if isinstance(value, str):
        return value
    return _number(name, value)


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise InputError(f"grid: {name} = {value!r}: must be a finite number or a text")
    return float(value)


def _find_key(name: str) -> tuple[str, str]:
    """Group and key of a name, in the spelling of the kernel's table."""
    group, _, key = name.rpartition(".")
    matches = [
        (row[0], row[1])
        for row in _library.schema()
        if row[1].lower() == key.lower()
        and (row[0] == group.lower() if group else row[0] != "spectrum")
    ]
    if len(matches) == 1:
        return matches[0]
    if matches:
        names = ", ".join(f"{found}.{key}" for found, _ in matches)
        raise InputError(f"grid: {name}: in several groups; write one of {names}")
    known = ", ".join(dict.fromkeys(row[1] for row in _library.schema()))
    raise InputError(f"grid: {name}: no key of a case; allowed are scale, eta, {known}")
