"""Version of the kernel, its tables of keys and quantities, and its reader of records."""

from __future__ import annotations

import functools
import math
import re
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_cases as _cases
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf.kernel.marshalling import Memory, call, decode, encode, fetch_text, split_table
from rwmf.kernel.numbers import Array

_BUFFER = 200


class FileHeader(NamedTuple):
    """Header of a record file.

    Attributes
    ----------
    is_at2 : bool
        True for an AT2 file.
    unit : str, optional
        Unit of the samples; None where the file gives none, or several.
    channels : int
        Number of columns of accelerations.
    """

    is_at2: bool
    unit: str | None
    channels: int


class FileChannel(NamedTuple):
    """Samples of a record file.

    Attributes
    ----------
    format : str
        'AT2', 'one column', 'two columns' or 'table'.
    unit : str
        Unit of the values: 'g', 'm/s2' or 'cm/s2'.
    name : str
        Name of the column.
    dt : float, optional
        Interval [s].
    values : array, shape (n,)
        Accelerations.
    times : array, shape (n,), optional
        Times [s].
    """

    format: str
    unit: str
    name: str
    dt: float | None
    values: Array
    times: Array | None


def read_record_header(content: bytes) -> FileHeader:
    """Read the header of a record file."""
    buffer = np.empty(_BUFFER, dtype=np.int8)
    (length,) = call(_cases.record_header, _bytes(content), buffer)
    name, unit, channels = decode(buffer, length).split("\t")
    return FileHeader(name == "AT2", unit or None, int(channels))


def read_record(content: bytes, unit: str | None, dt: float | None) -> list[FileChannel]:
    """Read the samples of a record file."""
    asked = (encode(unit or ""), 0.0 if dt is None else dt)
    handle, channels = call(_cases.record_read, _bytes(content), *asked)
    memory = Memory(handle)
    return [_channel(memory.handle, i + 1) for i in range(int(channels))]


def unit_named(text: str) -> tuple[str, str, float, float]:
    """Return the unit that a text of a file names."""
    ratio = np.ones(2)
    quantity, base = fetch_text(_cases.unit_named, encode(text), ratio).split("\t")
    return quantity, base, float(ratio[0]), float(ratio[1])


def _channel(handle: int, number: int) -> FileChannel:
    facts = fetch_text(_cases.channel_facts, handle, number).split("\t")
    name, unit, column, dt, size, has_times = facts
    values = np.empty(int(size))
    times = np.empty(int(size) if has_times == "1" else 0)
    _cases.channel_samples(handle, number, values, times)
    return FileChannel(
        name,
        unit,
        column,
        float(dt) if dt else None,
        values,
        times if times.size else None,
    )


def _bytes(content: bytes) -> npt.NDArray[np.int8]:
    return np.frombuffer(content, dtype=np.int8)


@functools.cache
def version() -> str:
    """Return the version of the compiled kernel."""
    return fetch_text(_kernel.version)


def instruction_set() -> str:
    """Return the instruction set that spectra use on this processor."""
    return fetch_text(_kernel.instruction_set)


_INTERVAL = re.compile(r"([\[(])([^,\s]+), ([^\])]+)[\])]")


class Bounds(NamedTuple):
    """Bounds of a number; None where there is none.

    Attributes
    ----------
    low, high : float or None
        The bounds.
    is_above, is_below : bool
        Whether the bound itself is refused.
    """

    low: float | None = None
    high: float | None = None
    is_above: bool = False
    is_below: bool = False


class KeyRow(NamedTuple):
    """A row of the kernel's table of keys.

    Attributes
    ----------
    group, key : str
        Names in the namelist.
    kind : str
        'real', 'reals' (one number, or one for each element), 'integer', 'logical', 'choice',
        'text' or '... list'.
    unit, default, allowed, meaning : str
        As in the reference of the namelist.
    usual : str
        Range in real buildings.
    gives : str
        Key of the group that may be left out when this one is given; empty for most keys.
    """

    group: str
    key: str
    kind: str
    unit: str
    default: str
    allowed: str
    meaning: str
    usual: str
    gives: str

    @property
    def bounds(self) -> Bounds:
        """Bounds of the allowed numbers."""
        if interval := _INTERVAL.fullmatch(self.allowed):
            low, high = number_of(interval[2]), number_of(interval[3])
            return Bounds(low, high, interval[1] == "(", self.allowed.endswith(")"))
        if bound := re.fullmatch(r"(>=?) (\S+)", self.allowed):
            return Bounds(number_of(bound[2]), None, bound[1] == ">")
        return Bounds()


def number_of(text: str) -> float | None:
    """Read a number of the table; None for a word."""
    if text in ("pi", "pi/2"):
        return math.pi / (2.0 if text.endswith("2") else 1.0)
    try:
        return float(text)
    except ValueError:
        return None


@functools.cache
def schema() -> tuple[KeyRow, ...]:
    """Return the kernel's table of groups and keys."""
    return tuple(KeyRow(*cells) for cells in split_table(fetch_text(_kernel.schema)))


@functools.cache
def rows_of_keys() -> dict[tuple[str, str], KeyRow]:
    """Return the rows of `schema` by group and key."""
    return {row[:2]: row for row in schema()}


@functools.cache
def keys_of_groups() -> dict[str, dict[str, str]]:
    """Return the keys of each group, by their names in lower case."""
    found: dict[str, dict[str, str]] = {}
    for row in schema():
        found.setdefault(row.group, {})[row.key.lower()] = row.key
    return found


def needs_of_groups() -> dict[str, list[str]]:
    """Return the groups of a case, each with the groups that it requires."""
    rows = split_table(fetch_text(_kernel.groups))
    found: dict[str, list[str]] = {}
    for name, *needs in rows:
        found.setdefault(name, []).extend(needs)
    return found


def quantities() -> list[list[str]]:
    """Return the kernel's table of output quantities."""
    return split_table(fetch_text(_kernel.quantities))


def digits_of(rtol: float, sensitivity: float) -> int:
    """Count the digits of a peak that hold."""
    return int(_kernel.digits_of(rtol, sensitivity))


def strip_under(normal: Array, phi: Array, *strip: float) -> Array:
    """Compute contact, toe stress, moment, settlement of a strip: width, thickness, k, strength."""
    found = np.empty((normal.size, 4), order="F")
    _kernel.strip_under(*strip, normal, phi, found)
    return found


def meant_quantity(word: str) -> str:
    """Find the quantity for a technical term or a misspelled key."""
    return fetch_text(_kernel.meant_quantity, encode(word[:80]))


def unusual_record(peak: float, interval: float, duration: float) -> str:
    """Return the warning about a record that is no earthquake in these units."""
    return fetch_text(_kernel.unusual_record, peak, interval, duration)
