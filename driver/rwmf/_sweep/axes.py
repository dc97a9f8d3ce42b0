"""The axes that a sweep loops over outside the kernel: records, scale factors, keys of the case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rwmf import _library
from rwmf._sweep.record_sets import RecordFile
from rwmf.case.namelist import Value
from rwmf.errors import InputError, did_you_mean

__all__ = [
    "PLACES",
    "Axis",
    "Coordinate",
    "Entries",
    "KeyAxis",
    "RecordAxis",
    "ScaleAxis",
    "key_axis",
    "keys_of_axis",
    "name_axes",
    "numbers_of_axis",
]

Entries = dict[str, dict[str, Value]]
# the axes that the kernel loops over, and what each sets
PLACES = {"T_s": ("frame", "T_s"), "gamma": ("frame", "gamma"), "b": ("wall", "b")}
# names of axes that set several keys at once
_PAIRS = {"eta": ("cable.eta_0", "cable.eta_alpha")}
_AMPLITUDES = ("scale", "a_max_g", "v_p")
# letters of a wrong value in a message
_SHOWN = 80


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
        """Put the values of one position into the groups of a case.

        Parameters
        ----------
        entries : dict of str to dict
            Groups of the case, which are changed.
        position : int
            Along the axis.
        """

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension.

        Returns
        -------
        list of Coordinate
            One, or one for each key that the axis sets.
        """


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
    meaning : str
        What a factor is.
    """

    values: tuple[float, ...]
    name: str = "scale"
    meaning: str = "factor on the ground motion"

    def __len__(self) -> int:
        """Count the positions."""
        return len(self.values)

    def apply(self, entries: Entries, position: int) -> None:
        """Multiply the amplitude that the motion gives; a record without one has 1."""
        motion = entries.get("motion", {})
        if str(motion.get("kind")).lower() == "record":
            motion.setdefault("scale", 1.0)
        for key in list(motion):
            if key.lower() in _AMPLITUDES:
                motion[key] = float(str(motion[key])) * self.values[position]

    def coordinates(self) -> list[Coordinate]:
        """Label the dimension."""
        return [Coordinate(self.name, self.name, self.values, "1", self.meaning)]


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


def name_axes(grid: Mapping[str, object]) -> dict[str, object]:
    """Give every axis of a grid its one name, however the grid spells what it sets.

    Parameters
    ----------
    grid : mapping
        Values by names: ``scale``, ``eta``, or keys of a case, with their group or without it;
        the case of the letters does not matter.

    Returns
    -------
    dict
        The same values by ``T_s``, ``gamma``, ``b``, ``scale``, ``eta`` or ``group.key``.

    Raises
    ------
    InputError
        When there is no such key, or when two axes set the same.
    """
    found: dict[str, object] = {}
    words: dict[tuple[str, str], str] = {}
    for word, values in grid.items():
        name = _axis_name(word)
        for key in keys_of_axis(name):
            if key in words:
                raise InputError(f"grid: {words[key]} and {word}: both set {'.'.join(key)}")
            words[key] = word
        found[name] = values
    return found


def _axis_name(word: str) -> str:
    if not isinstance(word, str):
        raise InputError(f"grid: {word!r}: the name of an axis is a text")
    same = [name for name in ("scale", *_PAIRS) if name == word.lower()]
    if same:
        return same[0]
    group, key = _find_key(word)
    if group == "spectrum" and key not in PLACES:
        raise InputError(f"grid: {word}: no axis; the periods are the values of T_s")
    is_place = key in PLACES and group in (PLACES[key][0], "spectrum")
    return key if is_place else f"{group}.{key}"


def keys_of_axis(name: str) -> tuple[tuple[str, str], ...]:
    """Return the groups and keys that an axis sets.

    Parameters
    ----------
    name : str
        From `name_axes`.

    Returns
    -------
    tuple of (group, key)
        In the kernel's spelling; for ``scale`` a key that no case has.
    """
    if name in PLACES:
        return (PLACES[name],)
    if name == "scale":
        return (("motion", "amplitude"),)
    parts = (part.partition(".") for part in _PAIRS.get(name, (name,)))
    return tuple((group, key) for group, _, key in parts)


def key_axis(name: str, values: object) -> KeyAxis | ScaleAxis:
    """Make an axis of a grid that is looped over outside the kernel.

    Parameters
    ----------
    name : str
        From `name_axes`: ``scale``; ``eta`` for pairs (eta_0, eta_alpha); or ``group.key``.
    values : sequence
        Numbers or texts, for ``eta`` pairs of numbers.

    Returns
    -------
    KeyAxis or ScaleAxis
        The axis.

    Raises
    ------
    InputError
        When the values do not fit it.
    """
    keys = keys_of_axis(name)
    rows = _rows(name, values, len(keys))
    if name == "scale":
        return ScaleAxis(numbers_of_axis(name, values))
    return KeyAxis(name.split(".")[-1], keys, tuple(_typed(keys, row) for row in rows))


def numbers_of_axis(name: str, values: object) -> tuple[float, ...]:
    """Take the values of an axis of numbers.

    Parameters
    ----------
    name : str
        From `name_axes`.
    values : float, sequence or array
        The values.

    Returns
    -------
    tuple of float
        At least one, each once.

    Raises
    ------
    InputError
        When one is no finite number, or when they do not differ.
    """
    return tuple(_number(name, row[0]) for row in _rows(name, values, 1))


def _rows(name: str, values: object, width: int) -> tuple[tuple[Value, ...], ...]:
    if not isinstance(values, str | Sequence):
        # an array of numpy or of what makes one; a bare value is a list of one
        values = np.asarray(values).tolist()
    if isinstance(values, str) or not isinstance(values, Sequence):
        values = [values]
    items = [
        item.tolist() if isinstance(item, np.generic | np.ndarray) else item for item in values
    ]
    rows = [tuple(item) if isinstance(item, list | tuple) else (item,) for item in items]
    if not rows or any(len(row) != width for row in rows):
        wanted = "a list of values" if width == 1 else f"a list of {width} numbers each"
        raise InputError(f"grid: {name} = {_shown(values)}: needs {wanted}")
    rows = [tuple(_plain(name, value) for value in row) for row in rows]
    if len(set(rows)) < len(rows):
        raise InputError(f"grid: {name}: a value stands there twice")
    return tuple(rows)


def _typed(keys: tuple[tuple[str, str], ...], row: tuple[Value, ...]) -> tuple[Value, ...]:
    """Write whole numbers of integer keys as such."""
    kinds = {(found[0], found[1]): found[2] for found in _library.schema()}
    return tuple(
        int(value)
        if kinds[key] == "integer" and isinstance(value, float) and value.is_integer()
        else value
        for key, value in zip(keys, row, strict=True)
    )


def _plain(name: str, value: object) -> Value:
    if isinstance(value, str):
        return value
    return _number(name, value)


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise InputError(f"grid: {name} = {_shown(value)}: must be a finite number")
    return float(value)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


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
    allowed = list(dict.fromkeys(["scale", *_PAIRS, *(row[1] for row in _library.schema())]))
    hint = did_you_mean(name, [*allowed, *(f"{row[0]}.{row[1]}" for row in _library.schema())])
    hint = f"{hint} Allowed" if hint else "; allowed"
    raise InputError(f"grid: {name}: no key of a case{hint} are {', '.join(allowed)}")
