"""Output files, written completely or not at all, and never over an input.

Every writer of the package uses `replacing`: a new file beside the target takes the target's name
once its bytes are on the disk. The order is write, fsync, rename, fsync of the folder. Superfluous
files (the journal of a sweep) are removed afterwards.

A new file has a random name and is created exclusively, so that no prepared link is followed. It is
locked while it is written. The file of a killed run therefore has no lock, on any host that shares
the folder. The next run in the folder removes it. The batch program uses the same names and locks.

HDF5 cannot close a file after a failed write; its remaining data end the process with a crash at
exit. `new_file` therefore hides failures from HDF5. Data that the disk refuses stay in memory
until HDF5 has closed the file. Then the error is raised.
"""

from __future__ import annotations

import csv
import errno
import fcntl
import functools
import io
import os
import re
import secrets
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from rwmf.errors import InputError, OutputError
from rwmf.kernel.names import problem_of_name
from rwmf.kernel.numbers import show

if TYPE_CHECKING:
    from h5netcdf import File
    from typing_extensions import Buffer

_TEMPORARY = re.compile(r"\.rwmf-[0-9a-f]{16}\.tmp(\.\w+)?")
_DESCRIPTOR = re.compile(r"/(?:dev|proc/(?:self|thread-self))/fd/(\d+)")
_NEW = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
# the kernel's limit for a chain of links
_MOST_LINKS = 40


def path_of(name: str, value: object, wanted: str = "the path of a file") -> str:
    """Return the text of a path."""
    path = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if not isinstance(path, str):
        raise InputError(f"{name} = {show(value)}: must be {wanted}")
    problem = problem_of_name(path)
    if problem is not None:
        raise InputError(f"{name} = {show(value)}: {problem}")
    return path


def check_outputs(
    outputs: Iterable[str | os.PathLike[str] | None],
    inputs: Iterable[str | os.PathLike[str]] = (),
) -> None:
    """Refuse, before the computation, outputs that cannot be written."""
    inputs = list(inputs)
    known: list[Path] = []
    for path in [Path(path) for path in outputs if path is not None]:
        with reported(path):
            target = _resolve(path)
        check_not_read(path, inputs)
        if _is_special(target):
            continue
        _check_folder(target.parent)
        if target.is_dir():
            raise OutputError(f"{path}: is a folder, not a file")
        if any(target == other or _is_same(target, other) for other in known):
            raise InputError(f"{path}: is written twice by this run; write to another file")
        known.append(target)


def check_not_read(path: str | os.PathLike[str], inputs: Iterable[str | os.PathLike[str]]) -> None:
    """Refuse to write an input file, under any name."""
    for source in inputs:
        if _is_same(path, source):
            raise InputError(f"{path}: is read by this run, as {source}; write to another file")


def is_regular_or_new(path: str | os.PathLike[str]) -> bool:
    """Check that a path, after following links, is a regular file or does not exist."""
    return not _is_special(_resolve(Path(path)))


@contextmanager
def replacing(path: str | os.PathLike[str], ending: str = "") -> Iterator[BinaryIO]:
    """Open a new file that replaces another when the block ends without an error.

    A link stays and its target is replaced. Special files (a pipe, a device, an open descriptor as
    /dev/stdout) are not replaced but written to.
    """
    with reported(path):
        target = _resolve(Path(path))
        if _is_special(target):
            with tempfile.NamedTemporaryFile(suffix=ending) as passing:
                yield cast("BinaryIO", passing)
                passing.flush()
                _copy(Path(passing.name), target)
            return
        _remove_leftovers(target.parent.absolute())
        stream = _create(target.parent, ending)
        try:
            # renamed while locked, so that no process removes it as a file of a killed run
            with stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
                Path(stream.name).replace(target)
            sync_folder(target.parent)
        finally:
            Path(stream.name).unlink(missing_ok=True)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file as `replacing` does."""
    with replacing(path) as stream:
        stream.write(content)


def csv_text(rows: Iterable[Iterable[object]], end: str = "\n") -> str:
    """Write rows as CSV; numbers keep all digits."""
    text = io.StringIO()
    csv.writer(text, lineterminator=end).writerows(rows)
    return text.getvalue()


def remove(path: Path) -> None:
    """Remove a file, if it exists, durably: a power failure does not restore it."""
    with reported(path):
        target = _resolve(path)
        target.unlink(missing_ok=True)
        sync_folder(target.parent)


def sync_folder(folder: Path) -> None:
    """Write the names of a folder to the disk, if its file system supports it."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except PermissionError:
        # a folder may be writable but not readable
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


