"""Files of recorded motions: format by content, channels as motions."""

from __future__ import annotations

import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rwmf import _library
from rwmf._records import blocks, networks
from rwmf._records.channels import Channel
from rwmf._records.plain import read_by_kernel
from rwmf.errors import InputError

__all__ = [
    "RECORD_SUFFIXES",
    "VERTICAL_SUFFIXES",
    "is_at2",
    "read_bytes",
    "read_channels",
    "unit_of_header",
]

# endings of record files in a folder, in lower case
RECORD_SUFFIXES = (
    *(".at2", ".asc", ".raw", ".knet", ".v1", ".v2", ".v1c", ".v2c"),
    *(".ew", ".ns", ".ew1", ".ew2", ".ns1", ".ns2"),
)
VERTICAL_SUFFIXES = (".ud", ".ud1", ".ud2")


@dataclass(frozen=True)
class _Dialect:
    name: str
    is_it: Callable[[list[str]], bool]
    read: Callable[[list[str], str], list[Channel]]


_DIALECTS = (
    _Dialect("ESM", networks.is_dyna, networks.read_dyna),
    _Dialect("K-NET", networks.is_nied, networks.read_nied),
    _Dialect("K-NET CSV", networks.is_nied_csv, networks.read_nied_csv),
    _Dialect("COSMOS", blocks.is_cosmos, blocks.read_cosmos),
    _Dialect("CGS", blocks.is_cgs, blocks.read_cgs),
)
_HEAD_BYTES = 1000
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def read_bytes(path: Path) -> bytes:
    """Read a regular file."""
    try:
        # opening a pipe could block for ever, reading a device could never end
        if not stat.S_ISREG(path.stat().st_mode):
            raise InputError(f"records: {path}: is not a regular file")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"records: {path}: cannot be read: {error.strerror}") from error


def is_at2(content: bytes) -> bool:
    """Recognise an AT2 file, whatever its name."""
    return _library.read_record_header(content).is_at2


def unit_of_header(content: bytes) -> str | None:
    """Return the unit that the header of a table or an AT2 file states."""
    return _library.read_record_header(content).unit


def read_channels(
    path: Path, content: bytes, unit: str | None, dt: float | None, *, is_any: bool = True
) -> Sequence[Channel]:
    """Read the channels of a file."""
    # a dialect shows in its first line, and long tables need no list of lines
    head = _lines(content[:_HEAD_BYTES])
    dialect = next((item for item in _DIALECTS if item.is_it(head)), None)
    try:
        if dialect is None:
            return _read_plain(path.stem, content, unit, dt, is_any)
        if unit is not None or dt is not None:
            key = "unit" if dt is None else "dt"
            raise InputError(
                f"the file ({dialect.name}) gives unit and interval: {key} must not be given"
            )
        return dialect.read(_lines(content), path.stem)
    except InputError as error:
        place = "" if dialect is None else f"{dialect.name}: "
        raise InputError(f"records: {path}: {place}{error}") from error


def _read_plain(
    name: str, content: bytes, unit: str | None, dt: float | None, is_any: bool
) -> Sequence[Channel]:
    """Read a file of the kernel's formats, as `read_channels`."""
    if is_any:
        return read_by_kernel(content, name, unit, dt)
    header = _library.read_record_header(content)
    if header.channels > 1:
        return read_by_kernel(content, name, unit, None)
    if unit is not None and not header.is_at2 and header.unit not in (None, unit):
        raise InputError(f"unit = {unit!r}: the header says {header.unit!r}")
    return ()


def _lines(content: bytes) -> list[str]:
    # the kernel ends lines at line feeds only
    return content.removeprefix(_BYTE_ORDER_MARK).decode("latin-1").split("\n")
