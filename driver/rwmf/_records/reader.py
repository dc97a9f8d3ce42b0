"""Files of recorded motions: format by content, channels as motions."""

from __future__ import annotations

import re
import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rwmf._records import blocks, networks
from rwmf._records.channels import Channel
from rwmf._records.plain import read_by_kernel, read_header, read_table
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = [
    "RECORD_SUFFIXES",
    "VERTICAL_SUFFIXES",
    "is_at2",
    "read_bytes",
    "read_channels",
    "unit_of_header",
]

_AT2_MARK = b"NPTS"
_HEADER_BYTES = 1000
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
    _Dialect("COSMOS", blocks.is_cosmos, blocks.read_cosmos),
    _Dialect("CGS", blocks.is_cgs, blocks.read_cgs),
)
# formats known by their first line, for which no published record could be tried
_REFUSED = {
    "SMC (USGS)": re.compile(r"\s*[123*]\s+(UN)?CORRECTED ACCELEROGRAM"),
    "AFAD (Turkey)": re.compile(r"STRONG GROUND MOTION RECORDS OF T"),
    "GeoNet": re.compile(r".*GeoNet", re.IGNORECASE),
    "CWB (Taiwan)": re.compile(r"#\s*(Earthquake Information|StationCode)"),
}
_BINARY = b"\0"
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
# place in messages of the kernel, with the path in short
_PLACE = re.compile(r"&motion: (file = '.*?': )?")


def read_bytes(path: Path) -> bytes:
    """Read a regular file.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    bytes
        Its content.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    try:
        # opening a pipe could block for ever, reading a device could never end
        if not stat.S_ISREG(path.stat().st_mode):
            raise InputError(f"records: {path}: is not a regular file")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"records: {path}: cannot be read: {error.strerror}") from error


def is_at2(content: bytes) -> bool:
    """Recognise an AT2 file, whatever its name.

    Parameters
    ----------
    content : bytes
        The file.

    Returns
    -------
    bool
        True when it has NPTS in its header.
    """
    return _AT2_MARK in content[:_HEADER_BYTES].upper()


def unit_of_header(content: bytes) -> str | None:
    """Return the unit in the line of names above two columns.

    Parameters
    ----------
    content : bytes
        The file.

    Returns
    -------
    str or None
        The unit; None where none is given.
    """
    header = read_header(_lines(content))
    return None if header is None else header.unit


def read_channels(
    path: Path, content: bytes, unit: str | None, dt: float | None, *, is_any: bool = True
) -> Sequence[Channel]:
    """Read the channels of a file.

    Parameters
    ----------
    path : path
        The file.
    content : bytes
        Its bytes.
    unit : str, optional
        Unit of the samples where the file gives none.
    dt : float, optional
        Interval of the samples of one column [s].
    is_any : bool
        False for formats only that the kernel does not read.

    Returns
    -------
    sequence of Channel
        Its channels; empty for a format of the kernel when `is_any` is False.

    Raises
    ------
    InputError
        When the format is not read, or the file is damaged.
    """
    lines = _lines(content)
    dialect = next((item for item in _DIALECTS if item.is_it(lines)), None)
    header = None if dialect is not None or is_at2(content) else read_header(lines)
    try:
        if dialect is not None:
            if unit is not None or dt is not None:
                key = "unit" if dt is None else "dt"
                raise InputError(
                    f"the file ({dialect.name}) gives unit and interval: {key} must not be given"
                )
            return dialect.read(lines, path.stem)
        _check_known(content, lines)
        if header is not None and header.unit is not None and unit not in (None, header.unit):
            raise InputError(f"unit = {unit!r}: the header says {header.unit!r}")
        if header is not None and header.has_components:
            return read_table(lines, header, path.stem, unit)
    except InputError as error:
        place = "" if dialect is None else f"{dialect.name}: "
        raise InputError(f"records: {path}: {place}{error}") from error
    if not is_any:
        return ()
    if is_at2(content):
        unit = dt = None
    elif unit is None and header is not None:
        unit = header.unit
    return read_by_kernel(lines, _case_of(path, unit, dt), path.stem)


def _lines(content: bytes) -> list[str]:
    # the kernel ends lines at line feeds only
    return content.removeprefix(_BYTE_ORDER_MARK).decode("latin-1").split("\n")


def _check_known(content: bytes, lines: list[str]) -> None:
    if _BINARY in content[:_HEADER_BYTES]:
        raise InputError(
            "is a binary file: records are text; other programs convert miniSEED or SAC to two "
            "columns of time and acceleration"
        )
    first = lines[0] if lines else ""
    for name, pattern in _REFUSED.items():
        if pattern.match(first):
            raise InputError(
                f"the format {name} is not read, as no published record of it could be tried: "
                "write two columns of time [s] and acceleration"
            )


def _case_of(path: Path, unit: str | None, dt: float | None) -> Case:
    """Let the kernel read and validate a record."""
    motion = {"kind": "record", "file": str(path.absolute()), "unit": unit, "dt": dt}
    keys = {key: value for key, value in motion.items() if value is not None}
    try:
        return Case(frame={"T_s": 1.0, "xi_s": 0.05}, motion=keys)
    except InputError as error:
        text = _PLACE.sub("", str(error), count=1)
        raise InputError(f"records: {path}: {text}") from error
