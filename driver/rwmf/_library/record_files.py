"""Record files as the kernel reads them: AT2 and tables."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_cases as _cases
from rwmf._library.marshalling import decode, encode, fetch_text, message_buffer, raise_for
from rwmf._library.memory import Memory

__all__ = ["FileChannel", "FileHeader", "read_record", "read_record_header", "unit_named"]

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
    values: npt.NDArray[np.float64]
    times: npt.NDArray[np.float64] | None


def read_record_header(content: bytes) -> FileHeader:
    """Read the header of a record file."""
    message, buffer = message_buffer(), np.empty(_BUFFER, dtype=np.int8)
    length, status, n = _cases.record_header(_bytes(content), buffer, message)
    raise_for(status, message, n)
    name, unit, channels = decode(buffer, length).split("\t")
    return FileHeader(name == "AT2", unit or None, int(channels))


def read_record(content: bytes, unit: str | None, dt: float | None) -> list[FileChannel]:
    """Read the samples of a record file."""
    message = message_buffer()
    handle, channels, status, n = _cases.record_read(
        _bytes(content), encode(unit or ""), 0.0 if dt is None else dt, message
    )
    raise_for(status, message, n)
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
