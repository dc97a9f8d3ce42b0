"""Files of recorded motions: format by content, channels as motions, components."""

from __future__ import annotations

import re
import stat
from collections.abc import Iterable, Sequence
from pathlib import Path

from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.motion import formats
from rwmf.motion.formats import Channel, read_by_kernel

VERTICAL = "vertical"
# letters of band and instrument of a channel: HN, BN, HL, EN
_STREAM = r"[A-Z][GHLMNP]"
# words of a direction; single letters need a mark before them
_UP = rf"(?:[-_. ]?(?:up|dwn|down|vert?(?:ical)?|u-?d)|[-_. ](?:[vz]|dn|{_STREAM}z))"
_LEVEL = (
    r"(?:h[123]|hor[12]|[xynewslt]|ln|tr|n-?s|e-?w|fn|fp|north|south|east|west|long\w*|tran\w*"
    rf"|radial|{_STREAM}[NERT123])"
)
# (whole name, with its ending): key of the record and name of the component; the first that fits
_PATTERNS = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        # K-NET and KiK-net: CHB0021412312349.NS, NGNH311106302345.EW2
        r"(?P<key>.+)\.(?P<part>ns|ew|ud)(?P<further>[12]?)",
        # ESM and COSMOS, by the code of the stream: HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC
        rf"(?P<key>(?:.*\.)?{_STREAM})(?P<part>[ENZ123])(?P<further>\..+\..+)",
        rf"(?P<key>{_STREAM})(?P<part>[ENZ123])(?P<further>\.\w+)",
        # PEER, by the number of the record: RSN6_IMPVALL.I_I-ELC180.AT2
        rf"(?P<key>RSN\d+)_(?P<part>.*?)(?P<up>{_UP}(?:[-_]up)?)?(?:[-_]hor[12])?\.\w+",
        # sets of FEMA P-695: far_field_011.csv
        r"(?P<key>(?:far|near)_field_(?:\w+_)?\d\d)(?P<part>[12])\.\w+",
        # NORTHR_SYL090.AT2, ABBAR--L.AT2, quake-UP.txt, quake_h1.csv, quake_x.csv, quake-1.txt
        rf"(?P<key>.+?)(?P<part>\d{{3}}|(?P<up>{_UP})|[-_. ](?:{_LEVEL}|[123]))\.\w+",
        # in a folder of the station: 090.AT2, UP.AT2, x.csv
        rf"(?P<key>)(?P<part>\d{{3}}|(?P<up>up|dwn|down|vert?(?:ical)?|u-?d|[vz])|{_LEVEL})\.\w+",
    )
)
# endings of tables, whose third column or file need not be vertical
_TABLES = (".csv", ".txt", ".dat")
_VERTICAL_PARTS = ("ud", "z", "3")
# a component that no pattern knows: a letter, two digits, or at most four letters behind a mark
_SHORT = re.compile(r"(.+?)(?:[-_. ]+\w{1,4}|\d\d|[nsewltxyh])\.\w+", re.IGNORECASE)
# names that archives, file managers and editors leave behind, in lower case
_LEFT_BEHIND = frozenset(
    {"__macosx", ".ds_store", "thumbs.db", "desktop.ini", "@eadir", ".ipynb_checkpoints"}
)


def component_of(name: str) -> tuple[str, str]:
    """Return record and component of a file."""
    key, part, is_up = _split(name)
    return key, VERTICAL if is_up else part


def _split(name: str) -> tuple[str, str, bool]:
    """Return record, component, and whether it is vertical."""
    for pattern in _PATTERNS:
        match = pattern.fullmatch(name)
        if match is None:
            continue
        found = match.groupdict()
        part = found["part"].strip("-_. ").lower()
        is_up = found.get("up") is not None or part in _VERTICAL_PARTS
        return found["key"].rstrip("-_. ") + (found.get("further") or ""), part, is_up
    return name, "", False


