"""Store of finished chunks: an append-only file that survives ``kill -9``.

The file has one text line, the layout with the table of its points, and then one entry per chunk
with a checksum. The checksum identifies an entry that a killed process left incomplete; it is
removed.
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
from typing import BinaryIO, Self

import numpy as np

from rwmf.errors import InputError, OutputError
from rwmf.kernel import files
from rwmf.sweeps.axes import Layout, difference
from rwmf.sweeps.plan import Chunk

_MAGIC = b"rwmf sweep journal 3\n"
# number of the chunk, length of the payload, CRC-32 of both and the payload
_HEAD = struct.Struct("<QQI")
_LAYOUT = 2**64 - 1


class ChunkStore:
    """Finished chunks of a sweep."""

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
        """Find the complete entries or create the file; remove incomplete data."""
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
        """Return True for a finished chunk."""
        return number in self._index

    def __len__(self) -> int:
        """Count the finished chunks."""
        return len(self._index)

    def add(self, chunk: Chunk) -> None:
        """Append a chunk and wait until it is on the disk."""
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
        # unbuffered: a buffer would repeat a failed write when the file is closed
        rest = memoryview(content)
        while rest:
            rest = rest[self._file.write(rest) :]

    def get(self, number: int) -> Chunk:
        """Read a chunk."""
        self._file.seek(self._index[number])
        head = self._file.read(_HEAD.size)
        return _unpack(number, self._file.read(_HEAD.unpack(head)[1]), self.layout)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        """Return the store itself."""
        return self

    def __exit__(self, *unused: object) -> None:
        """Close the file."""
        self.close()


def read_layout(path: Path) -> Layout:
    """Read the layout of a journal."""
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
        # a damaged length could request all memory
        if length > os.fstat(file.fileno()).st_size - offset:
            return
        payload = file.read(length)
        if _head(number, payload) != head:
            return
        yield number, offset, payload, offset + _HEAD.size + length
        offset += _HEAD.size + length


def _head(number: int, *parts: bytes | memoryview) -> bytes:
    """Make the header of an entry."""
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
    """Open or create the file of this name, and lock it."""
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
    """Open a regular file without following links."""
    descriptor = os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise InputError(f"{path}: is no journal of a sweep")
    return descriptor