@contextmanager
def reported(path: str | os.PathLike[str]) -> Iterator[None]:
    """Convert errors of the operating system on writing a file into `OutputError`."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error


def _open_new(path: str, _: int) -> int:
    return os.open(path, _NEW, 0o666)


def _create(folder: Path, ending: str) -> BinaryIO:
    """Create and lock a file with a random name and the permissions set by umask."""
    while True:
        path = folder / f".rwmf-{secrets.token_hex(8)}.tmp{ending}"
        stream = open(path, "w+b", opener=_open_new)  # noqa: SIM115
        try:
            # another process may have found the file before the lock, and removed it
            if _lock(stream.fileno(), unsupported=True) and path.exists():
                return stream
        except BaseException:
            stream.close()
            path.unlink(missing_ok=True)
            raise
        stream.close()


def _lock(descriptor: int, *, unsupported: bool) -> bool:
    """Lock a file; return `unsupported` where the file system has no locks."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return unsupported
    return True


@functools.cache
def _remove_leftovers(folder: Path) -> None:
    """Remove unlocked files of killed runs, once per process."""
    try:
        left = [path for path in folder.iterdir() if _TEMPORARY.fullmatch(path.name)]
    except OSError:
        # a folder that cannot be listed may still be writable
        return
    for name in left:
        try:
            descriptor = os.open(name, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
        except OSError:
            continue
        try:
            status = os.fstat(descriptor)
            own = stat.S_ISREG(status.st_mode) and status.st_uid == os.geteuid()
            if own and _lock(descriptor, unsupported=False):
                name.unlink(missing_ok=True)
        except OSError:
            continue
        finally:
            os.close(descriptor)


def _resolve(path: Path) -> Path:
    """Follow the links of the last name to a file, an unused name or a descriptor."""
    for _ in range(_MOST_LINKS):
        if _DESCRIPTOR.fullmatch(os.fspath(path)):
            return path
        try:
            link = path.readlink()
        except OSError:
            return path
        except ValueError as error:
            raise OSError(errno.EINVAL, str(error)) from error
        _check_owner(path)
        path = path.parent / link
    raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))


def _check_owner(link: Path) -> None:
    """Refuse a link of another user in a folder that all may write."""
    folder = link.parent.stat()
    shared = folder.st_mode & stat.S_ISVTX and folder.st_mode & stat.S_IWOTH
    if shared and link.lstat().st_uid not in (os.geteuid(), folder.st_uid):
        raise OSError(errno.EACCES, "it is another user's link in a folder that all may write")


def _is_special(target: Path) -> bool:
    """Check for a special file, which is neither a regular file nor a folder."""
    if _DESCRIPTOR.fullmatch(os.fspath(target)):
        return True
    try:
        mode = target.stat().st_mode
    except (OSError, ValueError):
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _copy(source: Path, target: Path) -> None:
    """Copy all bytes to a special file."""
    found = _DESCRIPTOR.fullmatch(os.fspath(target))
    if found and sys.stdout is not None:
        # keep the order with text that was printed before
        sys.stdout.flush()
    place = os.dup(int(found[1])) if found else os.open(target, os.O_WRONLY | os.O_CLOEXEC)
    with source.open("rb") as reader, os.fdopen(place, "wb") as writer:
        shutil.copyfileobj(reader, writer)


def _is_same(path: str | os.PathLike[str], other: str | os.PathLike[str]) -> bool:
    try:
        return Path(path).samefile(other)
    except (OSError, ValueError):
        return False


def _check_folder(folder: Path) -> None:
    if not folder.is_dir():
        raise OutputError(f"{folder}: the folder does not exist")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"{folder}: the folder cannot be written")
    _remove_leftovers(folder.absolute())


@contextmanager
def new_file(path: Path) -> Iterator[tuple[File, Callable[[], None]]]:
    """Open an empty NetCDF file that appears when the block ends without an error."""
    import h5netcdf

    with replacing(path) as stream:
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
