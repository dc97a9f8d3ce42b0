"""New NetCDF file, safe on a full disk.

HDF5 cannot close a file after a failed write; its remaining data end the process with a crash at
exit. This module therefore hides failures from HDF5. Data that the disk refuses stay in memory
until HDF5 has closed the file. Then the error is raised.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from rwmf.kernel import files

if TYPE_CHECKING:
    from h5netcdf import File
    from typing_extensions import Buffer


@contextmanager
def new_file(path: Path) -> Iterator[tuple[File, Callable[[], None]]]:
    """Open an empty NetCDF file that appears when the block ends without an error."""
    import h5netcdf

    with files.replacing(path) as stream:
        disk = _Disk(stream)
        try:
            with h5netcdf.File(disk, "w") as file:
                yield file, disk.check
        finally:
            # the original error, whatever HDF5 reports
            disk.check()


class _Disk(io.RawIOBase):
    """File object that accepts all data and keeps those that the disk refuses."""

    def __init__(self, stream: BinaryIO) -> None:
        self._descriptor = stream.fileno()
        self._error: OSError | None = None
        self._kept: list[tuple[int, bytes]] = []
        self._position = 0
        self._end = 0

    def check(self) -> None:
        """Raise the first error, if any."""
        if self._error is not None:
            raise self._error

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move to a position, possibly behind the end."""
        self._position = offset + (0, self._position, self._end)[whence]
        return self._position

    def write(self, data: Buffer) -> int:
        """Accept all bytes."""
        content = bytes(data)
        written = 0
        try:
            while self._error is None and written < len(content):
                place = self._position + written
                written += os.pwrite(self._descriptor, content[written:], place)
        except OSError as error:
            self._error = error
        if written < len(content):
            self._kept.append((self._position, content))
        self._position += len(content)
        self._end = max(self._end, self._position)
        return len(content)

    def readinto(self, buffer: Buffer) -> int:
        """Read written bytes, and zeros in gaps."""
        view = memoryview(buffer).cast("B")
        first, n = self._position, len(view)
        found = os.pread(self._descriptor, n, first)
        view[:] = found + bytes(n - len(found))
        for offset, content in self._kept:
            a, z = max(offset, first), min(offset + len(content), first + n)
            if a < z:
                view[a - first : z - first] = content[a - offset : z - offset]
        self._position += n
        return n

    def truncate(self, size: int | None = None) -> int:
        """Set the length."""
        self._end = self._position if size is None else size
        try:
            os.ftruncate(self._descriptor, self._end)
        except OSError as error:
            self._error = self._error or error
        return self._end
