"""Finished chunks of a sweep on disk: a file that only grows and survives ``kill -9``.

A text line, the layout with the table of its points, then one entry a chunk with its checksum. An
entry that a killed process left incomplete is found by its checksum and cut off.
"""

from __future__ import annotations

import fcntl
import json
import os
import stat
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import numpy as np

from rwmf._files import files
from rwmf._sweep.layout import Layout, difference
from rwmf._sweep.task import Chunk
from rwmf.errors import InputError, OutputError

__all__ = ["ChunkStore", "read_layout"]

_MAGIC = b"rwmf sweep journal 3\n"
# number of the chunk, length of the payload, CRC-32 of both and the payload
_HEAD = struct.Struct("<QQI")
_LAYOUT = 2**64 - 1


class ChunkStore:
    """The chunks that are done.

    Parameters
    ----------
    path : path
        The file; it is made, or continued when it belongs to the same layout.
    layout : Layout
        The sweep.
    restart : bool
        Begin a store that is there anew, whatever sweep it belongs to.

    Raises
    ------
    InputError
        When the file belongs to another sweep, with the difference, or is no journal.
    OutputError
        When it cannot be written, or when another process writes it.
    """

    def __init__(self, path: Path, layout: Layout, *, restart: bool = False) -> None:
        self.path = path
        self.layout = layout
        with files.reported(path):
            self._file: BinaryIO = _open_locked(path)
        try:
            self._index = self._scan(restart)
        except BaseException:
            self._file.close()
            raise

    def _scan(self, restart: bool) -> dict[int, int]:
        """Find the complete entries, or begin the file; what follows them is cut off."""
        index: dict[int, int] = {}
        end = 0
        for number, offset, payload, following in _entries(self._file, self.path):
            if restart:
                break
            if number == _LAYOUT:
                self._compare(Layout.text_of(payload))
            else:
                index[number] = offset
            end = following
        with files.reported(self.path):
            self._file.seek(end)
            self._file.truncate()
            if end == 0:
                self._write(_MAGIC)
                self._append(_LAYOUT, *self.layout.parts())
                files.sync_folder(self.path.parent)
        return index

    def _compare(self, old: str) -> None:
        new = self.layout.to_text()
        if old != new:
            raise InputError(
                f"{self.path}: belongs to another sweep (-), not to this one (+):\n"
                f"{difference(old, new)}\nrestart to discard it, or write to another file"
            )

    def __contains__(self, number: int) -> bool:
        """Whether a chunk is done."""
        return number in self._index

    def __len__(self) -> int:
        """Count the chunks that are done."""
        return len(self._index)

    def add(self, chunk: Chunk) -> None:
        """Keep a chunk; when this returns it is on the disk.

        Parameters
        ----------
        chunk : Chunk
            Results.

        Raises
        ------
        OutputError
            When the file cannot be written.
        """
        with files.reported(self.path):
            self._file.seek(0, os.SEEK_END)
            self._index[chunk.number] = self._append(chunk.number, _pack(chunk, self.layout))

    def _append(self, number: int, *parts: bytes | memoryview) -> int:
        offset = self._file.tell()
        for part in (_head(number, *parts), *parts):
            self._write(part)
        os.fsync(self._file.fileno())
        return offset

    def _write(self, content: bytes | memoryview) -> None:
        # without a buffer: what the disk refuses would be tried again when the file is closed
        rest = memoryview(content)
        while rest:
            rest = rest[self._file.write(rest) :]

    def get(self, number: int) -> Chunk:
        """Read a chunk.

        Parameters
        ----------
        number : int
            One that is done.

        Returns
        -------
        Chunk
            The results.
        """
        self._file.seek(self._index[number])
        head = self._file.read(_HEAD.size)
        return _unpack(number, self._file.read(_HEAD.unpack(head)[1]), self.layout)

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    def __enter__(self) -> Self:
        """Return the store itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Let go of the file."""
        self.close()


def read_layout(path: Path) -> Layout:
    """Read which sweep a journal belongs to.

    Parameters
    ----------
    path : path
        The journal.

    Returns
    -------
    Layout
        The sweep.

    Raises
    ------
    InputError
        When the file cannot be read or is no journal.
    """
    try:
        with path.open("rb") as file:
            for number, _, payload, _ in _entries(file, path):
                if number == _LAYOUT:
                    return Layout.from_bytes(payload)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    raise InputError(f"{path}: holds no sweep")


def _entries(file: BinaryIO, path: Path) -> Iterator[tuple[int, int, bytes, int]]:
    """Yield number, offset, payload and following offset of every complete entry."""
    file.seek(0)
    magic = file.read(len(_MAGIC))
    if not _MAGIC.startswith(magic):
        raise InputError(f"{path}: is no journal of a sweep of this version")
    offset = len(magic)
    while len(head := file.read(_HEAD.size)) == _HEAD.size:
        number, length, _ = _HEAD.unpack(head)
        # a torn length could ask for all memory
        if length > os.fstat(file.fileno()).st_size - offset:
            return
        payload = file.read(length)
        if _head(number, payload) != head:
            return
        yield number, offset, payload, offset + _HEAD.size + length
        offset += _HEAD.size + length


def _head(number: int, *parts: bytes | memoryview) -> bytes:
    """Make what stands before the parts of an entry."""
    length = sum(map(len, parts))
    checksum = zlib.crc32(struct.pack("<QQ", number, length))
    for part in parts:
        checksum = zlib.crc32(part, checksum)
    return _HEAD.pack(number, length, checksum)


def _pack(chunk: Chunk, layout: Layout) -> bytes:
    arrays = [np.ascontiguousarray(chunk.values[name], dtype="<f8") for name in layout.quantities]
    first = json.dumps(chunk.names).encode() + b"\n"
    return b"".join([first, chunk.status.tobytes(), *(array.tobytes() for array in arrays)])


def _unpack(number: int, payload: bytes, layout: Layout) -> Chunk:
    first, _, rest = payload.partition(b"\n")
    n = layout.chunk_size(number)
    values = {
        name: np.frombuffer(rest, "<f8", n, n + 8 * n * i)
        for i, name in enumerate(layout.quantities)
    }
    return Chunk(number, tuple(json.loads(first)), np.frombuffer(rest, "u1", n), values)


def _open_locked(path: Path) -> BinaryIO:
    """Open or make the file that the name stands for, and lock it.

    The name may change hands until the lock is there: whoever finishes a sweep removes its journal.
    """
    while True:
        file = open(path, "a+b", buffering=0, opener=_open_regular)  # noqa: SIM115
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(file.fileno()), path.lstat()):
                return file
        except FileNotFoundError:
            pass
        except BlockingIOError as error:
            file.close()
            raise OutputError(f"{path}: another process writes it") from error
        except BaseException:
            file.close()
            raise
        file.close()


def _open_regular(path: str, flags: int) -> int:
    """Open a file; neither through a link, which may be planted, nor what is no file."""
    descriptor = os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise InputError(f"{path}: is no journal of a sweep")
    return descriptor