def verticals_beside(paths: Iterable[Path]) -> set[Path]:
    """Find the vertical components beside horizontal ones of the same record and folder."""
    level: dict[tuple[Path, str], list[str]] = {}
    upward: list[tuple[tuple[Path, str], str, Path]] = []
    for path in paths:
        key, part, is_up = _split(path.name)
        place = (path.parent, key.lower())
        if is_up:
            upward.append((place, part, path))
            continue
        level.setdefault(place, []).append(part)
        short = _SHORT.fullmatch(path.name)
        if short is not None and short[1].lower() != place[1]:
            level.setdefault((path.parent, short[1].lower()), []).append(part)
    return {
        path
        for place, part, path in upward
        if place in level
        and (
            part != "3"
            or (sorted(level[place]) == ["1", "2"] and path.suffix.lower() not in _TABLES)
        )
    }


def is_left_behind(path: Path) -> bool:
    """Check whether an archive, file manager or editor has left a file or its folder behind."""
    return any(part.lower() in _LEFT_BEHIND or part.startswith("._") for part in path.parts)


# endings of record files in a folder, in lower case
RECORD_SUFFIXES = (
    *(".at2", ".asc", ".raw", ".knet", ".v1", ".v2", ".v1c", ".v2c"),
    *(".ew", ".ns", ".ew1", ".ew2", ".ns1", ".ns2"),
)
VERTICAL_SUFFIXES = (".ud", ".ud1", ".ud2")


# name, mark in the head of a file, and reader of each format
_DIALECTS = (
    ("ESM", r"\AEVENT_NAME:", formats.read_dyna),
    ("K-NET", r"\AOrigin Time", formats.read_nied),
    ("K-NET CSV", r"(?i)\A#(k-net|kik-net)", formats.read_nied_csv),
    ("CSMNC", r"(?m)^(?=.*CORRECTED ACCELERATION ).*UNIT:", formats.read_csmnc),
    ("COSMOS", r"\A(?=.*acceleration).*\(Format v", formats.read_cosmos),
    # GeoNet of New Zealand begins alike
    (
        "CGS",
        r"\A(?!(?i:.*(GNS|Geological and Nuc)))(Uncorrected Accelerogram Data|Corrected "
        r"accelerogram )",
        formats.read_cgs,
    ),
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


def read_channels(
    path: Path, content: bytes, unit: str | None, dt: float | None, *, is_any: bool = True
) -> Sequence[Channel]:
    """Read the channels of a file."""
    # a dialect shows in its first line, and long tables need no list of lines
    head = _lines(content[:_HEAD_BYTES])
    text = "\n".join(head)
    dialect, read = next(
        ((name, read) for name, mark, read in _DIALECTS if re.search(mark, text)), ("", None)
    )
    try:
        if read is None:
            return _read_plain(path.stem, content, unit, dt, is_any)
        if unit is not None or dt is not None:
            key = "unit" if dt is None else "dt"
            raise InputError(
                f"the file ({dialect}) gives unit and interval: {key} must not be given"
            )
        return read(_lines(content), path.stem)
    except InputError as error:
        place = "" if read is None else f"{dialect}: "
        raise InputError(f"records: {path}: {place}{error}") from error


def _read_plain(
    name: str, content: bytes, unit: str | None, dt: float | None, is_any: bool
) -> Sequence[Channel]:
    """Read a file of the kernel's formats, as `read_channels`."""
    if is_any:
        return read_by_kernel(content, name, unit, dt)
    header = tables.read_record_header(content)
    if header.channels > 1:
        return read_by_kernel(content, name, unit, None)
    if unit is not None and not header.is_at2 and header.unit not in (None, unit):
        raise InputError(f"unit = {unit!r}: the header says {header.unit!r}")
    return ()


def _lines(content: bytes) -> list[str]:
    # the kernel ends lines at line feeds only
    return content.removeprefix(_BYTE_ORDER_MARK).decode("latin-1").split("\n")
